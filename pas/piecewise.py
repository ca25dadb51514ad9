"""Piecewise algebraic surfaces and their meshes: one exact polynomial in each piece of a partition."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Unpack

import numpy as np

from pas.algebra.inputs import check_limit, check_surface_degree
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, VectorLike, check_tolerance, positive, to_fraction
from pas.arrays import Floats, Integers
from pas.certify.certificate import Certificate
from pas.certify.curvature import curvature_below
from pas.certify.local_mesh import FramedSurface
from pas.certify.mesh_proofs import MeshCertificate, certify_mesh
from pas.certify.proofs import certify
from pas.contacts.contact import Contact
from pas.errors import GeometryError, MeshError
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.partition.boxes import SingleCell
from pas.partition.cells import Partition
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape
from pas.surface.fairness import Fairness, fairness
from pas.surface.function import PiecewisePolynomial
from pas.surface.meshing import Mesher
from pas.surface.placed import PlacedContacts
from pas.verdicts import Verdict


class PiecewiseSurface(PiecewisePolynomial, Shape):
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
        super().__init__(PlacedContacts(partition, contacts, order), patches, degree)

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
        surface = cls.__new__(cls)
        PiecewisePolynomial.__init__(surface, placed, patches, degree)
        return surface

    @cached_property
    def mesher(self) -> Mesher:
        """The meshers of the surface."""
        return Mesher(self)

    @cached_property
    def framed(self) -> FramedSurface:
        """The surface in coordinates in which meshes of it are proved."""
        return FramedSurface(self)

    @limited("bounding curvature", "a larger bound")
    def curvature_below(self, bound: Exact, **limits: Unpack[WorkLimits]) -> Verdict:
        """The verdict on `sqrt(k1^2 + k2^2) < bound` all over the surface in its region: proved, refuted or undecided.

        k1 and k2 are the principal curvatures, `bound` is in 1 / unit of length.  About a second for surfaces up to
        degree 6, two more for the first of a degree; bounds nearer than a thousandth may stay undecided.

        Raises `ValueError` for a bound that is not positive, `GeometryError` for a surface without a region.
        """
        number = positive(bound, "bound")
        if not self.partition.cells:
            raise GeometryError("the curvature is bounded in a region, and the surface has none")
        return curvature_below(self, number)

    @limited("measuring how fair a surface is", "")
    def fairness(self, **limits: Unpack[WorkLimits]) -> Fairness:
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

    @limited("proving a surface", "")
    def certify(self, **limits: Unpack[WorkLimits]) -> Certificate:
        """Prove the contacts, the smoothness, the single sheet and the enclosure."""
        return certify(self)

    @cached_property
    def certificate(self) -> Certificate:
        """Its certificate, proved when first asked for and kept: never what somebody else says of this surface."""
        return self.certify()

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self,
        tolerance: Exact | None = None,
        *,
        max_triangles: int | None = None,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
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
            tolerance = RELATIVE_TOLERANCE * float(np.ptp(self.partition.points, axis=0).max())
        scale = float(to_fraction(self.partition.frame.scale))
        wanted = check_tolerance(tolerance, scale)
        most = check_limit(max_triangles)
        return self._kept(
            (wanted, most, how), lambda: SurfaceMesh.of_surface(self.mesher.mesh(wanted, most, how), self, wanted)
        )

    def certify_mesh(self, points: Floats, triangles: Integers) -> MeshCertificate:
        """The verdicts on points (N, 3) and triangles (T, 3) of any origin as a mesh of this surface.

        Whether they end on the walls of the region, have the topology of the surface, and how far from it they are.
        """
        return certify_mesh(self.framed, points, triangles, lambda: self.certificate)

    @limited("meshing a surface", "a coarser tolerance")
    def triangulate(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> SurfaceMesh:
        """The former name of `mesh`, whose result was another."""
        return self.mesh(tolerance)

    def __str__(self) -> str:
        pieces = f"{len(self.patches)} pieces" if len(self.patches) > 1 else "one piece"
        return f"{self.partition.name}, {pieces}, degree {self.degree}, order {self.order}"


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(Mesh):
    """A mesh of a piecewise surface; its certificate is a proof that it is one, worked out when first asked for.

    `tolerance` is the one it was made for, in the model's units.
    """

    surface: PiecewiseSurface | None = None
    tolerance: float | None = None

    @classmethod
    def of_surface(cls, mesh: Mesh, surface: PiecewiseSurface, tolerance: float) -> SurfaceMesh:
        """A mesh (points, triangles, normals) of a surface together with that surface."""
        known = mesh.points, mesh.triangles, mesh.faces, ("surface",), mesh.normals, None, mesh.deviation
        return cls(*known, smooth_normals=mesh.point_normals, surface=surface, tolerance=tolerance)

    def follow(self, surface: PiecewiseSurface, tolerance: Exact | None = None) -> SurfaceMesh:
        """A mesh of a surface that is this one's, moved a little, with about the same triangles, for sliders.

        The vertices are put onto it, and triangles that are then too far from it are halved; where that would fold
        some, the mesh is made anew.  Within `tolerance`, by default that of this mesh, as measured; its topology is
        that of this mesh unless it is made anew, and its certificate says whether that is the surface's.
        """
        wanted = check_tolerance(self.tolerance if tolerance is None else tolerance)
        try:
            mesh = surface.mesher.moved(self.points, self.triangles, wanted)
        except ArithmeticError:
            return surface.mesh(wanted)
        return self.of_surface(mesh, surface, wanted)

    @cached_property
    def certificate(self) -> MeshCertificate:
        """Whether it has the topology of the surface, and how far from it it is at most; see `certify_mesh`."""
        assert self.surface is not None
        return self.surface.certify_mesh(self.points, self.triangles)


def boxed(polynomial: Polynomial, lower: VectorLike, upper: VectorLike) -> PiecewiseSurface:
    """The zeros of a polynomial in a box, which meet nothing; see `pas.Polynomial.surface`."""
    return PiecewiseSurface.from_polynomials(SingleCell(lower, upper), (), 0, [polynomial])
