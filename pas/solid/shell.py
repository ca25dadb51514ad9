"""Shells: the part of a solid within a thickness of its faces.

The wall is where the solid's points are at most the thickness from the faces that are kept.  Distances count as
negative outside, so that a wall has one side, however thin it is, and are exact to rounding where the thickness is
below the faces' radii of curvature: the foot of a point is found on the faces' own functions, from the nearest vertex
of a mesh.  Faces that meet in sharp convex edges have inner faces of their own, which meet in sharp edges as well;
faces that continue each other share one, and so do faces that meet in a groove, whose inner face is round there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from pas.arrays import Bools, Floats, Integers
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.mesh.halfedges import halved
from pas.mesh.labelled import Labelled
from pas.mesh.projection import least_norm, project
from pas.mesh.refusals import FaceMesh
from pas.mesh.rows import cross
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected
from pas.solid.bounds import bounding_box
from pas.solid.field import SolidField
from pas.solid.functions import Distance, Followed
from pas.solid.tree import Atom, Node, Tree, combined, complement

BESIDE = 1e-7
"""How far on both sides of a foot the solid is looked for, over the local extent."""


@dataclass(frozen=True)
class _Target:
    """A face (one label), the groove between two, or all faces together, with its mesh's vertices.

    `normals` (N, 3) at the vertices, of any length, point outwards.
    """

    labels: tuple[int, ...]
    vertices: Floats
    normals: Floats
    tree: cKDTree


_Feet = tuple[Floats, Floats, Floats]
"""The nearest points (N, 3) of faces, the outward normals there, and the least (N,) that the distance may be."""


class Hollowable(Protocol):
    """The queries of a solid that shells are made of."""

    @property
    def tree(self) -> Tree:
        """Its inequalities."""

    @property
    def field(self) -> SolidField:
        """Its boundary."""

    def face_mesh(self, tolerance: float | None = None) -> FaceMesh:
        """A mesh of its boundary, by faces."""


class FaceDistance(Distance):
    """The distance from some faces of a solid, less a thickness; outside the solid and the faces that negative.

    `faces` are names, `tolerance` is that of the mesh from which feet are looked for.
    """

    def __init__(self, solid: Hollowable, faces: Sequence[str], thickness: float, tolerance: float) -> None:
        self.solid, self.faces, self.thickness, self.tolerance = solid, tuple(faces), thickness, tolerance
        mesh, field = _dense(solid, tolerance), solid.field
        self._field, self._scale = field, field.scale
        names = {label: field.face(label) for label in np.unique(mesh.labels).tolist()}
        labels = [label for label, name in names.items() if name in self.faces]
        self.follows = Followed(solid.tree, frozenset(self.faces), frozenset(names.values()), thickness)
        triangles = mesh.triangles[np.isin(mesh.labels, labels)]
        self._targets = [_target(mesh, field, (label,), mesh.triangles[mesh.labels == label]) for label in labels]
        edges = LabelEdges.of(mesh, field)
        pairs = np.sort(edges.labels, axis=1)
        for a, b in np.unique(pairs[edges.grooves], axis=0).tolist():
            if a in labels and b in labels:
                chosen = edges.grooves & (pairs == (a, b)).all(axis=1)
                self._targets.append(_target(mesh, field, (a, b), edges.ends[chosen]))
        self._targets += _corners(mesh, field, set(labels))
        self._all = _target(mesh, field, tuple(labels), triangles)
        sides = mesh.points[triangles] - mesh.points[np.roll(triangles, 1, axis=1)]
        self._longest = float(np.sqrt((sides * sides).sum(axis=2).max()))

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4); far from the value 0 they are those of the nearest vertex."""
        local = self._field.evaluator.local(points)
        points, normals, _ = self._nearest(local)
        away = local - points
        distance = np.linalg.norm(away, axis=1)
        side = np.where(self._outside(local, points, normals), -1.0, 1.0)
        gradient = away * (side / np.maximum(distance, 1e-300))[:, None]
        return np.concatenate([(side * distance * self._scale - self.thickness)[:, None], gradient], axis=1)

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in balls.

        Where a ball is neither certainly in the solid nor outside, only what holds of its points in the solid is said.
        """
        local, reach = self._field.evaluator.local(centers), radii / self._scale
        (points, normals, least), aim = self._nearest(local), self.thickness / self._scale
        outside, most = self._outside(local, points, normals), np.linalg.norm(local - points, axis=1)
        below = most + reach <= aim  # on either side
        rows = np.flatnonzero(outside & (least > reach))
        evaluator, half = self._field.evaluator, np.repeat(reach[rows, None], 3, axis=1)
        below[rows] = evaluator.decided(*evaluator.taylor(local[rows], half))[1]
        return below, ~outside & (least - reach > aim)

    def _outside(self, points: Floats, feet: Floats, normals: Floats) -> Bools:
        """Which points are outside the solid, and on the outer side of the faces that are followed."""
        beyond = ((points - feet) * normals).sum(axis=1) > 0
        beyond[beyond] = ~self._field.inside(self._field.signs(points[beyond]))
        return np.asarray(beyond)

    def _nearest(self, points: Floats) -> _Feet:
        """Feet of points: exact where the distance may be the thickness, else the nearest vertices."""
        distance, index = self._all.tree.query(points)
        feet, normals = self._all.vertices[index], self._all.normals[index]
        aim = self.thickness / self._scale
        least = np.sqrt(np.maximum(distance**2 - 2 * self._longest**2, 0.0))  # vertices are that dense
        close = np.flatnonzero((least <= aim) & (distance >= aim - self._longest / 2))
        feet[close], normals[close] = self._feet(points[close], distance[close], feet[close], normals[close])
        least[close] = np.linalg.norm(points[close] - feet[close], axis=1)
        return feet, normals, least

    def _feet(self, points: Floats, nearest: Floats, feet: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """The nearest points (N, 3) of the faces and the normals there, given the nearest vertices and theirs."""
        if len(self._targets) == 1:  # beyond its sharp edges a face is continued
            target, index = self._targets[0], self._targets[0].tree.query(points)[1]
            return self._foot(np.full((len(points), 1), target.labels[0]), points, target.vertices[index])
        most = nearest.max(initial=0.0) + self._longest
        groups = dict[int, list[tuple[Integers, Integers, Floats]]]()  # of one label, of two, of more
        for target in self._targets:
            away, index = target.tree.query(points, distance_upper_bound=most)
            rows = np.flatnonzero(away <= nearest + self._longest)
            labels = np.broadcast_to(target.labels, (len(rows), len(target.labels)))
            groups.setdefault(len(target.labels), []).append((rows, labels, target.vertices[index[rows]]))
        found = [self._nearby(points, *map(np.concatenate, zip(*some, strict=True))) for some in groups.values()]
        rows, square, places, outward = map(np.concatenate, zip(*found, strict=True))
        order = np.lexsort((square, rows))
        first = np.unique(rows[order], return_index=True)[1]
        best = order[first][np.isfinite(square[order[first]])]
        feet[rows[best]], normals[rows[best]] = places[best], outward[best]
        return feet, normals

    def _nearby(
        self, points: Floats, rows: Integers, labels: Integers, starts: Floats
    ) -> tuple[Integers, Floats, Floats, Floats]:
        """Rows (K,) of points, their feet on faces, grooves or corners of given labels (K, m) as `_foot` finds them,
        and the squares of their distances, infinite where that does not go there."""
        places, outward = self._foot(labels, points[rows], starts)
        square = ((places - points[rows]) ** 2).sum(axis=1)
        if labels.shape[1] < 3:
            if labels.shape[1] == 1:
                hidden = self._buried(places, labels[:, 0])
            else:  # the solid is above the curve on which a groove lies: it does not go there
                hidden = self._field.inside(self._field.signs(places + BESIDE * unit_rows(outward)))
            square[hidden] = np.inf
        return rows, square, places, outward

    def _foot(self, labels: Integers, points: Floats, feet: Floats) -> tuple[Floats, Floats]:
        """Where vertices (N, 3) of faces or grooves of given labels (N, m) go when they follow points there, and the
        outward normals."""
        feet, alone = feet.copy(), labels.shape[1] == 1
        active = np.arange(len(points) if labels.shape[1] < 3 else 0)  # corners stay
        for _ in range(80 if len(active) else 0):  # convergence is linear where faces bend
            checkpoint()
            p, own = feet[active], labels[active]
            move = points[active] - p
            if alone:
                jets = self._field.jets(p, own[:, 0])
                size = np.maximum((jets[:, 1:] ** 2).sum(axis=1), 1e-300)
                move -= (((move * jets[:, 1:]).sum(axis=1) + jets[:, 0]) / size)[:, None] * jets[:, 1:]
            else:
                along = unit_rows(cross(*(_normals(self._field, p, column) for column in own.T)))
                move = (move * along).sum(axis=1, keepdims=True) * along - least_norm(self._field, own, p)
            feet[active] = p + move
            active = active[(move * move).sum(axis=1) > 1e-13**2]  # steps of rounding, where the extent is 2
            if not len(active):
                break
        outward = [_normals(self._field, feet, column) for column in labels.T]
        return feet, np.asarray(np.sum(outward, axis=0))

    def _buried(self, points: Floats, label: Integers) -> Bools:
        """Whether the solid is on both sides of points on labels' surfaces (N,): their faces do not go there."""
        step = BESIDE * _normals(self._field, points, label)
        signs = [self._field.signs(points + side * step) for side in (-1, 1)]
        return np.asarray(self._field.inside(signs[0]) & self._field.inside(signs[1]))


