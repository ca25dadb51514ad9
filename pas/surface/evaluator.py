"""Values and derivatives of a piecewise polynomial at many points, and where rays cross its zeros.

Points are located by signs at planes (see `pas.partition.complex`) and evaluated by Horner's rule in the local
coordinates of the region (see `pas.algebra.evaluation`), in blocks that stay in the caches; rays by Bernstein bounds
on the polynomial along each (see `pas.surface.crossings`).  Where a partition has a centre or no cells,
values are the same bits on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.evaluation import PolynomialBatch
from pas.algebra.inputs import points_of, shown
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import to_float, to_floats
from pas.algebra.scaling import Scaled
from pas.arrays import Bools, Floats
from pas.limits import blocks
from pas.partition.boxes import SingleCell
from pas.partition.cells import Partition
from pas.surface.crossings import Crossings, crossings
from pas.surface.geometry import derivative_batch, symmetric
from pas.surface.rays import RayTarget

BLOCK = 1 << 14
"""Points that are worked on at once, so that what is needed of them stays in the caches."""


class Piecewise(Protocol):
    """The interface of a piecewise polynomial: one for each piece, in the local coordinates of a partition."""

    @property
    def partition(self) -> Partition:
        """The region and its pieces, in the user's coordinates."""

    @property
    def patches(self) -> Sequence[Polynomial]:
        """The polynomials in local coordinates."""


