"""Meshes of boundaries that are several surfaces, apart or with points in common: each surface is meshed by itself.

Of the pieces of each those count that bound the whole set.  Surfaces that are apart, such as both sides of a thin wall,
keep their distance: the cubes about points of one, three times as large as the tolerance, certainly miss the others.

A boundary whose surfaces touch in points is no manifold, but each of them is one: a ball less one that touches it from
inside is bounded by two spheres, and as a set of triangles by two closed meshes with two vertices at one place.  That
they have nothing else in common is looked at on the triangles themselves: no edge of one crosses or meets a triangle of
the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from pas.limits import checkpoint
from pas.mesh.face_ground import FaceGround, deviation, inner_points
from pas.mesh.field import FaceField, extent_of
from pas.mesh.first import unsound
from pas.mesh.halfedges import HalfEdges
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton
from pas.mesh.refusals import Made, Refusal
from pas.mesh.rows import Floats, cross
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected

ROOM = 3.0
"""Half of a cube about a point of one surface that must miss the others, over the tolerance."""

SHARES = (1 / 4, 1 / 16)
"""Of the tolerance, to which one of the surfaces after the other is meshed until they do not cross: where two bend the
same way, chords of the outer one pass through the inner one if they are long beside those."""

NEAR = 0.3
"""Distance from a vertex, over its size, up to which a point of contact is that vertex."""


def mesh_apart(
    field: FaceField,
    shells: Sequence[FaceField],
    tolerance: float,
    mesh: Callable[[FaceField, float], Made],
) -> Made | None:
    """The mesh of all of a boundary, and how near it is, from those of its surfaces, by `mesh(shell, tolerance)`.

    None where there is no room between them.
    """
    halvings = 6  # of the tolerance, until there is that room
    for halving in range(halvings):
        checkpoint("meshing surfaces one by one")
        aim = tolerance / 2**halving
        found = _all_made(mesh(shell, aim) for shell in shells)
        if isinstance(found, Refusal):
            return found
        meshes, reached = zip(*found, strict=True)
        pairs = permutations(zip(shells, meshes, strict=True), 2)
        if not any(other.crossed(_points(one), ROOM * aim).any() for (_, one), (other, _) in pairs):
            return together(field, shells, meshes), max(reached)
    return None


def _all_made(meshes: Iterable[Made]) -> list[tuple[Labelled, float]] | Refusal:
    """Meshes and how near they are, or why the first that is refused is."""
    found = []
    for made in meshes:
        if isinstance(made, Refusal):
            return made
        found.append(made)
    return found


def _points(mesh: Labelled) -> Floats:
    """The vertices and points inside the triangles (K, 3)."""
    return np.concatenate([mesh.points, inner_points(mesh.points[mesh.triangles])])


def together(field: FaceField, shells: Sequence[FaceField], meshes: Sequence[Labelled]) -> Labelled:
    """The mesh of a boundary from those of its surfaces, without the pieces of these that bound nothing."""
    points, triangles, labels, pinned, start = [], [], [], [], 0
    for shell, mesh in zip(shells, meshes, strict=True):
        kept = _bounding(field, shell, mesh)
        used, numbers = np.unique(mesh.triangles[kept], return_inverse=True)
        points.append(mesh.points[used])
        triangles.append(numbers.reshape(-1, 3) + start)
        labels.append(field.labels_of(shell, mesh.labels[kept]))
        pinned.append(np.flatnonzero(np.isin(used, mesh.topology.pinned)) + start)
        start += len(used)
    return Labelled.of(*map(np.concatenate, (points, triangles, labels, pinned)))


def _bounding(field: FaceField, shell: FaceField, mesh: Labelled) -> np.ndarray:
    """Which triangles (T,) are on pieces that bound the set: it changes across most triangles of each."""
    middles = mesh.points[mesh.triangles].mean(axis=1)
    at = newton(middles, shell, mesh.labels[:, None], mesh.sizes[mesh.triangles].max(axis=1))
    beside, mostly = 1e-6, 0.5  # how far on both sides of a piece, over the extent; share of its triangles that must do
    step = beside * extent_of(field) * unit_rows(shell.jets(at, mesh.labels)[:, 1:])
    changes = field.inside(field.signs(at - step)) & ~field.inside(field.signs(at + step))
    pieces = connected(mesh.topology.edges, len(mesh.points))[mesh.triangles[:, 0]]
    share = np.bincount(pieces, changes) / np.maximum(np.bincount(pieces), 1)
    return np.asarray(share[pieces] > mostly)


def mesh_touching(
    field: FaceField, surfaces: Sequence[FaceField], tolerance: float, mesh: Callable[[FaceField, float], Made]
) -> Made | None:
    """The mesh of a boundary and how near it is, from those of its surfaces, by `mesh(surface, tolerance)`.

    None where they are not near enough, or cross, however fine one of them is.
    """

    @cache
    def made(number: int, aim: float) -> Made:
        found = mesh(surfaces[number], aim)
        return found if isinstance(found, Refusal) else _with_contacts(found[0], surfaces[number], aim)

    finer = [(-1, 1.0), *product(range(len(surfaces)), SHARES)]
    for number, share in sorted(finer, key=lambda pair: -pair[1]):
        checkpoint("meshing surfaces that touch")
        # Share of the tolerance to which surfaces are meshed: a vertex that moves into a point of contact takes the
        # rest.
        left = 0.7
        found = _all_made(made(i, left * tolerance * (share if i == number else 1.0)) for i in range(len(surfaces)))
        if isinstance(found, Refusal):
            return found
        meshes, reached = zip(*found, strict=True)
        pairs = permutations(zip(surfaces, meshes, strict=True), 2)
        if max(reached) <= tolerance and not any(_crosses(one, *other) for (_, one), other in pairs):
            return together(field, surfaces, meshes), max(reached)
    return None


def _with_contacts(mesh: Labelled, surface: FaceField, aim: float) -> tuple[Labelled, float]:
    """The mesh with a vertex at each special point of the surface, and how near it is."""
    for point in surface.special_points:
        distance = np.linalg.norm(mesh.points - point, axis=1)
        nearest = int(distance.argmin())
        if distance[nearest] <= NEAR * mesh.sizes[nearest] and mesh.topology.label_count[nearest] == 1:
            points = mesh.points.copy()
            points[nearest] = point
            mesh = mesh.moved(points)
        else:
            mesh, nearest = _inserted(mesh, point), len(mesh.points)
        mesh = _flipped(mesh, surface, aim, mesh.topology.around(np.array([nearest]), rings=2))
    if unsound(mesh, surface, aim)[0]:
        return mesh, np.inf
    return mesh, deviation(mesh, surface)


def _flipped(mesh: Labelled, surface: FaceField, aim: float, near: NDArray[np.bool_]) -> Labelled:
    """The mesh with edges at vertices `near` (N,) flipped where that is better."""
    ground = FaceGround(surface, int(mesh.labels.max()) + 1)
    halves = HalfEdges(mesh, ground.faces)
    halves.normals[:] = ground.looked(halves.points[halves.vertex_of], halves.face_of)[0]
    halves.fresh[:] = near
    halves.flip(aim, only_fresh=True)
    return halves.value


def _inserted(mesh: Labelled, point: Floats) -> Labelled:
    """The mesh with a vertex in the triangle on which a point is, or nearly so."""
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    normal = cross(b - a, c - a)
    square = np.maximum((normal * normal).sum(axis=1), 1e-300)
    within = [(cross(q - p, point - p) * normal).sum(axis=1) / square for p, q in ((a, b), (b, c), (c, a))]
    off = np.abs(((point - a) * normal).sum(axis=1)) / np.sqrt(square)
    row = int(np.argmin(off / np.sqrt(np.sqrt(square)) - np.minimum(np.min(within, axis=0), 0.0)))
    i, j, k = mesh.triangles[row]
    new = len(mesh.points)
    triangles = np.concatenate([mesh.triangles, [[j, k, new], [k, i, new]]])
    triangles[row] = i, j, new
    labels = np.concatenate([mesh.labels, [mesh.labels[row]] * 2])
    return Labelled.of(np.concatenate([mesh.points, point[None]]), triangles, labels, mesh.topology.pinned)


def _crosses(mesh: Labelled, surface: FaceField, other: Labelled) -> bool:
    """Whether an edge of a mesh meets a triangle of another, but for those that end in a common vertex."""
    ends = mesh.points[mesh.topology.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    special = surface.special_points
    apart = np.array([[bool((np.abs(special - p).max(axis=1) == 0).any()) for p in pair] for pair in ends])
    near = np.asarray(~apart.any(axis=1))
    near[near] = surface.crossed(ends[near].mean(axis=1), float(lengths.max()))
    ends, corners = ends[near], other.points[other.triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    step = max(1, (1 << 18) // max(len(corners), 1))  # so many pairs are looked at together
    for start in range(0, len(ends), step):
        checkpoint("looking whether surfaces cross")
        part = ends[start : start + step]
        meet = (part.min(axis=1)[:, None] <= high) & (part.max(axis=1)[:, None] >= low)
        rows, columns = np.nonzero(meet.all(axis=2))
        if len(rows) and _pierced(part[rows], corners[columns]).any():
            return True
    return False


def _pierced(ends: Floats, corners: Floats) -> np.ndarray:
    """Whether edges (N, 2, 3) meet triangles (N, 3, 3), or nearly so (N,)."""
    (p, q), (a, b, c) = ends.transpose(1, 0, 2), corners.transpose(1, 0, 2)
    size = np.linalg.norm(q - p, axis=1) + np.abs(corners - corners[:, :1]).max(axis=(1, 2))
    normal, along = cross(b - a, c - a), q - p
    sides = [((x - a) * normal).sum(axis=1) for x in (p, q)]
    turns = [(cross(u - p, v - p) * along).sum(axis=1) for u, v in ((a, b), (b, c), (c, a))]
    # Share of a volume of six lengths, or of an area, up to which rounding leaves open on which side of a triangle or
    # of its edge something is.
    on = 1e-9
    slack = on * size**3
    across = (np.minimum(*sides) <= slack) & (np.maximum(*sides) >= -slack)
    return np.asarray(across & ((np.min(turns, axis=0) >= -slack) | (np.max(turns, axis=0) <= slack)))
