"""Meshes of boundaries that are several surfaces apart, as both sides of a thin wall, and of shells.

Of the pieces of surfaces that are meshed one by one those count that bound the whole set.  That the surfaces are apart
is looked at on the meshes: the cubes about points of one, three times as large as the tolerance, certainly miss the
others, and no triangle of one crosses a triangle of another.

The mesh of a shell is that of the solid, another one of the same triangles a thickness inside, and bands between them.
Vertices move along their faces' normals, which is exact where a face does not bend, and from there by Newton's method
onto the inner faces, their curves and corners; where a face is open both meshes end, and a band on it joins them.
Where faces meet in a groove, whose inner face is round there, the vertex has several images, and strips between these.
No lattice has to show the wall, so that it may be as thin as it likes: both sides are nearer to their faces than
a share of the thickness, and these faces are a thickness apart.

Guarantees, each checked on the result: all that the mesh of a solid has (see `closed`), and that the set changes across
each triangle.  None is made where the inner faces are no images of the outer ones, as where the thickness is
larger than a radius of curvature.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from itertools import combinations, pairwise, permutations

import numpy as np

from pas.arrays import AnyArray, Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.crossings import crossings
from pas.mesh.face_ground import inner_points
from pas.mesh.field import FaceField, ShellWall, bounds_set, place_of
from pas.mesh.first import unsound
from pas.mesh.halfedges import following
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton, pair_normals, project, second_derivatives
from pas.mesh.refusals import FaceMesh
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected, is_closed_manifold

ROOM = 3.0
"""Half of a cube about a point of one surface that must miss the others, over the tolerance."""

SHARE = 1 / 3
"""Of the thickness, how near each side is at least: less than 1/2, so that they do not meet."""

SMOOTH = 0.97
"""Cosine between normals of faces with one inner face above which their common vertex has one image."""


def mesh_apart(
    field: FaceField, shells: Sequence[FaceField], tolerance: float, mesh: Callable[[FaceField, float], FaceMesh]
) -> FaceMesh | None:
    """The mesh of all of a boundary from those of its surfaces, by `mesh(shell, tolerance)`.

    None where they cross, or there is no room between them.
    """
    halvings = 6  # of the tolerance, until there is that room
    for halving in range(halvings):
        checkpoint("meshing surfaces one by one")
        aim, found = tolerance / 2**halving, list[tuple[FaceField, Labelled, float]]()
        for shell in shells:
            made = mesh(shell, aim)
            found.append((shell, made.mesh, made.deviation))
        pairs = [(one, other) for (_, one, _), (other, _, _) in permutations(found, 2)]
        within = (other.inside(other.signs(one.points)) for one, other in pairs)
        if any(some.any() and not some.all() for some in within):
            return None
        points = (np.concatenate([one.points, inner_points(one.points[one.triangles])]) for one, _ in pairs)
        if not any(other.crossed(here, ROOM * aim).any() for here, (_, other) in zip(points, pairs, strict=True)):
            if any(_cross(one, other) for (_, one, _), (_, other, _) in combinations(found, 2)):
                return None
            whole = together(field, shells, [mesh for _, mesh, _ in found])
            return FaceMesh(whole, max(reached for *_, reached in found))
    return None


def _cross(first: Labelled, second: Labelled) -> bool:
    """Whether triangles of two meshes cross each other."""
    points = np.concatenate([first.points, second.points])
    pairs, _ = crossings(points, np.concatenate([first.triangles, second.triangles + len(first.points)]))
    return bool(np.diff(pairs < len(first.triangles), axis=1).any())


def together(field: FaceField, shells: Sequence[FaceField], meshes: Sequence[Labelled]) -> Labelled:
    """The mesh of a boundary from those of its surfaces, without the pieces of these that bound nothing."""
    points, triangles, labels, pinned = (list[AnyArray]() for _ in range(4))
    start = 0
    for shell, mesh in zip(shells, meshes, strict=True):
        kept = _bounding(field, shell, mesh)
        used, numbers = np.unique(mesh.triangles[kept], return_inverse=True)
        points.append(mesh.points[used])
        triangles.append(numbers.reshape(-1, 3) + start)
        labels.append(field.labels_of(shell, mesh.labels[kept]))
        pinned.append(np.flatnonzero(np.isin(used, mesh.topology.pinned)) + start)
        start += len(used)
    return Labelled.of(*map(np.concatenate, (points, triangles, labels, pinned)))


def _bounding(field: FaceField, shell: FaceField, mesh: Labelled) -> Bools:
    """Which triangles (T,) are on pieces that bound the set: it changes across most triangles of each."""
    middles, mostly = mesh.points[mesh.triangles].mean(axis=1), 0.5  # share of a piece's triangles that must do
    at = newton(middles, shell, mesh.labels[:, None], mesh.sizes[mesh.triangles].max(axis=1))
    changes = bounds_set(field, at, field.labels_of(shell, mesh.labels))
    pieces = connected(mesh.topology.edges, len(mesh.points))[mesh.triangles[:, 0]]
    share = np.bincount(pieces, changes) / np.maximum(np.bincount(pieces), 1)
    return np.asarray(share[pieces] > mostly)


def mesh_hollowed(
    field: FaceField,
    wall: ShellWall,
    tolerance: float,
    meshed: Callable[[FaceField, float], FaceMesh],
    refined: Callable[[Labelled, FaceField, float], FaceMesh],
) -> FaceMesh | None:
    """The mesh of a shell, from that of the solid by `meshed(solid, tolerance)`, `refined`.

    None where it does not come out, or `RefusalError` is raised.
    """
    checkpoint("meshing both sides of a wall")
    aim = min(tolerance, SHARE * wall.thickness)
    outer = meshed(wall.solid, aim)
    first = Doubled(outer.mesh, wall).projected(field)
    if not is_closed_manifold(first.triangles) or unsound(first, field, aim)[0]:
        return None
    found = refined(first, field, aim)
    mesh, middles = found.mesh, found.mesh.points[found.mesh.triangles].mean(axis=1)
    at = newton(middles, field, mesh.labels[:, None], np.full(len(middles), wall.thickness / 2))
    return found if bounds_set(field, at, mesh.labels).all() else None


class Doubled:
    """The mesh of both sides of a wall, and of the bands between them, from the mesh of the solid.

    Rows of points are those of the vertices, those of their images where they have one label, then the other images:
    one of a vertex for each set of labels that places it.
    """

    def __init__(self, mesh: Labelled, wall: ShellWall) -> None:
        self.mesh, self.wall = mesh, wall
        vertices, labels = mesh.topology.pairs.T
        self._around: dict[int, list[int]] = defaultdict(list)
        self._normals: dict[tuple[int, int], Floats] = {}
        several = np.flatnonzero(mesh.topology.label_count[vertices] > 1)
        normals = unit_rows(pair_normals(mesh, wall.solid))
        for row in several.tolist():
            self._around[int(vertices[row])].append(int(labels[row]))
            self._normals[int(vertices[row]), int(labels[row])] = normals[row]
        moved = mesh.points.copy()
        moved[vertices] -= wall.thickness * normals  # those with one label
        self._points = [mesh.points, moved]
        self._extra: list[Floats] = []
        self._found: dict[int, list[tuple[int, frozenset[int], Floats]]] = {}
        self._placed: dict[int, frozenset[int]] = {}
        self.triangles: list[tuple[int, int, int]] = []
        self.labels: list[int] = []

    def projected(self, field: FaceField) -> Labelled:
        """The mesh, its inner side on the inner faces."""
        mesh, wall, size = self.mesh, self.wall, len(self.mesh.points)
        kept = wall.inner[mesh.labels] >= 0
        sides, own = mesh.triangles[kept], mesh.labels[kept]
        within = sides + size
        towards = mesh.points[sides].mean(axis=1)
        for row, column in np.argwhere(mesh.topology.label_count[sides] > 1).tolist():
            within[row, column] = self._image(int(sides[row, column]), int(own[row]), towards[row])
        self._bridge(kept, within)
        triangles = np.concatenate([sides, within[:, ::-1], np.array(self.triangles, dtype=np.intp).reshape(-1, 3)])
        labels = np.concatenate([wall.outer[own], wall.inner[own], np.array(self.labels, dtype=np.intp)])
        points = np.concatenate([*self._points, np.array(self._extra).reshape(-1, 3)])
        # images of pinned vertices, and of those that have several: curves may turn sharply there
        known = set(mesh.topology.pinned.tolist())
        split = {row for vertex, own in self._found.items() if len(own) > 1 or vertex in known for row, *_ in own}
        pinned = np.concatenate([mesh.topology.pinned, list(split)]).astype(np.intp)
        used, numbers = np.unique(triangles, return_inverse=True)
        result = Labelled.of(points[used], numbers.reshape(-1, 3), labels, np.flatnonzero(np.isin(used, pinned)))
        inner = np.flatnonzero(used >= size)
        return project(result, field, np.full(len(used), wall.thickness), inner)

    def _placing(self, vertex: int, label: int) -> frozenset[int]:
        """The labels around a vertex that determine its image for one of them.

        Of those with one inner face: its own, or of others the first; and all that continue that one smoothly.
        """
        groups: dict[int, list[int]] = defaultdict(list)
        for other in self._around[vertex]:
            inner = int(self.wall.inner[other])
            groups[inner if inner >= 0 else -1 - other].append(other)
        chosen: set[int] = set()
        for labels in groups.values():
            first = label if label in labels else labels[0]
            normal = self._normals[vertex, first]
            chosen.update(o for o in labels if o == first or self._normals[vertex, o] @ normal > SMOOTH)
        return frozenset(chosen)

    def _image(self, vertex: int, label: int, towards: Floats) -> int:
        """The row of the image of a vertex for a triangle of some label, in some direction from it: of several that
        are on its inner face the one that is there."""
        if vertex not in self._found:
            self._found[vertex] = self._images(vertex)
        here = [(row, move) for row, placing, move in self._found[vertex] if label in placing]
        return max(here, key=lambda pair: float(pair[1] @ (towards - self.mesh.points[vertex])))[0]

    def _images(self, vertex: int) -> list[tuple[int, frozenset[int], Floats]]:
        """The rows of a vertex's images, the labels that place each, and how they are moved."""
        result = []
        for placing in dict.fromkeys(self._placing(vertex, label) for label in self._around[vertex]):
            rows = sorted(placing)
            if (self.wall.inner[rows] < 0).all():
                continue
            matrix = np.array([self._normals[vertex, other] for other in rows])
            right = np.where(self.wall.inner[rows] >= 0, -self.wall.thickness, 0.0)
            # Ratio of singular values below which normals count as parallel, where a vertex is moved along several.
            steep = 0.05
            move = np.linalg.pinv(matrix, rcond=steep) @ right
            row = 2 * len(self.mesh.points) + len(self._extra)
            self._extra.append(self.mesh.points[vertex] + move)
            self._placed[row] = placing
            result.append((row, placing, move))
        return result

    def _bridge(self, kept: Bools, within: Integers) -> None:
        """Add the bands on open faces, and what is between images of one vertex."""
        t, labels = self.mesh.triangles, self.mesh.labels
        image = np.full(t.shape, -1, dtype=np.intp)
        image[kept] = within
        start, end = t.ravel(), t[:, [1, 2, 0]].ravel()
        other, after = self.mesh.topology.twins, following(np.arange(len(start)))
        flat, triangle = image.ravel(), np.arange(len(start)) // 3
        several = np.zeros(len(self.mesh.points), dtype=bool)
        several[[vertex for vertex, own in self._found.items() if len(own) > 1]] = True
        chosen = kept[triangle] & ((labels[triangle] != labels[other // 3]) | several[start] | several[end])
        for edge in np.flatnonzero(chosen).tolist():
            a, b, p, q = (int(v) for v in (start[edge], end[edge], flat[edge], flat[after[edge]]))
            here, there = int(labels[triangle[edge]]), int(labels[other[edge] // 3])
            if not kept[other[edge] // 3]:
                self._add(int(self.wall.outer[there]), (b, a, p), (b, p, q))
            elif edge < other[edge]:
                r, s = int(flat[after[other[edge]]]), int(flat[other[edge]])  # the images of a and b across
                self._add(self._between(here, there, {p, q, r, s}), (p, q, s), (p, s, r))
        self._close(start, flat, other)

    def _add(self, label: int, *triangles: tuple[int, int, int]) -> None:
        for triangle in triangles:
            if len(set(triangle)) == 3:
                self.triangles.append(triangle)
                self.labels.append(label)

    def _between(self, here: int, there: int, images: set[int]) -> int:
        """The inner label of a strip between images on both sides of an edge between two labels."""
        common = [label for label in (here, there) if all(label in self._placed.get(row, ()) for row in images)]
        return int(self.wall.inner[common[0] if common else here])

    def _close(self, start: Integers, flat: Integers, other: Integers) -> None:
        """Add the polygons between the images of each vertex that has several."""
        many = [vertex for vertex, own in self._found.items() if len(own) > 1]
        corners: dict[int, list[int]] = defaultdict(list)
        for corner in np.flatnonzero(np.isin(start, many)).tolist():
            corners[int(start[corner])].append(corner)
        for vertex, own in sorted(corners.items()):
            # counterclockwise around the vertex: across the edge that ends there
            before = {c: int(other[c // 3 * 3 + (c + 2) % 3]) for c in own}
            opened = [c for c in own if flat[c] < 0]
            begin = next((before[c] for c in opened if flat[before[c]] >= 0), own[0])
            ring, corner = [], begin
            for _ in own:
                if flat[corner] < 0:
                    break
                ring.append(int(flat[corner]))
                corner = before[corner]
            ring = [a for a, b in zip(ring, [*ring[1:], None if opened else ring[0]], strict=True) if a != b]
            label = int(self.wall.inner[self.mesh.labels[begin // 3]])
            for p, q in pairwise(ring[1:]):
                self._add(label, (ring[0], q, p))
            if opened and len(ring) > 1:
                self._add(int(self.wall.outer[self.mesh.labels[corner // 3]]), (vertex, ring[-1], ring[0]))


def too_thick(mesh: Labelled, wall: ShellWall) -> str:
    """The complaint that a wall is thicker than a radius of curvature of a kept face, with the place; "" if it is not.

    `mesh` is that of the solid, at whose vertices curvatures are evaluated.
    """
    solid = wall.solid
    vertices, labels = mesh.topology.pairs[wall.inner[mesh.topology.pairs[:, 1]] >= 0].T
    points = mesh.points[vertices]
    gradients, bend = solid.jets(points, labels)[:, 1:], second_derivatives(solid, points, labels)
    size = np.maximum(np.linalg.norm(gradients, axis=1), 1e-300)[:, None, None]
    normals = gradients[:, :, None] / size
    across = np.eye(3) - normals @ normals.transpose(0, 2, 1)
    bend = across @ bend @ across / size
    curvatures = np.linalg.eigvalsh(np.where(np.isfinite(bend), bend, 0.0))[:, 2]
    most = int(curvatures.argmax())
    if curvatures[most] * wall.thickness < 1:
        return ""
    radius, name = solid.scale / curvatures[most], solid.face(int(labels[most]))
    return (
        f"the shell is {wall.thickness * solid.scale:.3g} thick, but near {place_of(solid, points[most])} the face "
        f"{name!r} has a radius of curvature of {radius:.3g}, within which its inner face folds over; "
        f"a thickness below {radius:.2g} works"
    )
