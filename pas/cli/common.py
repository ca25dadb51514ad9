"""The common parts of commands: exit codes, results, progress, settings as arguments, names of files, versions."""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeVar

from pas._version import __version__
from pas.algebra.rational import read_number, to_float
from pas.exchange.files import check_folder, source
from pas.exchange.formats import FORMATS
from pas.limits import note, stage_line
from pas.settings import options

EXIT_CODES = """\
Exit codes: 0 success; 1 something could not be done or proved; 2 wrong usage or input; 130 interrupted.
A command that prints verdicts ends with 1 if one of them is refuted, or fails as measured, even if the
problem file says `prove = false`.  A verdict that is merely undecided is a failure for `pas check` and
`pas teapot` and, for problem files, unless they say `prove = false`.  Claims that can only be measured
need not be proved, except with `prove = true` and for `pas check --independent`."""
"""The rule for all commands, as `pas --help` shows it."""

DONE, FAILED, WRONG = 0, 1, 2
INTERRUPTED = 130
"""After Ctrl-C, as shells expect it: 128 and the number of the signal."""


@dataclass(frozen=True)
class CommandResult:
    """The result of a command: the text that it prints, the same as a record for `--json`, and the exit code."""

    text: str
    record: dict[str, Any]
    code: int = DONE


@dataclass
class Clock:
    """Seconds spent in each stage; each is told as it ends."""

    seconds: dict[str, float] = field(default_factory=dict)
    last: float = field(default_factory=time.perf_counter)

    def passed(self, stage: str, detail: str = "") -> None:
        """Say that a stage has ended."""
        now = time.perf_counter()
        self.seconds[stage] = round(now - self.last, 3)
        note(stage_line(f"{stage}{detail}", now - self.last))
        self.last = now


def verdict_record(certificate: Any) -> dict[str, Any]:
    """A certificate as a record for programs."""
    verdicts = [verdict.to_record() for verdict in certificate.verdicts]
    return {"proved": certificate.proved, "holds": certificate.holds, "verdicts": verdicts}


def written_lines(files: Sequence[Path | str]) -> list[str]:
    """The names of files that were written, one a line."""
    return ["", "written:", *(f"  {name}" for name in files)] if files else []


def number(text: str) -> float:
    """A number in an argument: a decimal or a fraction."""
    try:
        return to_float(read_number(text))
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(f"must be a number, as 0.01 or 1/100, not {text!r}") from None


Settings = TypeVar("Settings")


def add_settings(
    parser: argparse._ActionsContainer, settings: type[Any], usual: str = "", leave: Iterable[str] = ()
) -> None:
    """An argument for each option of a class of settings, but those to leave out; `usual` stands in help texts."""
    for one in options(settings, "command", leave):
        name, about = f"--{one.name.replace('_', '-')}", one.metadata
        text = about["text"].format(usual=usual).replace("%", "%%")
        if about["kind"] is bool and about["metavar"]:  # which may be said more closely
            parser.add_argument(name, nargs="?", const=True, default=None, metavar=about["metavar"], help=text)
        elif about["kind"] is bool:
            parser.add_argument(name, action="store_true", default=None, help=text)
        else:
            known: dict[type, Any] = {list: str, float: number}
            kind = known.get(about["kind"], about["kind"])
            parser.add_argument(name, type=kind, metavar=about["metavar"], help=text)


def settings_of(settings: type[Settings], arguments: argparse.Namespace) -> Settings:
    """The settings that arguments give; what was not given is as usual."""
    values = {one.name: getattr(arguments, one.name, None) for one in options(settings, "command")}
    return settings(**{name: value for name, value in values.items() if value is not None})


def output_folder(name: str) -> Path:
    """The folder to write to, which need not exist; raises `ValueError` where it cannot be one."""
    folder = source(name)
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not existing.is_dir() or folder.suffix.lower() in (*FORMATS, ".png", ".json", ".toml"):
        raise ValueError(f"{name} is not a folder; -o names the folder to write to")
    check_folder(existing)
    return folder


def project_file(name: str) -> str:
    """The name of a project file to read; raises `ValueError` for that of a problem file."""
    if name.endswith(".toml"):
        raise ValueError(f"{name} is a problem file; make a project of it with `pas blend`")
    return name


def problem_file(name: str) -> str:
    """The name of a problem file to read; raises `ValueError` for that of a project file."""
    if name.endswith(".json"):
        raise ValueError(
            f"{name} is a project, solved already; `pas check`, `mesh`, `render`, `write` and `convert` take it, "
            "and this command the problem file (.toml) it was made from"
        )
    return name


def tell(line: str) -> None:
    """Say on stderr what is being done; nothing but results goes to stdout."""
    print(line, file=sys.stderr, flush=True)


LIBRARIES = ("numpy", "scipy", "sympy", "python-flint", "cvxpy", "clarabel", "daqp", "pyvista", "vtk", "manifold3d")
"""The libraries on which results and their speed depend."""


def version_text(verbose: bool) -> str:
    """The version; with `verbose` also that of Python and of libraries."""
    if not verbose:
        return f"pas {__version__}"
    lines = [f"pas {__version__}", f"Python {platform.python_version()} on {platform.platform()}"]
    lines += [f"{name} {_installed(name)}" for name in LIBRARIES]
    return "\n".join(lines)


def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "is not installed"
