"""Nodes of a boundary: points where curves between faces end or cross, however the faces meet there.

Three faces that cross meet in one point, which Newton's method finds on their functions.  Bars from one point,
equal cylinders and flush ends have more surfaces through a point, and surfaces that touch there: f = g = 0 and
grad f x grad g = 0.  All of these are overdetermined systems that have a solution, for which the Gauss-Newton method
converges quadratically (Deuflhard 2011, section 4.3), but where surfaces touch along a curve: of points on such a curve
none is given.

What a mesh must know of a node is whether the solid is one cone there, with one sheet of boundary: then what is on a
small sphere about it inside, and what outside, is connected.  Otherwise there is no manifold.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from pas.algebra.lengths import spiral
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.field import FaceField, column_of, extent_of, label_of, place_of
from pas.mesh.labelled import Labelled
from pas.mesh.projection import distances, least_norm, least_solutions, newton, second_derivatives
from pas.mesh.refusals import RefusalError
from pas.mesh.rows import any_of, cross, norms
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected, edge_table, numbered, pinched, same_places

SAME = 1e-7
"""Distance over the extent of the box between two nodes that are one."""

SHARP = 1e-3
"""Least singular value of unit normals: below, rounding moves a common zero, and the functions touch elsewhere."""

AROUND, REACH = 3.0, 4.0
"""Over a triangle's size: how far away its neighbours' faces count, and how far a node may be."""

AROUND_NODE = 642
"""Points of the sphere on which a node's surroundings are looked at."""

LINKS = (1e-2, 1e-3)
"""Radii of such spheres over a lattice's spacing; a cone looks the same on all of them."""

PARTS = 40
"""Points of a part of a finer sphere that is certainly seen as it is."""

FLAT = 0.3
"""Sine of the angle between faces below which they are looked at for a point where they touch."""

FOUND, PARALLEL = 1e-10, 1e-5
"""Distance over the extent of the box up to which a point is on a surface; sine up to which gradients are parallel."""


@dataclass(frozen=True)
class Nodes:
    """Points (K, 3) of the boundary, and from how far (K,) vertices are drawn into each."""

    points: Floats
    reach: Floats

    def reaches(self, places: Floats) -> Bools:
        """Which places (N, 3) are within reach of one."""
        if not len(self.points):
            return np.zeros(len(places), dtype=bool)
        distances = np.linalg.norm(places[:, None] - self.points, axis=2)
        return np.asarray((distances < self.reach).any(axis=1))


def find_nodes(
    field: FaceField,
    points: Floats,
    triangles: Integers,
    labels: Integers,
    places: Integers,
    flat: Integers,
) -> Nodes:
    """The nodes near triangles `places` of a mesh (T, 3) whose vertices are on faces of given labels.

    Near triangles `flat`, in which two faces meet flatly, they are looked for where these two touch.  Raises
    `RefusalError` where the solid touches itself in a node.
    """
    all_places = np.concatenate([places, flat])
    corners = points[triangles[all_places]]
    centers = corners.mean(axis=1)
    size = 2 * np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1, initial=0.0)
    columns = label_of(column_of(labels))
    starts, functions = _systems(field, cKDTree(points), centers[: len(places)], size[: len(places)], columns)
    pairs = [np.unique(columns[row])[:2] for row in triangles[flat]]
    starts = np.concatenate([starts, len(places) + np.arange(len(flat))])
    functions += [(int(pair[0]), int(pair[-1])) for pair in pairs]
    found, owners = _solved(field, centers[starts], functions, size[starts]), starts
    far = np.linalg.norm(found - centers[owners], axis=1) / size[owners]
    kept = np.flatnonzero(far < REACH)
    kept = kept[np.argsort(far[kept], kind="stable")]
    extent = extent_of(field)
    nodes, reach, done = [], [], np.zeros(len(all_places), dtype=bool)
    for row in kept:
        if done[owners[row]]:
            continue
        own = np.linalg.norm(found - found[row], axis=1) < SAME * extent
        near = own & ((owners < len(places)) | (np.arange(len(own)) == row))  # where flat, curves come out elsewhere
        radius = float(np.linalg.norm(centers[owners[near]] - found[row], axis=1).max() + size[owners[near]].max())
        if _is_cone(field, found[row], float(size[owners[row]])):
            nodes.append(found[row])
            reach.append(radius)
            done[owners[own]] = True
    return _apart(np.array(nodes).reshape(-1, 3), np.array(reach))


