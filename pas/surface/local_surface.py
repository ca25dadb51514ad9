"""A piecewise surface in its local coordinates, as meshers ask for it: projections onto it, gradients, curvatures."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_fraction
from pas.kernels.library import compiled
from pas.mesh.field import RimCurve
from pas.mesh.rows import Integers
from pas.surface.function import PiecewisePolynomial

CLOSE = 1e-11
"""The last step along a gradient, in local units, that is worth another."""


INSIDE = 1e-11
"""How far outside the region a point may be by rounding: in local units, barycentric coordinates, or over the way to
where its ray leaves."""


class LocalSurface(ABC):
    """A piecewise surface at points (N, 3) in its local coordinates, scaled.

    The piece of a point is that of the cell it is deepest in; with `faces` that of the outer face through which its ray
    from 0 leaves, given for each by the map (F, 3, 3) from points to weights of the corners, and the piece (F,).
    """

    rims: Sequence[RimCurve]
    """The curves on which it ends."""

    def __init__(self, surface: PiecewisePolynomial, faces: tuple[Floats, Integers] | None = None) -> None:
        local, self.degree, self.evaluator = surface.local, max(surface.degree, 1), surface.evaluator
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        self._value, self._jets, self._bends = (self.evaluator.batch(*range(n)) for n in (1, 2, 3))
        pieces = len(surface.patches)
        if faces is not None:
            self._pieces = np.array([pieces, len(faces[0]), 0]), *faces
        elif pieces == 1:
            self._pieces = np.array([1, 0, 0]), np.empty((0, 4, 4)), np.empty(0, dtype=np.intp)
        else:
            maps = np.ascontiguousarray(local.barycentric_maps)
            self._pieces = np.array([pieces, 0, len(maps)]), maps, np.array(local.piece_of, dtype=np.intp)

    @cached_property
    def fixed(self) -> NDArray[np.bool_]:
        """Which of `rims` are fixed, and, at the end, that what is on none is not, (R + 1,)."""
        return np.array([*(curve.fixed for curve in self.rims), False])

    def pieces(self, points: Floats) -> Integers:
        """The numbers of the pieces (N,) that hold points, or are nearest to them."""
        found = np.empty(len(points), dtype=np.intp)
        compiled().call("pas_pieces_of", *self._pieces, len(points), points, found)
        return found

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def values(self, points: Floats) -> Floats:
        """The values (N,)."""
        return self._value(points, self.pieces(points))[:, 0]

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4)."""
        return self._jets(points, self.pieces(points))

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3)."""
        return self.jets(points)[:, 1:]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,), to first order."""
        result = np.empty(len(points))
        compiled().call("pas_distances", *self._pieces, *self._jets.arrays, len(points), points, result)
        return result

    @abstractmethod
    def near(self, points: Floats) -> Floats:
        """Points (N, 3) of the surface near points inside or outside it."""

    def drawn(self, points: Floats, still: NDArray[np.bool_]) -> tuple[Floats, Floats, Floats]:
        """Points near the surface moved towards it, but for those that are `still` (N,), and gradients and curvatures
        there.

        By a step along the gradient, or as `near` does where the next one would be more than a tenth of it.
        """
        left = 0.1  # a larger share means that a point was not near the surface
        number = len(points)
        (moved, gradients), bends = np.empty((2, number, 3)), np.empty(number)
        lost = np.empty(number, dtype=np.bool_)
        given = (*self._pieces, *self._jets.arrays, *self._bends.arrays, number, points, still, left**2, CLOSE**2)
        compiled().call("pas_drawn", *given, moved, gradients, bends, lost)
        if lost.any():
            moved[lost] = self.near(points[lost])
            gradients[lost], bends[lost] = self.bending(moved[lost])
        return moved, gradients, bends

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        values, bends = np.empty((2, len(points)))
        gradients = np.empty((len(points), 3))
        given = (*self._pieces, *self._bends.arrays, len(points), points)
        compiled().call("pas_bent", *given, values, gradients, bends)
        return gradients, bends

    def closed(self, points: Floats) -> tuple[Floats, Floats]:
        """Points very near the surface moved onto it along gradients, (N, 3), and the gradients (N, 3) there."""
        steps = 6  # along gradients: from very near the surface two or three do
        result, gradients = np.array(points, order="C"), np.empty((len(points), 3))
        given = (*self._pieces, *self._jets.arrays, len(points), steps, CLOSE)
        compiled().call("pas_closed", *given, result, gradients)
        return result, gradients
