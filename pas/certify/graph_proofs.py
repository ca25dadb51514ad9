"""The proof that a mesh has the topology of a surface that is a graph over directions: it is one over the same.

A surface that is proved to be continuous, to have one sheet and to be enclosed is a graph over the sphere of directions
less those that lead out through clip faces where f_i < 0, or through an opening (theorem 7 of docs/theory/verdicts.md).
These are one disc a curve: f_i > 0 all around a clip face, and where a polynomial of degree 2 is negative on such a
face an ellipse bounds; of a higher degree there may be several, and nothing is proved.  However sharp the surface is,
and wherever its gradient points beside triangles, a mesh is such a graph as well if

- each triangle is seen from the centre with its outside away, so that looking from there is one to one near each point,
  but for vertices that are gone round more than once;
- its boundary is one loop on each contact's curve, which goes round the middle of that once, and no loop is inside
  another's: they bound discs, and a part of the sphere that is left;
- a ray into each of the discs crosses no triangle, however far it goes.  The number of triangles that a ray crosses is
  the same all over each part, and changes by one across a loop: it is one where the surface is, and nothing covers a
  disc a second time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from pas.algebra.lengths import across, angle_between
from pas.arrays import Bools, Floats, Integers
from pas.certify.certificate import Certificate
from pas.certify.local_mesh import OFF, FramedMesh
from pas.kernels.library import compiled
from pas.mesh.rows import cross, dots, norms, spans
from pas.mesh.shading import unit_rows
from pas.mesh.topology import Edges
from pas.surface.boundary_loops import BoundaryLoop
from pas.verdicts import Point, Status, Verdict

CLAIM, BORDER = "the topology of the surface", "a manifold that ends on the contacts' curves"

SURE = 2.0**-46
"""Determinants over the product of their rows' lengths are wrong by less: by some dozen roundings."""


SEPARATE = 1e-6
"""Radians that are left at least between loops."""


def certify_graph(mesh: FramedMesh, edges: Edges, promised: Callable[[], Certificate]) -> tuple[Verdict, Verdict]:
    """The verdicts on the boundary of a mesh and on its topology, which rests on the surface's own certificate."""
    surface = mesh.local.function
    assert mesh.local.center is not None
    points = mesh.points - mesh.local.center
    try:
        rings = surface.placed.loops
    except ArithmeticError as unseen:
        return Verdict(Status.UNDECIDED, BORDER, str(unseen)), _open(str(unseen))
    if not rings or any(not join.opening and join.contact.surface.degree > 2 for join in surface.joins):
        unknown = "of the contacts' curves it is not known that each bounds one disc"
        return Verdict(Status.UNDECIDED, BORDER, unknown), _open(unknown)
    loops = edges.loops
    rim = edges.rim[:, 0]
    off = np.array([ring.off(points[rim]) for ring in rings])
    far = np.flatnonzero(off.min(axis=0) > OFF)
    if len(far):
        place = mesh.local.frame.place(mesh.points[rim[far[0]]])
        return Verdict(Status.REFUTED, BORDER, "the mesh ends beside the curves", place), _open("it does not end there")
    owner = np.full(len(points), -1)
    owner[rim] = off.argmin(axis=0)
    said = f"every inner edge has two triangles; with {len(rim)} edges in {len(loops)} loops, to rounding"
    chain = Verdict(Status.PROVED, BORDER, said)
    volume, lengths = spans(points[mesh.triangles])
    turned = np.flatnonzero(volume <= SURE * lengths)
    if len(turned):
        reason = f"{len(turned)} triangles are not seen from the centre with their outside away"
        return chain, _open(reason, mesh.local.frame.place(mesh.points[mesh.triangles[turned[0], 0]]))
    certificate = promised()
    if not all(verdict.proved for verdict in (*certificate.faces, certificate.one_sheet, certificate.enclosed)):
        return chain, _open("the surface is not proved to be a graph over directions")
    reason = _parted(points, loops, owner, rings)
    if reason:
        return chain, _open(reason)
    ways = np.array([-ring.middle if ring.opening else ring.middle for ring in rings])
    beyond = 2.0  # times the distance of the vertex that is furthest from the centre
    ends = ways * (beyond * np.sqrt(dots(points, points).max() / dots(ways, ways)))[:, None]
    times, known = crossed(points, mesh.triangles, np.zeros(3), ends)
    for number in np.flatnonzero(~known | (times != 0))[:1].tolist():
        which = "away from the opening" if rings[number].opening else "out through one of the ends"
        return chain, _open(
            f"a ray {which} may cross the mesh", mesh.local.frame.place(ends[number] + mesh.local.center)
        )
    reason = f"all {len(volume)} triangles are seen once from the centre, as the surface is; {len(loops)} loops"
    return chain, Verdict(Status.PROVED, CLAIM, reason, measure=len(volume))


