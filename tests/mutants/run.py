"""Mutation of the proof code: `make mutants`.

    python tests/mutants/run.py [--only PATTERN] [--jobs N] [--seconds S]

Each list `*.toml` beside this file holds entries

    [[mutant]]
    name = "a wall is skipped"            # unique
    file = "pas/certify/proofs.py"        # from the root
    old = "for face in surface.walls"     # occurs exactly once in the file
    new = "for face in surface.walls[1:]"
    tests = ["tests/test_proofs.py::test_walls"]  # pytest arguments, at least one of which must fail
    hangs = true                          # only where it is killed by never ending

Every mutant is applied to a copy of the tree and its tests are run there.  Fails, with a table, if a
mutant survives, hangs unannounced, cannot be compiled or imported, or if the unmutated tests fail.
"""

from __future__ import annotations

import argparse
import ast
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from build_backend import compile_library  # noqa: E402  # beside the package, not in it

LEFT_BEHIND = shutil.ignore_patterns(".*", "__pycache__", "*.egg-info", "out", "build", "dist", "*.png")
"""What no test of the proofs reads."""

SECONDS = 180.0
"""A mutant that takes longer hangs: the tests named in the lists take seconds."""

ENVIRONMENT = {
    "PYTHONDONTWRITEBYTECODE": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PAS_ALL_CASES": "1",
    "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # whose imports take a second, and of which the tests use none
}

TESTS_FAILED = 1
"""pytest's exit status where tests ran and failed; 2 and above: they could not be run."""


@dataclass(frozen=True)
class Mutant:
    """One rule broken: `old` in `file` becomes `new`; `tests` are pytest arguments."""

    list: str
    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    hangs: bool = False

    def mutated(self, root: Path) -> str:
        """The file's text with the rule broken."""
        return (root / self.file).read_text(encoding="utf-8").replace(self.old, self.new)


def mutants(root: Path = ROOT) -> list[Mutant]:
    """The mutants of all lists; raises `TypeError` for an entry with a missing or an unknown key."""
    found = []
    for path in sorted((root / "tests" / "mutants").glob("*.toml")):
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]:
            found.append(Mutant(**(entry | {"list": path.stem, "tests": tuple(entry["tests"])})))
    return found


def flaws(mutant: Mutant, root: Path = ROOT) -> Iterator[str]:
    """What is wrong with an entry, found without running anything."""
    path = root / mutant.file
    if not mutant.file.startswith("pas/") or not path.is_file():
        yield f"{mutant.file} is no file of the package"
        return
    times = path.read_text(encoding="utf-8").count(mutant.old) if mutant.old else 0
    if times != 1 or mutant.old == mutant.new:
        yield f"its old text occurs {times} times in {mutant.file}, not once, or is the new one"
        return
    try:
        if path.suffix == ".py":
            compile(mutant.mutated(root), mutant.file, "exec")
    except SyntaxError as error:
        yield f"{mutant.file} does not compile: {error}"
    named = [test for test in mutant.tests if ".py" in test]
    if not named:
        yield "it names no test file"
    for test in named:
        file, _, function = test.partition("::")
        if not (root / file).is_file():
            yield f"{file} does not exist"
        elif function and function.split("[")[0].split("::")[-1] not in _functions(root / file):
            yield f"{file} has no test {function}"


@cache
def _functions(path: Path) -> set[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}


def prepared(root: Path, folder: Path) -> Path:
    """A copy of the tree, compiled so that a changed source is noticed by its hash, not by its date."""
    base = folder / "unmutated"
    shutil.copytree(root, base, ignore=LEFT_BEHIND)
    compile_all = ["-m", "compileall", "-q", "--invalidation-mode", "checked-hash", "pas"]
    subprocess.run([sys.executable, *compile_all], cwd=base, check=True)
    return base


