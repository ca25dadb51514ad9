"""How parametric surfaces bound bodies: they are closed, or end in plane curves, which flat faces close.

Not guaranteed: that a surface does not pass through itself, which is looked for at some hundred places.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from pas.algebra.inputs import shown_point
from pas.algebra.monomials import Floats
from pas.certify.graph_proofs import crossed
from pas.errors import GeometryError
from pas.mesh.mesh import Mesh
from pas.mesh.rows import Integers
from pas.parametric.maps import ParametricMap
from pas.parametric.tiling import closes
from pas.solid.tree import Bools

AROUND, FLAT = 128, 1e-7
"""Points of an edge; and how far it may be off its plane, over the surface's size."""


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
    around, used = _boundary_edges(mesh.triangles), np.zeros(len(mesh.points), dtype=bool)
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
    turned = [_outwards(edge, points[fan], side_of) for edge, fan in zip(edges, fans, strict=True)]
    for edge, fan in zip(turned, fans, strict=True):
        _check_below(edge, mesh, fan, size)
    _check_simple(points, triangles, mesh, side_of, np.unique(around))
    return tuple(turned), side_of


def _boundary_edges(triangles: Integers) -> Integers:
    """The edges (E, 2) of triangles that have no other beside them, turned as these are."""
    edges = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    size = int(triangles.max()) + 1
    return np.asarray(edges[~np.isin(edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0])])


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


def _outwards(edge: FlatEdge, fan: Floats, side: float) -> FlatEdge:
    """An edge whose plane is seen from outside, given the triangles (K, 3, 3) that close it, turned as the surface."""
    a, b, c = fan.transpose(1, 0, 2)
    up = float(np.cross(b - a, c - a).sum(axis=0) @ edge.outwards) * side
    return replace(edge, outwards=edge.outwards * np.sign(up))


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
    """Raise `GeometryError` where a closed mesh is not once around what is just inside of it, or is around what is out.

    Looked at are some vertices that are not among the `edged` ones.
    """
    rows = np.setdiff1d(np.unique(mesh.triangles), edged)
    places = 300  # at which a surface is looked at for passing through itself
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
