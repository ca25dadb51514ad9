"""Problem files (TOML) of every kind: one reader, and what all problems have in common.

A kind of problems says which files are its own and reads them: `ProblemKind`, listed in `PROBLEMS`; what their tables
hold stands in `corner_problem`, `parametric_problem` and `generatrix_problem`.  All may have

    name = "corner"                # of the files to write; by default that of the problem file
    tolerance = 1e-3               # of the mesh, in the model's units
    prove = true                   # true: all must be proved, false: nothing need be; else what the kind can give;
                                   # in no case may a claim be refuted, or fail as measured

    [picture]
    style = "zebra"                # plain, zebra, highlights; mean, gauss, max, min (curvature)
    view = [1, -1, "1/2"]          # the direction from where one looks
    combs = true                   # with curvature combs
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Self

from pas.errors import ProblemFileError
from pas.exchange.picture_options import View
from pas.exchange.tables import read_toml
from pas.registry import Registry
from pas.shape import Shape
from pas.verdicts import Verdicts


class Problem(ABC):
    """A problem as read from a file: a frozen dataclass with at least these fields.

    `tolerance` of the mesh, None for the shape's own; `prove` as in the file, `style`, `view`, `combs` of the picture.
    """

    name: str
    tolerance: float | None
    prove: bool | None
    style: str
    view: View | None
    combs: bool = False

    @property
    def fixed(self) -> str:
        """What is said where an option is to be changed that such a problem has not."""
        return "there is nothing to change in such a problem"

    @abstractmethod
    def solve(self) -> Shape:
        """The shape that was asked for; raises what finding it raises."""

    def changed(self, **options: Any) -> Self:
        """The problem with other values for those of its fields that are not None; raises `ValueError` for no field."""
        wanted = {name: value for name, value in options.items() if value is not None}
        known = {field.name for field in fields(self)}  # type: ignore[arg-type]  # all problems are dataclasses
        for name in wanted:
            if name not in known:
                raise ValueError(f"{self.fixed}; leave out --{name}")
        return replace(self, **wanted)  # type: ignore[type-var]

    def satisfied(self, certificate: Verdicts) -> bool:
        """Whether a certificate is as the file wants it: nothing is refuted, and proved is what was to be proved."""
        if certificate.failed:
            return False
        return certificate.holds if self.prove is None else certificate.proved or not self.prove


@dataclass(frozen=True)
class ProblemKind:
    """`fits(data)`: whether a file's data are such a problem; `read(file, text, data)` makes it."""

    name: str
    fits: Callable[[dict[str, Any]], bool]
    read: Callable[[Path, str, dict[str, Any]], Problem]


PROBLEMS: Registry[ProblemKind] = Registry(
    "kind of problem",
    {
        "generatrix": "pas.exchange.generatrix_problem:PROBLEM",
        "parametric": "pas.exchange.parametric_problem:PROBLEM",
        "corner": "pas.exchange.corner_problem:PROBLEM",
    },
)
"""In the order in which they are asked; the last one takes what no other wants."""

PARAMETRIC = ("generatrix", "parametric")


def read_problem(path: str | Path, kinds: Sequence[str] | None = None) -> Problem:
    """Read a problem file of any kind, or of some `kinds` of `PROBLEMS`.

    Raises `ProblemFileError` with the line for syntax errors, unknown or missing keys, wrong types and values, and for
    a problem of another kind; `FileNotFoundError`.
    """
    file, text, data = read_toml(path)
    fitting = [kind for kind in PROBLEMS.values() if kind.fits(data)]
    if not any(kinds is None or kind.name in kinds for kind in fitting):
        raise ProblemFileError(f"{file.name}: this is a problem of the kind {fitting[0].name!r}, not {_either(kinds)}")
    kind = next(kind for kind in fitting if kinds is None or kind.name in kinds)
    return kind.read(file, text, data)


def read_parametric_problem(path: str | Path) -> Problem:
    """`read_problem` of a parametric blend or one by a generatrix; raises `ProblemFileError` for other problems."""
    return read_problem(path, PARAMETRIC)


def _either(kinds: Sequence[str] | None) -> str:
    return " or ".join(map(repr, kinds or ()))
