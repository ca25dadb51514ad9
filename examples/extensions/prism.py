"""A primitive of your own: the upright prism over a convex polygon.

    python examples/extensions/prism.py

A primitive is a function that returns a `Solid`.  Made of half spaces, balls and other polynomials by | & -, it has
everything that solids have: exact files, joints, meshes, pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import pas
from pas import solid


def prism(corners: Sequence[tuple[object, object]], bottom: object, top: object) -> solid.Solid:
    """The prism over a convex polygon of corners (x, y), exact numbers counterclockwise, from z = bottom to z = top.

    The sides are "side 1", ..., from the first corner on.  Raises `ValueError` for corners that do not turn left.
    """
    x, y, z = (pas.Polynomial(name) for name in "xyz")
    result = solid.half_space(z - top, "top") & solid.half_space(bottom - z, "bottom")
    closed = [tuple(map(pas.Polynomial, corner)) for corner in (*corners, *corners[:2])]
    for number, ((a, b), (c, d)) in enumerate(pairwise(closed[:-1]), start=1):
        e, f = closed[number + 1]
        outside = (x - a) * (d - b) - (y - b) * (c - a)  # positive to the right of the side
        if outside.at((e.at((0, 0, 0)), f.at((0, 0, 0)), 0)) >= 0:
            raise ValueError(f"the corners must turn left all the way round, and do not at corner {number + 1}")
        result &= solid.half_space(outside, f"side {number}")
    return result


if __name__ == "__main__":
    wedge = prism([(0, 0), (3, 0), (0, 4)], 0, "1/2")
    print(wedge, wedge.volume())  # 3