def _corners(mesh: Labelled, field: SolidField, labels: set[int]) -> list[_Target]:
    """The vertices at which three or more of some labels meet."""
    rows, places = np.unique(mesh.topology.vertex_labels, axis=0, return_inverse=True)
    found = [(tuple(label for label in row if label in labels), i) for i, row in enumerate(rows.tolist())]
    return [_target(mesh, field, own, np.flatnonzero(places == i)) for own, i in found if len(own) > 2]


def _normals(field: SolidField, points: Floats, label: int | Integers) -> Floats:
    return unit_rows(field.jets(points, label)[:, 1:])


def _dense(solid: Hollowable, tolerance: float) -> Labelled:
    """A mesh of the faces with vertices everywhere, flat or not: 20 along the longest side of the box."""
    longest = float(np.ptp(solid.field.box, axis=0).max()) / 20
    mesh = solid.face_mesh(tolerance).mesh
    while (long := mesh.lengths > longest).any():
        checkpoint(f"subdividing the mesh ({len(mesh.triangles)} triangles)")
        finer = halved(mesh, np.flatnonzero(long))
        mesh = project(finer, solid.field, finer.sizes)
    return mesh


def _target(mesh: Labelled, field: SolidField, labels: tuple[int, ...], cells: Integers) -> _Target:
    """The vertices of some cells, with the mean normals of those of their faces that are followed."""
    chosen = np.unique(cells)
    outward = np.zeros_like(mesh.points)
    for label in labels:
        rows = np.unique(mesh.triangles[mesh.labels == label])
        outward[rows] += _normals(field, mesh.points[rows], label)
    vertices = mesh.points[chosen]
    return _Target(labels, vertices, outward[chosen], cKDTree(vertices))


