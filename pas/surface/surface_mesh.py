"""Meshes of surfaces, which know of what they are meshes, so that they can be proved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

from pas.mesh.mesh import Mesh, SmoothMesh
from pas.surface.mesh_proofs import MeshCertificate, certify_mesh

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(SmoothMesh):
    """A mesh of a piecewise surface; its certificate is a proof that it is one, worked out when first asked for."""

    surface: PiecewiseSurface | None = None

    @classmethod
    def of_surface(cls, mesh: Mesh, surface: PiecewiseSurface) -> SurfaceMesh:
        """The same mesh with its surface."""
        result = cast(
            SurfaceMesh, cls.smooth(mesh.points, mesh.triangles, mesh.point_normals, deviation=mesh.deviation)
        )
        object.__setattr__(result, "surface", surface)
        return result

    @cached_property
    def certificate(self) -> MeshCertificate:
        """Whether it has the topology of the surface, and how far from it it is at most; see `certify_mesh`."""
        assert self.surface is not None
        return certify_mesh(self.surface, self.points, self.triangles)
