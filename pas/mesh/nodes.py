"""Nodes of a boundary: points where curves between faces end or cross, however the faces meet there.

Three faces that cross meet in one point, which Newton's method finds on their functions.  Bars from one point,
equal cylinders and flush ends have more surfaces through a point, and surfaces that touch there; such points are
zeros of the vector product of two gradients as well.  All of these are overdetermined systems that have a solution,
for which the Gauss-Newton method converges quadratically (Deuflhard 2011, section 4.3).

What a mesh must know of a node is whether the solid is one cone there, with one sheet of boundary: then what is on a
small sphere about it inside, and what outside, is connected.  Otherwise there is no manifold.
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as field_of
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, cKDTree

from pas.mesh.changes import Changes
from pas.mesh.field import FaceField, place_of
from pas.mesh.hull import icosphere
from pas.mesh.projection import least_norm, newton
from pas.mesh.refusals import Refusal
from pas.mesh.rows import Floats, Integers, norms
from pas.mesh.shading import unit_rows
from pas.mesh.stars import Stars
from pas.mesh.topology import edge_table, numbered
from pas.mesh.touching import FOUND, touching

SAME = 1e-7
"""Distance over the extent of the box between two nodes that are one."""

SHARP = 1e-3
"""Least singular value of unit normals: below, rounding moves a common zero, and the functions touch elsewhere."""

MOST_FACES = 6
"""Faces near a place of which all pairs and triples are tried."""

AROUND, REACH = 3.0, 4.0
"""Over a triangle's size: how far away its neighbours' faces count, and how far a node may be."""

LEVEL = 3
"""Of the sphere on which a node's surroundings are looked at: 642 points."""

LINKS = (1e-2, 1e-3)
"""Radii of such spheres over a lattice's spacing; a cone looks the same on all of them."""

PARTS = 40
"""Points of a part of a finer sphere that is certainly seen as it is."""

NOWHERE = np.empty((0, 3))

SHRINKS = (1.0, 1.4, 0.7, 2.0, 0.5, 2.8)
"""Shares of a node's reach that are tried until what is in it is a disc."""


@dataclass(frozen=True)
class Nodes:
    """Points (K, 3) of the boundary, and from how far (K,) vertices are drawn into each."""

    points: Floats
    reach: Floats

    def reaches(self, places: Floats) -> NDArray[np.bool_]:
        """Which places (N, 3) are within reach of one."""
        if not len(self.points):
            return np.zeros(len(places), dtype=bool)
        distances = np.linalg.norm(places[:, None] - self.points, axis=2)
        return np.asarray((distances < self.reach).any(axis=1))


@dataclass
class Known:
    """What was found from places that other lattices of a boundary have as well: most of them stay where they are.

    `zeros` of systems of functions by these, the start and the reach; `cones` by the node and the spacing; and where
    the edges of the last lattice are crossed.
    """

    changes: Changes | None = None

    zeros: dict[tuple[tuple[int, ...], bytes, float], Floats] = field_of(default_factory=dict)
    cones: dict[tuple[bytes, float], bool | Refusal] = field_of(default_factory=dict)