def pinched_at(field: FaceField, point: Floats) -> RefusalError:
    """The refusal of a boundary that is no surface at a point (3,)."""
    return RefusalError(
        f"the solid could not be meshed: near {place_of(field, point)} it touches itself in a point or an edge, "
        "so that its boundary is no surface there; let its parts overlap or keep them apart"
    )


def check_crossing_edges(field: FaceField, ends: Floats, functions: Integers, reach: Floats, room: float) -> None:
    """Raise `RefusalError` where two edges (N, 2, 2, 3) cross, within `room` of both, on curves of functions (N, 4), so
    that the boundary is no surface there."""
    found = _solved(field, ends.mean(axis=(1, 2)), [*map(tuple, functions.tolist())], reach)
    inside = (found[:, None] >= ends.min(axis=2) - room) & (found[:, None] <= ends.max(axis=2) + room)
    for row in np.flatnonzero(inside.all(axis=(1, 2))):
        _is_cone(field, found[row], float(reach[row]))  # or it raises


def flat_nodes(field: FaceField, mesh: Labelled) -> Nodes:
    """The nodes near edges of a labelled mesh in which two faces meet flatly: where these touch."""
    edges, labels = mesh.topology.edge_table
    rows = np.flatnonzero(labels[:, 0] != labels[:, 1])
    ends, pairs = mesh.points[edges[rows]], label_of(column_of(labels[rows]))
    middles, size = ends.mean(axis=1), norms(ends[:, 1] - ends[:, 0])
    flat = norms(cross(*(unit_rows(field.jets(middles, column)[:, 1:]) for column in pairs.T))) < FLAT
    found = _touching(field, middles[flat], pairs[flat], size[flat])
    kept = np.flatnonzero(norms(found - middles[flat]) < REACH * size[flat])  # not where it is no number
    firsts = same_places((found[kept] / (SAME * extent_of(field))).round())[0]
    return _apart(found[kept][firsts], size[flat][kept][firsts])


def _systems(
    field: FaceField, tree: cKDTree, centers: Floats, size: Floats, columns: Integers
) -> tuple[Integers, list[tuple[int, ...]]]:
    """The systems of functions that may have a common zero near centres: for each, the centre's row and the functions.

    Of faces that touch along a known curve those that determine it are taken.
    """
    rows, systems = [], []
    for row, near in enumerate(tree.query_ball_point(centers, AROUND * size)):
        distance = np.linalg.norm(tree.data[near] - centers[row], axis=1)
        close = dict.fromkeys(int(columns[near[k]]) for k in np.argsort(distance, kind="stable"))
        most_faces = 6  # faces near a place of which all pairs and triples are tried
        few = sorted(list(close)[:most_faces])
        own = [tuple(few)] if len(few) > 3 else []
        own += [*combinations(few, 3), *combinations(few, 2)]
        systems += [field.functions(labels) for labels in own]
        rows += [row] * len(own)
    return np.array(rows, dtype=np.intp), systems


def _solved(field: FaceField, starts: Floats, systems: list[tuple[int, ...]], reach: Floats) -> Floats:
    """A common zero of each system near its start (N, 3), of two functions one where they touch; NaN where none."""
    result = np.full(starts.shape, np.nan)
    extent = extent_of(field)
    lengths = np.array([len(s) for s in systems], dtype=np.intp)
    for length in np.unique(lengths):
        rows = np.flatnonzero(lengths == length)
        functions = np.array([systems[row] for row in rows], dtype=np.intp)
        if length == 2:
            result[rows] = _touching(field, starts[rows], functions, reach[rows])
            continue
        end = newton(starts[rows], field, functions, reach[rows])
        units = np.stack([unit_rows(field.jets(end, column)[:, 1:]) for column in functions.T], axis=1)
        off = np.max([distances(field, end, column) for column in functions.T], axis=0)
        sharp = np.linalg.svd(units, compute_uv=False)[:, 2] > SHARP
        result[rows] = np.where((sharp & (off < FOUND * extent))[:, None], end, np.nan)
    return result


