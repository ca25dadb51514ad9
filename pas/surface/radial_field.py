"""A piecewise surface as a graph over directions: where rays from the centre meet it, and the curves it ends on.

The piece of a ray is that of the outer face it leaves the region through, so no point is ever located in a cell.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyval

from pas.algebra.bracket import jets_of_columns, sign_change
from pas.algebra.evaluation import strided
from pas.arrays import Bools, Floats, Integers
from pas.kernels.library import compiled
from pas.mesh.rows import along_lines, dots
from pas.surface.boundary_loops import BoundaryLoop, Loops
from pas.surface.function import PiecewisePolynomial
from pas.surface.geometry import profile_batch
from pas.surface.sheet import INSIDE, LocalSurface

AROUND = np.array([0.0, *1.5 ** np.arange(6.0)])
"""Shares of rays from the skeleton between which their meeting with the surface is looked for, from 1 on outwards."""

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
        super().__init__(surface)
        self._profiles = profile_batch(self.evaluator.columns, self.degree)
        self.rims = surface.placed.loops
        self._loops = Loops(self.rims)

    @cached_property
    def fixed(self) -> Bools:
        return np.zeros(len(self.rims) + 1, dtype=bool)

    def between(self, ends: Floats, rims: Integers) -> Integers:
        raise AssertionError("no curve is fixed")

    def within(self, points: Floats) -> bool:
        """Whether rays leave the region there or farther away."""
        return bool((self.leaving(points)[0] >= 1 - INSIDE).all())

    def leaving(self, points: Floats) -> tuple[Floats, Integers]:
        """The multiples (N,) of points (N, 3) at which their rays leave the region, and the pieces (N,)."""
        leave, pieces, number = np.empty(len(points)), np.empty(len(points), dtype=np.intp), len(points)
        tables = len(self._weights), self._weights, self._piece
        compiled().call("pas_leaving", *tables, number, *strided(points), leave, pieces)
        return leave, pieces

    def pieces(self, points: Floats) -> Integers:
        """The pieces through whose outer faces rays to points leave the region."""
        return self.leaving(points)[1]

    def profiles(self, points: Floats) -> tuple[Floats, Floats]:
        """Coefficients (n + 1, N) of f along the rays to points, in multiples of these, and where they leave (N,)."""
        leave, pieces = self.leaving(points)
        return self._profiles(points, pieces).T, leave

    def met(self, points: Floats) -> Floats:
        """Where the rays through points (N, 3) meet the surface, found from there."""
        return self._met(points)[0]

    def _met(self, points: Floats) -> tuple[Floats, Bools]:
        """Where rays through points (N, 3) meet the surface, (N, 3), and which of them (N,) graze or miss it."""
        steep = 0.4  # cosine between normal and ray below which a ray from the skeleton is taken
        off = 1e-6  # so far from the surface, over the way from 0, a ray has missed it: it left through a contact
        profiles, leave = self.profiles(points)
        start = np.minimum(leave / 2 + np.where(leave > 1, 0.5, 0.0), 1.0)
        shares = sign_change(jets_of_columns(profiles), np.zeros(len(points)), leave, start, SETTLED)
        found = shares[:, None] * points
        jets = self.jets(found)
        sizes = np.sqrt(dots(found, found) * dots(jets[:, 1:], jets[:, 1:]))
        return found, ~((dots(found, jets[:, 1:]) > steep * sizes) & (np.abs(jets[:, 0]) <= off * sizes))

    def on_rims(self, points: Floats, rim: Integers) -> Floats:
        return self._loops.at(points, rim)

    def rim_distances(self, points: Floats, rim: Integers) -> Floats:
        return self._loops.distances(points, rim)

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
        feet = self._feet(points)
        ways, farthest = points - feet, np.zeros(len(points))
        for share in AROUND[1:]:
            beyond = self.values(feet + share * ways) > 0
            farthest = np.where(beyond & (farthest == 0), share, farthest)
        met = np.flatnonzero(farthest > 0)
        feet, ways = feet[met], ways[met]
        along = along_lines(lambda here, _: self.jets(here), feet, ways)
        before = AROUND[np.searchsorted(AROUND, farthest[met]) - 1]
        found = sign_change(along, before, farthest[met], np.ones(len(met)).clip(before, farthest[met]), SETTLED)
        result = np.array(otherwise)
        result[met] = feet + found[:, None] * ways
        return result

    def _feet(self, points: Floats) -> Floats:
        """The nearest points (N, 3) of the skeleton."""
        feet, least = np.zeros_like(points), dots(points, points)
        for middle in (ring.middle for ring in self.rims):
            places = np.clip(points @ middle / (middle @ middle), 0.0, 1.0)[:, None] * middle
            squares = dots(points - places, points - places)
            nearer = squares < least
            feet[nearer], least[nearer] = places[nearer], squares[nearer]
        return feet

    def once(self, points: Floats) -> bool:
        """Whether f changes its sign once, from inside to outside, along all rays to points, as sampled."""
        samples = 32  # places along a ray where the sign of f is looked at
        profiles, leave = self.profiles(points)
        shares = np.outer(np.linspace(0.0, 1.0, samples + 1), leave)
        inside = polyval(shares, profiles, tensor=False) < 0
        return bool((inside[:-1] >= inside[1:]).all() and inside[0].all() and not inside[-1].any())
