"""Blends of quadrics: two cut by planes, and n surfaces joined by a sphere in the middle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations
from typing import Any

import numpy as np

from pas.algebra.brief import brief
from pas.algebra.inputs import check_tolerance, short, shown
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, VectorLike, plain, rational, to_float, to_floats, vector
from pas.errors import GeometryError, MeshError
from pas.generatrix.blend import GeneratrixBlend, generatrix_blend
from pas.generatrix.boundary import Boundary
from pas.generatrix.checks import refuse_both
from pas.generatrix.quadric import text
from pas.generatrix.sections import plane_section
from pas.generatrix.shape import GeneratrixShape
from pas.generatrix.sphere_mesh import grid_deviation, sphere_deviation, sphere_mesh
from pas.limits import Report, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.shape import Shape
from pas.verdicts import Findings

SAMPLES = 256

GRID = 96, 48
"""Points of each blend's mesh in s and t where neither tolerance nor size is given."""

SIZES = tuple((round(24 * 2 ** (k / 2)), round(12 * 2 ** (k / 2))) for k in range(13))
"""Grids that are tried for a tolerance, each with twice the points of the last; the finest has 3 million triangles
on three blends."""

SHARES = {
    Quality.BALANCED: (1.0,),
    Quality.COUNT: (1.0, 0.7, 0.5, 0.35, 1.4),
    Quality.ANGLES: (1.0, 0.7, 0.5, 0.35, 1.4),
}
"""Of these grids' points in t, of which the best is taken."""

ROOM = 0.8
"""Share of half the angle between neighbouring directions that a circle on the middle sphere takes at most."""

WIDEST = math.pi / 3
"""Half-angle of the circles at most, so that a good part of the sphere's cap is bent towards the boundary."""


@limited("finding a blend by a generatrix", "lengths l1 and l2")
def blend_quadrics(
    quadric1: PolynomialLike,
    plane1: PolynomialLike,
    quadric2: PolynomialLike,
    plane2: PolynomialLike,
    shape: GeneratrixShape | None = None,
    sides: tuple[int | None, int | None] = (None, None),
    *,
    seconds: float | None = None,
    progress: Report | None = None,
) -> GeneratrixBlend:
    """The blend of two quadrics in any position, each ending at a plane that cuts it in an ellipse.

    `shape` holds the four shape values (by default they are chosen), `sides` where each blend lies (see `Boundary`)
    if that is not clear.  Raises `GeometryError` for sections that are no closed curves, and as `generatrix_blend`.
    """
    boundaries = []
    for quadric, plane, side, name in zip((quadric1, quadric2), (plane1, plane2), sides, ("1", "2"), strict=True):
        try:
            boundaries.append(plane_section(quadric, plane, side=side))
        except (GeometryError, ValueError, TypeError) as error:
            raise type(error)(f"quadric{name} and plane{name}: {error}") from None
    return generatrix_blend(boundaries[0], boundaries[1], shape)


