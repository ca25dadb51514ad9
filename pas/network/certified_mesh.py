"""Meshes of networks, and the proof that they are those of their bodies: node by node of each class, strip by strip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pas.algebra.rational import exact
from pas.mesh.mesh import Mesh
from pas.mesh.quality import manifold
from pas.verdicts import Findings, Status, Verdict


@dataclass(frozen=True, eq=False, repr=False)
class NetworkMesh(Mesh):
    """The mesh of a network's body; its certificate is a proof that it is one."""

    part: Any = field(default=None, kw_only=True)
    tolerance: float = field(default=0.0, kw_only=True)

    @cached_property
    def certificate(self) -> Findings:
        """Whether it is a closed manifold, each node's mesh has the topology of its surface, and how far it is off."""
        topology = Verdict(Status.PROVED, "the topology of every node", "by the meshes of their classes")
        distances = []
        for side in self.part.pieces(self.tolerance).sides:
            distances.append(max(strut.deviation for strut in side.struts))
            for one in self.part.classes:
                if (blend := side.blends.get(one.kind.form.key)) is None:
                    continue
                found = blend.surface.mesh(side.tolerance / side.step).certificate
                open_ = [verdict for verdict in found.verdicts if not (verdict.proved or verdict.measured)]
                for verdict in open_:
                    reason = f"{one}: {verdict.claim}: {verdict.reason}"
                    topology = replace(topology, status=verdict.status, reason=reason)
                # a mesh that may lack a part of its surface, though near to it where it is, is not near the body
                off = np.inf if open_ or found.distance is None else side.step * found.distance
                distances[-1] = max(distances[-1], off)
        bound = max(distances) + float(np.abs(self.points).max()) * 2.0**-50
        near = Verdict(Status.UNDECIDED, "near the surface", "of some class the distance is not proved")
        if np.isfinite(bound):
            reason = f"within {bound:.3g}: nodes by their classes, strips by their widest angle"
            near = Verdict(Status.PROVED, near.claim, reason)
        return Findings((manifold(self.triangles), topology, near, *self._apart(sum(distances))))

    def _apart(self, distance: float) -> Iterator[Verdict]:
        """The verdict that the meshes of a hollow body's sides are apart, being off by `distance` together."""
        part = self.part
        if part.wall is None:
            return
        claim, bound = "both sides of the wall are apart", exact(distance / float(part.network.grid))
        for found in part.hollow.values() if np.isfinite(distance) else ():
            thick = found.thicker_than(bound)
            if not thick.proved:
                yield replace(thick, claim=claim)
                return
        proved = distance < float(part.wall)
        reason = f"the wall is thicker than {distance:.3g}, by which both are off together"
        yield Verdict(Status.PROVED if proved else Status.UNDECIDED, claim, reason if proved else "the wall is thinner")