@dataclass(frozen=True)
class LabelEdges:
    """The edges between labels: `ends` (E, 2), `labels` (E, 2), and which are `smooth` or `grooves` (E,)."""

    ends: Integers
    labels: Integers
    smooth: Bools
    grooves: Bools

    @classmethod
    def of(cls, mesh: Labelled, field: SolidField) -> LabelEdges:
        """Those of a mesh; normals are the functions' own.

        Edges are smooth where these differ by less than 14 degrees.
        """
        topology = mesh.topology
        halves = topology.halves[topology.seam_mask]
        twins = topology.twins[halves]
        labels = np.stack([mesh.labels[halves // 3], mesh.labels[twins // 3]], axis=1)
        middle = mesh.points[topology.seams].mean(axis=1)
        first, second = (_normals(field, middle, column) for column in labels.T)
        smooth = (first * second).sum(axis=1) > 0.97
        opposite = mesh.points[mesh.triangles[twins // 3, (twins + 2) % 3]]
        convex = ((opposite - middle) * first).sum(axis=1) < 0
        return cls(topology.seams, labels, smooth, ~convex & ~smooth)


def shelled(solid: Hollowable, thickness: float, without: Iterable[str], tolerance: float) -> Tree:
    """The points of a solid within `thickness` of its faces, some faces left out.

    Raises `GeometryError` where nothing would be hollow, for unknown faces, or where none is left.
    """
    mesh, field = _dense(solid, tolerance), solid.field
    names = {label: field.face(label) for label in np.unique(mesh.labels).tolist()}
    left_out = tuple(without)
    for name in left_out:
        if name not in names.values():
            raise GeometryError(
                f"the solid has no face {name!r} to open; its faces are {', '.join(dict.fromkeys(names.values()))}"
            )
    kept = [name for name in dict.fromkeys(names.values()) if name not in left_out]
    if not kept:
        raise GeometryError("a shell needs at least one face that is not open")
    edges = LabelEdges.of(mesh, field)
    for pair in np.unique(edges.labels[edges.smooth], axis=0).tolist():
        for opened, outer in permutations(names[label] for label in pair):
            if opened in left_out and outer in kept:
                raise GeometryError(
                    f"the open face {opened!r} goes on smoothly, or nearly so, in {outer!r}, where a wall has no edge "
                    "to end in: round other edges alone, as `rounded` does with the names of all faces but the open"
                )
    groups = _groups(edges, names, kept)
    walls = [
        Atom(FaceDistance(solid, group, thickness, tolerance), f"inside of {' and '.join(group)}") for group in groups
    ]
    wall = Node(tuple(walls), True) if len(walls) > 1 else walls[0]
    try:
        bounding_box(combined(False, solid.tree, complement(wall)))
    except GeometryError:
        vertices = mesh.points[np.unique(mesh.triangles[np.isin(mesh.labels, [i for i in names if names[i] in kept])])]
        raise GeometryError(
            f"the shell is thicker than the part: no point of it is {thickness:.6g} away from its faces, so nothing "
            f"would be hollow; the thickness must be below {_depth(solid, vertices):.2g}"
        ) from None
    return combined(False, solid.tree, wall)


def _groups(edges: LabelEdges, names: dict[int, str], kept: list[str]) -> list[list[str]]:
    """Faces whose inner faces are one: all that meet otherwise than in sharp convex edges."""
    number = np.array([kept.index(n) if (n := names.get(i)) in kept else -1 for i in range(max(names) + 1)])
    pairs = number[edges.labels[edges.smooth | edges.grooves]]
    pairs = pairs[(pairs >= 0).all(axis=1)]
    group = connected(pairs, len(kept))
    return [[f for f, g in zip(kept, group, strict=True) if g == own] for own in dict.fromkeys(group.tolist())]


def _depth(solid: Hollowable, vertices: Floats) -> float:
    """About how deep the solid is below its kept faces' vertices (local coordinates), by samples."""
    low, high = solid.field.box
    grid = np.stack(np.meshgrid(*np.linspace(low, high, 41).T, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = grid[solid.field.inside(solid.field.signs(grid))]
    return float(cKDTree(vertices).query(inside)[0].max(initial=0.0)) * solid.field.scale
