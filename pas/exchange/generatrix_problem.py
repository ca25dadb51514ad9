"""Problem files (TOML) of blends by a Bezier generatrix: two boundaries, and what shapes the blend between them.

method = "generatrix"          # or "quadrics": the same, of two closed plane sections of quadrics
align = true                   # optional; false: the curves are left as they run
unit = true                    # optional; false: vectors as long as they are, which keeps rational data rational
tolerance = 1e-3               # optional; of the mesh, in the model's units
prove = true                   # optional; true: the exit code asks for all proofs, else only that no claim is
                               # refuted, or fails as measured

[[boundaries]]                 # two of these; kinds and keys: `pas.exchange.boundaries`
quadric = "x^2 + y^2 - 1"
plane = "z - 2"

[[boundaries]]
implicit = "y^2 + z^2 - 1"
curve = ["3", "cos(2*pi*s)", "sin(2*pi*s)"]
side = 1                       # optional: on which side the blend lies

[shape]                        # optional, as is each of the five
l1 = 1                         # a number,
l2 = [[0, 1], ["1/2", 2]]      # data pairs (s, value),
lambda1 = { low = 0, high = 0.5, start = 0 }      # or, for closed curves, a cosine
lambda2 = 0
middle = ["2*s", "1", "0"]     # the middle control curve of a quartic blend

[picture]                      # optional: style, view, combs
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from pas.errors import LimitError, PasError
from pas.exchange.boundaries import KEYS, KINDS, SECTION, as_plain, boundary_from
from pas.exchange.picture_options import PICTURE_KEYS, PictureReader, View
from pas.exchange.problem import Problem, ProblemKind
from pas.parametric.generatrix.blend import GeneratrixBlend, generatrix_blend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeFunction

GENERATRIX_METHODS = {"generatrix": KINDS, "quadrics": (SECTION,)}
"""Names of the methods, and the kinds of boundaries that each takes."""

VALUES = ("l1", "l2", "lambda1", "lambda2")


@dataclass(frozen=True)
class GeneratrixProblem(Problem):
    """A problem as read from a file; `prove` None where it does not say."""

    name: str
    method: str
    boundaries: tuple[Boundary, Boundary]
    shape: GeneratrixShape
    align: bool
    unit: bool
    tolerance: float | None
    prove: bool | None
    style: str
    view: View | None
    combs: bool

    @property
    def fixed(self) -> str:
        """What is said where an option is to be changed."""
        return f"a blend of the method {self.method!r} has contact of order 1"

    def solve(self) -> GeneratrixBlend:
        """The blend; raises what `generatrix_blend` raises."""
        return generatrix_blend(*self.boundaries, self.shape, self.align, self.unit)

    blend = solve


class GeneratrixReader(PictureReader):
    """Reads the tables of such a file; every error is a `ProblemFileError` with the line."""

    keys: ClassVar = {
        "": {"name", "method", "align", "unit", "tolerance", "prove", "boundaries", "shape", "picture"},
        "boundaries": set(KEYS),
        "shape": {*VALUES, "middle"},
        "picture": PICTURE_KEYS,
    }
    required: ClassVar = {"": {"boundaries"}}
    lists: ClassVar = {"boundaries"}

    def problem(self, data: dict[str, Any]) -> GeneratrixProblem:
        """The problem of a whole file."""
        self.check(data, "", 0)
        method, tables = data.get("method", "generatrix"), data["boundaries"]
        if len(tables) != 2:
            raise self.error(f"there must be two [[boundaries]], not {len(tables)}", "", 0, "boundaries")
        first, second = (self._boundary(i, table, method) for i, table in enumerate(tables))
        return GeneratrixProblem(
            name=self.name(data),
            method=method,
            boundaries=(first, second),
            shape=self._shape(data.get("shape", {})),
            align=self.typed(data, "align", bool, True),
            unit=self.typed(data, "unit", bool, True),
            tolerance=self.tolerance(data),
            prove=self.typed(data, "prove", bool, None),
            **self.picture(data),
        )

    def _boundary(self, index: int, table: dict[str, Any], method: str) -> Boundary:
        self.check(table, "boundaries", index)
        try:
            made = boundary_from(table, GENERATRIX_METHODS[method])
            if method == "quadrics" and not made.closed:
                raise ValueError('the section is an open curve; blend it by method = "generatrix"')
        except LimitError:
            raise
        except (ValueError, TypeError, PasError) as error:
            key = next((k for k in table if str(error).startswith(f"{k} ")), None)
            raise self.error(f"boundary {index + 1}: {error}", "boundaries", index, key) from None
        return made

    def _shape(self, table: dict[str, Any]) -> GeneratrixShape:
        self.check(table, "shape", 0)
        found: dict[str, Any] = {}
        for key, value in table.items():
            try:
                found[key] = as_plain(value) if key == "middle" else _function(value)
                GeneratrixShape(**{key: found[key]})
            except (ValueError, TypeError) as error:
                text = str(error)
                raise self.error(text if text.startswith(key) else f"{key}: {text}", "shape", 0, key) from None
        return GeneratrixShape(**found)


def _function(value: Any) -> Any:
    """A number as it is, data pairs or a cosine as a shape function."""
    if isinstance(value, list):
        return ShapeFunction.through([pair if isinstance(pair, list) else [pair] for pair in value])
    if isinstance(value, dict):
        if not {"low", "high"} <= set(value) <= {"low", "high", "start"}:
            raise ValueError(f"a cosine has low, high and perhaps start, not {', '.join(value) or 'nothing'}")
        return ShapeFunction.cosine(**value)
    return value


def _fits(data: dict[str, Any]) -> bool:
    return data.get("method", "generatrix" if "boundaries" in data else "") in tuple(GENERATRIX_METHODS)


def _read(file: Path, text: str, data: dict[str, Any]) -> GeneratrixProblem:
    return GeneratrixReader(file, text).problem(data)


PROBLEM = ProblemKind("generatrix", _fits, _read)
