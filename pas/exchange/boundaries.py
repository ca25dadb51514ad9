"""Boundaries of generatrix blends as plain data: tables of problem files, and records of project files.

One table is one boundary; its keys say of which kind it is:

quadric, plane                            the section of a quadric by a plane (interval, branch)
quadric, other                            branch number `branch` (0) of the intersection of two quadrics (interval)
implicit, curve                           a curve on an algebraic surface (interval, closed)
x, y, z and one of t, h, path             a curve on a parametric surface (domain, interval, closed)
curve and one of normal, tangent          a curve with vectors along it (interval, closed)

Each may also have side, name and by_length (true: s is the share of the curve's length).  Expressions are strings,
curves and paths lists of them, in s; numbers are integers or strings such as "1/2".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from pas.algebra.rational import plain, rational
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.intersection import quadric_intersection
from pas.parametric.generatrix.sections import plane_section
from pas.parametric.surface import ParametricSurface, SurfaceCurve, iso_curve

BoundaryTable = Mapping[str, Any]
COMMON = frozenset({"side", "name", "by_length"})


@dataclass(frozen=True)
class BoundaryKind:
    """A kind of boundary: the keys it needs, of `either` exactly one, those it may have, and what makes it."""

    needs: tuple[str, ...]
    either: tuple[str, ...]
    may: frozenset[str]
    build: Callable[[BoundaryTable, dict[str, Any]], Boundary]

    @property
    def keys(self) -> frozenset[str]:
        """All keys that there are."""
        return frozenset(self.needs) | frozenset(self.either) | self.may | COMMON

    def fits(self, table: BoundaryTable) -> bool:
        """Whether a table has what this kind needs."""
        return set(self.needs) <= set(table) and (not self.either or any(key in table for key in self.either))

    def __str__(self) -> str:
        one = [f"one of {', '.join(self.either)}"] if self.either else []
        return " and ".join([", ".join(self.needs), *one])


def _intersection(table: BoundaryTable, options: dict[str, Any]) -> Boundary:
    branches, number = quadric_intersection(table["quadric"], table["other"]), options.pop("branch", 0)
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < len(branches):
        raise ValueError(f"branch must be a whole number from 0 to {len(branches) - 1}, not {number!r}")
    return branches[number].on(0, **options)


def _parametric(table: BoundaryTable, options: dict[str, Any]) -> Boundary:
    surface = ParametricSurface(table["x"], table["y"], table["z"], domain=options.pop("domain", None))
    if "path" not in table:
        return Boundary.on_parametric(iso_curve(surface, table.get("t"), table.get("h")), **options)
    path = table["path"]
    if not isinstance(path, list) or len(path) != 2:
        raise ValueError(f'path must be two expressions in s such as ["s", "1 - s"], not {path!r}')
    return Boundary.on_parametric(SurfaceCurve(surface, path[0], path[1]), **options)


SECTION = BoundaryKind(
    ("quadric", "plane"), (), frozenset({"interval", "branch"}),
    lambda table, options: plane_section(table["quadric"], table["plane"], **options),
)  # fmt: skip
CURVE = frozenset({"interval", "closed"})
KINDS = (
    SECTION,
    BoundaryKind(("quadric", "other"), (), frozenset({"interval", "branch"}), _intersection),
    BoundaryKind(
        ("implicit", "curve"), (), CURVE,
        lambda table, options: Boundary.on_implicit(table["implicit"], table["curve"], **options),
    ),
    BoundaryKind(("x", "y", "z"), ("t", "h", "path"), CURVE | {"domain"}, _parametric),
    BoundaryKind(
        ("curve",), ("normal", "tangent"), CURVE,
        lambda table, options: Boundary.along(table["curve"], table.get("normal"), table.get("tangent"), **options),
    ),
)  # fmt: skip
KEYS = frozenset().union(*(kind.keys for kind in KINDS))


def boundary_from(table: BoundaryTable, kinds: tuple[BoundaryKind, ...] = KINDS) -> Boundary:
    """The boundary of a table, which it keeps as its `source`.

    Raises `ValueError` for a table of no kind or of wrong types, and what making the boundary raises.
    """
    kind = next((k for k in kinds if k.fits(table)), None)
    if kind is None:
        raise ValueError(f"a boundary needs {'; or '.join(map(str, kinds))}; this one has {', '.join(table) or 'none'}")
    strange = [key for key in table if key not in kind.keys]
    if strange or sum(key in table for key in kind.either) > 1:
        more = strange or [key for key in kind.either if key in table][1:]
        raise ValueError(f"a boundary with {kind} has no {more[0]!r} besides")
    source = {key: as_plain(value) for key, value in table.items()}
    for key, types in (("name", str), ("closed", bool), ("by_length", bool)):
        if key in source and not isinstance(source[key], types):
            raise ValueError(f"{key} must be {'a string' if types is str else 'true or false'}, not {source[key]!r}")
    options = {key: source[key] for key in (*kind.may, "side", "name") if key in source}
    evened = source.pop("by_length", False)
    made = replace(kind.build(source, options), source=source)
    return made.by_length() if evened else made  # which notes it in the source


def as_plain(value: Any) -> Any:
    """Numbers, lists and tables as JSON knows them: decimals become exact strings."""
    if isinstance(value, dict):
        return {str(key): as_plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [as_plain(v) for v in value]
    if isinstance(value, Fraction):
        return plain(rational(value))
    return value
