"""The bodies of networks: proved nodes, exact struts, and meshes of any size made of few."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.affine import ORIGIN, height
from pas.algebra.inputs import check_tolerance, whole
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import cross, dot, exact, rational, vector
from pas.certify.proofs import zeros_signs
from pas.errors import MeshError
from pas.limits import WorkLimits, in_parts, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality, manifold
from pas.network.classes import Kinds
from pas.network.clearance import clearance
from pas.network.graph import StrutGraph
from pas.network.nodes import NodeClass, classes_of
from pas.network.placing import PlacedPieces
from pas.pipeline.result import Blend
from pas.pipeline.search import excess
from pas.settings import MeshSettings
from pas.shape import Shape
from pas.verdicts import Findings, Status, Verdict

USUAL = 0.03
"""Of the least radius: the tolerance of meshes."""

FACES = ("nodes", "struts")

MOST_TRIANGLES = 40_000_000
"""Of one mesh, which take some 10 GB; more are written by pieces, see `NetworkPart.write`."""


@dataclass(frozen=True, eq=False, repr=False)
class NetworkPart(Shape):
    """The body of a network: a blend for each class of its nodes, a cylinder or cone for each strut, flat ends.

    `kinds` are those of its nodes, with their ends, `blends` has the blend of each class by its key, in steps of the
    grid.
    """

    network: StrutGraph
    order: int
    kinds: Kinds
    blends: Mapping[Any, Blend]
    kind = "network"

    @cached_property
    def classes(self) -> tuple[NodeClass, ...]:
        """The classes of its nodes with their ends, the most frequent first."""
        return classes_of(self.kinds, self.network)

    def blend_of(self, one: NodeClass) -> Blend | None:
        """The blend of a class of nodes, in steps of the grid around the origin; None where none is needed."""
        return self.blends.get(one.kind.form.key)

    @property
    def unfair(self) -> tuple[NodeClass, ...]:
        """The classes whose blends are proved and not within the limits of fairness."""
        return tuple(one for one in self.classes if (b := self.blend_of(one)) is not None and excess(b) > 0)

    @cached_property
    def certificate(self) -> Findings:
        """That every node is proved, is its class turned, meets its struts, and that nothing else meets.

        A node is the blend of its class under an exact rotation or reflection, which keeps every claim of it; struts
        are the cylinders and cones that these blends are proved to meet, on one exact axis from node to node.
        """
        apart = clearance(self.network, self._reach, self._ends)
        return Findings((self._nodes(), self._struts(), self._apart(), apart))

    def _nodes(self) -> Verdict:
        claim = f"every node meets its struts with GC^{self.order}"
        for one in self.classes:
            found = self.blend_of(one)
            if found is None and one.blended:
                return Verdict(Status.UNDECIDED, claim, f"there is no blend of {one}")
            if found is not None and not found.certificate.proved:
                reason = f"the blend of {one} is not proved ({found.certificate.counts})"
                return Verdict(Status.UNDECIDED, claim, reason)
            if found is not None and not self._seen(one, found):
                return Verdict(Status.UNDECIDED, claim, f"the blend of {one} has a centre away from its struts")
        turned = len(self.kinds.kinds)
        reason = f"{len(self.blends)} proved blends in {turned} exact positions; exact struts between them"
        return Verdict(Status.PROVED, claim, reason, measure=turned)

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

    def _struts(self) -> Verdict:
        claim = "every strut is straight between its nodes"
        free = 1 - self._ends.sum(axis=1)
        number = int(free.argmin())
        status = Status.PROVED if free[number] > 0 else Status.REFUTED
        return Verdict(status, claim, f"at least {100 * free[number]:.3g} % of its length, of strut {number}")

    @property
    def _ends(self) -> Floats:
        """Where each strut begins and ends (E, 2), in parts of its length."""
        return np.asarray(self.kinds.ends[self.kinds.of[self.network.edges], self.kinds.slots])

    @cached_property
    def _reach(self) -> Floats:
        """The radius of a ball around each point that holds its node (N,), proved on the polynomials; inf if not."""
        pieces, step = self.pieces(), self.network.grid
        found = np.array([np.linalg.norm(piece.points, axis=1).max() for piece in pieces.nodes]) + pieces.tolerance
        for key, numbers in self.kinds.classes.items():
            found[numbers] = most = found[numbers].max()
            square = exact(most / step) ** 2 - dot(GENERATORS, GENERATORS)
            if key in self.blends and not _holds(self.blends[key], square):
                found[numbers] = np.inf
        return np.where(self.kinds.of >= 0, found[self.kinds.of], 0.0)

    def _apart(self) -> Verdict:
        """By planes across the struts, at so many parts of each, where the meshes leave as much room on both sides."""
        claim, pieces, kinds = "neighbouring nodes are apart", self.pieces(), self.kinds
        parts, least = 1024, np.full(kinds.ends.shape, np.inf)
        for strut in pieces.struts:
            way = strut.vector / (strut.vector @ strut.vector)
            here, there = (pieces.nodes[kind].points @ way for kind in strut.kinds)
            plane = round(parts * (1 + here.max() + there.min()) / 2)
            for kind, slot, at in zip(strut.kinds, strut.slots, (plane, parts - plane), strict=True):
                least[kind, slot] = min(least[kind, slot], at)
        for key, numbers in kinds.classes.items():
            first = kinds.kinds[numbers[0]]
            rows = least[np.array(numbers)[:, None], [kinds.kinds[number].form.order for number in numbers]]
            for arm, plane in zip(first.form.order, rows.min(axis=0).tolist(), strict=True):
                arrow = first.exact(arm)
                before = fmpq(int(plane), parts) * dot(arrow, arrow) - height(ORIGIN, arrow)
                if not (plane > 0 and (key not in self.blends or _holds(self.blends[key], before))):
                    reason = f"the node {kinds.nodes(numbers)[0]} may reach beyond a plane across its strut"
                    return Verdict(Status.UNDECIDED, claim, reason)
        return Verdict(Status.PROVED, claim, "a plane across each strut is between them", measure=len(pieces.struts))

    @property
    def genus(self) -> int:
        """Of its surface, summed over its pieces: struts - nodes + pieces."""
        used = int((self.network.valence > 0).sum())
        return len(self.network.edges) - used + self.network.pieces

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

    def pieces(self, tolerance: float | None = None) -> PlacedPieces:
        """The meshes of the kinds of nodes and struts, and their places, of which `mesh` and files consist; kept."""
        wanted = USUAL * float(min(self.network.radii)) if tolerance is None else check_tolerance(tolerance)
        if wanted not in self._made:
            self._made[wanted] = PlacedPieces(self.network, self.kinds, dict(self.blends), wanted)
        return self._made[wanted]

    @limited("meshing a network", "a coarser tolerance")
    def mesh(
        self, tolerance: float | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> NetworkMesh:
        """Triangles within `tolerance` (the model's units; by default 3 % of the least radius), watertight.

        Its faces are "nodes" and "struts".  Raises `MeshError` for more than 40 million triangles.
        """
        Quality.of(quality)
        pieces = self.pieces(tolerance)
        counts = np.array([len(p.triangles) for p in pieces.nodes])
        total = int(counts @ self.kinds.counts) + sum(len(s.triangles) * len(s.edges) for s in pieces.struts)
        if total > MOST_TRIANGLES:
            raise MeshError(
                f"the mesh would have {total} triangles, and {MOST_TRIANGLES} is the most; write a .3mf or .glb file, "
                "which holds each kind of node once, or give a coarser tolerance"
            )

        def made() -> NetworkMesh:
            points, triangles, normals, faces = pieces.mesh()
            known = points, triangles, faces, FACES, normals
            return NetworkMesh(*known, deviation=pieces.deviation, part=self, tolerance=pieces.tolerance)

        return self._kept((pieces.tolerance,), made)

    @property
    def bounding_box(self) -> Floats:
        """Two corners (2, 3) of the smallest box with sides along the axes, up to the usual tolerance."""
        pieces = self.pieces()
        found = []
        for kind, piece in enumerate(pieces.nodes):
            places = self.network.points[self.kinds.of == kind]
            found += [places.min(axis=0) + piece.points.min(axis=0), places.max(axis=0) + piece.points.max(axis=0)]
        return np.stack([np.min(found, axis=0), np.max(found, axis=0)])

    @property
    def description(self) -> str:
        """The network, its classes of nodes, and how dense it is."""
        network = self.network
        lines = [f"{int((network.valence > 0).sum())} nodes, {len(network.edges)} struts, order {self.order}"]
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
        """Closed meshes of the kinds of nodes with halves of their struts, and the places (M, 3) where each stands."""
        found = self.pieces(settings.tolerance).bodies()
        meshes = [replace(Mesh.from_triangles(p, t, "node"), normals=n) for p, t, n, _ in found]
        return [(mesh, self.network.points[nodes]) for mesh, (*_, nodes) in zip(meshes, found, strict=True)]

    def write_blocks(self, folder: str | Path, tolerance: float | None = None, *, struts: int = 20_000) -> list[Path]:
        """Write the watertight mesh as STL files of about so many struts each, for what is too large for one mesh.

        A block has the nodes in a box, and the struts that begin there; together the files are the mesh.  One that is
        there already is not made again, and none is left half written.  Returns the paths.

        Raises `ValueError` for fewer than one strut, and what writing raises.
        """
        whole(struts, "struts", 1, len(self.network.edges) + struts)
        place, pieces = Path(folder), self.pieces(tolerance)
        place.mkdir(parents=True, exist_ok=True)
        sides = np.ptp(self.network.places, axis=0) + 1
        across = max(1, round((len(self.network.edges) / struts) ** (1 / 3)))
        cells = (self.network.places - self.network.places.min(axis=0)) * across // sides
        numbers, paths = cells @ (across**2, across, 1), []
        for number in in_parts(np.unique(numbers).tolist(), "writing blocks"):
            path = place / "block-{}-{}-{}.stl".format(*np.unravel_index(number, (across,) * 3))
            if not path.exists():
                points, triangles, normals, faces = pieces.mesh(numbers == number)
                Mesh(points, triangles, faces, FACES, normals, deviation=pieces.deviation).write(path, open=True)
            paths.append(path)
        return paths

    def __repr__(self) -> str:
        return f"<NetworkPart: {len(self.network.places)} nodes, {len(self.network.edges)} struts, GC^{self.order}>"


@dataclass(frozen=True, eq=False, repr=False)
class NetworkMesh(Mesh):
    """The mesh of a network's body; its certificate is a proof that it is one."""

    part: NetworkPart | None = field(default=None, kw_only=True)
    tolerance: float = field(default=0.0, kw_only=True)

    @cached_property
    def certificate(self) -> Findings:
        """Whether it is a closed manifold, each node's mesh has the topology of its surface, and how far it is off."""
        assert self.part is not None
        pieces, step = self.part.pieces(self.tolerance), float(self.part.network.grid)
        topology, distance = Verdict(Status.PROVED, "the topology of every node", "by the meshes of their classes"), 0.0
        for one in self.part.classes:
            if (blend := self.part.blend_of(one)) is None:
                continue
            found = blend.surface.mesh(self.tolerance / step).certificate
            open_ = [verdict for verdict in found.verdicts if not (verdict.proved or verdict.measured)]
            for verdict in open_:
                topology = Verdict(verdict.status, topology.claim, f"{one}: {verdict.claim}: {verdict.reason}")
            # with the topology goes that points of both are joined along the gradient, on which the distance is bounded
            distance = max(distance, np.inf if open_ or found.distance is None else step * found.distance)
        strips = max((s.deviation for s in pieces.struts), default=0.0)
        bound = max(distance, strips) + float(np.abs(self.points).max()) * 2.0**-50
        near = Verdict(Status.UNDECIDED, "near the surface", "of some class the distance is not proved")
        if np.isfinite(bound):
            reason = f"within {bound:.3g}: nodes by their classes, strips by their widest angle"
            near = Verdict(Status.PROVED, near.claim, reason)
        return Findings((manifold(self.triangles), topology, near))


def _holds(blend: Blend, value: fmpq_mpoly) -> bool:
    """Whether a polynomial in the blend's coordinates is proved to be positive on the whole surface."""
    local = blend.surface.partition.frame.localise(Polynomial.from_raw(value)).raw
    return zeros_signs(blend.surface, [local] * len(blend.surface.patches)).status is Status.PROVED
