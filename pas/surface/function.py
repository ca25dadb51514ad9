"""Piecewise polynomials on a partition: the functions whose zeros piecewise algebraic surfaces are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.inputs import check_surface_degree, points_of
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_fraction, vector
from pas.algebra.scaling import Scaled
from pas.arrays import Bools, Floats
from pas.bernstein.forms import b_form, nearby_forms, on_simplex
from pas.contacts.joins import Join
from pas.partition.cells import Partition
from pas.partition.complex import OuterFace
from pas.surface.evaluator import Evaluator
from pas.surface.geometry import Geometry, symmetric
from pas.surface.placed import InPlace, PlacedContacts


@dataclass(frozen=True)
class Cell:
    """One cell of a surface: a tetrahedron and the polynomial in it, exact."""

    vertices: tuple[tuple[Fraction, Fraction, Fraction], ...]
    polynomial: Polynomial
    degree: int

    @cached_property
    def b_coefficients(self) -> dict[tuple[int, int, int, int], Fraction]:
        """The Bernstein-Bezier form on the cell's tetrahedron, by multi-index, exact."""
        corners = [vector(v) for v in self.vertices]
        values = b_form(on_simplex(self.polynomial.raw, corners), self.degree, 3)
        indices = homogeneous_exponents(self.degree, 4)
        return {(a, b, c, d): to_fraction(v) for (a, b, c, d), v in zip(indices, values, strict=True)}


class PiecewisePolynomial(InPlace):
    """One polynomial in each piece of a partition, with the contacts that its zeros are to meet.

    `patches` are the polynomials in the partition's local coordinates, one for each piece; `degree` is at least
    theirs.  Raises `ValueError` for another number of patches and degrees beyond the limit.
    """

    def __init__(self, placed: PlacedContacts, patches: Sequence[Polynomial], degree: int | None = None) -> None:
        pieces = len(placed.partition.pieces)
        if len(patches) != pieces:
            raise ValueError(f"there must be a patch for each of the {pieces} pieces, not {len(patches)}")
        self.placed = placed
        self.patches = tuple(patches)
        self.degree = check_surface_degree(max(0, *(p.degree for p in self.patches)), degree)

    @property
    def local(self) -> Partition:
        """The partition in local coordinates, in which `patches` are given."""
        return self.placed.local

    @property
    def joins(self) -> tuple[Join, ...]:
        """The contacts in local coordinates, with their places on the partition."""
        return self.placed.joins

    @property
    def walls(self) -> tuple[OuterFace, ...]:
        """The faces of the region that the inside may not reach; see `PlacedContacts.walls`."""
        return self.placed.walls

    @cached_property
    def polynomials(self) -> tuple[Polynomial, ...]:
        """The polynomial of each piece, exact, in the user's coordinates."""
        return tuple(map(self.partition.frame.globalise, self.patches))

    @property
    def scaled(self) -> Scaled:
        """The patches over their common power of two, as whatever works in doubles takes them."""
        return self.evaluator.scaled

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """The cells with their exact vertices and polynomials, in the user's coordinates."""
        return tuple(
            Cell(
                tuple(tuple(to_fraction(x) for x in v) for v in self.partition.corners(cell)),  # type: ignore[misc]
                self.polynomials[piece],
                self.degree,
            )
            for cell, piece in zip(self.partition.cells, self.partition.piece_of, strict=True)
        )

    def __call__(self, points: ArrayLike) -> Floats:
        """Values at `points` (..., 3), shape (...); NaN outside the region."""
        return self.evaluator.derivatives(points_of(points), (0,))[..., 0]

    def gradient(self, points: ArrayLike) -> Floats:
        """Gradients at `points` (..., 3), shape (..., 3); NaN outside the region."""
        return self.evaluator.derivatives(points_of(points), (1,))

    def jets(self, points: ArrayLike) -> Floats:
        """Values and gradients at `points` (..., 3), shape (..., 4); NaN outside the region."""
        return self.evaluator.derivatives(points_of(points), (0, 1))

    def hessian(self, points: ArrayLike) -> Floats:
        """Second derivatives at `points` (..., 3), shape (..., 3, 3); NaN outside the region."""
        return symmetric(self.evaluator.derivatives(points_of(points), (2,)), 2)

    @cached_property
    def evaluator(self) -> Evaluator:
        """The evaluator of the surface at many points and along many rays."""
        return Evaluator(self)

    @cached_property
    def cell_forms(self) -> tuple[Floats, float]:
        """The B-coefficients (C, m) on the cells in local coordinates, each cell's scaled by a positive number, and by
        how much they may be off over the largest of its cell."""
        cells = [self.local.corners(cell) for cell in self.local.cells]
        return nearby_forms([self.patches[p].raw for p in self.local.piece_of], cells, max(self.degree, 1))

    def curvatures(self, points: ArrayLike) -> Floats:
        """Mean and Gauss curvature at surface points (..., 3): shape (..., 2).

        The mean curvature is positive where the surface bends like a ball that is inside.
        """
        jets = self.evaluator.scaled_derivatives(points_of(points), range(4))
        principal = Geometry(jets.reshape(-1, jets.shape[-1])).principal.reshape(*jets.shape[:-1], 2)
        return np.stack([principal.mean(axis=-1), principal.prod(axis=-1)], axis=-1)

    def contains(self, points: ArrayLike) -> Bools:
        """Whether `points` (..., 3) are in the region and inside or on the surface, shape (...)."""
        return np.asarray(self(points) <= 0)

    def intersect_rays(self, origins: ArrayLike, directions: ArrayLike) -> Floats:
        """Where rays first meet the surface inside the region.

        `origins` and `directions` broadcast to (..., 3); returns the parameters t >= 0 of the
        points `origin + t * direction`, shape (...), NaN for rays that miss.  All crossings: `pas.Evaluator.rays`.
        """
        shape = np.broadcast_shapes(np.shape(origins), np.shape(directions))
        return self.evaluator.first(origins, directions) if np.prod(shape) else np.empty(shape[:-1])
