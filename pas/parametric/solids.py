"""Solids that parametric surfaces bound: closed ones, and such as end in plane curves, which flat faces close.

The inside is where the signed distance is not positive.  The foot of a point near the surface is found by Newton's
method in the parameters, from the nearest of samples; it is accurate to rounding where the surface bends less sharply
than samples are apart.  At a flat end the surface is continued along its normals, and the end's plane cuts it.

Not guaranteed: that features between samples are seen, nor that a surface does not pass through itself, which is looked
for at some hundred places.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.inputs import shown_point
from pas.algebra.lengths import lengths, unit
from pas.arrays import Bools, Floats, Integers
from pas.certify.graph_proofs import crossed
from pas.errors import GeometryError
from pas.mesh.mesh import Mesh
from pas.mesh.topology import Edges
from pas.parametric.maps import ParametricMap
from pas.parametric.tiling import closes
from pas.solid.functions import Distance, Parametrized
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined

AROUND, FLAT = 128, 1e-7
"""Points of an edge; and how far it may be off its plane, over the surface's size."""

NEAR = 2.0
"""Distance, over that of samples, up to which feet are found; the distance of others is that of the nearest sample."""

STILL = 1e-8
"""Step of Newton's method, over the surface's size, after which a foot is right to rounding."""


@dataclass(frozen=True)
class FlatEdge:
    """The closed plane curve (M, 3) in which a surface ends where parameter number `axis` has an end of its domain.

    The body is below its plane, through the `middle`, across the unit vector `outwards`.
    """

    axis: int
    side: int
    loop: Floats
    middle: Floats
    outwards: Floats

    def heights(self, points: Floats) -> Floats:
        """How far points (N, 3) are above the plane."""
        return np.asarray((points - self.middle) @ self.outwards)

    def covers(self, points: Floats) -> Bools:
        """Which points (N, 3) have their feet on the plane within the curve: a ray there crosses it an odd time."""
        frame = np.linalg.svd(self.outwards[None])[2][1:]
        places, corners = (points - self.middle) @ frame.T, (self.loop - self.middle) @ frame.T
        result = (np.abs(places) <= np.abs(corners).max(axis=0)).all(axis=1)
        x, y = places[result].T
        odd = np.zeros(len(x), dtype=bool)
        for (a, b), (c, d) in zip(np.roll(corners, 1, axis=0).tolist(), corners.tolist(), strict=True):
            if b != d:
                odd ^= ((b > y) != (d > y)) & (x < a + (y - b) * (c - a) / (d - b))
        result[result] = odd
        return np.asarray(result)


@dataclass(frozen=True)
class Feet:
    """Of some points the nearest ones (N, 3) of the surface, the outward normals (N, 3) there, which of them (N,) were
    found, the others being the nearest samples, and their parameters (N, 2)."""

    points: Floats
    normals: Floats
    found: Bools
    parameters: Floats


