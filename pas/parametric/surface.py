"""Parametric surfaces: maps of two parameters that can be proved, meshed, drawn and saved."""

from __future__ import annotations

from functools import cached_property

from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.domain import DomainLike
from pas.parametric.maps import ParametricMap
from pas.parametric.meshing import mesh_surface
from pas.parametric.regularity import regularity
from pas.shape import Shape
from pas.verdicts import Findings


class ParametricSurface(ParametricMap, Shape):
    __doc__ = (ParametricMap.__doc__ or "").replace("A map (x, y, z)", "A surface (x, y, z)")
    kind = "parametric surface"

    @cached_property
    def certificate(self) -> Findings:
        """The verdict of `pas.regularity` on the whole domain, worked out when first asked for."""
        return Findings((regularity(self),))

    @limited("meshing a surface", "a coarser tolerance or a smaller domain")
    def mesh(
        self,
        tolerance: float | None = None,
        domain: DomainLike = None,
        *,
        quality: Quality | str = Quality.BALANCED,
        seconds: float | None = None,
        progress: Report | None = None,
    ) -> Mesh:
        """A triangle mesh, with normals, nowhere further than `tolerance` from the surface.

        The tolerance is by default a thousandth of the surface's extent.  `domain` is that of the mesh, None for a
        parameter or an end that the surface's own bounds.  The bound is proved for exact surfaces, measured for
        others; the mesh says which.  Of some meshes the `quality` "angles" takes that with the largest smallest angle,
        "count" that with fewest triangles; for "angles" long cells are halved as well.  Raises `ValueError` for an
        infinite domain, `GeometryError` near poles, `MeshError` for a tolerance that needs too many triangles.
        """
        return mesh_surface(self, tolerance, domain, quality)
