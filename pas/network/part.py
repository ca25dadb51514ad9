"""The bodies of networks: proved nodes, exact struts, and meshes of any size made of few."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from pas.algebra.affine import ORIGIN
from pas.algebra.rational import Exact, check_tolerance, cross, dot, rational, vector
from pas.arrays import Floats
from pas.errors import MeshError
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.network.blocks import write_blocks
from pas.network.certified_mesh import NetworkMesh
from pas.network.classes import Kinds, NodeClass
from pas.network.clearance import clearance
from pas.network.covers import NodeCovers
from pas.network.graph import NetworkProblem, StrutGraph, problems_text
from pas.network.nodes import of_nodes
from pas.network.placing import PlacedPieces
from pas.network.sides import NetworkSide
from pas.pipeline.hollow import HollowBlend
from pas.pipeline.result import Blend
from pas.pipeline.search import excess
from pas.settings import MeshSettings
from pas.shape import Shape
from pas.verdicts import Findings, Status, Verdict

USUAL = 0.03
"""The usual tolerance of meshes, over the least radius."""

MOST_TRIANGLES = 40_000_000
"""The most triangles of one mesh, which take some 10 GB; more are written by pieces, see `NetworkPart.write`."""


Proof = tuple[Verdict, tuple[NetworkProblem, ...]]
"""A verdict, and all that keeps it from being proved."""


@dataclass(frozen=True, eq=False, repr=False)
class NetworkPart(Shape):
    """The body of a network: a blend for each class of its nodes, a cylinder or cone for each strut, flat ends.

    `kinds` are those of its nodes, with their ends, `blends` has the blend of each class by its key, in steps of the
    grid.  Of a hollow body, with a `wall` in the model's units, `hollow` has those of its classes with their cavities.
    """

    order: int
    kinds: Kinds
    blends: Mapping[Any, Blend]
    wall: Fraction | None = None
    hollow: Mapping[Any, HollowBlend[Blend]] = field(default_factory=dict)
    kind = "network"

    @classmethod
    def of(cls, order: int, kinds: Kinds, found: Mapping[Any, Any], wall: Fraction | None) -> NetworkPart:
        """The body with blends, hollow ones where there is a wall."""
        outer = {key: blend if wall is None else blend.outer for key, blend in found.items()}
        return cls(order, kinds, outer, wall, {} if wall is None else found)

    @property
    def network(self) -> StrutGraph:
        """The graph."""
        return self.kinds.network

    @cached_property
    def cavity(self) -> NetworkPart | None:
        """The cavity of a hollow body, as a body of its own; None of a full one."""
        if self.wall is None:
            return None
        network, wall = self.network, self.wall
        radii = [(network.radii[a] - wall, network.radii[b] - wall) for a, b in network.sizes.tolist()]
        inner = StrutGraph(network.points, network.edges, radii, network.grid)
        kinds = replace(self.kinds, network=inner)
        return NetworkPart(self.order, kinds, {key: found.inner for key, found in self.hollow.items()})

    @cached_property
    def classes(self) -> tuple[NodeClass, ...]:
        """The classes of its nodes with their ends, the most frequent first."""
        return self.kinds.by_frequency

    def blend_of(self, one: NodeClass) -> Blend | None:
        """The blend of a class of nodes, in steps of the grid around the origin; None where none is needed."""
        return self.blends.get(one.kind.form.key)

    @property
    def unfair(self) -> tuple[NodeClass, ...]:
        """The classes whose blends are proved and not within the limits of fairness."""
        sides = [self.blends, *([self.cavity.blends] if self.cavity else [])]
        keys = [(one, one.kind.form.key) for one in self.classes]
        return tuple(one for one, key in keys if any(key in side and excess(side[key]) > 0 for side in sides))

    @cached_property
    def certificate(self) -> Findings:
        """That every node is proved, is its class turned, meets its struts, and that nothing else meets.

        A node is the blend of its class under an exact rotation or reflection, which keeps every claim of it; struts
        are the cylinders and cones that these blends are proved to meet, on one exact axis from node to node.
        """
        return Findings(tuple(verdict for verdict, _ in self._proofs))

    @property
    def unproved(self) -> tuple[NetworkProblem, ...]:
        """All that its certificate does not prove, with the numbers of points and struts."""
        return tuple(problem for _, problems in self._proofs for problem in problems)

    @cached_property
    def _proofs(self) -> tuple[Proof, ...]:
        covers = NodeCovers(self.kinds, self.blends)
        return (self._nodes(), _straight(self.kinds.ends), clearance(self.network, covers), *self._inside())

    def _inside(self) -> Iterator[Proof]:
        """The verdicts that a hollow body's cavity meets its struts, and is inside: then nothing of it meets."""
        if self.cavity is None:
            return
        nodes, problems = self.cavity._nodes()
        yield replace(nodes, claim=nodes.claim.replace("its struts", "its struts inside")), problems
        wrong = []
        for one in self.classes:
            found = self.hollow.get(one.kind.form.key)
            if one.blended and (found is None or not found.certificate.proved):
                wrong.append(of_nodes("not proved", one, f"the cavity of {one} is not proved"))
        reason = f"of every node, and every strut has a wall of {self.wall} across its axis"
        yield _found("the cavity is inside", wrong, reason, len(self.hollow))

    def _nodes(self) -> Proof:
        turned = len(self.kinds.kinds)
        reason = f"{len(self.blends)} proved blends in {turned} exact positions; exact struts between them"
        return _found(f"every node meets its struts with GC^{self.order}", self._wrong(), reason, turned)

    def _wrong(self) -> Iterator[NetworkProblem]:
        """The classes whose nodes are not proved, and why."""
        for one in self.classes:
            found, said = self.blend_of(one), ""
            if found is None:
                said = f"there is no blend of {one}" if one.blended else ""
            elif not found.certificate.proved:
                said = f"the blend of {one} is not proved ({found.certificate.counts})"
            elif not self._seen(one, found):
                said = f"the blend of {one} has a centre away from its struts"
            if said:
                yield of_nodes("not proved", one, said)

    def _seen(self, one: NodeClass, blend: Blend) -> bool:
        """Whether the centre of a blend is inside of all struts, were they to go on.

        Then a strut beyond its end is seen from there in the directions of the clip's circle, in which no surface is:
        parted in the ratio of distances, the centre's distance from the axis and the circle's radius are at least the
        strut's.
        """
        center = blend.surface.partition.center or ORIGIN
        for way, radius, far in one.struts:
            axis, slope = vector(way), rational((far - radius) / self.network.grid)
            width = rational(radius / self.network.grid) + slope * dot(center, axis) / dot(axis, axis)
            off = cross(center, axis)
            if width <= 0 or dot(off, off) >= width**2 * dot(axis, axis):
                return False
        return True

    @property
    def genus(self) -> int:
        """The genus of the surface, summed over its pieces: struts - nodes + pieces.

        That of a hollow body is twice as much, and one for each open end of a piece after the first.
        """
        network = self.network
        found = len(network.edges) - int((network.valence > 0).sum()) + network.pieces
        ends = np.unique(network.components[network.valence == 1], return_counts=True)[1]
        return found if self.wall is None else 2 * found + int((ends - 1).sum())

    @cached_property
    def volume(self) -> float:
        """The volume in the model's units, cubed, of the mesh within the usual tolerance."""
        return self.pieces().volume

    @property
    def density(self) -> float:
        """The volume over that of the box of the network's points: how much of it is material."""
        sides = np.ptp(self.network.points, axis=0)
        return self.volume / float(sides.prod()) if sides.all() else float("nan")

    @cached_property
    def _made(self) -> dict[float, PlacedPieces]:
        return {}

    def pieces(self, tolerance: Exact | None = None) -> PlacedPieces:
        """The meshes of the kinds of nodes and struts, and their places, of which `mesh` and files consist; kept."""
        usual = USUAL * float(min(self.network.radii))
        if self.wall is not None:
            usual = min(usual, float(self.wall) / 4)  # so that the meshes of both sides are apart
        wanted = usual if tolerance is None else check_tolerance(tolerance)
        if wanted not in self._made:
            outer, cavity = NetworkSide(self.kinds, self.blends, wanted), self.cavity
            inner = [NetworkSide(cavity.kinds, cavity.blends, wanted, outer)] if cavity else []
            self._made[wanted] = PlacedPieces([outer, *inner])
        return self._made[wanted]

    @limited("meshing a network", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> NetworkMesh:
        """Triangles within `tolerance` (the model's units; by default 3 % of the least radius, or a fourth of the wall
        where that is less), watertight.

        Its faces are "nodes" and "struts".  Raises `MeshError` for more than 40 million triangles.
        """
        Quality.of(quality)
        pieces = self.pieces(tolerance)
        if pieces.count > MOST_TRIANGLES:
            raise MeshError(
                f"the mesh would have {pieces.count} triangles, and {MOST_TRIANGLES} is the most; write a .3mf or .glb "
                "file, which holds each kind of node once, or give a coarser tolerance"
            )

        def made() -> NetworkMesh:
            return NetworkMesh(*pieces.mesh(), deviation=pieces.deviation, part=self, tolerance=pieces.tolerance)

        return self._kept((pieces.tolerance,), made)

    @property
    def bounding_box(self) -> Floats:
        """Two corners (2, 3) of the smallest box with sides along the axes, up to the usual tolerance."""
        pieces = self.pieces()
        found = []
        for piece in pieces.nodes:
            places = self.network.points[piece.copies[:, 0]]
            found += [places.min(axis=0) + piece.points.min(axis=0), places.max(axis=0) + piece.points.max(axis=0)]
        return np.stack([np.min(found, axis=0), np.max(found, axis=0)])

    @property
    def description(self) -> str:
        """The network, its classes of nodes, and how dense it is."""
        network = self.network
        walls = "" if self.wall is None else f", hollow with walls of {self.wall}"
        lines = [f"{int((network.valence > 0).sum())} nodes, {len(network.edges)} struts, order {self.order}{walls}"]
        unfair = set(map(id, self.unfair))
        for one in self.classes:
            found = self.blend_of(one)
            how = f"degree {found.surface.degree}" if found is not None else "straight on or an end"
            lines.append(f"  {one}: {how}{', not fair' if id(one) in unfair else ''}")
        lines.append(f"genus {self.genus}, volume {self.volume:.6g}, density {self.density:.4g}")
        return "\n".join(lines)

    def __str__(self) -> str:
        return f"{self.description}\n\n{self.certificate}"

    def bodies(self, settings: MeshSettings) -> list[tuple[Mesh, Floats]]:
        """Closed meshes of the kinds of nodes with halves of their struts, and the places (M, 3) where each stands.

        Their one face has the name of the class.
        """
        found, kinds = self.pieces(settings.tolerance).bodies(), self.kinds
        names = {number: str(one) for one in self.classes for number in one.numbers}
        meshes = [replace(Mesh.from_triangles(p, t, names[kinds.of[at[0]]]), normals=n) for p, t, n, at in found]
        return [(mesh, self.network.points[nodes]) for mesh, (*_, nodes) in zip(meshes, found, strict=True)]

    def write_blocks(
        self, folder: str | Path, tolerance: Exact | None = None, *, struts: int = 20_000, map: Callable[..., Any] = map
    ) -> list[Path]:
        """Write the watertight mesh as STL files of about so many struts each, for what is too large for one mesh.

        A block has the nodes in a box, and the struts that begin there; together the files are the mesh.  One that is
        there already is not made again, and none is left half written.  `map` is as in `Network.blend`.  Returns the
        paths.

        Raises `ValueError` for fewer than one strut and for a folder with blocks of another mesh, `EngineLostError`
        where the engine ends, and what writing raises.
        """
        return write_blocks(self.pieces(tolerance), Path(folder), struts, map)

    def __repr__(self) -> str:
        return f"<NetworkPart: {len(self.network.places)} nodes, {len(self.network.edges)} struts, GC^{self.order}>"


def _straight(ends: Floats) -> Proof:
    """The verdict on all struts being straight between their ends (E, 2), in parts of their lengths."""
    free = 1 - ends.sum(axis=1)
    number, short = int(free.argmin()), np.flatnonzero(free <= 0).tolist()
    wrong = [NetworkProblem("no straight part", (n,), f"strut {n} has no straight part") for n in short]
    reason = f"at least {100 * free[number]:.3g} % of its length, of strut {number}"
    return _found("every strut is straight between its nodes", wrong, reason, status=Status.REFUTED)


def _found(
    claim: str, problems: Iterable[NetworkProblem], reason: str, measure: int = 0, status: Status = Status.UNDECIDED
) -> Proof:
    """The verdict on a claim: proved, or what problems make of it, and these."""
    if wrong := tuple(problems):
        return Verdict(status, claim, problems_text(wrong)), wrong
    return Verdict(Status.PROVED, claim, reason, measure=measure), ()
