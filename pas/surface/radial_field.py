"""A piecewise surface as a graph over directions: where rays from the centre meet it, and the curves it ends on.

The piece of a ray is that of the outer face it leaves the region through, so no point is ever located in a cell.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.kernels.library import compiled
from pas.mesh.graph import first
from pas.mesh.labelled import Labelled
from pas.mesh.rows import Integers, dots
from pas.surface.boundary_loops import BoundaryLoop, Loops
from pas.surface.function import PiecewisePolynomial
from pas.surface.geometry import profile_batch
from pas.surface.local_field import INSIDE, LocalSurface

STEPS = 60
"""Along a ray at most: Newton's, each kept between the ends of a bracket that holds the root, else halved."""

SETTLED = 1e-9
"""Change of the share of a ray's length that ends the search: by Newton's method the next is about its square."""


class RadialField(LocalSurface):
    """A surface of one sheet around the centre of its partition, in local coordinates with the centre 0."""

    rims: list[BoundaryLoop]

    def __init__(self, surface: PiecewisePolynomial) -> None:
        outer = surface.local.outer_faces
        corners = np.array([surface.local.points[list(face.vertices)] for face in outer])
        self._weights = np.linalg.inv(corners.transpose(0, 2, 1))
        self._piece = np.array([face.piece for face in outer], dtype=np.intp)
        super().__init__(surface, (self._weights, self._piece))
        self._profiles = profile_batch(self.evaluator.columns, self.degree)
        self.rims = surface.placed.loops
        self._loops = Loops(self.rims)
        middles = np.array([ring.middle for ring in self.rims]).reshape(-1, 3)
        self._skeleton = middles, dots(middles, middles)

    @cached_property
    def first(self) -> Labelled | None:
        """Few triangles, with which meshes begin, None where rays show that it is no graph."""
        try:
            return first(self)
        except ArithmeticError:
            return None

    def between(self, ends: Floats, rims: Integers) -> Integers:
        """See `pas.mesh.field.SheetField`: none, as rings have no ends."""
        return np.full(len(ends), -1)

    def within(self, points: Floats) -> bool:
        """Whether all points (N, 3) are in the region, but for rounding: rays leave it there or farther away."""
        return bool((self.leaving(points)[0] >= 1 - INSIDE).all())

    def leaving(self, points: Floats) -> tuple[Floats, Integers]:
        """The multiples (N,) of points (N, 3) at which their rays leave the region, and the pieces (N,)."""
        leave, faces = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
        compiled().call("pas_leaving", len(self._weights), self._weights, len(points), points, leave, faces)
        return leave, self._piece[faces]

    def profiles(self, points: Floats) -> tuple[Floats, Floats]:
        """Coefficients (n + 1, N) of f along the rays to points, in multiples of these, and where they leave (N,)."""
        leave, pieces = self.leaving(points)
        return self._profiles(points, pieces).T, leave

    def met(self, points: Floats) -> Floats:
        """Where the rays through points (N, 3) meet the surface, found from there."""
        return self._met(points)[0]

    def _met(self, points: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Where rays through points (N, 3) meet the surface, (N, 3), and which of them (N,) graze or miss it."""
        steep = 0.4  # cosine between normal and ray below which a ray from the skeleton is taken
        off = 1e-6  # so far from the surface, over the way from 0, a ray has missed it: it left through a contact
        result, grazed = np.empty((len(points), 3)), np.empty(len(points), dtype=np.bool_)
        polynomials = (self.degree + 1, *self._profiles.arrays, *self._jets.arrays)
        given = (*self._pieces, *polynomials, len(points), points, STEPS, SETTLED, steep, off)
        compiled().call("pas_near", *given, result, grazed)
        return result, grazed

    def on_rims(self, points: Floats, rim: Integers) -> Floats:
        """Points (N, 3) near curves of given numbers (N,) moved onto these."""
        return self._loops.at(points, rim)

    def rim_distances(self, points: Floats, rim: Integers) -> Floats:
        """Distances (N,) of points (N, 3) from curves of given numbers (N,), to first order."""
        result = np.zeros(len(points))
        for number in np.unique(rim).tolist():
            result[rim == number] = self.rims[number].distances(points[rim == number])
        return result

    def near(self, points: Floats) -> Floats:
        """The surface's points (N, 3) on rays through points, from the skeleton where those from 0 graze or miss it."""
        found, grazed = self._met(points)
        if grazed.any():
            found[grazed] = self._around(points[grazed], found[grazed])
        return found

    def _around(self, points: Floats, otherwise: Floats) -> Floats:
        """Where the rays to points (N, 3) from the nearest points of the skeleton meet the surface, found from there.

        The skeleton joins the centre with the middle of each ring: all of it is inside a surface of one sheet, and near
        a ring such rays stay in the region, however thin the surface is there.  Points that they do not meet nearby are
        those given `otherwise`.
        """
        outwards = 1.5  # the furthest step outwards along a ray of the skeleton, over the distance from it
        away = 10.0  # how far, over the distance from the skeleton, such rays are followed at most
        result, middles = np.array(otherwise, order="C"), self._skeleton
        given = (*self._pieces, *self._jets.arrays, len(middles[0]), *middles, len(points), points)
        compiled().call("pas_around", *given, STEPS, SETTLED, outwards, away**2, result)
        return result

    def once(self, points: Floats) -> bool:
        """Whether f changes its sign once, from inside to outside, along all rays to points, as sampled."""
        samples = 32  # places along a ray where the sign of f is looked at
        profiles, leave = self.profiles(points)
        shares, once = np.linspace(0.0, 1.0, samples + 1), np.empty(1, dtype=np.intp)
        compiled().call("pas_once", *profiles.shape, profiles, leave, len(shares), shares, once)
        return bool(once[0])
