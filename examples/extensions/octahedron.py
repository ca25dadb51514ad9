"""A partition of one's own: the octahedral split, for pipes along the diagonals of a cube.

The octahedron around a centre, cut by the three planes of the axes into eight cells, one for each octant; each of its
faces is across a diagonal.  So the nodes of a diamond lattice fit on it: four pipes, each in a face of its own, the
other four faces being walls.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import pas


@pas.register_partition
class OctahedralSplit(pas.Partition):
    """The points with `|x| + |y| + |z| <= size` around `center` (three exact numbers), in eight cells.

    The arguments are the keys of its table in problem files; project files hold it as the tetrahedra that it is.
    """

    name = "octahedral split"

    def __init__(self, size: Any = 1, center: Any = (0, 0, 0)) -> None:
        middle = [Fraction(c) for c in center]
        axes = [(s, axis) for s in (1, -1) for axis in range(3)]
        corners = [[m + s * Fraction(size) * (i == axis) for i, m in enumerate(middle)] for s, axis in axes]
        cells = [(0, 1 + a, 2 + b, 3 + c) for a, b, c in product((0, 3), repeat=3)]
        super().__init__([middle, *corners], cells, middle)
