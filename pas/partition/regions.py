"""Regions that the program laid out around contacts, closed and open ones."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import accumulate, chain, pairwise
from typing import Any, Self

from pas.algebra.affine import Affine
from pas.algebra.rational import Vector, vector
from pas.partition.cells import Partition
from pas.partition.layout import primitive

DIRECTION = re.compile(r"\(-?\d+, -?\d+, -?\d+\)")
"""A direction in the title of a layout, as that of the axis of a fan."""


class Region(Partition):
    """A partition built around the curves of contacts, as `pas.layouts` does: its room follows from the contacts.

    What counts as fair in it is judged by the arcs that fit between the contacts (`pas.FairnessLimits.of_node`),
    since no cell was given by the user.  Arguments and errors are those of `Partition`.
    """

    name = "region"

    @classmethod
    def of_triangles(cls, pieces: Sequence[Sequence[tuple[Vector, ...]]], center: Vector, title: str) -> Self:
        """The cells from the centre over triangles, whose corners are given relative to it, piece by piece."""
        numbers: dict[Vector, int] = {}
        cells = [
            [(0, *(numbers.setdefault(corner, 1 + len(numbers)) for corner in triangle)) for triangle in piece]
            for piece in pieces
        ]
        ends = [0, *accumulate(map(len, cells))]
        vertices = [center, *(tuple(a + b for a, b in zip(center, corner, strict=True)) for corner in numbers)]
        return cls(vertices, list(chain(*cells)), center, [range(a, b) for a, b in pairwise(ends)], title)

    def moved(self, map_: Affine) -> Region:
        """See `Partition.moved`; a direction in the title goes along."""
        center = None if self.center is None else map_.exact(self.center)
        title = DIRECTION.sub(lambda found: _moved(found[0], map_), self.title)
        return type(self)([map_.exact(v) for v in self.vertices], self.cells, center, self.pieces, title)

    def to_record(self) -> dict[str, Any]:
        """The partition as a table of plain data, exact numbers as texts."""
        return super().to_record() | {"kind": self.name}


class OpenRegion(Region):
    """Cells that fill a convex cone up to its outer faces, its apex the centre, as `pas.layouts.opened` makes them.

    One contact has no face of it: its clip is a cone of degree 2 with the same apex, inside this one, as that through
    the edge of a plate.  Arguments are those of `Partition`; raises `GeometryError` without a centre, and where cells
    fill no convex cone around it.
    """

    name = "open region"
    open = True


def _moved(words: str, map_: Affine) -> str:
    """A direction in words, moved."""
    return str(primitive(map_.direction(vector(words.strip("()").split(", ")))))