@dataclass(frozen=True, eq=False, repr=False)
class SphereBlend(Shape):
    """Blends from n boundaries to as many circles on a sphere; between the circles the sphere itself is the blend.

    `angles` are the circles' half-angles seen from the centre.
    """

    center: tuple[float, float, float]
    radius: float
    circles: tuple[Boundary, ...]
    angles: tuple[float, ...]
    blends: tuple[GeneratrixBlend, ...]
    kind = "sphere blend"

    @cached_property
    def certificate(self) -> Findings:
        """The verdicts on all blends."""
        return Findings.of_parts({f"blend {i}": blend.certificate for i, blend in enumerate(self.blends)})

    __repr__ = brief

    @limited("meshing a blend", "a coarser tolerance or a smaller size")
    def mesh(
        self,
        tolerance: float | None = None,
        *,
        size: tuple[int, int] | None = None,
        quality: Quality | str = Quality.BALANCED,
        seconds: float | None = None,
        progress: Report | None = None,
    ) -> Mesh:
        """Triangles of all blends and of the sphere between the circles, all welded, within `tolerance` as measured.

        Each blend is on a grid of `size` points in s and t, by default 96 x 48; with a tolerance on the coarsest of
        a sequence of grids that meets it.  The faces are `blend 1`, ... and `sphere`; normals point out of the
        sphere.  Of grids with more or fewer points in t the `quality` "angles" takes that with the largest smallest
        angle, "count" that with fewest triangles, within the tolerance, or as near as by default.  Raises `ValueError`
        for a size with one of the others, `MeshError` for a tolerance that needs too many triangles.
        """
        how = Quality.of(quality)
        if tolerance is None and how is Quality.BALANCED:
            return self._gridded(size or GRID)
        refuse_both(tolerance, size)
        wanted = self._measured(GRID).deviation if tolerance is None else check_tolerance(tolerance, self.radius)
        found: list[Mesh] = []
        for share in SHARES[how]:
            try:
                found.append(self._near(wanted or 0.0, share))
            except MeshError:  # there is a mesh already
                if not found:
                    raise
        return how.best(found)

    def _near(self, wanted: float, share: float) -> Mesh:
        """The mesh on the coarsest grid that is as near as wanted, with a share of the usual points in t."""
        for n, m in SIZES:
            checkpoint(f"meshing on {n} x {m} points")
            mesh = self._measured((n, max(3, round(share * m))))
            if mesh.deviation is not None and mesh.deviation <= wanted:
                return mesh
        raise MeshError(
            f"the tolerance {wanted:.3g} needs more than {len(mesh.triangles)} triangles; "
            f"{mesh.deviation:.2g} is reached"
        )

    def _measured(self, grid: tuple[int, int]) -> Mesh:
        """The mesh on a grid, and how near it is."""
        mesh = self._gridded(grid)
        on_blends = (grid_deviation(partial(_points, blend), grid, blend.closed) for blend in self.blends)
        return replace(mesh, deviation=max(*on_blends, sphere_deviation(mesh, self.center, self.radius)))

    def _gridded(self, size: tuple[int, int]) -> Mesh:
        return sphere_mesh(self.center, self.radius, [blend.mesh(size=size) for blend in self.blends], size)

    def __str__(self) -> str:
        return f"{len(self.blends)} blends through a sphere of radius {self.radius:.6g} about {text(self.center)}"

    def require(self) -> SphereBlend:
        """The same; raises `NotProvedError` where a claim of one blend's certificate is refuted or measured to fail."""
        for blend in self.blends:
            blend.require()
        return self


def _points(blend: GeneratrixBlend, size: tuple[int, int]) -> Floats:
    return blend.sheet(size)[0]


@limited("finding a blend by a generatrix", "lengths l1 and l2")
def blend_through_sphere(
    boundaries: Sequence[Boundary],
    center: VectorLike,
    radius: Exact,
    angles: Sequence[float] | None = None,
    shape: GeneratrixShape | None = None,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
) -> SphereBlend:
    """Blend n >= 2 surfaces, each from its closed boundary to a circle on the sphere in the middle.

    `center` and `radius` are those of the sphere, in the model's units.

    The circles stand towards the boundaries' middles.  Their half-angles (radians) are `angles`, or chosen: as wide
    as the boundary, at most 0.8 of half the angle to the next and 60 degrees.

    Raises `ValueError` for fewer than two boundaries or a radius not positive, `GeometryError` for open
    boundaries, ones that reach into the sphere, and circles that cannot be disjoint.
    """
    items, middle, size = tuple(boundaries), vector(center, "center"), rational(radius, "radius")
    if len(items) < 2:
        raise ValueError(f"a blend through a sphere needs at least two boundaries, not {len(items)}")
    if size <= 0:
        raise ValueError(f"radius must be positive, not {short(plain(size))}")
    o, r = np.array(to_floats(middle)), to_float(size)
    directions, widths = zip(*(_seen(item, i, o, r) for i, item in enumerate(items)), strict=True)
    gaps = _gaps(np.array(directions))
    if angles is None:
        chosen = tuple(
            float(min(ROOM * gap / 2, width, WIDEST)) for gap, width in zip(gaps.min(axis=1), widths, strict=True)
        )
    else:
        chosen = tuple(map(float, angles))
        _require_disjoint(chosen, gaps, len(items))
    f = _sphere(middle, size)
    circles = tuple(
        plane_section(f, _plane(u, o, r * math.cos(a)), name=f"circle {i} on the sphere")
        for i, (u, a) in enumerate(zip(directions, chosen, strict=True))
    )
    blends = tuple(generatrix_blend(item, circle, shape) for item, circle in zip(items, circles, strict=True))
    return SphereBlend((float(o[0]), float(o[1]), float(o[2])), r, circles, chosen, blends)


