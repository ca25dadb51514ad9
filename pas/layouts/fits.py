"""Which piece of a layout holds each contact."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.errors import GeometryError
from pas.layouts.seen import Seen
from pas.partition.layout import Layout, Ray


def check_fits(layout: Layout, discs: Sequence[Seen]) -> list[int]:
    """The piece that holds each disc; raises `GeometryError` for a disc in none, or two in one."""
    normals = [sides([layout.rays[i] for i in piece]) for piece in layout.pieces]
    found: list[int] = []
    for disc in discs:
        towards = unit(disc.points).T
        here = [p for p, inwards in enumerate(normals) if (inwards @ towards).min() > 0]
        if len(here) != 1:
            direction = ", ".join(f"{c:.3g}" for c in disc.direction)
            raise GeometryError(
                f"the curve of contact {disc.number} fits in no piece of the layout ({layout.name}): it is seen "
                f"{degrees(disc.angle):.3g} degrees wide around ({direction})"
            )
        if here[0] in found:
            raise GeometryError(
                f"contacts {discs[found.index(here[0])].number} and {disc.number} lie in one piece of the layout "
                f"({layout.name}); each needs a piece of its own"
            )
        found.append(here[0])
    return found


def room(layout: Layout, piece: int, disc: Seen) -> float:
    """The least angle (radians) between a disc's curve and the planes of a piece's sides, negative where it is outside.

    That is right for convex pieces; of others it is at most the truth.
    """
    sines = sides([layout.rays[i] for i in layout.pieces[piece]]) @ unit(disc.points).T
    return float(np.arcsin(np.clip(sines.min(), -1, 1)))


def sides(rays: Sequence[Ray]) -> Floats:
    """The unit normals (N, 3), inwards, of the planes of a piece's sides."""
    around = np.array(rays, dtype=float)
    return unit(np.cross(around, np.roll(around, -1, axis=0)))