def find_nodes(
    field: FaceField,
    points: Floats,
    triangles: Integers,
    labels: Integers,
    places: Integers,
    flat: Integers,
    known: Known | None = None,
) -> Nodes | Refusal:
    """The nodes near triangles `places` of a mesh (T, 3) whose vertices are on faces of given labels.

    Near triangles `flat`, in which two faces meet flatly, they are looked for where these two touch.  What is `known`
    is not looked for again, and added to.  Refused where the solid touches itself in a node.
    """
    known = Known() if known is None else known
    all_places = np.concatenate([places, flat])
    corners = points[triangles[all_places]]
    centers = corners.mean(axis=1)
    size = 2 * np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1, initial=0.0)
    columns = 2 * (labels // 2)
    starts, functions = _systems(cKDTree(points), centers[: len(places)], size[: len(places)], columns)
    pairs = [np.unique(columns[row])[:2] for row in triangles[flat]]
    starts = np.concatenate([starts, len(places) + np.arange(len(flat))])
    functions += [(int(pair[0]), int(pair[-1])) for pair in pairs]
    found, owners = _known_zeros(field, centers[starts], functions, size[starts], known), starts
    far = np.linalg.norm(found - centers[owners], axis=1) / size[owners]
    kept = np.flatnonzero(far < REACH)
    kept = kept[np.argsort(far[kept], kind="stable")]
    extent = float(np.ptp(field.box, axis=0).max())
    nodes, reach, done = [], [], np.zeros(len(all_places), dtype=bool)
    for row in kept:
        if done[owners[row]]:
            continue
        own = np.linalg.norm(found - found[row], axis=1) < SAME * extent
        radius = float(np.linalg.norm(centers[owners[own]] - found[row], axis=1).max() + size[owners[own]].max())
        key = found[row].tobytes(), float(size[owners[row]])
        if key not in known.cones:
            known.cones[key] = _is_cone(field, found[row], key[1])
        cone = known.cones[key]
        if isinstance(cone, Refusal):
            return cone
        if cone:
            nodes.append(found[row])
            reach.append(radius)
            done[owners[own]] = True
    return _apart(np.array(nodes).reshape(-1, 3), np.array(reach))


def _systems(tree: cKDTree, centers: Floats, size: Floats, columns: Integers) -> tuple[Integers, list[tuple[int, ...]]]:
    """What may meet near centres: for each system of functions, the centre's row and the functions."""
    rows, systems = [], []
    for row, near in enumerate(tree.query_ball_point(centers, AROUND * size)):
        distance = np.linalg.norm(tree.data[near] - centers[row], axis=1)
        close = dict.fromkeys(int(columns[near[k]]) for k in np.argsort(distance, kind="stable"))
        few = sorted(list(close)[:MOST_FACES])
        own = [tuple(few)] if len(few) > 3 else []
        own += [*combinations(few, 3), *combinations(few, 2)]
        systems += own
        rows += [row] * len(own)
    return np.array(rows, dtype=np.intp), systems


def _known_zeros(
    field: FaceField, starts: Floats, systems: list[tuple[int, ...]], reach: Floats, known: Known
) -> Floats:
    """The zeros (K, 3) that `_solved` finds, those that are known looked up."""
    keys = [(s, p.tobytes(), r) for s, p, r in zip(systems, starts, reach.tolist(), strict=True)]
    new = [row for row, key in enumerate(keys) if key not in known.zeros]
    found = _solved(field, starts[new], [systems[row] for row in new], reach[new])
    known.zeros.update((keys[row], zero) for row, zero in zip(new, found, strict=True))
    return np.array([known.zeros[key] for key in keys]).reshape(-1, 3)


def _solved(field: FaceField, starts: Floats, systems: list[tuple[int, ...]], reach: Floats) -> Floats:
    """A common zero of each system near its start (N, 3), of two functions one where they touch; NaN where none."""
    result = np.full(starts.shape, np.nan)
    extent = float(np.ptp(field.box, axis=0).max())
    lengths = np.array([len(s) for s in systems], dtype=np.intp)
    for length in np.unique(lengths):
        rows = np.flatnonzero(lengths == length)
        functions = np.array([systems[row] for row in rows], dtype=np.intp)
        if length == 2:
            result[rows] = touching(field, starts[rows], functions, reach[rows])
            continue
        end = newton(starts[rows], field, functions, reach[rows])
        jets = np.stack([field.jets(end, column) for column in functions.T], axis=1)
        units = unit_rows(jets[..., 1:])
        off = np.abs(jets[..., 0]) / np.maximum(np.linalg.norm(jets[..., 1:], axis=2), 1e-300)
        sharp = np.linalg.svd(units, compute_uv=False)[:, 2] > SHARP
        result[rows] = np.where((sharp & (off.max(axis=1) < FOUND * extent))[:, None], end, np.nan)
    return result


def _is_cone(field: FaceField, node: Floats, spacing: float) -> bool | Refusal:
    """Whether the boundary is one sheet at a node, as its links show; refused where it is pinched there."""
    if all(len(inside) == len(outside) == 1 for inside, outside in _links(field, node, spacing, LEVEL)):
        return True
    finer = _links(field, node, spacing, LEVEL + 1)
    if all(max(len(inside), len(outside)) > 1 and min(*inside, *outside, PARTS) == PARTS for inside, outside in finer):
        return Refusal(
            f"the solid could not be meshed: near {place_of(field, node)} it touches itself in a point or an edge, "
            "so that its boundary is no surface there; let its parts overlap or keep them apart"
        )
    return False


def _links(field: FaceField, node: Floats, spacing: float, level: int) -> list[tuple[list[int], list[int]]]:
    """Of each small sphere the numbers of points in its connected parts that are inside, and of those outside."""
    units, edges = _sphere(level)
    number, count = len(units), len(LINKS)
    radii = spacing * np.array(LINKS)
    inside = field.inside(field.signs((node + radii[:, None, None] * units).reshape(-1, 3)))
    every = (edges + number * np.arange(count)[:, None, None]).reshape(-1, 2)
    kept = every[inside[every[:, 0]] == inside[every[:, 1]]]
    part = connected_components(coo_array((np.ones(len(kept)), kept.T), shape=(len(inside),) * 2), directed=False)[1]
    first, times = np.unique(part, return_index=True, return_counts=True)[1:]
    parts = [(times[first // number == k], inside[first[first // number == k]]) for k in range(count)]
    return [(sizes[within].tolist(), sizes[~within].tolist()) for sizes, within in parts]


@cache
def _sphere(level: int) -> tuple[Floats, Integers]:
    """Points on the unit sphere and which of them are next to each other."""
    units = icosphere(level)[0]
    return units, edge_table(ConvexHull(units).simplices.astype(np.intp))[0]


def _apart(points: Floats, reach: Floats) -> Nodes:
    """Nodes none of which reaches to the middle between two."""
    if len(points) > 1:
        nearest = cKDTree(points).query(points, 2)[0][:, 1]
        reach = np.minimum(reach, nearest / 2)
    return Nodes(points, reach)


def contracted(
    field: FaceField, points: Floats, triangles: Integers, labels: Integers, nodes: Nodes
) -> tuple[Floats, Integers, Integers, Integers] | Nodes:
    """The mesh (points, triangles, labels, the nodes' vertices) with all within reach of a node drawn into one vertex.

    Only what is a disc is; where it is none the result is the nodes in question.
    """
    failed, drawn, close = np.zeros(len(nodes.points), dtype=bool), [], SAME * float(np.ptp(field.box, axis=0).max())
    stars, points = Stars(triangles, labels, len(points)), points.copy()
    for number, (node, reach) in enumerate(zip(nodes.points, nodes.reach, strict=True)):
        distance = np.where(stars.used, norms(points - node), np.inf)
        center = int(distance.argmin())
        for share in SHRINKS:
            found = stars.drawn(np.flatnonzero(distance < share * reach), center)
            if found is not None and _meet(field, node, found.labels, close):
                break
        else:
            failed[number] = True
            continue
        stars.draw(found)
        points[center] = node
        drawn.append(center)
    if failed.any():
        return Nodes(nodes.points[failed], nodes.reach[failed])
    triangles, labels = stars.triangles[stars.left], stars.labels[stars.left]
    used, numbers = numbered(triangles.ravel())
    return points[used], numbers.reshape(-1, 3), labels, np.flatnonzero(np.isin(used, drawn))


def _meet(field: FaceField, node: Floats, labels: Integers, close: float) -> bool:
    """Whether the faces of given labels pass through a node."""
    labels = np.unique(labels)
    steps = least_norm(field, labels[:, None], np.tile(node, (len(labels), 1)))
    return bool(np.abs(steps).max(initial=0.0) < close)
