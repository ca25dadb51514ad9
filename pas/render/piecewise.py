"""Piecewise surfaces for pictures: the surface, the neighbours that it continues, and combs.

Combs stand along sections in the planes of two contacts' axes, and along the contact curves.  The curves are found on
the mesh and brought to the surface by Newton's method; curvatures are those of the polynomials there, in the direction
of the curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from pas.algebra.lengths import arc_lengths, resampled, unit
from pas.algebra.rational import to_float
from pas.arrays import Floats
from pas.mesh.mesh import Mesh
from pas.mesh.topology import chains
from pas.piecewise import PiecewiseSurface
from pas.render.neighbours import contact_rim, neighbours
from pas.render.scene import BLEND_COLOR, PIPE_COLOR, Comb, Layer, Scene
from pas.solid.faces import JetsAt
from pas.surface.fairness_limits import neighbour
from pas.surface.geometry import FIRST, Geometry

VIEW = (0.62, -0.62, 0.48)
"""From where one looks, in the frame of the contact directions: past the pipes, from above."""


def layers(surface: PiecewiseSurface, scene: Scene) -> None:
    """Add the surface and its neighbours; raises `MeshError` where it has no region."""
    extent = float(np.ptp(surface.partition.points, axis=0).max()) if len(surface.partition.points) else 1.0
    tolerance = scene.picture.tolerance or extent * scene.picture.coloring.tolerance
    mesh = scene.mesh(lambda: surface.mesh(tolerance))
    scene.look(VIEW, _frame(surface))
    scene.layers.append(
        Layer(
            mesh,
            BLEND_COLOR,
            principal=lambda: principal_curvatures(surface, mesh.points),
            unit=sharpest_neighbour(surface) if scene.picture.curved else None,
            combs=combs(surface, mesh) if scene.picture.combs else (),
            outlined=True,
        )
    )
    scene.layers += [Layer(other, PIPE_COLOR, aside=True) for other in neighbours(surface, mesh, extent / 4)]


def principal_curvatures(surface: PiecewiseSurface, points: Floats) -> Floats:
    """Principal curvatures (N, 2) at surface points (N, 3), the larger first: those of the polynomials."""
    return geometry_at(surface, points)[1].principal / to_float(surface.partition.frame.scale)


def sharpest_neighbour(surface: PiecewiseSurface) -> float | None:
    """The largest |principal curvature| of the contacts' surfaces on their curves; None where all are flat there."""
    scale = to_float(surface.partition.frame.scale)
    found = [neighbour(join, scale).curvature for join in surface.joins if np.isfinite(join.radius)]
    most = max(found, default=0.0)
    return most if most * scale > 1e-9 else None  # which rounding alone would make


def _frame(surface: PiecewiseSurface) -> Floats:
    """Unit directions towards the first contacts, completed to a frame by the axes."""
    rows = [c.scaled.clip.gradient(np.zeros(3)) for c in surface.contacts] + list(np.eye(3))
    frame: list[Floats] = []
    for row in rows:
        rest = np.array(row, dtype=float)
        for known in frame:
            rest = rest - (rest @ known) * known
        if np.linalg.norm(rest) > 1e-6 * max(float(np.linalg.norm(row)), 1e-300) and len(frame) < 3:
            frame.append(rest / np.linalg.norm(rest))
    return np.array(frame)


FEWEST = 8
"""Points of a curve below which it is not shown: corners that a plane just touches."""


def combs(surface: PiecewiseSurface, mesh: Mesh) -> tuple[Comb, ...]:
    """The combs of a surface; `mesh` is its own."""
    extent = float(np.ptp(mesh.points, axis=0).max())
    spacing, aside = extent / 200, 1e-7 * extent  # between hairs, and of planes: vertices may lie on the plane itself
    found, ends = [], []
    for contact in (contact.scaled for contact in surface.contacts):
        rim = contact_rim(contact, mesh)
        if not len(rim):
            continue
        curves = [_resampled(mesh.points[chain], spacing) for chain in chains(rim)]
        there = [_comb(surface, curve, contact.clip.jets) for curve in curves]
        found += there
        for part in _neighbours([comb.points for comb in there], spacing):
            mean = _middle(part)
            ends.append((mean, unit(contact.clip.gradient(mean[None]))[0]))
    for place, normal in section_planes(ends):
        plane = _plane(place, normal)
        for curve in _section(mesh, place + aside * normal, normal):
            found.append(_comb(surface, _resampled(curve, spacing), plane))
    return tuple(comb for comb in found if len(comb.points) >= FEWEST)


def geometry_at(surface: PiecewiseSurface, points: Floats) -> tuple[Floats, Geometry]:
    """The jets (N, 20) at points (N, 3) and what they say, all in local coordinates; the nearest cell's outside."""
    local = surface.partition.frame.local_points(points)
    found = surface.evaluator.batch(0, 1, 2, 3)(local, surface.local.location.pieces(local.T, np.inf))
    return found, Geometry(found)


