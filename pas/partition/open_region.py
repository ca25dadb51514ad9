"""Regions that are open: convex cones around a centre, cut off, for blends that are seen through their contact."""

from __future__ import annotations

from typing import ClassVar

from pas.algebra.affine import Affine
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
        vertices, center = [map_.exact(v) for v in self.vertices], map_.exact(self.center)
        return OpenRegion(vertices, self.cells, center, self.pieces, self.title)

    def _bare(self) -> OpenRegion:
        return object.__new__(OpenRegion)
