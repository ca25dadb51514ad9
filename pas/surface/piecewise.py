"""Piecewise algebraic surfaces: one exact polynomial in each piece of a partition."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.inputs import check_limit, check_surface_degree, check_tolerance
from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, plain, rational, to_fraction, vector
from pas.algebra.scaling import Scaled
from pas.bernstein.forms import b_form, nearby_forms, on_simplex
from pas.errors import GeometryError, MeshError
from pas.limits import Report, limited
from pas.mesh.quality import Quality
from pas.partition.cells import OuterFace, Partition
from pas.shape import Shape
from pas.surface.certificate import Certificate
from pas.surface.contact import Contact
from pas.surface.curvature_bound import curvature_below
from pas.surface.evaluator import Evaluator, symmetric
from pas.surface.fairness import Fairness, fairness
from pas.surface.following import around_centre
from pas.surface.joins import Join
from pas.surface.local_field import LocalField
from pas.surface.mesh_stage import Stage
from pas.surface.meshing import meshed
from pas.surface.placed import InPlace, PlacedContacts
from pas.surface.proofs import certify
from pas.surface.radial_field import RadialField
from pas.surface.surface_mesh import SurfaceMesh
from pas.verdicts import Verdict

DEFAULT_TOLERANCE = 1e-3
"""Of a mesh, over the longest side of the region's box."""


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


