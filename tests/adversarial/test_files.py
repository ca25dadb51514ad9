"""Files changed at random, a right checksum included: every one is read or refused in one sentence, whole, in time.

A worker process of limited memory runs the commands (`file_worker`); the files are those of `file_cases`, changed by
`file_mutations`.  Judged are the exit code, what was printed and what was written: no traceback and no error of
Python's own, no hang, no death for want of memory, nothing half-written, no success with a refuted verdict.
"""

from __future__ import annotations

import json
import os
import random
import re
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from file_cases import Base, problems, projects
from file_mutations import changed

import pas

PATIENCE = 10.0
"""Seconds that a command is allowed: it must end soon after, in a sentence of its own."""

WAIT = 1200.0
"""Seconds without an answer and without work: the worker itself ends after 20 s of work (`file_worker.HANG`)."""

LONGEST_SENTENCE = 800
"""Characters of a message; those of our own sentences stay below 400, of which a part is quoted from the file."""

FEW, MANY, CHUNKS = 60, 10_000, 4

BLENDS = ("corner.pas.json", "elbow.pas.json")
"""Files that both checkers take."""

WRITTEN = {".json", ".stl", ".ply"}


class Worker:
    """A process that runs commands, started again where it died."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self.buffer = b""

    def run(self, seconds: float | None, arguments: list[str]) -> dict[str, Any]:
        """The reply to one command; `code` is a signal's name, or "silent", where there was none."""
        process = self._started()
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(json.dumps([seconds, arguments]).encode() + b"\n")
        process.stdin.flush()
        answer = b""
        while not answer.endswith(b"\n"):
            ready, _, _ = select.select([process.stdout], [], [], WAIT)
            more = os.read(process.stdout.fileno(), 1 << 16) if ready else None
            if not more:
                end = signal.Signals(-process.wait()).name if ready else "silent"
                self.stop()
                return {"code": end, "out": "", "err": "", "seconds": 0.0}
            answer += more
        return dict(json.loads(answer))

    def stop(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def _started(self) -> subprocess.Popen[bytes]:
        if self.process is None:
            script = Path(__file__).with_name("file_worker.py")
            threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
            self.process = subprocess.Popen(
                [sys.executable, str(script)],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=os.environ | threads,
            )  # fmt: skip
        return self.process


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    made = Worker()
    yield made
    made.stop()


@cache
def bases() -> tuple[Base, ...]:
    """The good files."""
    return (*problems(), *projects())


def case(number: int, known: tuple[Base, ...]) -> tuple[Base, tuple[str, ...], bytes]:
    """The file and the command of a number, the same on every machine."""
    rng = random.Random(number)
    base = known[number % len(known)]
    return base, rng.choice(base.commands), changed(base, rng)


def run(
    worker: Worker,
    base: Base,
    command: tuple[str, ...],
    content: bytes,
    folder: Path,
    seconds: float | None = PATIENCE,
) -> tuple[Any, Path]:
    """The reply, and the folder with nothing but the file and what was written."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    file = folder / base.name
    file.write_bytes(content)
    places = {"{}": str(file), "a.stl": str(folder / "a.stl"), "a.ply": str(folder / "a.ply")}
    arguments = [places.get(word, word) for word in command]
    if arguments[-1] == "-o":
        arguments.append(str(folder))
    return worker.run(seconds, [arguments[0], "--debug", *arguments[1:]]), file


def judged(reply: dict[str, Any], file: Path) -> str:
    """What is wrong with the outcome of a command; empty where all is well."""
    code, err = reply["code"], reply["err"]
    if code not in (0, 1, 2):
        return f"exit code {code}: {err[-600:]}"
    complaints = [line for line in err.splitlines() if line.startswith("pas: ")]
    if code == 2 and not complaints:
        return f"exit code 2 without a word: {err[-300:]}"
    if any(len(line) > LONGEST_SENTENCE for line in complaints):
        return f"a sentence of {max(map(len, complaints))} characters: {complaints[0][:200]}"
    return _not_ours(err) or _written(reply, file) or _verdict(reply)


def _not_ours(err: str) -> str:
    """The end of a traceback that no `raise` of `pas` began: an error that nobody thought of."""
    frames = list(re.finditer(r'^  File "(.*)", line \d+, in .*\n    (.*)$', err, re.MULTILINE))
    if not frames:
        return ""
    path, line = frames[-1].groups()
    of_pas = re.match(r"pas\.", err[frames[-1].end() :].lstrip(" ^~\n"))
    if of_pas or (f"{os.sep}pas{os.sep}" in path and line.startswith("raise")):
        return _python_words(err)
    return f"not refused but failed: {err[frames[-1].start() :][-700:]}"


def _python_words(err: str) -> str:
    """Errors of Python's own that a sentence of ours passes on."""
    last = err.rstrip().splitlines()[-1]
    pattern = r"KeyError|TypeError|IndexError|AttributeError|ValueError|object is not|object has no|not iterable|unpack"
    return f"Python's own words: {last[:300]}" if re.search(pattern, last) else ""


def _written(reply: dict[str, Any], file: Path) -> str:
    """Files that are not whole, or are there after a refusal."""
    others = [p for p in file.parent.iterdir() if p != file or (reply["code"] == 2 and p.name.startswith("."))]
    for path in others:
        if path.suffix not in WRITTEN or path.name.startswith("."):
            return f"left behind: {path.name}"
        if reply["code"] == 2:
            return f"refused, and yet wrote {path.name}"
        if path.suffix == ".json":
            pas.load(path)
        elif path.suffix == ".stl" and (path.stat().st_size - 84) % 50:
            return f"{path.name} is not whole"
    return ""


def _verdict(reply: dict[str, Any]) -> str:
    """A success that the verdicts do not bear out."""
    if '"proved": ' in reply["out"]:
        told = json.loads(reply["out"])
        proved = bool(told["verdicts"]) and all(v["status"] == "proved" for v in told["verdicts"])
        failed = any(v["status"] in ("refuted", "fails, measured") for v in told["verdicts"])
        right = told["proved"] == proved and told["holds"] == (reply["code"] == 0) and told["holds"] <= (not failed)
        return "" if right else f"exit code {reply['code']}, but {reply['out'][-300:]}"
    last = reply["out"].rstrip().splitlines()[-1:] or [""]
    claims = [line for line in reply["out"].splitlines() if re.search(r"\brefuted\b", line)]
    if reply["code"] == 0 and re.match(r"(not )?all proved|none refuted", last[0]) and (
        last[0].startswith("not") or any(not line.startswith("none refuted") for line in claims)
    ):  # fmt: skip
        return f"exit code 0, but {(claims or last)[0]}"
    return ""


def _contradicted(worker: Worker, reply: dict[str, Any], base: Base, content: bytes, folder: Path) -> str:
    """What one checker of blends proves and the other refutes."""
    other, _ = run(worker, base, ("check", "{}", "--independent"), content, folder)
    for first, second in ((reply, other), (other, reply)):
        refuted = [line for line in second["out"].splitlines() if re.search(r"  refuted\b", line)]
        if first["code"] == 0 and refuted:
            return f"proved by one checker, and by the other: {refuted[0]}"
    return ""


def hunt(numbers: range, worker: Worker, folder: Path) -> list[str]:
    """What went wrong in the cases of these numbers."""
    known, found = bases(), []
    for number in numbers:
        base, command, content = case(number, known)
        reply, file = run(worker, base, command, content, folder / "case")
        wrong = judged(reply, file)
        if not wrong and command == ("check", "{}") and reply["code"] in (0, 1) and base.name in BLENDS:
            wrong = _contradicted(worker, reply, base, content, folder / "case")
        if wrong:
            found.append(f"case {number}, {base.name}, {command[0]}: {wrong}")
    return found


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_changed_files_are_read_or_refused(chunk, worker, tmp_path):
    assert not hunt(range(chunk, FEW, CHUNKS), worker, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_ten_thousand_changed_files(chunk, worker, tmp_path):
    assert not hunt(range(FEW + chunk, FEW + MANY, CHUNKS), worker, tmp_path)


@pytest.mark.slow
def test_the_files_are_good_before_they_are_changed(worker, tmp_path):
    for base in bases():
        for command in base.commands:
            reply, file = run(worker, base, command, base.text.encode(), tmp_path / "case", None)
            assert not judged(reply, file)
            assert reply["code"] in (0, 1) and "pas: " not in reply["err"], reply
