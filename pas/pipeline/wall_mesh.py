"""The mesh of a hollow blend, and the proof that it is one: both sheets are their surfaces, and rings close it.

With both sheets proved to be surfaces that end in one simple loop on each contact's curve (see
`pas.certify.mesh_proofs`), an end of the wall is a ring if its vertices lie in the end, a plane or the cone of an
opening, and its triangles are all seen from one side, along the axis of that.  The times that
they cover a point are then the difference of how often the two loops go round it, which is not negative: so the inner
loop is inside the outer one, and what is between is covered once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pas.arrays import Floats, Integers
from pas.certify.local_mesh import OFF
from pas.mesh.mesh import Mesh
from pas.mesh.quality import manifold
from pas.piecewise import PiecewiseSurface
from pas.solid.faces import End, off_surface
from pas.verdicts import Findings, Status, Verdict, Verdicts


@dataclass(frozen=True, eq=False, repr=False)
class WallMesh(Mesh):
    """A closed mesh between an outer and an inner surface, whose first two faces are these and whose others are `ends`.

    Its certificate is a proof that it is one, worked out when first asked for.
    """

    sheets: tuple[PiecewiseSurface, ...] = ()
    ends: Sequence[End] = field(default=())

    @cached_property
    def certificate(self) -> Findings:
        """Whether it is closed, both sheets are their surfaces, and rings are between them at the ends."""
        outer, inner = self.sheets
        of = [self.triangles[self.faces == number] for number in range(2 + len(self.ends))]
        parts: dict[str, Verdicts] = {
            "outer": outer.certify_mesh(*_alone(self.points, of[0])),
            "inner": inner.certify_mesh(*_alone(self.points, of[1][:, ::-1])),
        }
        sheets = Findings.of_parts(parts).verdicts
        size = float(np.ptp(outer.partition.points, axis=0).max())
        rings = [
            ring_verdict(f"a ring at end {number + 1}", self.points[of[2 + number]], end, size)
            for number, end in enumerate(self.ends)
        ]
        closed = manifold(self.triangles)
        if len(self.triangles) != sum(map(len, of)) or not self.is_closed:
            closed = replace(closed, status=Status.REFUTED, reason="it is not closed, or has a face of its own")
        return Findings((closed, *sheets, *rings), partly_measured=True)


def _alone(points: Floats, triangles: Integers) -> tuple[Floats, Integers]:
    """Triangles (T, 3) with their own points only."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return points[used], numbers.reshape(triangles.shape)


def ring_verdict(claim: str, corners: Floats, end: End, size: float) -> Verdict:
    """Whether triangles (T, 3, 3) are in an end, and all seen from one side; `size` is that of the region."""
    if not len(corners):
        return Verdict(Status.REFUTED, claim, "there are no triangles")
    off = off_surface(end.surface, corners.reshape(-1, 3))
    if not off.max() <= OFF * size:
        x, y, z = corners.reshape(-1, 3)[int(np.argmax(np.where(np.isnan(off), np.inf, off)))].tolist()
        return Verdict(Status.REFUTED, claim, "a vertex is not in the end", (x, y, z))
    turned = np.flatnonzero(~(end.facing(corners) > 0))
    if len(turned):
        x, y, z = corners[turned[0]].mean(axis=0).tolist()
        return Verdict(Status.UNDECIDED, claim, "a triangle may be turned round", (x, y, z))
    return Verdict(Status.PROVED, claim, f"{len(corners)} triangles in it, to rounding, all seen from one side")