class PiecewiseSurface(InPlace, Shape):
    """The zero set of a piecewise polynomial, C^`order` across faces, meeting its contacts.

    `patches` are the polynomials in the partition's local coordinates, one for each piece.
    Negative values are inside.  Nothing is taken on trust: what holds is what `certify` proves.
    """

    kind = "surface"

    def __init__(
        self,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        patches: Sequence[Polynomial],
        degree: int | None = None,
    ) -> None:
        if len(patches) != len(partition.pieces):
            raise ValueError(
                f"there must be a patch for each of the {len(partition.pieces)} pieces, not {len(patches)}"
            )
        self.placed = PlacedContacts(partition, contacts, order)
        self.patches = tuple(patches)
        self.degree = check_surface_degree(max(0, *(p.degree for p in self.patches)), degree)

    @classmethod
    def from_polynomials(
        cls,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        polynomials: Iterable[PolynomialLike],
        degree: int | None = None,
    ) -> PiecewiseSurface:
        """A surface from the polynomials of its pieces in the user's coordinates."""
        given = [Polynomial(p) for p in polynomials]
        check_surface_degree(max((p.degree for p in given), default=0))
        return cls(partition, contacts, order, [partition.frame.localise(p) for p in given], degree)

    @classmethod
    def in_place(cls, placed: PlacedContacts, patches: Sequence[Polynomial], degree: int) -> PiecewiseSurface:
        """A surface that meets contacts in place: what is known of these is not worked out again."""
        surface = cls(placed.partition, placed.contacts, placed.order, patches, degree)
        surface.placed = placed
        return surface

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
        return self.evaluator.derivatives(_shaped(points), (0,))[..., 0]

    def gradient(self, points: ArrayLike) -> Floats:
        """Gradients at `points` (..., 3), shape (..., 3); NaN outside the region."""
        return self.evaluator.derivatives(_shaped(points), (1,))

    def jets(self, points: ArrayLike) -> Floats:
        """Values and gradients at `points` (..., 3), shape (..., 4); NaN outside the region."""
        return self.evaluator.derivatives(_shaped(points), (0, 1))

    def hessian(self, points: ArrayLike) -> Floats:
        """Second derivatives at `points` (..., 3), shape (..., 3, 3); NaN outside the region."""
        return symmetric(self.evaluator.derivatives(_shaped(points), (2,)), 2)

    @cached_property
    def evaluator(self) -> Evaluator:
        """What evaluates the surface at many points and along many rays."""
        return Evaluator(self)

    @cached_property
    def radial_field(self) -> RadialField | None:
        """What meshes it as a graph over directions, None where it is none."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is no graph
                return RadialField(self) if around_centre(self) else None
        except ArithmeticError:
            return None

    @cached_property
    def cell_forms(self) -> tuple[Floats, float]:
        """The B-coefficients (C, m) on the cells in local coordinates, each cell's scaled by a positive number, and by
        how much they may be off over the largest of its cell."""
        cells = [self.local.corners(cell) for cell in self.local.cells]
        return nearby_forms([self.patches[p].raw for p in self.local.piece_of], cells, max(self.degree, 1))

    @cached_property
    def cell_field(self) -> LocalField:
        """What meshes it from lattices in the cells."""
        return LocalField(self)

    @cached_property
    def stage(self) -> Stage:
        """What proves meshes of it."""
        return Stage(self)

    def local_jets(self, points: Floats, pieces: np.ndarray) -> Floats:
        """Values and gradients (N, 4) of the scaled patches of given pieces at local points (N, 3)."""
        return self.evaluator.local_derivatives(points, pieces, (0, 1))

    def curvatures(self, points: ArrayLike) -> Floats:
        """Mean and Gauss curvature at surface points (..., 3): shape (..., 2).

        The mean curvature is positive where the surface bends like a ball that is inside
        (Goldman 2005: `(|g|^2 tr H - g^T H g) / (2 |g|^3)` and `g^T adj(H) g / |g|^4`).
        """
        jets = self.evaluator.scaled_derivatives(_shaped(points), (1, 2))
        g, h = jets[..., :3], symmetric(jets[..., 3:], 2)
        length = np.linalg.norm(g, axis=-1)
        quadratic = np.einsum("...i,...ij,...j", g, h, g)
        mean = (length**2 * np.trace(h, axis1=-2, axis2=-1) - quadratic) / (2 * length**3)
        adjugate = np.stack(
            [
                np.cross(h[..., 1, :], h[..., 2, :]),
                np.cross(h[..., 2, :], h[..., 0, :]),
                np.cross(h[..., 0, :], h[..., 1, :]),
            ],
            axis=-2,
        )
        gauss = np.einsum("...i,...ij,...j", g, adjugate, g) / length**4
        return np.stack([mean, gauss], axis=-1)

    @limited("bounding curvature", "a larger bound")
    def curvature_below(self, bound: Exact, *, seconds: float | None = None, progress: Report | None = None) -> Verdict:
        """The verdict on `sqrt(k1^2 + k2^2) < bound` all over the surface in its region: proved, refuted or undecided.

        k1 and k2 are the principal curvatures, `bound` is in 1 / unit of length.  A second for surfaces of degree 4,
        ten for degree 6; bounds that are nearer than some thousandth to the largest stay undecided.

        Raises `ValueError` for a bound that is not positive, `GeometryError` for a surface without a region.
        """
        number = rational(bound, "bound")
        if number <= 0:
            raise ValueError(f"bound must be positive, not {plain(number)}")
        if not self.partition.cells:
            raise GeometryError("the curvature is bounded in a region, and the surface has none")
        return curvature_below(self, number)

    @limited("measuring how fair a surface is", "")
    def fairness(self, *, seconds: float | None = None, progress: Report | None = None) -> Fairness:
        """How fair the surface is: curvature beside that of its neighbours, bulges, inflections; see `pas.Fairness`.

        Measured on some thousand rays from the centre.  Raises `GeometryError` for a surface without a region, a
        centre inside it or a contact.
        """
        return self._fairness

    @cached_property
    def _fairness(self) -> Fairness:
        return fairness(self)

    @property
    def looked_into(self) -> bool:
        """Whether its certificate has been worked out."""
        return "certificate" in vars(self)

    def contains(self, points: ArrayLike) -> np.ndarray:
        """Whether `points` (..., 3) are in the region and inside or on the surface, shape (...)."""
        return np.asarray(self(points) <= 0)

    def intersect_rays(self, origins: ArrayLike, directions: ArrayLike) -> Floats:
        """Where rays first meet the surface inside the region.

        `origins` and `directions` broadcast to (..., 3); returns the parameters t >= 0 of the
        points `origin + t * direction`, shape (...), NaN for rays that miss.  All crossings: `pas.Evaluator.rays`.
        """
        shape = np.broadcast_shapes(np.shape(origins), np.shape(directions))
        return self.evaluator.first(origins, directions) if np.prod(shape) else np.empty(shape[:-1])

    @limited("proving a surface", "")
    def certify(self, *, seconds: float | None = None, progress: Report | None = None) -> Certificate:
        """Prove the contacts, the smoothness, the single sheet and the enclosure."""
        return certify(self)

    @cached_property
    def certificate(self) -> Certificate:
        """The same, proved when first asked for and kept: never what somebody else says of this surface."""
        return self.certify()

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self,
        tolerance: float | None = None,
        *,
        max_triangles: int | None = None,
        quality: Quality | str = Quality.BALANCED,
        seconds: float | None = None,
        progress: Report | None = None,
    ) -> SurfaceMesh:
        """Triangles within `tolerance` (the model's units) of the surface, as measured, at most `max_triangles`.

        Vertices lie on the surface, boundary vertices on the contact curves; normals point outwards.  By default
        the tolerance is a thousandth of the longest side of the region's box.  Raises `MeshError` where there is
        no surface or the tolerance needs more triangles than that (four million by default).  Of some meshes the
        `quality` "angles" takes that with the largest smallest angle, "count" that with fewest triangles.
        """
        how = Quality.of(quality)
        if not self.partition.cells:
            raise MeshError("the surface has no region to be meshed in: give its cell one, as in pas.SingleCell(box)")
        if all(patch.degree < 1 for patch in self.patches):
            raise MeshError("there is no surface to be meshed: its function is constant in each piece")
        if tolerance is None:
            tolerance = DEFAULT_TOLERANCE * float(np.ptp(self.partition.points, axis=0).max())
        scale = float(to_fraction(self.partition.frame.scale))
        return meshed(self, check_tolerance(tolerance, scale), check_limit(max_triangles), how)

    @limited("meshing a surface", "a coarser tolerance")
    def triangulate(
        self, tolerance: float | None = None, *, seconds: float | None = None, progress: Report | None = None
    ) -> SurfaceMesh:
        """What `mesh` was called when it made something else."""
        return self.mesh(tolerance)

    def __str__(self) -> str:
        pieces = f"{len(self.patches)} pieces" if len(self.patches) > 1 else "one piece"
        return f"{self.partition.name}, {pieces}, degree {self.degree}, order {self.order}"


def _shaped(points: ArrayLike) -> Floats:
    """Points (..., 3) as an array.  Raises `ValueError` for another shape."""
    array = np.asarray(points, dtype=float)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"points must have shape (..., 3), not {array.shape}")
    return array