def section_planes(ends: Sequence[tuple[Floats, Floats]]) -> list[tuple[Floats, Floats]]:
    """A point and the unit normal of each plane of two axes, which are given by points and unit directions (3,).

    Skew axes give the plane that is nearest to both.  Where all axes are on one line, there are two planes through it.
    """
    planes: list[tuple[Floats, Floats]] = []
    straight: list[tuple[Floats, Floats]] = []
    for (first, along), (second, other) in combinations(ends, 2):
        across = second - first
        size = np.linalg.norm(across)
        ways = np.stack([along, other, across / size if size else along])
        _, sizes, axes = np.linalg.svd(ways)
        if sizes[1] < 1e-4 * sizes[0]:
            straight += [(first, axes[1]), (first, axes[2])]
        elif not any(_same((first + second) / 2, axes[2], *plane) for plane in planes):
            planes.append(((first + second) / 2, axes[2]))
    return planes or straight[:2]


def _same(place: Floats, normal: Floats, other: Floats, way: Floats) -> bool:
    """Whether two planes through measured points are one."""
    size = 1.0 + float(np.abs(place).max())
    return bool(np.linalg.norm(np.cross(normal, way)) < 1e-4 and abs(way @ (place - other)) < 1e-4 * size)


def _plane(place: Floats, normal: Floats) -> JetsAt:
    return lambda p: np.column_stack([(p - place) @ normal, np.broadcast_to(normal, p.shape)])


def _comb(surface: PiecewiseSurface, points: Floats, other: JetsAt) -> Comb:
    """The comb of the curve where the surface meets another one, near to `points` (n, 3)."""
    scale = to_float(surface.partition.frame.scale)
    for _ in range(6):  # of Newton's method, from points within the mesh's tolerance
        found, _ = geometry_at(surface, points)
        jets = other(points)
        rows = np.stack([found[:, FIRST] / scale, jets[:, 1:]], axis=1)
        points = points - (np.linalg.pinv(rows) @ np.stack([found[:, 0], jets[:, 0]], axis=1)[:, :, None])[:, :, 0]
    _, geometry = geometry_at(surface, points)
    tangents = unit(np.cross(geometry.normals, other(points)[:, 1:]))
    parts = np.einsum("nij,ni->nj", geometry.frame[:, :, :2], tangents)
    curvatures = (parts**2 * geometry.principal).sum(axis=1) / scale
    known = np.isfinite(points).all(axis=1) & np.isfinite(curvatures)
    return Comb(points[known], geometry.normals[known], curvatures[known])


def _section(mesh: Mesh, place: Floats, normal: Floats) -> list[Floats]:
    """Where a plane through no vertex cuts a mesh: the points of each curve."""
    heights = (mesh.points - place) @ normal
    above = heights[mesh.triangles] > 0
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    sides = np.stack([mesh.triangles[cut], np.roll(mesh.triangles[cut], -1, axis=1)], axis=2)  # (n, 3, 2)
    crossed = above[cut] != np.roll(above[cut], -1, axis=1)  # two of three
    edges, places = np.unique(np.sort(sides[crossed], axis=1), axis=0, return_inverse=True)
    a, b = heights[edges].T
    share = (a / np.where(a == b, 1.0, a - b))[:, None]
    points = (1 - share) * mesh.points[edges[:, 0]] + share * mesh.points[edges[:, 1]]
    return [points[chain] for chain in chains(places.reshape(-1, 2))]


def _neighbours(curves: Sequence[Floats], near: float) -> list[list[Floats]]:
    """The curves of a contact by neighbours: each closed one is a neighbour's, open ones are parts of one."""
    closed = [bool(np.linalg.norm(curve[0] - curve[-1]) < near) for curve in curves]
    parts = [[curve] for curve, whole in zip(curves, closed, strict=True) if whole]
    rest = [curve for curve, whole in zip(curves, closed, strict=True) if not whole]
    return parts + [rest] * bool(rest)


def _middle(curves: Sequence[Floats]) -> Floats:
    """The mean point of polylines (n, 3)."""
    starts, stops = (np.concatenate([curve[part] for curve in curves]) for part in (slice(-1), slice(1, None)))
    weights = np.linalg.norm(stops - starts, axis=1)
    return np.asarray(weights @ (starts + stops) / (2 * weights.sum()))


def _resampled(curve: Floats, spacing: float) -> Floats:
    """Points at equal distances along a polyline (n, 3), about `spacing` apart, both ends included."""
    return resampled(curve, max(2, round(arc_lengths(curve)[-1] / spacing) + 1))
