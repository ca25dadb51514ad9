"""What the remesher asks of the surface that a mesh is of: projections of points, and distances."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pas.mesh.halfedges import HalfEdges
from pas.mesh.rows import Floats, Integers


class Ground(Protocol):
    """A surface, or the faces of a solid by their labels, near which the vertices of a mesh are."""

    reach: float
    """Half the diagonal of what holds it."""

    faces: NDArray[np.int8]
    """The kinds of labels (L,): 0 for bent faces, 1 for ruled ones, 2 for planes."""

    knows_bends: bool
    """Whether curvatures are known, or must be taken from how normals turn."""

    def drawn(self, mesh: HalfEdges, to: Floats) -> tuple[Floats, Floats, Floats | None]:
        """Places (V, 3) for vertices, drawn towards their faces and curves until they are much nearer; normals (W, 3)
        and curvatures (W,) of wedges there."""

    def placed(self, points: Floats, labels: Integers, rims: Integers, reach: Floats) -> Floats:
        """Points (K, 3) projected onto where faces of labels (K, k), ascending, then -1, meet, or onto boundary curves
        of numbers (K,), -1 of none; no step is longer than its `reach` (K,)."""

    def projected(self, mesh: HalfEdges) -> tuple[Floats, Floats]:
        """All vertices (V, 3), which are near, projected onto their faces and curves, and normals (W, 3) there."""

    def looked(self, points: Floats, labels: Integers) -> tuple[Floats, Floats | None]:
        """Unit normals (K, 3) and curvatures (K,) of faces at points on them."""

    def measured(self, mesh: HalfEdges, rows: Integers, halves: Integers) -> tuple[Floats, Floats]:
        """Distances of the insides of triangles and the middles of half edges from their faces and curves."""

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance (K,) of triangles (K, 3, 3) and their edges from a face."""
