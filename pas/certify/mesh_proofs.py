"""The proof that a mesh is a surface: the same topology, and how far it is from it at most, however it was made.

That of topology is the theorem of docs/theory/meshes.md, with its field v, along which f rises, and its number w, which
drops by 1 where one leaves through a triangle.  The zeros of v are enclosed by simplices of the cells, the outer faces,
the edges and the ends (see `pas.certify.local_mesh`), the triangles are bounded by Bernstein forms
(`pas.certify.mesh_bounds`), w is counted along segments from the centre (`pas.certify.graph_proofs.crossed`).  All
count their rounding.  Points of the boundary may be off the walls by rounding, and are then taken to be on them.

Where v is not seen to cross all triangles, as where they are large beside a sharp edge, the mesh is the surface as well
if both are graphs over the same directions from the centre (see `pas.certify.graph_proofs`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.bernstein.search import Searched
from pas.bernstein.simplices import Simplices
from pas.certify.certificate import Certificate
from pas.certify.graph_proofs import CLAIM, certify_graph, crossed
from pas.certify.local_mesh import OFF, ON_WALL, FramedMesh, FramedSurface, critical_parts
from pas.certify.mesh_bounds import along_walls, apart, bounds, farthest
from pas.mesh.topology import Edges, connected, same_places
from pas.verdicts import Findings, Point, Status, Verdict

BORDER = "a manifold that ends on the walls"


@dataclass(frozen=True)
class MeshCertificate(Findings):
    """The verdicts on a mesh of a surface.

    `distance` is the largest of the mesh's points from the zeros, proved, in the model's units, None where it is not
    known; `places` are points (x, y, z) where it could not be decided that the topology is that of the surface.
    """

    distance: float | None = None
    places: tuple[Point, ...] = field(default=())


def certify_mesh(
    local: FramedSurface, points: Floats, triangles: Integers, promised: Callable[[], Certificate]
) -> MeshCertificate:
    """The verdicts on a mesh (N, 3), (T, 3) of a surface: whether it is its boundary on walls, topology, distance.

    `promised` gives the surface's own certificate, which meshes of surfaces in open regions rest on.
    """
    edges = Edges(triangles, int(triangles.max(initial=0)) + 1)
    if not len(triangles) or not edges.manifold:
        verdict = Verdict(Status.REFUTED, "a manifold", "there are no triangles, or some edge does not have one or two")
        return MeshCertificate((verdict,), partly_measured=True)
    mesh = FramedMesh(local, points, triangles)
    if np.abs(mesh.points).max() > mesh.local.reach:
        return MeshCertificate((Verdict(Status.REFUTED, BORDER, "a vertex is outside the region"),))
    most, least = bounds(mesh)
    if any(join.opening for join in local.function.joins):
        near, distance = _distance(mesh, most, least, closed=False)
        verdicts = (*certify_graph(mesh, edges, promised), _vertices(mesh), near)
        places = tuple(v.witness for v in verdicts if v.witness is not None)
        return MeshCertificate(verdicts, partly_measured=True, distance=distance, places=places)
    chain, borders = _border(mesh, edges)
    if chain.proved:
        topology, places = _topology(mesh, most, least, borders)
        if not topology.proved and local.function.joins and local.center is not None:
            _, seen = certify_graph(mesh, edges, promised)
            topology, places = (seen, ()) if seen.proved else (topology, places)
    else:
        topology = Verdict(Status.UNDECIDED, CLAIM, "the mesh does not end on the walls")
        places = () if chain.witness is None else (chain.witness,)
    near, distance = _distance(mesh, most, least, closed=not len(edges.rim))
    verdicts = (chain, _vertices(mesh), topology, near)
    return MeshCertificate(verdicts, partly_measured=True, distance=distance, places=places)


def _vertices(mesh: FramedMesh) -> Verdict:
    """How near the vertices are, to first order: what a vertex that was moved fails."""
    claim, local = "vertices on the surface", mesh.local
    values, gradients = local.jets(mesh.points)
    with np.errstate(all="ignore"):
        off = np.where(values == 0, 0.0, np.abs(values) / np.sqrt((gradients * gradients).sum(axis=0)))
    if np.isnan(off).any():
        place = mesh.points[int(np.isnan(off).argmax())]
        return Verdict(Status.FAILS_MEASURED, claim, "one is outside the region", local.frame.place(place))
    worst = int(off.argmax())
    if off[worst] <= OFF:
        reason = f"|f| / |grad f| is at most {off[worst] * local.scale:.1g} at all {len(off)} of them"
        return Verdict(Status.HOLDS_MEASURED, claim, reason)
    reason = f"|f| / |grad f| is {off[worst] * local.scale:.2g} at one"
    return Verdict(Status.FAILS_MEASURED, claim, reason, local.frame.place(mesh.points[worst]))


def _border(mesh: FramedMesh, edges: Edges) -> tuple[Verdict, list[tuple[Floats, Bools]]]:
    """Whether the mesh is in the region and ends on its walls, and with what directions and vertices of which walls."""
    claim, local, points = BORDER, mesh.local, mesh.points
    middles, wall = points[edges.rim].mean(axis=1), np.full(len(edges.rim), -1)
    inside, on = local.placed(np.concatenate([points, middles]))
    used = np.flatnonzero(np.bincount(mesh.triangles.ravel(), minlength=len(points)))
    if not inside[used].all():
        place = points[used[~inside[used]][0]]
        return Verdict(Status.REFUTED, claim, "a vertex is outside the region", local.frame.place(place)), []
    touches = np.zeros(len(points), dtype=bool)
    for number, rows in enumerate(on):
        first = np.searchsorted(rows, len(points))
        touches[rows[:first]] = True
        wall[rows[first:] - len(points)] = number
    if (wall < 0).any():
        place = middles[wall < 0][0]
        return Verdict(Status.REFUTED, claim, "the mesh ends inside the region", local.frame.place(place)), []
    touches[edges.rim] = False
    if touches[used].any():
        place = points[used[touches[used]][0]]
        return Verdict(Status.UNDECIDED, claim, "the mesh touches a wall from inside", local.frame.place(place)), []
    how = f"with {len(edges.rim)} edges on the walls" if len(edges.rim) else "closed"
    return Verdict(Status.PROVED, claim, f"every inner edge has two triangles; {how}"), _borders(mesh, edges, wall)


def _borders(mesh: FramedMesh, edges: Edges, wall: Integers) -> list[tuple[Floats, Bools]]:
    """For each wall its normal and the vertices of edges on it; the same for pairs of walls with common vertices."""
    on, local = {}, mesh.local
    for number in np.unique(wall).tolist():
        on[number] = np.zeros(len(mesh.points), dtype=bool)
        on[number][edges.rim[wall == number]] = True
    normals = local.planes[:, :3]
    result = [(normals[[n]], vertices) for n, vertices in on.items()]
    pairs = [(i, j, both) for i, j in combinations(on, 2) if (both := on[i] & on[j]).any()]
    planes = normals[np.array([pair[:2] for pair in pairs], dtype=np.intp).reshape(-1, 2)]
    across = np.linalg.qr(planes.transpose(0, 2, 1))[0].transpose(0, 2, 1)
    return [*result, *((way, both) for way, (_, _, both) in zip(across, pairs, strict=True))]


def _topology(
    mesh: FramedMesh, most: Floats, least: Floats, borders: list[tuple[Floats, Bools]]
) -> tuple[Verdict, tuple[Point, ...]]:
    local = mesh.local
    if local.center is None:
        return _undecided(local, "the region has no centre from which to count", np.empty((0, 3)))
    if not local.meets_smoothly:
        return _undecided(local, "the pieces are not proved to meet with continuous gradients", np.empty((0, 3)))
    flat = ~(least > 0)
    if flat.any():
        places = mesh.corners[flat].mean(axis=1)
        return _undecided(local, f"{int(flat.sum())} triangles may be turned from the gradient", places)
    steep, numbers = along_walls(mesh, borders)
    if not (steep > 0).all():
        places = mesh.corners[numbers[~(steep > 0)]].mean(axis=1)
        return _undecided(local, "the surface may be tangential to a wall", places)
    parts = local.isolated
    if not any(len(part.open) for part in parts):
        parts = _critical(mesh, most * (1 + 1e-9))  # more than the rounding of what it is compared with
    left = np.concatenate([part.open.corners.mean(axis=1) for part in parts])
    if len(left):
        return _undecided(local, "the surface may be singular, or closer to itself than to the mesh", left)
    return _counted(mesh, parts)


def _undecided(
    local: FramedSurface, reason: str, places: Floats, examined: int = 0
) -> tuple[Verdict, tuple[Point, ...]]:
    """The verdict that it is open whether the topology is right, with some of many places (N, 3), far apart."""
    most = 8  # places that are told
    chosen, far = list[Point](), np.full(len(places), np.inf)
    while len(chosen) < most and len(places) and (not chosen or far.max() > 1e-2):
        here = places[int(far.argmax())]
        chosen.append(local.frame.place(here))
        far = np.minimum(far, np.sqrt(((places - here) ** 2).sum(axis=1)))
    return Verdict(Status.UNDECIDED, CLAIM, reason, chosen[0] if chosen else None, examined), tuple(chosen)


def _critical(mesh: FramedMesh, most: Floats) -> list[Searched[Simplices]]:
    """Where f may have critical points in each of the strata, free of triangles on which |f| is `most` (T,) at most."""
    size, largest = mesh.local.size, most.max()
    a, b, c = (np.ascontiguousarray(mesh.corners[:, i].T) for i in range(3))
    starts, ends = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)

    def meeting(low: Floats, high: Floats) -> Integers:
        """The numbers of triangles whose boxes meet one."""
        rows = np.flatnonzero((starts[0] <= high[0]) & (ends[0] >= low[0]))
        for axis in (1, 2):
            rows = rows[(starts[axis, rows] <= high[axis]) & (ends[axis, rows] >= low[axis])]
        return rows

    def free(least: Floats, simplices: Floats) -> Bools:
        result = np.asarray((least > 0) & (least * size > largest))
        near = np.flatnonzero((least > 0) & ~result)
        if len(near) * len(mesh.corners) <= 4_000_000:  # a second's work; others are cut first
            low, high = simplices[near].min(axis=1) - ON_WALL, simplices[near].max(axis=1) + ON_WALL
            met = [*map(meeting, low, high)]
            rows, triangles = np.repeat(near, [len(some) for some in met]), np.concatenate([*met, near[:0]])
            close = most[triangles] >= least[rows] * size
            rows, triangles = rows[close], triangles[close]
            free_of = apart(simplices[rows], mesh.corners[triangles], mesh.normals[triangles])
            result[near] = True
            result[rows[~free_of]] = False
        return result

    return [critical_parts(found, free) for found in mesh.local.isolated]


def _grouped(parts: list[Floats]) -> list[list[int]]:
    """The numbers of simplices, given as tables (R, d + 1, 3), by connected unions, the largest of each first.

    Those with a common corner are in one.
    """
    counts = np.concatenate([np.full(len(part), part.shape[1]) for part in parts])
    corners = same_places(np.concatenate([part.reshape(-1, 3) for part in parts]))[1]
    ends = np.stack([np.repeat(np.arange(len(counts)), counts), len(counts) + corners], axis=1)
    label = connected(ends, len(counts) + len(corners)).tolist()
    extents = np.concatenate([np.ptp(part, axis=1).sum(axis=1) for part in parts])
    groups: dict[int, list[int]] = {}
    for number in np.argsort(-extents, kind="stable").tolist():
        groups.setdefault(label[number], []).append(number)
    return list(groups.values())


def _counted(mesh: FramedMesh, parts: list[Searched[Simplices]]) -> tuple[Verdict, tuple[Point, ...]]:
    """Whether the mesh is crossed as the surface is between all critical points.

    None of them is on the mesh, so one of each group with common corners stands for all.
    """
    local, examined = mesh.local, sum(part.examined for part in parts)
    simplices = [simplex for part in parts for simplex in part.kept.corners]
    signs = np.concatenate([np.sign(part.kept.table[:, 0]) for part in parts])
    groups = _grouped([part.kept.corners for part in parts])
    times, ends = np.zeros(len(groups), dtype=np.intp), np.zeros((len(groups), 3))
    known, inside = np.zeros(len(groups), dtype=bool), signs[[group[0] for group in groups]] < 0
    assert local.center is not None
    origin = local.center + local.room * np.array([0.213, 0.127, -0.171])
    for attempt in range(6):  # other points, where a segment grazes an edge
        rows = np.flatnonzero(~known)
        for row in rows.tolist():
            simplex = simplices[groups[row][attempt % len(groups[row])]]
            weights = 1 + 0.618 * np.sin(2.4 * np.arange(1, len(simplex) + 1) + attempt)
            ends[row] = weights @ simplex / weights.sum()
        times[rows], known[rows] = crossed(mesh.points, mesh.triangles, origin, ends[rows])
        if known.all():
            break
    if not known.all():
        return _undecided(local, "crossings could not be counted for sure", ends[~known])
    excess = times + inside  # the same for all where the mesh is the surface
    wrong = np.flatnonzero(excess != excess[:1])  # as for the largest part, which small ones may outnumber
    if len(wrong):
        # no refutation: coarse meshes pass by places next to the surface whose changes cancel one another
        reason = (
            f"{len(wrong)} of {len(groups)} places at which f rests are on the wrong side: a component is missing or "
            "too many, or the mesh is too coarse there"
        )
        return _undecided(local, reason, ends[wrong], examined)
    reason = (
        f"f rises across all {len(mesh.triangles)} triangles, and {len(groups)} parts that hold all its critical "
        f"points are on the right side of the mesh; {examined} simplices"
    )
    return Verdict(Status.PROVED, CLAIM, reason, measure=examined), ()


def _distance(mesh: FramedMesh, most: Floats, least: Floats, closed: bool) -> tuple[Verdict, float | None]:
    """The largest distance of the mesh's points from the zeros, here or just beyond the walls."""
    local, way = mesh.local, farthest(mesh, most, least)
    if way is None or not np.isfinite(way).all():
        place, reason = None, "the gradient may vanish too near to a triangle"
        if way is not None:
            worst = np.flatnonzero(~np.isfinite(way))[0]
            place = local.frame.place(mesh.corners[worst].mean(axis=0))
            if least[worst] > 0:
                reason = "the triangles there are too large to bound it: try a smaller tolerance"
        return Verdict(Status.UNDECIDED, "a distance from the surface", reason, place), None
    far = float(way.max()) * local.scale
    beyond = "" if closed else ", in pieces that go on beyond the walls"
    reason = f"f < 0 and f > 0 so near to all points of triangles, along normals or rays from the centre{beyond}"
    return Verdict(Status.PROVED, f"within {far:.3g} of the surface", reason), far