def _open(reason: str, place: Point | None = None) -> Verdict:
    return Verdict(Status.UNDECIDED, CLAIM, reason, place)


def _parted(points: Floats, loops: Sequence[Integers], owner: Integers, rings: Sequence[BoundaryLoop]) -> str:
    """Why the loops may not bound discs that are apart; empty where they do."""
    if sorted(int(owner[loop[0]]) for loop in loops) != list(range(len(rings))):
        return "the mesh does not end in one loop on each contact's curve"
    for loop in loops:
        ring = rings[int(owner[loop[0]])]
        if (owner[loop] != owner[loop[0]]).any() or not _once_round(points[loop], ring):
            return "a loop does not go once round its contact's curve"
    for first, second in combinations(loops, 2):
        a, b = (rings[int(owner[loop[0]])] for loop in (first, second))
        if a.opening or b.opening:
            inner, outer = (second, first) if a.opening else (first, second)
            apart = _inside(points[inner], points[outer])
        else:
            apart = _spread(points[first], a) + _spread(points[second], b) + SEPARATE < angle_between(
                a.middle, b.middle
            )
        if not apart:
            return "loops on two contacts' curves may cross, as seen from the centre"
    return ""


def _once_round(loop: Floats, ring: BoundaryLoop) -> bool:
    """Whether a loop goes round the middle of a ring once, always on."""
    first, second = across(ring.normal)
    away = loop - ring.middle
    angles = np.arctan2(away @ second, away @ first)
    steps = (np.roll(angles, -1) - angles + np.pi) % (2 * np.pi) - np.pi
    steps = steps if steps.sum() > 0 else -steps
    return bool((steps > SEPARATE * 1e-3).all() and round(float(steps.sum()) / (2 * np.pi)) == 1)


def _inside(inner: Floats, outer: Floats) -> bool:
    """Whether directions (N, 3) are inside the convex cone of a loop (M, 3)."""
    depths = unit_rows(inner) @ unit_rows(cross(outer, np.roll(outer, -1, axis=0))).T
    return bool((depths > SEPARATE).all() or (depths < -SEPARATE).all())


def _spread(loop: Floats, ring: BoundaryLoop) -> float:
    return max(angle_between(point, ring.middle) for point in loop)


def crossed(points: Floats, triangles: Integers, origin: Floats, ends: Floats) -> tuple[Integers, Bools]:
    """How often segments from `origin` (3,) to `ends` (E, 3) leave through triangles more than they enter.

    Also for which ends (E,) that is known.  A segment from 0 to p crosses a triangle a, b, d where det(p, a, b),
    det(p, b, d) and det(p, d, a) have one sign, at the share det(a, b, d) over their sum.  Each is known to `SURE`
    times the lengths of its rows; what is not surely crossed nor surely missed makes the number of p unknown.
    """
    grazing = 1e-9  # by which cosines of angles may be wrong without a triangle being missed
    ways = ends - origin
    towards = ways / np.maximum(norms(ways), 1e-300)[:, None]
    times, known = np.empty(len(ways), dtype=np.intp), np.empty(len(ways), dtype=np.bool_)
    given = (len(triangles), triangles, points, origin, len(ways), ways, towards, grazing, SURE)
    compiled().call("pas_crossed", *given, times, known)
    return times, known
