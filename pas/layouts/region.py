"""Regions: from a layout and the contacts' curves to tetrahedra in which a surface is proved and meshed.

The region is star-shaped around the centre of its layout.  Every clip face is a small polygon around its contact's
curve, strictly inside the contact's piece; tetrahedra of the same piece lie between it and the ends of the
layout's rays.  How far out these are is the largest lever: too near, no member is clean; too far, all are wavy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, determinant, dot
from pas.errors import GeometryError
from pas.layouts.fits import check_fits
from pas.layouts.ring import between, clip_polygon
from pas.layouts.seen import Seen, power_of_two
from pas.partition.layout import Layout, Ray
from pas.partition.regions import Region

WALLS = 1.3
"""How far out free rays end, as a multiple of what just leaves all pipes: at 1.0 three pipes at GC^2 have no clean
member, at 1.3 they have, and at 1.6 one of three times the energy."""

CLEAR, FARTHEST = 1.2, 1.15
"""Rays end this much beyond the surfaces of pipes at least, and no farther out than this beyond the farthest curve."""

STEEPEST = 0.1
"""Cosine to a clip's normal below which a ray is not followed to the clip's plane."""

FINE = 16
"""Parts of its length, at least, in which the end of a ray is rounded."""


@dataclass(frozen=True)
class Builder:
    """What tetrahedra are made from: points relative to the centre, all exact."""

    layout: Layout
    discs: Sequence[Seen]
    walls: float

    def end(self, ray: Ray) -> Vector:
        """Where a free ray ends."""
        length = float(np.linalg.norm(ray))
        far = self.walls * self.reach(np.array(ray) / length) / length
        step = power_of_two(far / FINE)
        share = fmpq(round(far / (float(step.p) / float(step.q)))) * step
        end = share * ray[0], share * ray[1], share * ray[2]
        while any(dot(disc.normal, end) == disc.height for disc in self.discs):
            share += step  # a wall in a clip plane would be taken for a part of the clip face
            end = share * ray[0], share * ray[1], share * ray[2]
        return end

    def reach(self, direction: Floats) -> float:
        """The distance along a unit vector (3,) at which all pipes are left, or the nearest clip plane beyond that."""
        low, planes = 0.0, []
        for disc in self.discs:
            cosine = float(direction @ disc.unit)
            if cosine > 0:
                sine = max(1 - cosine * cosine, 1e-9) ** 0.5
                low = max(low, min(disc.radius / sine, 1.1 * disc.distance))
                if cosine > STEEPEST:
                    planes.append(float(disc.unit @ disc.middle) / cosine)
            else:
                low = max(low, disc.radius)
        high = max(float(np.hypot(disc.distance, disc.radius)) for disc in self.discs)
        return min(max(CLEAR * low, min((p for p in planes if p > CLEAR * low), default=0.0)), FARTHEST * high)


def region(layout: Layout, discs: Sequence[Seen], walls: float = WALLS) -> Region:
    """The region of a layout whose clip faces lie around the curves of all contacts.

    Raises `GeometryError` where a curve fits in no piece, or no polygon of tetrahedra fits around it.
    """
    carried = dict(zip(check_fits(layout, discs), discs, strict=True))
    builder = Builder(layout, discs, walls)
    ends = [builder.end(ray) for ray in layout.all_rays]
    points: dict[tuple[str, ...], int] = {}
    vertices: list[Vector] = [(fmpq(0), fmpq(0), fmpq(0))]
    cells: list[tuple[int, ...]] = []
    pieces: list[list[int]] = []
    for number, piece in enumerate(layout.pieces):
        if number in carried:
            disc = carried[number]
            outer = [ends[i] for i in piece]
            inner = clip_polygon(disc, [layout.rays[i] for i in piece])
            triangles = [(inner[0], a, b) for a, b in pairwise(inner[1:])]
            triangles += between(disc, inner, outer)
        else:
            triangles = [tuple(ends[i] for i in t) for t in layout.triangles[number]]  # type: ignore[misc]
        pieces.append([])
        for corners in triangles:
            if determinant(*corners) <= 0:
                raise GeometryError(
                    f"a tetrahedron of the region is flat or turned in piece {number + 1} of {layout.name}"
                )
            cell = [0]
            for corner in corners:
                key = tuple(map(str, corner))
                if key not in points:
                    points[key] = len(vertices)
                    vertices.append(corner)
                cell.append(points[key])
            pieces[-1].append(len(cells))
            cells.append(tuple(cell))
    origin = layout.center
    moved = [(x + origin[0], y + origin[1], z + origin[2]) for x, y, z in vertices]
    return Region(moved, cells, origin, pieces, layout.name)