def _is_cone(field: FaceField, node: Floats, spacing: float) -> bool:
    """Whether the boundary is one sheet at a node, as its links show; raises `RefusalError` where it is pinched."""
    if all(len(inside) == len(outside) == 1 for inside, outside in _links(field, node, spacing, AROUND_NODE)):
        return True
    finer = _links(field, node, spacing, 4 * AROUND_NODE)
    if all(max(len(inside), len(outside)) > 1 and min(*inside, *outside, PARTS) == PARTS for inside, outside in finer):
        raise pinched_at(field, node)
    return False


def _links(field: FaceField, node: Floats, spacing: float, number: int) -> list[tuple[list[int], list[int]]]:
    """For each small sphere the sizes of its connected parts that are inside, and of those outside."""
    (units, edges), count = _sphere(number), len(LINKS)
    radii = spacing * np.array(LINKS)
    inside = field.inside(field.signs((node + radii[:, None, None] * units).reshape(-1, 3)))
    every = (edges + number * np.arange(count)[:, None, None]).reshape(-1, 2)
    kept = every[inside[every[:, 0]] == inside[every[:, 1]]]
    first, times = np.unique(connected(kept, len(inside)), return_index=True, return_counts=True)[1:]
    parts = [(times[first // number == k], inside[first[first // number == k]]) for k in range(count)]
    return [(sizes[within].tolist(), sizes[~within].tolist()) for sizes, within in parts]


@cache
def _sphere(number: int) -> tuple[Floats, Integers]:
    """A `number` of points on the unit sphere, and which are next to each other."""
    units = spiral(number)
    return units, edge_table(ConvexHull(units).simplices.astype(np.intp))[0]


def _apart(points: Floats, reach: Floats) -> Nodes:
    """Nodes none of which reaches to the middle between two."""
    if len(points) > 1:
        nearest = cKDTree(points).query(points, 2)[0][:, 1]
        reach = np.minimum(reach, nearest / 2)
    return Nodes(points, reach)


def _touching(field: FaceField, points: Floats, pairs: Integers, reach: Floats) -> Floats:
    """The points (N, 3) near given ones where the functions of two labels (N, 2) vanish with parallel gradients.

    NaN where none is found within steps of `reach` (N,).
    """
    extent = extent_of(field)
    lengths = [np.linalg.norm(field.jets(points, column)[:, 1:], axis=1) for column in pairs.T]
    scale = 1 / np.maximum(np.stack(lengths, axis=1), 1e-300)
    points, active, still = points.copy(), np.arange(len(points)), 1e-15 * extent
    for _ in range(24):  # quadratic convergence takes fewer; where there is none the steps do not become still
        checkpoint()
        value, matrix = _system(field, points[active], pairs[active], scale[active], reach[active])
        step = -least_solutions(matrix, value)
        length = np.sqrt((step * step).sum(axis=1))
        points[active] += step * np.minimum(1.0, reach[active] / np.maximum(length, 1e-300))[:, None]
        active = active[length > still]  # not where it is NaN
        if not len(active):
            break
    found = np.asarray(np.isfinite(points).all(axis=1))
    here, functions = points[found], pairs[found]
    off = [distances(field, here, column) for column in functions.T]
    sine = norms(cross(*(unit_rows(field.jets(here, column)[:, 1:]) for column in functions.T)))
    found[found] = (np.max(off, axis=0) < FOUND * extent) & (sine < PARALLEL)
    matrix = _system(field, points[found], pairs[found], scale[found], reach[found])[1]
    isolated = 1e-3  # least singular value, in the scale of `reach`, above which no curve of such points passes
    found[found] = np.linalg.svd(matrix, compute_uv=False)[:, 2] > isolated
    points[~found] = np.nan
    return points


def _system(field: FaceField, points: Floats, pairs: Integers, scale: Floats, size: Floats) -> tuple[Floats, Floats]:
    """The equations' values (N, 5) and derivatives (N, 5, 3).

    `scale` (N, 2) are factors of functions, `size` (N,) of the gradients' product.
    """
    jets = [field.jets(points, label) * factor[:, None] for label, factor in zip(pairs.T, scale.T, strict=True)]
    (a, b), bends = (jet[:, None, 1:] for jet in jets), (second_derivatives(field, points, label) for label in pairs.T)
    bend_a, bend_b = (bend * factor[:, None, None] for bend, factor in zip(bends, scale.T, strict=True))
    turn = np.cross(bend_a, b) + np.cross(a, bend_b)  # row k: the product's derivative along axis k
    value = np.concatenate([*(jet[:, :1] for jet in jets), size[:, None] * np.cross(a, b)[:, 0]], axis=1)
    matrix = np.concatenate([a, b, size[:, None, None] * turn.transpose(0, 2, 1)], axis=1)
    return value, matrix


def contracted(
    field: FaceField, points: Floats, triangles: Integers, labels: Integers, nodes: Nodes
) -> tuple[Floats, Integers, Integers, Integers] | Nodes:
    """The mesh (points, triangles, labels, the nodes' vertices) with all within reach of a node drawn into one vertex.

    Only what is a disc is; where it is none the result is the nodes in question.
    """
    failed, drawn, close = np.zeros(len(nodes.points), dtype=bool), [], SAME * extent_of(field)
    points = points.copy()
    for number, (node, reach) in enumerate(zip(nodes.points, nodes.reach, strict=True)):
        used = np.zeros(len(points), dtype=bool)
        used[triangles] = True
        distance = np.where(used, norms(points - node), np.inf)
        center = int(distance.argmin())
        shares = 1.0, 1.4, 0.7  # of a node's reach: what is within one of these is a disc
        found = (_drawn_into(center, distance < share * reach, triangles, labels) for share in shares)
        best = next((f for f in found if f and _meet(field, node, f[1][(f[0] == center).any(axis=1)], close)), None)
        failed[number] = best is None
        if best is not None:
            triangles, labels = best
            points[center] = node
            drawn.append(center)
    if failed.any():
        return Nodes(nodes.points[failed], nodes.reach[failed])
    used, numbers = numbered(triangles.ravel())
    return points[used], numbers.reshape(-1, 3), labels, np.flatnonzero(np.isin(used, drawn))


def _meet(field: FaceField, node: Floats, labels: Integers, close: float) -> bool:
    """Whether the faces of given labels pass through a node."""
    labels = np.unique(labels)
    steps = least_norm(field, labels[:, None], np.tile(node, (len(labels), 1)))
    return bool(np.abs(steps).max(initial=0.0) < close)


def _drawn_into(center: int, near: Bools, triangles: Integers, labels: Integers) -> tuple[Integers, Integers] | None:
    """Triangles (T, 3) and labels (T,) with vertices `near` (N,) drawn into one of them, the centre.

    None where these are no disc, a label would be lost, or a vertex is no more surrounded by one fan.
    """
    near[center] = True
    is_near = near[triangles]
    rows = np.flatnonzero(any_of(is_near))
    before, is_near = triangles[rows], is_near[rows]
    inner = near[edge_table(before[is_near.sum(axis=1) > 1])[0]].all(axis=1).sum()
    if near.sum() - inner + is_near.all(axis=1).sum() != 1:
        return None
    after, kept = triangles.copy(), np.ones(len(triangles), dtype=bool)
    after[rows] = np.where(is_near, center, before)
    kept[rows] = (after[rows] != after[rows][:, [1, 2, 0]]).all(axis=1)
    about = np.zeros(len(near), dtype=bool)
    about[after[rows]] = True
    beside = kept & any_of(about[after])
    if not np.isin(labels[rows], labels[kept]).all() or len(pinched(after[beside], about)):
        return None
    return after[kept], labels[kept]
