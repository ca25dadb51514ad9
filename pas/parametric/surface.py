"""Parametric surfaces: maps of two parameters that can be proved, meshed within a tolerance, drawn and saved.

Meshes are made in the surface's own frame, so that neither its units nor those of the parameters matter.  Sides that
close up share their vertices, sides and lines that shrink to a point have one vertex, no triangle has two equal
vertices, and triangles are oriented along dP/dt x dP/dh.
"""

from __future__ import annotations

from functools import cached_property
from typing import Unpack

from pas.algebra.affine import Affine, AffineShape
from pas.algebra.inputs import check_tolerance
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.domain import DomainLike
from pas.parametric.maps import ParametricMap
from pas.parametric.meshing import Mesher
from pas.parametric.nets import Framed, exact_rectangle
from pas.parametric.regularity import regularity
from pas.parametric.solids import solid_of
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape
from pas.solid.solid import Solid
from pas.verdicts import Findings

ParametricMesh = Mesh
"""What the meshes of parametric surfaces were called."""

PARTS = tuple((n, m) for m in (1, 3) for n in (1, 3))
"""Into how many parts each way the rectangle is cut first, before parts are halved; usually there is one."""

WAYS = {
    Quality.BALANCED: ((PARTS[0], False),),
    Quality.COUNT: tuple((parts, False) for parts in PARTS),
    Quality.ANGLES: ((PARTS[0], False), *((parts, True) for parts in PARTS)),
}
"""Such parts, and whether long cells are halved as well: the best of these meshes is kept."""


class ParametricSurface(ParametricMap, AffineShape["ParametricSurface"], Shape):
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
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """A triangle mesh, with normals, nowhere further than `tolerance` from the surface.

        The tolerance is by default a thousandth of the surface's extent.  `domain` is that of the mesh, None for a
        parameter or an end that the surface's own bounds.  The bound is proved for exact surfaces, measured for
        others; the mesh says which.  Of some meshes the `quality` "angles" takes that with the largest smallest angle,
        "count" that with fewest triangles; for "angles" long cells are halved as well.  Raises `ValueError` for an
        infinite domain, `GeometryError` near poles, `MeshError` for a tolerance that needs too many triangles.
        """
        how = Quality.of(quality)
        rectangle = exact_rectangle(self, domain)
        framed = Framed.of(self.with_domain(rectangle))
        wanted = RELATIVE_TOLERANCE * framed.size
        if tolerance is not None:
            wanted = framed.inside(check_tolerance(tolerance, framed.outside(framed.size)))
        makers = (Mesher(framed, rectangle, wanted, *way).mesh for way in WAYS[how])
        return self._kept((wanted, rectangle, how), lambda: how.best_of(makers))

    def _moved(self, map_: Affine) -> ParametricSurface:
        return self.moved(map_.matrix, map_.shift)

    @limited("making a solid of a surface", "a smaller domain")
    def solid(self, face: str = "surface", **limits: Unpack[WorkLimits]) -> Solid:
        """The body that the surface bounds, as a `pas.solid.Solid` with a face of that name.

        The surface is closed, as a ball's or a ring's are, or has ends in planes, as a vase or a tube has, which are
        closed by flat faces, "surface start" and "surface end".  Raises `ValueError` for an infinite domain,
        `GeometryError` where it has other edges, an end that is not plane, or passes through itself.

            pas.surface_of_revolution("1 + h^2/4", "h", angle=True, interval=(-1, 2)).solid("vase")
        """
        return solid_of(self, self.mesh(), face)