class Evaluator:
    """Evaluates a piecewise surface, or a polynomial in all of space, at many points and along many rays.

    Points (..., 3) are in the user's coordinates, and so are all derivatives; results are floats of shape (...),
    with (3,), (3, 3) or (3, 3, 3) appended.  Outside the region they are `outside`, NaN by default.  A value errs
    by some dozen roundings of the sum of its terms' sizes; on faces between pieces either piece may be taken.

    Raises `TypeError` for what has no polynomials, `ValueError` for points that are not finite, of a wrong shape
    or none at all.

    >>> sphere = Evaluator("x^2 + y^2 + z^2 - 1")
    >>> sphere.values([[2, 0, 0], [0, 0, 0]])
    array([ 3., -1.])
    >>> sphere.rays([[-2, 0, 0]], [[1, 0, 0]]).parameters
    array([1., 3.])
    """

    def __init__(self, surface: Piecewise | PolynomialLike) -> None:
        partition, patches = getattr(surface, "partition", None), getattr(surface, "patches", None)
        if partition is None or patches is None:
            try:
                patches = (Polynomial(surface),)  # type: ignore[arg-type]  # refused where it is none
            except TypeError:
                raise TypeError(
                    "surface must be a piecewise surface or a polynomial (of a blend, take its surface), "
                    f"not {shown(surface)}"
                ) from None
            partition = SingleCell()
        self.partition: Partition = partition
        self.patches: tuple[Polynomial, ...] = tuple(patches)
        self.scaled = Scaled.of(self.patches)
        self.degree = max(0, *(patch.degree for patch in self.patches))
        self._batches: dict[tuple[int, ...], PolynomialBatch] = {}

    def __repr__(self) -> str:
        pieces = "1 piece" if len(self.patches) == 1 else f"{len(self.patches)} pieces"
        return f"<Evaluator: degree {self.degree}, {pieces}>"

    def values(self, points: ArrayLike, outside: float = np.nan) -> Floats:
        """Values at `points` (..., 3), shape (...)."""
        return self.derivatives(checked(points), (0,), outside)[..., 0]

    def gradients(self, points: ArrayLike, outside: float = np.nan) -> Floats:
        """Gradients at `points` (..., 3), shape (..., 3)."""
        return self.derivatives(checked(points), (1,), outside)

    def hessians(self, points: ArrayLike, outside: float = np.nan) -> Floats:
        """Matrices of second derivatives at `points` (..., 3), shape (..., 3, 3)."""
        return symmetric(self.derivatives(checked(points), (2,), outside), 2)

    def third_derivatives(self, points: ArrayLike, outside: float = np.nan) -> Floats:
        """All third derivatives at `points` (..., 3), shape (..., 3, 3, 3)."""
        return symmetric(self.derivatives(checked(points), (3,), outside), 3)

    def jets(self, points: ArrayLike, outside: float = np.nan) -> Floats:
        """Values and gradients at `points` (..., 3), shape (..., 4)."""
        return self.derivatives(checked(points), (0, 1), outside)

    def rays(self, origins: ArrayLike, directions: ArrayLike) -> Crossings:
        """All crossings of the rays `origin + t direction`, t >= 0, with the surface in its region, in order.

        `origins` and `directions` broadcast to (..., 3); rays are numbered in the order of the flattened result.
        All numbers count as they are, exactly: the region with its boundary, without any tolerance, and the zeros of
        the polynomials of its cells.  So the counts do not change when directions are multiplied by powers of two.
        Origins may be far away and directions as short or as long as doubles are; a parameter beyond the range of
        doubles is infinite, and its point is right where it is not so far away itself.  Raises `ValueError` for
        directions of length zero.
        """
        return crossings(self.target, *rays_of(origins, directions))

    def first(self, origins: ArrayLike, directions: ArrayLike) -> Floats:
        """The parameters t >= 0 of the first crossings of rays, shape (...), NaN for those that miss; see `rays`."""
        shape = np.broadcast_shapes(np.shape(origins), np.shape(directions))[:-1]
        return self.rays(origins, directions).first.reshape(shape)

    def derivatives(self, points: Floats, orders: Sequence[int], outside: float = np.nan) -> Floats:
        """The partial derivatives of some orders at points (..., 3), one of each kind: shape (..., entries).

        In each order they are those of `monomials.homogeneous_exponents`.  Points are taken as they are; what is not
        finite is outside.
        """
        found, inside = self._located(points, orders)
        result = self.scaled.true(found)
        if not np.isnan(outside):
            result[~inside] = outside
        return result

    def scaled_derivatives(self, points: Floats, orders: Sequence[int]) -> Floats:
        """Partial derivatives of the scaled patches at points (..., 3), (..., entries), finite inside; NaN outside."""
        return self._located(points, orders)[0]

    def _located(self, points: Floats, orders: Sequence[int]) -> tuple[Floats, Bools]:
        """The derivatives of the scaled patches (..., entries), and which points (...) are in the region."""
        flat, batch = np.asarray(points, dtype=float).reshape(-1, 3), self.batch(*orders)
        result, inside = np.empty((len(flat), batch.degrees.shape[1])), np.empty(len(flat), dtype=bool)
        for here in blocks(len(flat), BLOCK):
            local = np.array(flat[here].T, order="C")
            local -= self._origin
            local /= self.scale
            pieces = self.partition.local.location.pieces(local, self.tolerance)
            result[here] = batch(local.T, pieces)
            inside[here] = pieces >= 0
        result /= [self.scale**order for order in orders for _ in homogeneous_exponents(order, 3)]
        shape = np.shape(points)[:-1]
        return result.reshape(*shape, result.shape[1]), inside.reshape(shape)

    @cached_property
    def _origin(self) -> Floats:
        return np.array(to_floats(self.partition.frame.origin))[:, None]

    @cached_property
    def scale(self) -> float:
        """The length of the local unit, in the user's."""
        return to_float(self.partition.frame.scale)

    @cached_property
    def tolerance(self) -> float:
        """How far outside its cell, in barycentric coordinates, a point counts as inside.

        Far from the origin, points on the boundary are off it by the spacing of doubles there.
        """
        rounding, spacings = 1e-12, 8  # of barycentric coordinates; of doubles at the region's furthest point
        return rounding + spacings * float(np.finfo(float).eps) * self.target.reach

    @cached_property
    def target(self) -> RayTarget:
        """The polynomials that rays are shot at."""
        return RayTarget(self.partition, self.scaled.polynomials)

    def batch(self, *orders: int) -> PolynomialBatch:
        """The partial derivatives of some orders up to 3 of the scaled patches, in local coordinates."""
        if orders not in self._batches:
            self._batches[orders] = derivative_batch(self.columns, orders)
        return self._batches[orders]

    @cached_property
    def columns(self) -> list[Floats]:
        """The coefficients of the scaled patches (C(n+3, 3),), rounded."""
        return [patch.dense(max(patch.degree, 0)) for patch in self.scaled.polynomials]


def checked(points: ArrayLike, name: str = "points") -> Floats:
    """Finite points (..., 3), at least one.  Raises `ValueError` otherwise."""
    array = points_of(points, name)
    if array.size == 0:
        raise ValueError(f"{name} must hold at least one, not none: their shape is {array.shape}")
    finite = np.isfinite(array)
    if not finite.all():
        row = np.argwhere(~finite)[0]
        raise ValueError(f"{name}{row[:-1].tolist() if array.ndim > 1 else ''} must be finite, not {array[tuple(row)]}")
    return array


def rays_of(origins: ArrayLike, directions: ArrayLike) -> tuple[Floats, Floats]:
    """Origins and directions of rays, both (N, 3).  Raises `ValueError` for arrays of other shapes or not finite."""
    starts, ways = checked(origins, "origins"), checked(directions, "directions")
    lengths = np.abs(ways).max(axis=-1)
    if not lengths.all():
        where = np.argwhere(lengths == 0)[0].tolist() if ways.ndim > 1 else ""
        raise ValueError(f"directions{where} must not be of length zero")
    try:
        starts, ways = np.broadcast_arrays(starts, ways)
    except ValueError:
        raise ValueError(
            f"origins and directions must broadcast to one shape, not {starts.shape} and {ways.shape}"
        ) from None
    return starts.reshape(-1, 3), ways.reshape(-1, 3)
