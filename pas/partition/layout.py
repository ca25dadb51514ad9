"""Layouts: the sphere of directions around a centre, cut into pieces by arcs of great circles.

Where all faces between pieces pass through one centre, piecewise polynomials see of a region only in which
directions these faces lie.  A layout is that and nothing else; how far out a surface is proved and meshed is said
by a region (see `pas.partition.cells` and `pas.layouts.region`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import gcd, lcm
from pathlib import Path
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, Vector, VectorLike, cross, determinant, listed, plain, vector
from pas.errors import GeometryError
from pas.registry import Serialisable, loaded
from pas.shape import Shape
from pas.verdicts import Findings, Status, Verdict

Ray = tuple[int, int, int]
Triangle = tuple[int, int, int]

SPHERE, PICTURE = "pas.layouts.sphere:sphere_mesh", "pas.render.layout:picture"
DIMENSIONS = "pas.blending.solving:dimensions"
"""Where its mesh and its picture are made and its surfaces counted, in layers above."""


@dataclass(frozen=True)
class GreatArc:
    """A part of a great circle between two rays (their numbers): piece `first` lies to its left, seen from outside,
    `second` to its right; `normal` is that of its plane, positive on the side of `first`."""

    start: int
    end: int
    first: int
    second: int
    normal: Ray


class Layout(Shape, Serialisable):
    """The directions around `center`, cut into pieces.

    `rays` are directions (three exact numbers each, of any length); `pieces` go round each piece by the numbers of its
    rays, counterclockwise seen from outside.  Two rays that follow one another are joined by the shorter arc of a great
    circle, so they must not be opposite.  `name` says in summaries what it is.

    As a shape it is the sphere of radius 1 around the centre, with the pieces as its faces.

    Raises `GeometryError` where the pieces do not cover all directions exactly once, `ValueError` for wrong numbers.
    """

    kind = "layout"

    def __init__(
        self,
        rays: Sequence[VectorLike],
        pieces: Sequence[Sequence[int]],
        center: VectorLike = (0, 0, 0),
        name: str = "layout",
    ) -> None:
        self.rays: tuple[Ray, ...] = tuple(primitive(vector(ray, f"rays[{i}]"), i) for i, ray in enumerate(rays))
        self.center: Vector = vector(center, "center")
        self.name = str(name)
        if not len(pieces):
            raise GeometryError("a layout needs pieces, which together cover all directions")
        self.pieces = tuple(self._checked(number, piece) for number, piece in enumerate(pieces))
        twice = next((i for i, ray in enumerate(self.rays) if ray in self.rays[:i]), None)
        if twice is not None:
            raise ValueError(f"rays[{twice}] has the direction of rays[{self.rays.index(self.rays[twice])}]")
        self._check_cover()

    def _checked(self, number: int, piece: Sequence[int]) -> tuple[int, ...]:
        where, most = f"pieces[{number}]", len(self.rays)
        indices = tuple(piece) if isinstance(piece, Sequence) and not isinstance(piece, str) else ()
        if len(indices) < 3 or any(isinstance(i, bool) or not isinstance(i, int) for i in indices):
            raise ValueError(f"{where} must be at least three numbers of rays, not {shown(piece)}")
        if len(set(indices)) != len(indices) or not all(0 <= i < most for i in indices):
            raise ValueError(f"{where} must be different numbers of rays below {most}, not {shown(list(indices))}")
        for i, j in zip(indices, (*indices[1:], indices[0]), strict=True):
            if not any(cross(self.rays[i], self.rays[j])):
                raise GeometryError(
                    f"{where}: rays {i} and {j} lie on one line through the centre, so no arc joins them; "
                    "put a ray between them"
                )
        return indices

    def _check_cover(self) -> None:
        """That every arc has a piece on either side, and that all together are the sphere once."""
        sides = self._sides()
        for (start, end), piece in sides.items():
            if (end, start) not in sides:
                raise GeometryError(
                    f"the arc from ray {start} to ray {end} of pieces[{piece}] has no piece on its other side: the "
                    "pieces of a layout must cover all directions"
                )
        triangles = [t for piece in self.triangles for t in piece]
        # every arc has triangles on both sides, so all directions are covered equally often: one is counted
        times = times_covered([tuple(self.rays[i] for i in t) for t in triangles])
        if times != 1:
            raise GeometryError(f"the pieces of a layout must cover all directions once; they do {times} times")

    def _sides(self) -> dict[tuple[int, int], int]:
        """The piece to the left of each arc."""
        sides: dict[tuple[int, int], int] = {}
        for number, piece in enumerate(self.pieces):
            for edge in zip(piece, (*piece[1:], piece[0]), strict=True):
                if edge in sides:
                    raise GeometryError(
                        f"pieces[{sides[edge]}] and pieces[{number}] lie on the same side of the arc from ray "
                        f"{edge[0]} to ray {edge[1]}; go round every piece counterclockwise, seen from outside"
                    )
                sides[edge] = number
        return sides

    @cached_property
    def arcs(self) -> tuple[GreatArc, ...]:
        """The arcs between two pieces."""
        sides = self._sides()
        return tuple(
            GreatArc(start, end, first, sides[end, start], reduced(cross(self.rays[start], self.rays[end])))
            for (start, end), first in sides.items()
            if start < end and sides[end, start] != first
        )

    @cached_property
    def triangles(self) -> tuple[tuple[Triangle, ...], ...]:
        """Each piece cut into spherical triangles from one of its rays, counterclockwise: numbers of rays."""
        return tuple(self._triangles(number, piece) for number, piece in enumerate(self.pieces))

    def _triangles(self, number: int, piece: tuple[int, ...]) -> tuple[Triangle, ...]:
        for start in range(len(piece)):
            first, *others = piece[start:] + piece[:start]
            triangles = tuple((first, a, b) for a, b in pairwise(others))
            if all(determinant(*(self.rays[i] for i in triangle)) > 0 for triangle in triangles):
                return triangles
        raise GeometryError(
            f"pieces[{number}] of the layout is not seen undivided from one of its rays; go round it "
            "counterclockwise, seen from outside, or cut it in two"
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Layout) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> tuple[Any, ...]:
        return self.rays, self.pieces, tuple(map(plain, self.center))

    def __repr__(self) -> str:
        return f"<Layout {self.name!r}: {len(self.pieces)} pieces, {len(self.rays)} rays>"

    def __str__(self) -> str:
        words = listed(self.center)
        return f"{self.name}: {len(self.pieces)} pieces between {len(self.rays)} rays from ({words})"

    @property
    def certificate(self) -> Findings:
        """The verdict that it is a layout, which is checked exactly where it is made."""
        reason = "every arc has a piece on either side, and one direction lies in one piece: exact"
        return Findings((Verdict(Status.PROVED, "the pieces cover all directions once", reason),))

    def mesh(self, tolerance: Exact | None = None, *, quality: Any = "balanced") -> Any:
        """The sphere of directions as a closed `pas.Mesh` with a face for each piece; see `Shape.mesh`.

        It has one mesh of each number of triangles, so that all of `quality` are the same.
        """
        return loaded(SPHERE)(self, tolerance).mesh(quality=quality)

    def picture(self, path: str | Path | None = None, contacts: Sequence[Any] = (), **options: Any) -> Path | None:
        """Draw the sphere of directions with its pieces, their arcs and the curves of contacts (`.png`).

        `contacts` are those of a node around this centre.  Without a path it is shown in a window.  `options` are those
        of `pas.draw`, such as `view` and `size`; returns the path.

        Raises `GeometryError` for contacts that do not fit the pieces, and what `pas.draw` and `pas.show` raise.
        """
        drawn = loaded(PICTURE)(self, path, contacts, **options)
        return None if drawn is None else Path(drawn)

    def dimensions(self, contacts: Sequence[Any], order: int, degrees: Iterable[int] | int) -> dict[int, int]:
        """The dimension of the space of all GC^`order` surfaces on it that meet the contacts, by degree; exact.

        `contacts` as for `pas.blend`, with their region chosen as `pas.solutions` does; without any, those of all
        piecewise polynomials that are C^order, sums of homogeneous splines (Alfeld, Neamtu and Schumaker 1996).
        `degrees` are one or several.

        Raises `GeometryError` for contacts that do not fit, `ValueError` or `TypeError` for wrong arguments.
        """
        return loaded(DIMENSIONS)(self, contacts, order, degrees)

    def to_record(self) -> dict[str, Any]:
        """The layout as a table of plain data."""
        return {
            "center": [plain(c) for c in self.center],
            "rays": [list(ray) for ray in self.rays],
            "pieces": [list(piece) for piece in self.pieces],
            "name": self.name,
        }


def primitive(direction: Vector, number: int | None = None) -> Ray:
    """The shortest integer vector of a direction; raises `ValueError` for zero, with its `number` among the rays."""
    common = lcm(*(int(c.q) for c in direction))
    if not any(direction):
        raise ValueError(f"rays[{number}] must not be the zero vector")
    x, y, z = (int((c * common).p) for c in direction)
    return reduced((x, y, z))


def reduced(v: Any) -> Ray:
    """Three whole numbers divided by their greatest common divisor."""
    common = gcd(*v)
    return v[0] // common, v[1] // common, v[2] // common


def times_covered(triangles: Sequence[tuple[Ray, ...]]) -> int:
    """How many spherical triangles hold a direction that lies on none of their sides."""
    a, b, c = triangles[0]
    for step in range(2, 3 + 6 * len(triangles)):
        way = tuple(x + step * y + step * step * z for x, y, z in zip(a, b, c, strict=True))
        depths = [min(determinant(way, q, r), determinant(way, r, p), determinant(way, p, q)) for p, q, r in triangles]
        if all(depths):
            return sum(depth > 0 for depth in depths)
    raise AssertionError("of a parabola no more than two points lie in the plane of a side")
