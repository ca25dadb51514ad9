"""Regions that are open: convex cones around a centre, cut off, for blends that are seen through their contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from pas.algebra.affine import Affine
from pas.algebra.rational import Vector
from pas.partition.region import Region


class OpenRegion(Region):
    """Cells that fill a convex cone up to its outer faces, its apex the centre, as `pas.layouts.opened` makes them.

    One contact has no face of it: its clip is a cone of degree 2 with the same apex, inside this one, as that through
    the edge of a plate.  Arguments are those of `Partition`; raises `GeometryError` without a centre, and where cells
    fill no convex cone around it.
    """

    name = "open region"
    open: ClassVar[bool] = True

    def moved(self, map_: Affine) -> OpenRegion:
        """See `Partition.moved`."""
        assert self.center is not None
        return self.with_vertices([map_.exact(v) for v in self.vertices], map_.exact(self.center))

    def with_vertices(self, vertices: Sequence[Vector], center: Vector | None) -> OpenRegion:
        return OpenRegion(vertices, self.cells, center, self.pieces, self.title)
