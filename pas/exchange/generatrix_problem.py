"""Problem files (TOML) of blends by a Bezier generatrix: two boundaries, and what shapes the blend between them.

method = "generatrix"          # or "quadrics": the same, of two closed plane sections of quadrics
align = true                   # optional; false: the curves are left as they run
unit = true                    # optional; false: vectors as long as they are, which keeps rational data rational

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

Also those of every problem: see `pas.exchange.problem`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pas.exchange.boundaries import KEYS, KINDS, SECTION, as_plain, boundary_from
from pas.exchange.problem import COMMON, COMMON_TABLES, Problem, ProblemKind, common
from pas.exchange.tables import TableReader
from pas.parametric.generatrix.blend import GeneratrixBlend, generatrix_blend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeFunction
from pas.settings import MeshSettings

GENERATRIX_METHODS = {"generatrix": KINDS, "quadrics": (SECTION,)}
"""Names of the methods, and the kinds of boundaries that each takes."""

TABLES = {
    "": COMMON | dict.fromkeys(("method", "align", "unit", "shape"), False) | {"boundaries": True},
    **COMMON_TABLES,
    "boundaries": dict.fromkeys(KEYS, False),
    "shape": dict.fromkeys(("l1", "l2", "lambda1", "lambda2", "middle"), False),
}


@dataclass(frozen=True)
class GeneratrixProblem(Problem):
    """A problem as read from a file."""

    method: str
    boundaries: tuple[Boundary, Boundary]
    shape: GeneratrixShape
    align: bool
    unit: bool

    @property
    def fixed(self) -> str:
        """What is said where an option is to be changed."""
        return f"a blend of the method {self.method!r} has contact of order 1"

    def solve(self) -> GeneratrixBlend:
        """The blend; raises what `generatrix_blend` raises."""
        return generatrix_blend(*self.boundaries, self.shape, self.align, self.unit)

    blend = solve


def _read(file: Path, text: str, data: dict[str, Any]) -> GeneratrixProblem:
    reader = TableReader(file, text, TABLES, ("boundaries",))
    reader.check(data)
    method = data.get("method", "generatrix")
    if len(data["boundaries"]) != 2:
        raise reader.error(f"there must be two [[boundaries]], not {len(data['boundaries'])}", key="boundaries")
    first, second = reader.each(data, "boundaries", lambda table: _boundary(table, method), "boundary")
    return GeneratrixProblem(
        **common(reader, data, MeshSettings()),
        prove=reader.typed(data, "prove", bool, None),
        method=method,
        boundaries=(first, second),
        shape=reader.made(_shape, data.get("shape", {}), "shape"),
        align=reader.typed(data, "align", bool, True),
        unit=reader.typed(data, "unit", bool, True),
    )


def _boundary(table: dict[str, Any], method: str) -> Boundary:
    made = boundary_from(table, GENERATRIX_METHODS[method])
    if method == "quadrics" and not made.closed:
        raise ValueError('the section is an open curve; blend it by method = "generatrix"')
    return made


def _shape(table: dict[str, Any]) -> GeneratrixShape:
    found: dict[str, Any] = {}
    for key, value in table.items():
        try:
            found[key] = as_plain(value) if key == "middle" else _function(value)
            GeneratrixShape(**{key: found[key]})
        except (ValueError, TypeError) as error:
            raise ValueError(str(error) if str(error).startswith(key) else f"{key}: {error}") from None
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


PROBLEM = ProblemKind("generatrix", _fits, _read)
