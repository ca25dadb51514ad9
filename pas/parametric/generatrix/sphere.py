"""Blends of n surfaces joined by a sphere in the middle, and their meshes.

Points on a sphere that lie on the blends' circles or outside them have a convex hull whose faces are a triangulation
of the sphere between the circles and one flat disc for each, which is left out.  The circles' points are the blends'
own, so that all is welded.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations
from typing import Any, Unpack

import numpy as np

from pas.algebra.brief import brief
from pas.algebra.inputs import shown, shown_point
from pas.algebra.lengths import lengths, spiral, unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, VectorLike, check_tolerance, dot, positive, to_float, to_floats, vector
from pas.arrays import Floats, Integers
from pas.errors import GeometryError, MeshError
from pas.limits import WorkLimits, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.rows import inside_sphere
from pas.parametric.generatrix.blend import GeneratrixBlend, generatrix_blend, refuse_both
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.sections import plane_section
from pas.parametric.generatrix.shape import GeneratrixShape
from pas.shape import Shape
from pas.verdicts import Findings

SPHERE = "sphere"
"""The name of the face on the sphere."""

GRID = 96, 48
"""Points of each blend's mesh in s and t where neither tolerance nor size is given."""


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
        tolerance: Exact | None = None,
        *,
        size: tuple[int, int] | None = None,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
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
        shares = (1.0,) if how is Quality.BALANCED else (1.0, 0.7, 0.5, 0.35, 1.4)  # of the usual points in t
        return how.best_of(partial(self._near, wanted or 0.0, share) for share in shares)

    def _near(self, wanted: float, share: float) -> Mesh:
        """The mesh on the coarsest grid that is as near as wanted, with a share of the usual points in t.

        Each grid has twice the points of the last; the finest has 3 million triangles on three blends.
        """
        for k in range(13):
            n, m = round(24 * 2 ** (k / 2)), round(12 * 2 ** (k / 2))
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
        middle = mesh.points[mesh.triangles[mesh.faces == mesh.names.index(SPHERE)]] - self.center
        away = [*(_grid_deviation(blend, grid) for blend in self.blends), inside_sphere(middle, self.radius)]
        return replace(mesh, deviation=max(away))

    def _gridded(self, size: tuple[int, int]) -> Mesh:
        """The blends on grids of a size, whose last points in t are the circles, and the sphere."""
        n, m = size
        count, origin = n * m, np.array(self.center)
        tubes, rim = [blend.mesh(size=size) for blend in self.blends], np.arange(m - 1, count, m)
        outwards = [((tube.points[rim] - origin) * tube.point_normals[rim]).sum() >= 0 for tube in tubes]
        tubes = [tube if out else tube.flipped for tube, out in zip(tubes, outwards, strict=True)]
        circles = [(tube.points[rim] - origin) / self.radius for tube in tubes]
        points = np.concatenate([tube.points for tube in tubes])
        free = _between(circles, n)
        faces = _hull(np.concatenate([*circles, free]), len(circles), n)
        rims = [rim + number * count for number in range(len(tubes))]
        numbers = np.concatenate([*rims, len(points) + np.arange(len(free))])
        triangles = [tube.triangles + number * count for number, tube in enumerate(tubes)]
        mesh = Mesh.smooth(
            np.concatenate([points, origin + self.radius * free]),
            np.concatenate([*triangles, numbers[faces]]),
            np.concatenate([*(tube.point_normals for tube in tubes), free]),
        )
        owner = np.repeat(np.arange(len(tubes) + 1), [*map(len, triangles), len(faces)])
        return replace(mesh, faces=owner, names=(*(f"blend {i + 1}" for i in range(len(tubes))), SPHERE))

    def __str__(self) -> str:
        about = shown_point(self.center, 6)
        return f"{len(self.blends)} blends through a sphere of radius {self.radius:.6g} about {about}"

    def require(self) -> SphereBlend:
        """The blend itself; raises `NotProvedError` where a claim of a certificate is refuted or measured to fail."""
        for blend in self.blends:
            blend.require()
        return self


def _grid_deviation(blend: GeneratrixBlend, size: tuple[int, int]) -> float:
    """How far a blend is from its mesh on a grid, at equal parameters half way between the grid's points."""
    n, m = size
    points, _ = blend.sheet((2 * n if blend.closed else 2 * n - 1, 2 * m - 1))
    if blend.closed:
        points = np.concatenate([points, points[:1]])
    corners = points[::2, ::2]
    middles = (
        (points[1::2, ::2], corners[:-1], corners[1:]),
        (points[::2, 1::2], corners[:, :-1], corners[:, 1:]),
        (points[1::2, 1::2], corners[:-1, :-1], corners[1:, 1:]),  # of the diagonals that `connectivity` draws
    )
    return max(float(np.linalg.norm(p - (a + b) / 2, axis=-1).max()) for p, a, b in middles)


