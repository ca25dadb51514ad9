"""What can be said of a mesh by itself: whether it is a manifold, whether it folds, how near to its surface it is."""

from __future__ import annotations

import numpy as np

from pas.mesh.rows import Floats, Integers
from pas.mesh.topology import is_closed_manifold, is_manifold
from pas.verdicts import Findings, Status, Verdict


def soundness(points: Floats, triangles: Integers, normals: Floats, deviation: float | None, proved: bool) -> Findings:
    """The verdicts on a mesh; `normals` (T, 3, 3) are those of the surface at the corners, `deviation` what is known.

    Manifold is decided by counting, folds are looked for by comparing each triangle with the normals at its corners.
    """
    found = [manifold(triangles), _unfolded(points, triangles, normals)]
    if deviation is not None:
        status = Status.PROVED if proved else Status.HOLDS_MEASURED
        claim, reason = f"within {deviation:.3g} of the surface", "bounded" if proved else "the largest distance found"
        found.append(Verdict(status, claim, reason))
    return Findings(tuple(found), partly_measured=True)


def manifold(triangles: Integers) -> Verdict:
    """Whether triangles (T, 3) are a manifold, by counting those at edges and vertices."""
    claim = "a manifold"
    if is_closed_manifold(triangles):
        return Verdict(Status.PROVED, claim, "closed: every edge has two triangles, every vertex one fan of them")
    if is_manifold(triangles):
        return Verdict(Status.PROVED, claim, "with a boundary; no edge has more than two triangles")
    return Verdict(Status.REFUTED, claim, "an edge has more than two triangles, or a vertex more than one fan of them")


def _unfolded(points: Floats, triangles: Integers, normals: Floats) -> Verdict:
    claim = "no folds"
    a, b, c = (points[triangles[:, i]] for i in range(3))
    across = np.cross(b - a, c - a)
    against = ((across[:, None] * normals).sum(axis=2) < 0).all(axis=1)
    if not against.any():
        return Verdict(Status.HOLDS_MEASURED, claim, "every triangle agrees with the normal at some corner")
    x, y, z = ((a + b + c) / 3)[int(against.argmax())].tolist()
    reason = f"{int(against.sum())} triangles are turned against the normals at their corners"
    return Verdict(Status.FAILS_MEASURED, claim, reason, (x, y, z))
