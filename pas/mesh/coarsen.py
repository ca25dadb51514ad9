"""Collapsing short edges of a mesh with a boundary, so that its topology stays, many at once.

Only edges go that meet the link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999), leave no edge too long and turn
no triangle away from the surface's normals.  Of edges chosen together no end is next to an end of another.
"""

from __future__ import annotations

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.radial import TURNED, Edges

SHORT = 0.7
"""Edges this many times as long as they should be are collapsed."""

LONGER = 1.3
"""No edge is made longer than so many times as long as it should be."""


ROUNDS = 4
"""In which collapses are chosen that do not touch those chosen before."""


def collapsed(
    points: Floats, edges: Edges, normals: Floats, rim: Integers, fixed: np.ndarray, sizes: Floats
) -> tuple[Integers, Integers]:
    """The vertices (M,) that are left, and the triangles of them, after one pass.

    Edges should be as long as `sizes` (N,) say.  Vertices of the boundary (`rim` >= 0) go only along it, the `fixed`
    (N,) stay.
    """
    limits, every = (SHORT, LONGER, TURNED, ROUNDS), (edges.every, len(edges.inner))
    target = compiled().collapsed(points, edges.triangles, normals, sizes, every, rim, fixed, limits)
    triangles = target[edges.triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    left = np.zeros(len(points), dtype=bool)
    left[triangles] = True
    return np.flatnonzero(left), (np.cumsum(left) - 1)[triangles]
