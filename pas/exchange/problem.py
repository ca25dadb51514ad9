"""Problem files (TOML) of every kind: one reader, and what all problems have in common.

A kind of problems says which files are its own and reads them: `ProblemKind`, listed in `PROBLEMS`; what their tables
hold stands in `corner_problem`, `parametric_problem` and `part_problem`.  All may have

    name = "corner"                # of the files to write; by default that of the problem file
    tolerance = 1e-3               # of the mesh, in the model's units
    prove = true                   # true: all must be proved, false: nothing need be; else what the kind can give;
                                   # in no case may a claim be refuted, or fail as measured

    [mesh]                         # further settings of the mesh, see pas.settings.MeshSettings
    quality = "angles"

    [picture]                      # those of pas.Picture
    style = "zebra"                # plain, zebra, highlights; mean, gauss, max, min (curvature)
    view = [1, -1, "1/2"]          # the direction from where one looks
    combs = true                   # with curvature combs
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Self, TypeVar

from pas.algebra.inputs import check_tolerance, shown
from pas.errors import ProblemFileError
from pas.exchange.picture_options import Picture
from pas.exchange.tables import TableReader, read_toml
from pas.registry import Registry
from pas.settings import MeshSettings, options
from pas.shape import Shape
from pas.verdicts import Verdicts

Settings = TypeVar("Settings", MeshSettings, Picture)

COMMON = dict.fromkeys(("name", "tolerance", "prove", "mesh", "picture"), False)
"""The keys that all files may have."""

COMMON_TABLES = {
    "mesh": {f.name: False for f in options(MeshSettings, "file")},
    "picture": {f.name: False for f in options(Picture, "file")},
}


@dataclass(frozen=True, kw_only=True)
class Problem(ABC):
    """A problem as read from a file; `prove` is None where the file does not say whether all must be proved.

    `model_unit` is that of its lengths, for the kinds whose files may tell it.
    """

    name: str
    prove: bool | None = None
    model_unit: str | None = None
    mesh: MeshSettings = field(default_factory=MeshSettings)
    picture: Picture = field(default_factory=Picture)

    @property
    def tolerance(self) -> float | None:
        """That of the mesh; None for the shape's own."""
        return self.mesh.tolerance

    @property
    def style(self) -> str:
        """The name of the picture's style."""
        return self.picture.name

    @property
    def view(self) -> Any:
        """The direction from where one looks; None for the widest."""
        return self.picture.view

    @property
    def fixed(self) -> str:
        """What is said where an option is to be changed that such a problem has not."""
        return "there is nothing to change in such a problem"

    @abstractmethod
    def solve(self) -> Shape:
        """The shape that was asked for; raises what finding it raises."""

    def changed(self, **changes: Any) -> Self:
        """The problem with other values for those of its fields, and its mesh's settings, that are not None.

        Raises `ValueError` for what is neither.
        """
        wanted = {name: value for name, value in changes.items() if value is not None}
        of_mesh = {f.name: wanted.pop(f.name) for f in fields(MeshSettings) if f.name in wanted}
        known = {field.name for field in fields(self)}
        for name in wanted:
            if name not in known:
                raise ValueError(f"{self.fixed}; leave out --{name}")
        return replace(self, **wanted, mesh=replace(self.mesh, **of_mesh))

    def satisfied(self, certificate: Verdicts) -> bool:
        """Whether a certificate is as the file wants it: nothing is refuted, and proved is what was to be proved."""
        if certificate.failed:
            return False
        return certificate.holds if self.prove is None else certificate.proved or not self.prove


def common(reader: TableReader, data: dict[str, Any], usual: MeshSettings, style: str = "zebra") -> dict[str, Any]:
    """The fields that every problem has, as a file says them; else the usual mesh and style of the kind."""
    name = reader.typed(data, "name", str, reader.file.name.removesuffix(".toml"))
    if Path(name).name != name or name in ("", ".", "..") or not name.isprintable():
        raise reader.error(f"name must be a plain file name without folders, not {shown(name)}", key="name")
    tolerance = reader.checked(data, "tolerance", check_tolerance, usual.tolerance)
    mesh = _settings(reader, data.get("mesh", {}), "mesh", replace(usual, tolerance=tolerance))
    picture = _settings(reader, data.get("picture", {}), "picture", Picture(style=style))
    return {"name": name, "mesh": mesh, "picture": picture}


def _settings(reader: TableReader, table: Any, section: str, usual: Settings) -> Settings:
    def make(table: dict[str, Any]) -> Settings:
        kinds = {f.name: f.metadata["kind"] for f in options(type(usual), "file")}
        worded = {f.name for f in options(type(usual), "file") if f.metadata["metavar"]}
        kinds |= {key: str for key in worded & table.keys() if isinstance(table[key], str)}  # as on the command line
        given = {key: reader.typed(table, key, kinds[key], None, section) for key in table}
        return replace(usual, **given)

    return reader.made(make, table, section)


@dataclass(frozen=True)
class ProblemKind:
    """`fits(data)`: whether a file's data are such a problem; `read(file, text, data)` makes it."""

    name: str
    fits: Callable[[dict[str, Any]], bool]
    read: Callable[[Path, str, dict[str, Any]], Problem]


PROBLEMS: Registry[ProblemKind] = Registry(
    "kind of problem",
    {
        "generatrix": "pas.exchange.parametric_problem:GENERATRIX",
        "parametric": "pas.exchange.parametric_problem:PROBLEM",
        "part": "pas.exchange.part_problem:PROBLEM",
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