class SurfaceDistance(Distance, Parametrized):
    """The signed distance from a surface with a finite domain that is closed, or ends in planes; negative inside.

    Raises `GeometryError` where it has other edges, or is seen to pass through itself.
    """

    def __init__(self, surface: ParametricMap, mesh: Mesh) -> None:
        self.surface, self._size = surface, float(np.ptp(mesh.points, axis=0).max())
        self._low, self._width = np.array([[low, high - low] for low, high in surface.domain]).T
        self._closes = np.array([closes(surface, axis, self._size) for axis in (0, 1)])
        self.domain, self.periods = np.array(surface.domain), np.where(self._closes, self._width, 0.0)
        self.edges, self._side = closed(surface, mesh)
        grid = self._grid(mesh)
        points, normals = surface(grid), surface.normals(grid)
        diagonals = points[1:, 1:] - points[:-1, :-1], points[1:, :-1] - points[:-1, 1:]
        self.gap = float(max(lengths(d).max() for d in diagonals))
        kept = np.isfinite(normals).all(axis=2)
        self._samples, self._normals, self._places = points[kept], self._side * normals[kept], grid[kept]
        self._tree = cKDTree(self._samples)

    def _grid(self, mesh: Mesh) -> Floats:
        """Parameters (n, m, 2) as dense as the finest of a mesh, and no cells much longer than wide."""
        assert mesh.parameters is not None
        steps = [np.diff(np.unique(mesh.parameters[:, axis])) for axis in (0, 1)]
        counts = np.array([w / s[s > 1e-9 * w].min() for w, s in zip(self._width, steps, strict=True)])
        few = [np.linspace(low, low + width, 33) for low, width in zip(self._low, self._width, strict=True)]
        points = self.surface.on_grid(*few)
        long = np.array([lengths(np.diff(points, axis=axis)).sum(axis=axis).max() for axis in (0, 1)])
        counts = np.maximum(counts, long / (2 * (long / counts).min()))
        counts = np.clip(counts, 16, 1024) * min(1.0, 512 / float(np.sqrt(counts.prod())))
        ends = [np.linspace(lo, lo + w, int(n) + 1) for lo, w, n in zip(self._low, self._width, counts, strict=True)]
        return np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1)

    def places(self, points: Floats) -> Floats:
        return self.feet(points).parameters

    def at(self, places: Floats) -> Floats:
        return self.surface(self._within(places))

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4); far from the surface those of the nearest sample."""
        return self._jets(points, self.feet(points))

    def _jets(self, points: Floats, feet: Feet) -> Floats:
        away = points - feet.points
        above = (away * feet.normals).sum(axis=1)
        distance = lengths(away)
        value = np.where(above < 0, -distance, distance)
        direction = away / np.where(np.abs(value) < 1e-12 * self._size, np.inf, value)[:, None]
        gradient = np.where((np.abs(value) < 1e-9 * self._size)[:, None], feet.normals, direction)
        for edge in self.edges:
            on = is_end(self.surface, edge.axis, edge.side, feet.parameters)
            near = on & (distance < NEAR * self.gap)
            value[near], gradient[near] = above[near], feet.normals[near]
            beyond = np.flatnonzero(on & ~near & (edge.heights(points) > 0))
            value[beyond] = np.where(edge.covers(points[beyond]), -1.0, 1.0) * distance[beyond]
        return np.concatenate([value[:, None], gradient], axis=1)

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        feet = self.feet(centers)
        value, least = self._jets(centers, feet)[:, 0], self.least(centers, feet)
        return (value <= 0) & (radii <= least), (value > 0) & (radii < least)

    def away(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the nearest samples (N,)."""
        return np.asarray(self._tree.query(points)[0])

    def least(self, points: Floats, feet: Feet) -> Floats:
        """The least distances (N,) of the surface from points with such feet."""
        found = lengths(points - feet.points)
        return np.where(feet.found, found, np.maximum(found - self.gap, 0.0))

    def feet(self, points: Floats) -> Feet:
        """The feet of points (N, 3): of those that are not near the nearest samples."""
        distance, rows = self._tree.query(points)
        near = np.flatnonzero(distance < NEAR * self.gap)
        feet = Feet(self._samples[rows], self._normals[rows], distance < NEAR * self.gap, self._places[rows])
        for part in np.array_split(near, 1 + len(near) // (1 << 14)):
            self._improve(feet, points, part)
        return feet

    def _improve(self, feet: Feet, points: Floats, rows: Integers) -> None:
        """Newton's method for the feet of some points, with no step that is longer than samples are apart."""
        place, p, active = feet.parameters[rows], points[rows], np.arange(len(rows))
        for _ in range(24):
            here, first, second = self._expanded(place[active])
            away = here - p[active]
            slope = np.einsum("nij,nj->ni", first, away)
            square = np.einsum("nij,nkj->nik", first, first)
            bent = square + np.einsum("nikj,nj->nik", second, away)
            good = (bent[:, 0, 0] > 0) & (np.linalg.det(bent) > 0.1 * np.linalg.det(square))
            matrix = np.where(good[:, None, None], bent, square)
            held = self._held(place[active], slope)
            slope = np.where(held, 0.0, slope)
            matrix = np.where(held[:, :, None] | held[:, None, :], np.eye(2) * square, matrix)
            step = -_solved(matrix, slope)
            length = lengths(np.einsum("ni,nij->nj", step, first))
            step *= np.minimum(1.0, self.gap / np.maximum(length, 1e-300))[:, None]
            place[active] = self._within(place[active] + step)
            active = active[length > STILL * self._size]
            if not len(active):
                break
        here, first, _ = self._expanded(place)
        better = np.flatnonzero(lengths(here - p) <= lengths(feet.points[rows] - p))
        chosen = rows[better]
        feet.points[chosen], feet.parameters[chosen] = here[better], place[better]
        normals = self._side * np.cross(first[better, 0], first[better, 1])
        flat = lengths(normals) <= 1e-9 * lengths(first[better]).max(axis=1) ** 2
        feet.normals[chosen[~flat]] = unit(normals[~flat])

    def _held(self, place: Floats, slope: Floats) -> Bools:
        """Which parameters (N, 2) stay at an end of the domain, beyond which the distance falls."""
        low, high = place <= self._low, place >= self._low + self._width
        return np.asarray(~self._closes & ((low & (slope > 0)) | (high & (slope < 0))))

    def _within(self, place: Floats) -> Floats:
        """Parameters in the domain: at its ends, or as many turns back."""
        share = (place - self._low) / self._width
        return np.asarray(self._low + self._width * np.where(self._closes, share % 1.0, np.clip(share, 0.0, 1.0)))

    def _expanded(self, place: Floats) -> tuple[Floats, Floats, Floats]:
        """Points (N, 3), first derivatives (N, 2, 3) and second ones (N, 2, 2, 3)."""
        rows = self.surface.partials(place, (0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        return rows[:, 0], rows[:, 1:3], rows[:, [[3, 4], [4, 5]]]


class FlatEnd(Distance):
    """How far points are above the plane in which a surface ends, where the body ends there; else negative."""

    def __init__(self, distance: SurfaceDistance, number: int) -> None:
        self.distance, self.number, self.edge = distance, number, distance.edges[number]
        self.plane = self.edge.middle, self.edge.outwards

    def jets(self, points: Floats) -> Floats:
        edge, gap = self.edge, self.distance.gap
        heights = edge.heights(points)
        near = np.isfinite(cKDTree(edge.loop).query(points, distance_upper_bound=NEAR * gap)[0])  # of AROUND points
        far = np.flatnonzero(~near)
        near[far] = edge.covers(points[far])
        high = far[near[far] & (heights[far] > 0)]  # of which some are in other parts of the body
        near[high] = heights[high] <= self.distance.away(points[high]) + gap
        result = np.concatenate([heights[:, None], np.broadcast_to(edge.outwards, points.shape)], axis=1)
        result[~near, 0] = np.minimum(heights[~near], -gap)
        return result

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in balls; the latter only of such as the surface misses."""
        below, above = super().decided_within(centers, radii)
        above[above] = radii[above] < self.distance.away(centers[above]) - self.distance.gap
        return below, above


def solid_of(surface: ParametricMap, mesh: Mesh, face: str) -> Solid:
    """The body that a surface bounds, of which a mesh is given; see `ParametricSurface.solid`."""
    distance = SurfaceDistance(surface, mesh)
    ends = [
        Atom(FlatEnd(distance, number), f"{face} {('start', 'end')[edge.side]}")
        for number, edge in enumerate(distance.edges)
    ]
    return Solid(combined(False, Atom(distance, face), *ends))


def _solved(matrix: Floats, right: Floats) -> Floats:
    """The solutions (N, 2) of symmetric systems; of singular ones, as at poles, not far from the least."""
    scale = np.maximum(np.einsum("nii->ni", matrix), 1e-300) ** -0.5
    even = matrix * scale[:, :, None] * scale[:, None, :] + 1e-14 * np.eye(2)
    return np.asarray(scale * np.linalg.solve(even, (right * scale)[:, :, None])[:, :, 0])


def is_end(surface: ParametricMap, axis: int, side: int, parameters: Floats) -> Bools:
    """Which parameters (N, 2) are at an end of the domain: the lower one of parameter number `axis`, or the upper."""
    low, high = surface.domain[axis]
    share = (parameters[:, axis] - low) / (high - low)
    return np.asarray(share <= 1e-12 if side == 0 else share >= 1 - 1e-12)


def closed(surface: ParametricMap, mesh: Mesh) -> tuple[tuple[FlatEdge, ...], float]:
    """The edges in which a surface of a given mesh ends, and the side, 1 or -1, on which its normals point outwards.

    Raises `GeometryError` where it bounds no body, or is seen to pass through itself.
    """
    assert mesh.parameters is not None
    size = float(np.ptp(mesh.points, axis=0).max())
    around, used = Edges(mesh.triangles, len(mesh.points)).rim, np.zeros(len(mesh.points), dtype=bool)
    wraps = [closes(surface, axis, size) for axis in (0, 1)]
    edges, fans = list[FlatEdge](), list[Integers]()
    for axis, side in product((0, 1), (0, 1)):
        rows = around[is_end(surface, axis, side, mesh.parameters[around.ravel()]).reshape(-1, 2).all(axis=1)]
        if len(rows) and wraps[1 - axis] and not wraps[axis]:
            used[rows] = True
            fans.append(np.column_stack([rows[:, ::-1], np.full(len(rows), len(mesh.points) + len(edges))]))
            edges.append(_edge(surface, axis, side, size))
    open_ = around[~used[around].all(axis=1)]
    if len(open_):
        raise GeometryError(
            f"the surface bounds no body: it has an edge near {shown_point(mesh.points[open_[0, 0]])} that is no "
            "closed curve at one end of its domain, and only such are closed by flat faces"
        )
    points = np.concatenate([mesh.points, *(edge.middle[None] for edge in edges)])
    triangles = np.concatenate([mesh.triangles, *fans])
    side_of = -1.0 if float(np.linalg.det(points[triangles] - points.mean(axis=0)).sum()) < 0 else 1.0
    turned = []
    for edge, fan in zip(edges, fans, strict=True):
        a, b, c = points[fan].transpose(1, 0, 2)
        up = side_of * float(np.cross(b - a, c - a).sum(axis=0) @ edge.outwards)  # its plane is seen from outside
        turned.append(replace(edge, outwards=edge.outwards * np.sign(up)))
        _check_below(turned[-1], mesh, fan, size)
    _check_simple(points, triangles, mesh, side_of, np.unique(around))
    return tuple(turned), side_of


def _edge(surface: ParametricMap, axis: int, side: int, size: float) -> FlatEdge:
    """The edge at an end of the domain; raises `GeometryError` where it is in no plane."""
    low, high = surface.domain[1 - axis]
    place = np.empty((AROUND, 2))
    place[:, axis], place[:, 1 - axis] = surface.domain[axis][side], low + (high - low) * np.arange(AROUND) / AROUND
    loop = surface(place)
    middle = loop.mean(axis=0)
    outwards = np.linalg.svd(loop - middle, full_matrices=False)[2][2]
    off = float(np.abs((loop - middle) @ outwards).max())
    if off > FLAT * size:
        end = f"{surface.parameters[axis]} = {surface.domain[axis][side]:.6g}"
        raise GeometryError(
            f"the surface bounds no body: its edge at {end} is in no plane (it is off by {off:.3g}), and only plane "
            "ends are closed by flat faces"
        )
    return FlatEdge(axis, side, loop, middle, outwards)


def _check_below(edge: FlatEdge, mesh: Mesh, fan: Integers, size: float) -> None:
    """Raise `GeometryError` where the surface is above the plane of its end beside it."""
    beside = mesh.triangles[np.isin(mesh.triangles, fan).sum(axis=1) > 1]
    heights = edge.heights(mesh.points[beside.ravel()]).reshape(-1, 3).max(axis=1)
    if heights.max(initial=0.0) > FLAT * size:
        place = mesh.points[beside[int(heights.argmax()), 0]]
        raise GeometryError(
            f"the surface bounds no body: near {shown_point(place)} it goes on beyond the plane in which it ends, "
            "where no flat face closes it"
        )


def _check_simple(points: Floats, triangles: Integers, mesh: Mesh, side: float, edged: Integers) -> None:
    """Raise `GeometryError` where a closed mesh is not once around what is just inside of it, or is around what is out,
    at some vertices that are not among the `edged` ones."""
    rows, places = np.setdiff1d(np.unique(mesh.triangles), edged), 300
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, places).astype(int))]
    step = 4 * (mesh.deviation or 0.0)
    origin = points.max(axis=0) + np.ptp(points, axis=0) * [0.317, 0.419, 0.523]
    for sign, times in ((1, 0), (-1, -round(side))):
        ends = mesh.points[rows] + sign * side * step * mesh.point_normals[rows]
        found, known = crossed(points, triangles, origin, ends)
        wrong = rows[known & (found != times)]
        if len(wrong):
            raise GeometryError(
                f"the surface bounds no body: near {shown_point(mesh.points[wrong[0]])} it passes through itself, or "
                f"is thinner than {2 * step:.3g}"
            )