def _between(circles: Sequence[Floats], n: int) -> Floats:
    """Points spread evenly over the unit sphere those in the circles left out."""
    spacing = min(float(np.linalg.norm(circle[1] - circle[0])) for circle in circles)
    number = int(np.clip(4 * np.pi / spacing**2, 4 * n, 60 * n))
    points = spiral(number)
    margin = 0.6 * np.sqrt(4 * np.pi / number)  # of the mean spacing
    outside = np.ones(number, dtype=bool)
    for circle in circles:
        axis = circle.mean(axis=0)
        height = float(np.linalg.norm(axis))
        outside &= np.arccos(np.clip(points @ (axis / height), -1, 1)) > np.arccos(min(1.0, height)) + margin
    return points[outside]


def _hull(points: Floats, circles: int, n: int) -> Integers:
    """The faces of the hull, outwards, but those with all corners on one of the circles, n points each."""
    from scipy.spatial import ConvexHull

    faces = ConvexHull(points).simplices
    owner = np.minimum(faces // n, circles)
    faces = faces[~((owner[:, 0] == owner[:, 1]) & (owner[:, 1] == owner[:, 2]) & (owner[:, 0] < circles))]
    p = points[faces]
    inward = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p.sum(axis=1)) < 0
    faces[inward] = faces[inward][:, ::-1]
    return np.asarray(faces, dtype=np.intp)


@limited("finding a blend by a generatrix", "lengths l1 and l2")
def blend_through_sphere(
    boundaries: Sequence[Boundary],
    center: VectorLike,
    radius: Exact,
    angles: Sequence[float] | None = None,
    shape: GeneratrixShape | None = None,
    **limits: Unpack[WorkLimits],
) -> SphereBlend:
    """Blend n >= 2 surfaces, each from its closed boundary to a circle on the sphere in the middle.

    `center` and `radius` are those of the sphere, in the model's units.

    The circles stand towards the boundaries' middles.  Their half-angles (radians) are `angles`, or chosen: as wide
    as the boundary, at most 0.8 of half the angle to the next and 60 degrees.

    Raises `ValueError` for fewer than two boundaries or a radius not positive, `GeometryError` for open
    boundaries, ones that reach into the sphere, and circles that cannot be disjoint.
    """
    items, middle = tuple(boundaries), vector(center, "center")
    if len(items) < 2:
        raise ValueError(f"a blend through a sphere needs at least two boundaries, not {len(items)}")
    size = positive(radius, "radius")
    o, r = np.array(to_floats(middle)), to_float(size)
    directions, widths = zip(*(_seen(item, i, o, r) for i, item in enumerate(items)), strict=True)
    gaps = _gaps(np.array(directions))
    if angles is None:
        pairs = zip(gaps.min(axis=1), widths, strict=True)
        chosen = tuple(float(min(0.8 * gap / 2, width, math.pi / 3)) for gap, width in pairs)
    else:
        chosen = tuple(map(float, angles))
        _require_disjoint(chosen, gaps, len(items))
    coordinates = [Polynomial(v) - Polynomial(c) for v, c in zip("xyz", middle, strict=True)]
    f = sum((p * p for p in coordinates), Polynomial(-size * size))
    planes = (
        dot(coordinates, list(map(Polynomial, u.tolist()))) - r * math.cos(a)
        for u, a in zip(directions, chosen, strict=True)
    )
    circles = tuple(plane_section(f, p, name=f"circle {i} on the sphere") for i, p in enumerate(planes))
    blends = tuple(generatrix_blend(item, circle, shape) for item, circle in zip(items, circles, strict=True))
    return SphereBlend((float(o[0]), float(o[1]), float(o[2])), r, circles, chosen, blends)


def _seen(boundary: Any, number: int, center: Floats, radius: float) -> tuple[Floats, float]:
    """The direction of a boundary from the centre, and the half-angle of a circle as wide as it."""
    if not isinstance(boundary, Boundary):
        raise TypeError(f"boundaries[{number}] must be a Boundary, not {shown(boundary)}")
    if not boundary.closed:
        raise GeometryError(f"boundaries[{number}] ({boundary.name}) is open; circles on a sphere are closed")
    points = boundary(np.linspace(0, 1, 256, endpoint=False))
    away = lengths(points - center)
    if away.min() <= radius:
        where = shown_point(points[int(away.argmin())], 6)
        raise GeometryError(
            f"boundaries[{number}] ({boundary.name}) reaches into the sphere at {where}; make it smaller"
        )
    way = points.mean(axis=0) - center
    if np.linalg.norm(way) <= 1e-9 * away.max():
        raise GeometryError(
            f"boundaries[{number}] ({boundary.name}) goes round the centre {shown_point(center, 6)}; move the sphere"
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
