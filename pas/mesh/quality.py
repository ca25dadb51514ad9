"""The preference of a mesh where it cannot have both, good angles or few triangles; and the verdicts on a mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from enum import Enum
from typing import Any, TypeVar

import numpy as np

from pas.arrays import Floats, Integers
from pas.errors import MeshError
from pas.mesh.rows import area_vectors
from pas.mesh.topology import is_closed_manifold, is_manifold
from pas.settings import check_quality
from pas.verdicts import Findings, Status, Verdict

AnyMesh = TypeVar("AnyMesh")


class Quality(Enum):
    """`ANGLES`: no long triangles; `COUNT`: as few triangles as the tolerance allows, however long.

    `BALANCED`, which is usual, has long triangles along straight lines, with at least 1/40 of their length in height,
    1/10 on planes if vertices inside help; between short edges of a face and others far away there are worse ones.
    Surfaces without faces are meshed with edges of several lengths, those with parameters in several ways, and the
    best of these meshes is kept.  Where there is one mesh only, as of a mesh, all are the same.
    """

    ANGLES = "angles"
    BALANCED = "balanced"
    COUNT = "count"

    @classmethod
    def of(cls, given: Quality | str) -> Quality:
        """A quality by itself or by its name; raises `ValueError` for any other."""
        return cls(check_quality(given))

    @property
    def flat(self) -> tuple[float, float, float]:
        """The least ratio of height to longest side of triangles that are made long: by collapses on curves, inside
        faces, and inside planes."""
        return (SLENDER,) * 3 if self is Quality.COUNT else (PRINTABLE, PRINTABLE, FLAT)

    @property
    def aims(self) -> tuple[float, ...]:
        """Shares of the tolerance at which edges of even triangles are as long as the curvature lets them be.

        The first is the usual one: below, there are more triangles, and above, more edges that must be halved.
        """
        return AIMS[self]

    def best_of(self, makers: Iterable[Callable[[], AnyMesh]]) -> AnyMesh:
        """The best of the meshes that are made; a `MeshError` of the first is raised, later ones are left out."""
        first, *others = makers
        found = [first()]
        for make in others:
            with suppress(MeshError):  # too many triangles, or no good mesh: there is one already
                found.append(make())
        return self.best(found)

    def best(self, meshes: Sequence[AnyMesh]) -> AnyMesh:
        """The one of some meshes that has the largest smallest angle, or the fewest triangles; the first of equals."""

        def merit(mesh: Any) -> float:
            few = -len(mesh.triangles)
            return smallest_angles(mesh.points[mesh.triangles]).min(initial=np.pi) if self is Quality.ANGLES else few

        return max(meshes, key=merit)


def smallest_angles(corners: Floats) -> Floats:
    """The smallest angle in radians of each triangle (T, 3, 3), (T,)."""
    sides = np.roll(corners, 1, axis=1) - corners
    units = sides / np.maximum(np.linalg.norm(sides, axis=2, keepdims=True), 1e-300)
    cosines = -(units * np.roll(units, 1, axis=1)).sum(axis=2)
    return np.asarray(np.arccos(np.clip(cosines, -1.0, 1.0)).min(axis=1))


AIM = 0.72
"""The usual share: angles are as good as with shorter edges in the mean, and few edges must be halved."""

AIMS = {Quality.ANGLES: (AIM, 0.66, 0.6, 0.5), Quality.BALANCED: (AIM,), Quality.COUNT: (AIM, 0.85, 1.0, 1.2)}

PRINTABLE, SLENDER = 0.025, 5e-4
"""Of triangles that printers' programs take; and of such that rounding to single precision, as STL has it, leaves."""

FLAT = 0.1
"""Of triangles on planes, where a few more vertices inside do for good ones; along the lines of a cylinder it takes
many, and where the sides of a plane are long and near to each other nothing helps."""


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
    corners = points[triangles]
    against = ((area_vectors(corners)[:, None] * normals).sum(axis=2) < 0).all(axis=1)
    if not against.any():
        return Verdict(Status.HOLDS_MEASURED, claim, "every triangle agrees with the normal at some corner")
    x, y, z = corners[int(against.argmax())].mean(axis=0).tolist()
    reason = f"{int(against.sum())} triangles are turned against the normals at their corners"
    return Verdict(Status.FAILS_MEASURED, claim, reason, (x, y, z))
