"""Where to end the pipes of a node: as near as a fair blend leaves room for."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import atan, ceil, cos, degrees, radians, sin, tan

import numpy as np
from flint import fmpq

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, VectorLike, to_float, to_floats
from pas.errors import GeometryError
from pas.layouts.fan import best_gaps
from pas.layouts.nodes import Node
from pas.layouts.planes import symmetric
from pas.layouts.seen import angle_between
from pas.surface.contacts.pipe import Pipe
from pas.surface.fairness_limits import WEDGE

SHARE = 0.6
"""Share of the angle between two pipes that their circles may take up: of 0.8 and 0.6 the strongest lever on shape."""

WIDEST = radians(40)
"""Angular radius of a circle, at the most."""

FILLET = 0.6
"""Radius of the arc that must fit between two pipes, over that of the wider one."""

GAP, OUTWARDS, FARTHEST = radians(5), 1.08, 6.0
"""Clips go outwards by this factor until a layout fits, mostly a fan with such a gap, up to so many times as far."""

FINE = 64
"""Parts of its axis to which a clip is rounded, up."""

CLOSEST = radians(10)
"""Directions closer than this are refused: their clips would be very far out."""


def with_clips(axes: Sequence[Vector], radii: Sequence[fmpq], order: int, center: VectorLike = (0, 0, 0)) -> list[Pipe]:
    """Pipes through a common centre along directions, clipped as near as a fair blend of this order allows.

    Raises `GeometryError` for directions that are too close.
    """
    units, sizes = [unit(to_floats(axis)) for axis in axes], [to_float(radius) for radius in radii]
    for (i, a), (j, b) in combinations(enumerate(units, start=1), 2):
        if angle_between(a, b) < CLOSEST:
            raise GeometryError(
                f"directions {i} and {j} are {degrees(angle_between(a, b)):.3g} degrees apart; at least "
                f"{degrees(CLOSEST):.3g} are needed"
            )
    distances = _nearest(units, sizes)
    factor = 1.0
    while True:
        pipes = [
            Pipe(axis, radius, _rounded(factor * far, axis), center)
            for axis, radius, far in zip(axes, radii, distances, strict=True)
        ]
        if factor > FARTHEST or _served(pipes, order):
            return pipes
        factor *= OUTWARDS


def _served(pipes: Sequence[Pipe], order: int) -> bool:
    """Whether a layout fits: for four pipes or more, and at higher orders, a fan with some room."""
    try:
        seen = Node.of([pipe.contact for pipe in pipes])
        wide = (order < 2 and len(pipes) < 4) or symmetric(seen.discs)
        next(seen.regions(order, None if wide else "fan"))
        return wide or min(best_gaps(seen.discs).sizes) >= GAP
    except GeometryError:
        return False


def _rounded(distance: float, axis: Vector) -> fmpq:
    return fmpq(ceil(distance / float(np.linalg.norm(to_floats(axis))) * FINE), FINE)


def _nearest(units: Sequence[Floats], radii: Sequence[float]) -> list[float]:
    """The distances: as many radii for all at first, then each by itself as near as it may be."""
    pairs = [(i, j, angle_between(units[i], units[j])) for i, j in combinations(range(len(units)), 2)]

    def fits(clips: Sequence[float]) -> bool:
        wide = [atan(r / c) for r, c in zip(radii, clips, strict=True)]
        apart = all(wide[i] + wide[j] <= SHARE * angle for i, j, angle in pairs)
        return (
            apart and max(wide) <= WIDEST and all(_arc(radii[i], radii[j], clips[i], clips[j], t) for i, j, t in pairs)
        )

    clips = list(radii)
    while not fits(clips):
        clips = [1.01 * c for c in clips]
    for i, alike in enumerate(clips):
        while clips[i] > 0.6 * alike and fits([*clips[:i], 0.99 * clips[i], *clips[i + 1 :]]):
            clips[i] *= 0.99
    return clips


def _arc(first: float, second: float, near: float, far: float, angle: float) -> bool:
    """Whether a large enough arc fits between two pipes that end at given distances."""
    if angle >= WEDGE:
        return True
    ways = ((first, second, near), (second, first, far))
    along = min(end - (other + own * cos(angle)) / sin(angle) for own, other, end in ways)
    return along * tan(angle / 2) >= FILLET * max(first, second)
