"""Meshes of surfaces, which know of what they are meshes, so that they can be proved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

from pas.algebra.inputs import check_tolerance
from pas.mesh.mesh import Mesh, SmoothMesh
from pas.surface.following import on_surface
from pas.surface.mesh_proofs import MeshCertificate, certify_mesh

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(SmoothMesh):
    """A mesh of a piecewise surface; its certificate is a proof that it is one, worked out when first asked for.

    `tolerance` is the one it was made for, in the model's units.
    """

    surface: PiecewiseSurface | None = None
    tolerance: float | None = None

    @classmethod
    def of_surface(cls, mesh: Mesh, surface: PiecewiseSurface, tolerance: float) -> SurfaceMesh:
        """The same mesh with its surface."""
        result = cast(
            SurfaceMesh, cls.smooth(mesh.points, mesh.triangles, mesh.point_normals, deviation=mesh.deviation)
        )
        object.__setattr__(result, "surface", surface)
        object.__setattr__(result, "tolerance", tolerance)
        return result

    def follow(self, surface: PiecewiseSurface, tolerance: float | None = None) -> SurfaceMesh:
        """A mesh of a surface that is this one's, moved a little, with about the same triangles, for sliders.

        The vertices are put onto it, and triangles that are then too far from it are halved; where that would fold
        some, the mesh is made anew.  Within `tolerance`, by default that of this mesh, as measured; its topology is
        that of this mesh unless it is made anew, and its certificate says whether that is the surface's.
        """
        wanted = check_tolerance(self.tolerance if tolerance is None else tolerance)
        try:
            mesh = on_surface(surface, self.points, self.triangles, wanted)
        except ArithmeticError:
            return surface.mesh(wanted)
        return self.of_surface(mesh, surface, wanted)

    @cached_property
    def certificate(self) -> MeshCertificate:
        """Whether it has the topology of the surface, and how far from it it is at most; see `certify_mesh`."""
        assert self.surface is not None
        return certify_mesh(self.surface, self.points, self.triangles)