def _seen(boundary: Any, number: int, center: Floats, radius: float) -> tuple[Floats, float]:
    """The direction of a boundary from the centre, and the half-angle of a circle as wide as it."""
    if not isinstance(boundary, Boundary):
        raise TypeError(f"boundaries[{number}] must be a Boundary, not {shown(boundary)}")
    if not boundary.closed:
        raise GeometryError(f"boundaries[{number}] ({boundary.name}) is open; circles on a sphere are closed")
    points = boundary(np.linspace(0, 1, SAMPLES, endpoint=False))
    away = np.linalg.norm(points - center, axis=1)
    if away.min() <= radius:
        where = text(points[int(away.argmin())])
        raise GeometryError(
            f"boundaries[{number}] ({boundary.name}) reaches into the sphere at {where}; make it smaller"
        )
    way = points.mean(axis=0) - center
    if np.linalg.norm(way) <= 1e-9 * away.max():
        raise GeometryError(
            f"boundaries[{number}] ({boundary.name}) goes round the centre {text(center)}; move the sphere"
        )
    direction = unit(way)
    along = (points - center) @ direction
    width = float(np.sqrt(np.maximum(away**2 - along**2, 0.0)).mean())
    return direction, math.asin(min(1.0, width / radius))


def _gaps(directions: Floats) -> Floats:
    """The angles between all pairs of directions, pi on the diagonal; raises `GeometryError` for equal ones."""
    cosines = np.clip(directions @ directions.T, -1.0, 1.0)
    sines = np.linalg.norm(np.cross(directions[:, None], directions[None]), axis=-1)
    gaps = np.asarray(np.arctan2(sines, cosines))
    np.fill_diagonal(gaps, math.pi)
    for i, j in combinations(range(len(gaps)), 2):
        if gaps[i, j] < 1e-3:
            raise GeometryError(
                f"boundaries[{i}] and boundaries[{j}] lie in the same direction from the sphere's centre, so their "
                "circles cannot be disjoint; move the sphere"
            )
    return gaps


def _require_disjoint(angles: Sequence[float], gaps: Floats, number: int) -> None:
    if len(angles) != number:
        raise ValueError(f"there are {number} boundaries but {len(angles)} angles; give one for each")
    for i, angle in enumerate(angles):
        if not 0 < angle < math.pi:
            raise ValueError(f"angles[{i}] must be between 0 and pi radians, not {angle:.6g}")
    for i, j in combinations(range(number), 2):
        if angles[i] + angles[j] >= gaps[i, j]:
            raise GeometryError(
                f"the circles {i} and {j} overlap: their half-angles {angles[i]:.4g} + {angles[j]:.4g} must be less "
                f"than {gaps[i, j]:.4g}, the angle between their directions"
            )


def _sphere(center: Any, radius: Any) -> Polynomial:
    parts = (Polynomial(v) - Polynomial(c) for v, c in zip("xyz", center, strict=True))
    return sum((p * p for p in parts), Polynomial(-radius * radius))


def _plane(direction: Floats, center: Floats, distance: float) -> Polynomial:
    offset = float(direction @ center) + distance
    x, y, z = map(float, direction)
    return Polynomial({(1, 0, 0): x, (0, 1, 0): y, (0, 0, 1): z, (0, 0, 0): -offset})
