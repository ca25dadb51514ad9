"""Sixty cases before and after a change: degree, verdicts, fairness, mesh and seconds of each.

    python benchmarks/reference.py --write FILE.json
    python benchmarks/reference.py --against FILE.json [--checkout PATH]

`--write` keeps the values.  `--against` compares with those that were kept, prints what differs, and exits with 1 where
a verdict or a degree differs, more than three cases are less fair, or, with `--checkout`, time is above 1.2 times (that
of meshes above 1.1 times) that of another checkout, which is run at the same time, case by case in turn: seconds of two
runs say nothing about each other.  Names of cases may be given, to run these only; `--repeat` takes the least seconds
of several runs.

Seconds are of the processor, with one thread: of the construction, with all proofs that it makes, of the mesh, of the
mesh's certificate, and of the shape's certificate after it was saved and loaded.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

HERE = Path(__file__).resolve().parent
PHASES = {"construction": 1.2, "mesh": 1.1, "mesh certificate": 1.1, "certificate": 1.2}
"""How many times as long each may take."""

LESS_FAIR = 3
"""So many cases may be less fair."""

SLACK = 0.01
"""By how much the excess of the measures over their limits may grow before a case is less fair: below it, two surfaces
look alike."""

Record = dict[str, Any]
T = TypeVar("T")


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """What comes of some work, and its seconds."""
    start = time.process_time()
    result = work()
    return result, time.process_time() - start


def measured(name: str) -> Record:
    """All values of one case."""
    from reference_cases import all_cases

    import pas

    if not hasattr(pas, "Session"):
        pas.keep_blends(0)  # versions without sessions kept blends by themselves; each is to be found anew
    case = all_cases()[name]
    try:
        shape, construction = timed(case.make)
        mesh, meshing = timed(lambda: shape.mesh(case.tolerance))
        sound, soundness = timed(lambda: mesh.certificate)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "case.pas.json"
            shape.save(path)
            certificate, proving = timed(lambda: pas.load(path).certificate)
    except (pas.PasError, ArithmeticError, ValueError, TypeError) as error:
        return {"error": f"{type(error).__name__}: {error}"}
    return {
        "degree": degree(shape),
        "verdicts": statuses(certificate),
        "fairness": fairness(shape),
        "mesh verdicts": statuses(sound),
        "distance": mesh.deviation,
        "triangles": len(mesh.triangles),
        "smallest angle": float(mesh.smallest_angles.min()),
        "seconds": dict(zip(PHASES, (construction, meshing, soundness, proving), strict=True)),
    }


def degree(shape: Any) -> Any:
    """Of the surface, of both sides of what is hollow, in both parameters; None for solids and where there is none."""
    if hasattr(shape, "outer"):
        return [shape.outer.surface.degree, shape.inner.surface.degree]
    surface = getattr(shape, "surface", shape)
    if not getattr(surface, "is_exact", True):
        return None
    found = getattr(surface, "degrees", None) or getattr(surface, "degree", None)
    return list(found) if isinstance(found, tuple) else found


def statuses(certificate: Any) -> list[list[str]]:
    """The claims, without the numbers that were found, and what came of each."""
    return [[re.sub(r"within \S+", "within so much", v.claim), v.status.value] for v in certificate.verdicts]


def fairness(shape: Any) -> dict[str, list[float]]:
    """The measures that have limits, each beside its own."""
    parts = {"outer ": shape.outer, "inner ": shape.inner} if hasattr(shape, "outer") else {"": shape}
    found = {}
    for prefix, part in parts.items():
        measures, limits = getattr(part, "fairness", None), getattr(part, "limits", None)
        if measures is not None and limits is not None and not callable(measures):
            for field in fields(limits):
                found[prefix + field.name] = [getattr(measures, field.name), getattr(limits, field.name)]
    return found


def excess(record: Record) -> float:
    """How far the measures are beyond their limits in all, each over its limit."""
    return sum(max(0.0, value / most - 1) for value, most in record["fairness"].values())


class Worker:
    """A process that measures cases with the package of one checkout."""

    def __init__(self, checkout: Path) -> None:
        paths = os.pathsep.join((str(checkout), str(HERE)))
        threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **threads, "PYTHONPATH": paths},
        )
        home = Path(self.asked("")).resolve()
        if home != checkout.resolve() / "pas":
            raise SystemExit(f"the package was found in {home}, not in {checkout}")

    def asked(self, name: str) -> Any:
        """The values of a case; of none, where the package is."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(f"{name}\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"the process that measured {name!r} ended")
        return json.loads(line)


def serve() -> None:
    """Measure the cases that are named line by line."""
    import pas

    for line in sys.stdin:
        name = line.strip()
        print(json.dumps(measured(name) if name else str(Path(pas.__file__).parent)), flush=True)