def pytest_status(tree: Path, tests: tuple[str, ...], seconds: float | None) -> tuple[int | None, str]:
    """The exit status of the tests in a tree and what they printed; None where they took too long."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", "slow or not slow", *tests]
    environment = os.environ | ENVIRONMENT | {"PYTHONPATH": str(tree)}
    process = subprocess.Popen(
        command, cwd=tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        start_new_session=True,
    )  # fmt: skip
    try:
        printed, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # with the commands that the tests started
        process.communicate()
        return None, ""
    return process.returncode, printed


def outcome(mutant: Mutant, base: Path, seconds: float) -> str:
    """ "killed", or what happened instead."""
    tree = Path(tempfile.mkdtemp(dir=base.parent))
    try:
        shutil.copytree(base, tree, dirs_exist_ok=True)
        (tree / mutant.file).write_text(mutant.mutated(tree), encoding="utf-8")
        if mutant.file.endswith((".c", ".h")):
            compile_library(sorted((tree / "pas" / "kernels").glob("*.c")), tree / "pas" / "kernels" / "_library.so")
        status, printed = pytest_status(tree, mutant.tests, seconds)
    finally:
        shutil.rmtree(tree, ignore_errors=True)
    if status is None:
        return "killed" if mutant.hangs else f"hangs (no end in {seconds:g} s)"
    if status == 0:
        return "SURVIVED"
    return "killed" if status == TESTS_FAILED else f"tests cannot be run (status {status})\n{printed[-2000:]}"


def unmutated(chosen: list[Mutant], base: Path) -> list[str]:
    """What the tests print that fail without any mutation: each must be a test that can pass."""
    plain = {test for m in chosen if not _has_options(m) for test in m.tests}
    runs = {tuple(sorted(plain))} if plain else set()
    runs |= {m.tests for m in chosen if _has_options(m)}
    done = [(tests, *pytest_status(base, tests, None)) for tests in sorted(runs)]
    return [f"without any mutation: {' '.join(tests)}\n{printed[-4000:]}" for tests, status, printed in done if status]


def _has_options(mutant: Mutant) -> bool:
    return any(test.startswith("-") for test in mutant.tests)


def run(root: Path, only: str, jobs: int, seconds: float) -> bool:
    """Run the mutants whose name or list matches, print a table; whether all were killed."""
    known = mutants(root)
    chosen = [m for m in known if fnmatch(f"{m.list}: {m.name}", f"*{only}*")]
    wrong = [f"{m.list}: {m.name}: {flaw}" for m in chosen for flaw in flaws(m, root)]
    if wrong or not chosen:
        print("\n".join(wrong) or f"none of {len(known)} mutants matches {only!r}")
        return False
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        base = prepared(root, Path(folder))
        failing = unmutated(chosen, base)
        if failing:
            print("\n".join(failing))
            return False
        print(f"the unmutated tests pass; {len(chosen)} mutants, {jobs} at a time", flush=True)
        with ThreadPoolExecutor(jobs) as pool:
            outcomes = list(pool.map(lambda m: _reported(m, base, seconds), chosen))
    killed = outcomes.count("killed")
    print(f"\n{killed} of {len(chosen)} killed")
    for mutant, result in zip(chosen, outcomes, strict=True):
        if result != "killed":
            print(f"  {mutant.list}: {mutant.name}: {result}")
    return killed == len(chosen)


def _reported(mutant: Mutant, base: Path, seconds: float) -> str:
    start = time.perf_counter()
    result = outcome(mutant, base, seconds)
    line = f"{mutant.list:<12} {mutant.name:<60} {time.perf_counter() - start:6.1f} s  {result.splitlines()[0]}"
    print(line, flush=True)
    return result


def main(arguments: list[str] | None = None) -> int:
    """The command; 0 where all mutants were killed."""
    parser = argparse.ArgumentParser(description="Break each rule of the proofs and see a test fail.")
    parser.add_argument("--only", default="", metavar="PATTERN", help="part of `LIST: NAME`; * stands for anything")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="how many run at a time (default: 2)")
    parser.add_argument("--seconds", type=float, default=SECONDS, metavar="S", help="time limit of each mutant")
    parser.add_argument("--root", type=Path, default=ROOT, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    return 0 if run(options.root, options.only, options.jobs, options.seconds) else 1


if __name__ == "__main__":
    sys.exit(main())