def run(names: Sequence[str], checkouts: Sequence[Path], repeat: int) -> Iterator[tuple[str, list[Record]]]:
    """The values of each case in each checkout, whose turns alternate."""
    workers = [Worker(checkout) for checkout in checkouts]
    for worker in workers:
        worker.asked("sphere and pipe, GC^1")  # imports
    for name in names:
        rounds = [[worker.asked(name) for worker in workers] for _ in range(repeat)]
        yield name, [fastest(records) for records in zip(*rounds, strict=True)]


def fastest(records: Sequence[Record]) -> Record:
    """The last record, with the least seconds of all."""
    last = records[-1]
    if "error" in last:
        return last
    return {**last, "seconds": {phase: min(r["seconds"][phase] for r in records if "seconds" in r) for phase in PHASES}}


def rounded(value: Any) -> Any:
    """Values with six digits of each number."""
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


def differences(old: Record, new: Record) -> list[str]:
    """What of degree and verdicts differs, in words."""
    if "error" in old or "error" in new:
        return [] if old == new else [f"{old.get('error', 'was made')} -> {new.get('error', 'is made')}"]
    found = [] if old["degree"] == new["degree"] else [f"degree {old['degree']} -> {new['degree']}"]
    for key in ("verdicts", "mesh verdicts"):
        if old[key] != new[key]:
            gone = [f"{claim}: {status}" for claim, status in old[key] if [claim, status] not in new[key]]
            come = [f"{claim}: {status}" for claim, status in new[key] if [claim, status] not in old[key]]
            found.append(f"{key}: {', '.join(gone) or 'in another order'} -> {', '.join(come) or 'none'}")
    return found


def mesh_row(old: Record, new: Record) -> str:
    """The mesh's values beside each other, where they are not the same."""
    keys = ("distance", "triangles", "smallest angle")
    if all(old[key] == new[key] for key in keys):
        return ""
    return ", ".join(f"{key} {_short(old[key])} -> {_short(new[key])}" for key in keys)


def _short(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def compare(old: Mapping[str, Record], new: Mapping[str, Record]) -> list[str]:
    """Print what differs; what of it is too much, in words."""
    wrong: list[str] = []
    less: list[str] = []
    for name, record in new.items():
        if name not in old:
            print(f"{name:<32} is new")
            continue
        bad = differences(old[name], record)
        wrong += [f"{name}: {text}" for text in bad]
        lines = list(bad)
        if "error" not in old[name] and "error" not in record:
            if excess(record) > excess(old[name]) + SLACK:
                less.append(name)
                lines.append(f"less fair: {excess(old[name]):.3f} -> {excess(record):.3f} beyond its limits")
            lines += filter(None, [mesh_row(old[name], record)])
        for line in lines:
            print(f"{name:<32} {line}")
    if len(less) > LESS_FAIR:
        wrong.append(f"{len(less)} cases are less fair: {'; '.join(less)}")
    return wrong


def compare_seconds(old: Mapping[str, Record], new: Mapping[str, Record], judged: bool) -> list[str]:
    """Print the sums of seconds; what of them is too much, in words."""
    both = [
        (old[name], record) for name, record in new.items() if "seconds" in record and "seconds" in old.get(name, {})
    ]
    wrong = []
    for phase, most in PHASES.items():
        before, after = (sum(pair[side]["seconds"][phase] for pair in both) for side in (0, 1))
        ratio = after / max(before, 1e-9)
        print(f"{phase:<18}{before:>9.2f} s ->{after:>9.2f} s {ratio:>6.2f}" + ("" if judged else " (of two runs)"))
        if judged and ratio > most:
            wrong.append(f"{phase} takes {ratio:.2f} times as long, above {most}")
    return wrong


def main() -> None:
    """Read the command line, run and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="names of cases (all if none is given)")
    parser.add_argument("--write", type=Path, metavar="FILE", help="keep the values")
    parser.add_argument("--against", type=Path, metavar="FILE", help="compare with values that were kept")
    parser.add_argument("--checkout", type=Path, metavar="PATH", help="compare seconds with those of another checkout")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        return serve()
    sys.path.insert(0, str(HERE.parent))
    from reference_cases import all_cases

    names = options.cases or list(all_cases())
    if unknown := [name for name in names if name not in all_cases()]:
        parser.error(f"no such case: {', '.join(unknown)}")
    checkouts = [HERE.parent, *filter(None, [options.checkout])]
    new: dict[str, Record] = {}
    other: dict[str, Record] = {}
    for name, records in run(names, checkouts, options.repeat):
        new[name] = rounded(records[0])
        if records[1:]:
            other[name] = rounded(records[1])
        spent = "  ".join(f"{s:6.2f}" for s in records[0].get("seconds", {}).values()) or records[0]["error"]
        print(f"{name:<32}{spent}", flush=True)
    if options.write:
        lines = (f"{json.dumps(name)}: {json.dumps(record)}" for name, record in new.items())
        options.write.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    kept = json.loads(options.against.read_text()) if options.against else other
    if kept:
        wrong = compare(kept, new) + compare_seconds(other or kept, new, bool(other))
        print(f"\n{len(wrong)} too much" if wrong else "\nas it was", *wrong, sep="\n  ")
        sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
