"""Edges of a mesh made as long as the curvature of its surface lets them be.

Edges are collapsed, split and flipped, and vertices moved to the middle of their triangles.  On ruled faces an edge is
as long as its own sag allows, so that triangles along straight lines are long ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.halfedges import TURNED, HalfEdges, VertexKind, following
from pas.mesh.labelled import NONE, Labelled
from pas.mesh.rows import dots, norms
from pas.mesh.topology import first_rows

KEPT = 0.35
"""Cosine with the normals below which triangles about folded ones are not made."""

LARGEST = 4_000_000
"""Triangles; more would not fit into the memory of a small machine."""


@dataclass(frozen=True)
class Settings:
    """How meshes are made; lengths are over the reach of the surface, or over what edges should be."""

    aim: float = 0.72
    """Share of the tolerance at which edges are as long as the curvature lets them be: few must be halved then."""

    coarse: float = 8e-3
    """The tolerance for the triangles that are then cut, over the reach; `more` is added to the number of parts."""

    more: float = 0.0
    longest: float = 0.3
    grade: float = 0.5
    """Of edges, over the reach; and by how much their length may grow from one end to the other, over it."""

    bent: float = 1.2
    """Edges over the smaller radius of curvature, of faces and of curves."""

    long: float = 1.35
    short: float = 0.7
    longer: float = 1.3
    """Edges that are split, that are collapsed, and that are the longest that a collapse makes."""

    folded: float = 0.3
    """Cosine with the normals at its corners below which a triangle counts as folded."""

    good: float = 0.5
    """Sine of the angle below which a triangle away from curves is mended."""

    flat: tuple[float, float, float] = (0.025, 0.025, 0.1)
    """The least height over the longest side of long triangles: where a vertex on a curve goes, one inside, and one
    inside a plane."""

    most: int = LARGEST
    """Triangles at most."""


class Ground(Protocol):
    """The queries of a surface, or of a solid's faces by their labels, near which the vertices of a mesh are."""

    reach: float
    """Half the diagonal of what holds it, or the distance from 0 of its furthest point."""

    faces: NDArray[np.int8]
    """The kinds of labels (L,): 0 for bent faces, 1 for ruled ones, 2 for planes."""

    knows_bends: bool
    """Whether curvatures are known, or must be taken from how normals turn."""

    def drawn(self, mesh: HalfEdges, to: Floats) -> tuple[Floats, Floats, Floats | None]:
        """Positions (V, 3) one step from `to` towards faces and curves, much nearer to them than before; and the
        normals (W, 3) and curvatures (W,) of wedges there."""

    def placed(self, points: Floats, labels: Integers, rims: Integers, reach: Floats) -> Floats:
        """Points (K, 3) projected onto where faces of labels (K, k), ascending, then -1, meet, or onto boundary curves
        of numbers (K,), -1 of none; no step is longer than its `reach` (K,)."""

    def projected(self, mesh: HalfEdges) -> tuple[Floats, Floats]:
        """All vertices (V, 3), which are near, projected onto their faces and curves, and normals (W, 3) there."""

    def local_geometry(self, points: Floats, labels: Integers) -> tuple[Floats, Floats | None]:
        """Unit normals (K, 3) and curvatures (K,) of faces at points on them."""

    def measured(self, mesh: HalfEdges, rows: Integers, halves: Integers) -> tuple[Floats, Floats]:
        """Distances of the insides of triangles and the middles of half edges from their faces and curves."""

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance (K,) of triangles (K, 3, 3) and their edges from a face."""


class Grading:
    """The grading of meshes of a ground for a tolerance: edge lengths follow curvature."""

    THINNINGS, SPLITTINGS, UNTANGLINGS, CALM = 40, 24, 8, 3
    """Passes of collapses, of splits, and about folded triangles at most: each ends when little changes.  And
    smoothings without splits at the end of these."""

    def __init__(self, ground: Ground, tolerance: float, settings: Settings) -> None:
        self.ground, self.tolerance, self.settings = ground, tolerance, settings
        self.ruled = bool(ground.faces.any())
        self.fine = settings.aim * tolerance

    def begun(self, first: Labelled) -> HalfEdges:
        """The half edges of a first mesh, with what is known of the surface at its vertices."""
        mesh = HalfEdges(first, self.ground.faces)
        self._evaluate(mesh, np.arange(len(mesh.vertex_of)))
        return mesh

    @property
    def parts(self) -> int:
        """The most parts into which `HalfEdges.cut` may cut edges, so that the triangles before that are coarse."""
        return max(1, int(np.sqrt(self.settings.coarse * self.ground.reach / self.tolerance) + self.settings.more))

    def graded(self, mesh: HalfEdges, parts: int, thin: bool = True) -> None:
        """Collapse and split edges to the lengths that the tolerance asks for once each is cut into so many parts."""
        if thin:
            self._thin(mesh, parts)
        if self.ruled:
            self._grow_curves(mesh, parts)
        self._grow(mesh, parts)
        if self.ruled:
            self._straighten(mesh, parts)

    def halve_long(self, mesh: HalfEdges, parts: float) -> None:
        """Split edges above their target length until none is left, leaving short ones alone, as across strips."""
        for _ in range(self.SPLITTINGS):
            self._sizes(mesh, parts)
            size = len(mesh.points)
            self._split(mesh, self._longest(mesh), careful=True)
            if len(mesh.points) == size:
                return
            mesh.flip(self.fine)

    def _sizes(self, mesh: HalfEdges, parts: float) -> None:
        if not self.ground.knows_bends:
            mesh.bend()
        s = self.settings
        mesh.size(parts, self.fine, s.longest * self.ground.reach, s.bent, s.grade)

    def _thin(self, mesh: HalfEdges, parts: float) -> None:
        """Collapse edges below their target length, smoothing now and then, until few vertices go."""
        for step in range(self.THINNINGS):
            checkpoint(f"coarsening the first triangles ({len(mesh.labels)})")
            self._sizes(mesh, parts)
            few = self._collapse(mesh) <= 0.02 * len(mesh.points)
            if few or step % 6 == 5:
                self._relax(mesh)
            if few:
                return

    def _collapse(self, mesh: HalfEdges, only_fresh: bool = False) -> int:
        """Collapse edges below their target length, those of the least ratio to it first; returns their number."""
        ratios = mesh.ratios
        rows = np.flatnonzero((ratios < self.settings.short) & (mesh.twins < np.arange(len(ratios))))
        if only_fresh:
            rows = rows[mesh.fresh[mesh.corners[rows]] | mesh.fresh[mesh.corners[following(rows)]]]
            mesh.fresh[:] = False
        order, straight = ratios[rows], np.flatnonzero(ratios[rows] <= 0.05)
        order[straight] = 1e-3 * mesh.lengths(rows[straight])  # along lines of ruled faces
        rows = rows[np.argsort(order, kind="stable")]
        return mesh.collapse(rows, self.settings.longer, TURNED, self.settings.flat)

    def _grow(self, mesh: HalfEdges, parts: float) -> None:
        """Split edges above their target length, and smooth, until none is left after some smoothings."""
        smoothed = 0
        for _ in range(self.SPLITTINGS):
            checkpoint(f"making the first triangles ({len(mesh.labels)})")
            self._sizes(mesh, parts)
            long, size = self._longest(mesh), len(mesh.points)
            if len(long):
                self._split(mesh, long, careful=True)
            if len(mesh.points) == size:
                smoothed += 1
                if smoothed > self.CALM:
                    return
            self._relax(mesh)

    def _grow_curves(self, mesh: HalfEdges, parts: float) -> None:
        """Split edges on curves that are above their target length, so that ruled faces get their corners there."""
        for _ in range(self.SPLITTINGS):
            checkpoint(f"cutting curves ({len(mesh.labels)} triangles)")
            self._sizes(mesh, parts)
            long, size = self._long_curves(mesh), len(mesh.points)
            self._split(mesh, long, careful=True)
            if len(mesh.points) == size:
                return
            mesh.flip(self.fine)

    @staticmethod
    def _long_curves(mesh: HalfEdges) -> Integers:
        """The half edges on curves that are above their target length, the longest first."""
        ratios, halves = mesh.ratios, np.arange(len(mesh.corners))
        rows = np.flatnonzero(mesh.on_curves & (ratios > 1.0) & ((mesh.twins < 0) | (mesh.twins > halves)))
        return rows[np.argsort(-ratios[rows], kind="stable")]

    def _longest(self, mesh: HalfEdges) -> Integers:
        """The longest half edge of each triangle where it is above its target length, the longest first."""
        ratios, count = mesh.ratios, len(mesh.labels)
        rows = 3 * np.arange(count) + ratios.reshape(-1, 3).argmax(axis=1)
        rows = rows[ratios[rows] > self.settings.long]
        rows = rows[np.argsort(-ratios[rows], kind="stable")]
        edge = np.maximum(rows, mesh.twins[rows])
        return rows[first_rows(edge, len(ratios))[edge] == np.arange(len(edge))]

    def _split(self, mesh: HalfEdges, halves: Integers, careful: bool = False) -> None:
        """Split half edges, the new vertices projected onto the surface.

        If `careful`, not where the projection goes to another side of the surface, as around a thin arm, so that the
        normal there is turned away from one at an end, or to another part of a curve, at more than half their length.
        """
        size, twins = len(mesh.points), mesh.twins[halves]
        own = mesh.labels[halves // 3]
        other = np.where(twins < 0, -1, mesh.labels[twins // 3])
        labels = np.stack([np.where(other < 0, own, np.minimum(own, other)), np.maximum(own, other)], axis=1)
        labels[other == own, 1] = labels[other < 0, 1] = -1
        middles, lengths = mesh.middles(NONE, halves), mesh.lengths(halves)
        places = self.ground.placed(middles, labels, mesh.rims_of(halves), lengths)
        normals, bends = self.ground.local_geometry(places, own)
        if careful:
            ends = mesh.normals[mesh.wedge_of[halves]], mesh.normals[mesh.wedge_of[following(halves)]]
            good = (dots(normals, ends[0]) > 0) & (dots(normals, ends[1]) > 0)
            good &= 2 * norms(places - middles) < lengths
            halves, places, normals = halves[good], places[good], normals[good]
            bends = None if bends is None else bends[good]
        mesh.split(halves)
        mesh.points[size:] = places
        wedges = np.flatnonzero(mesh.vertex_of >= size)
        known = np.diff(mesh.vertex_of[wedges], prepend=-1) > 0  # the first of a vertex has the half edge's label
        self._store(mesh, wedges[known], normals, bends)
        self._evaluate(mesh, wedges[~known])

    def _evaluate(self, mesh: HalfEdges, wedges: Integers) -> None:
        if len(wedges):
            found = self.ground.local_geometry(mesh.points[mesh.vertex_of[wedges]], mesh.face_of[wedges])
            self._store(mesh, wedges, *found)

    @staticmethod
    def _store(mesh: HalfEdges, wedges: Integers, normals: Floats, bends: Floats | None) -> None:
        mesh.normals[wedges] = normals
        mesh.bends[wedges] = 0.0 if bends is None else bends

    def _relax(self, mesh: HalfEdges) -> None:
        """Flip edges and smooth once."""
        mesh.flip(self.fine)
        mesh.settle(*self.ground.drawn(mesh, mesh.targets))

    def _straighten(self, mesh: HalfEdges, parts: float) -> None:
        """Collapse edges along the straight lines of ruled faces."""
        self._sizes(mesh, parts)
        mesh.fresh[:] = True
        only_fresh = False
        while True:
            checkpoint(f"coarsening the mesh ({len(mesh.labels)} triangles)")
            size = len(mesh.points)
            gone = self._collapse(mesh, only_fresh)
            mesh.flip(self.fine)
            only_fresh = True
            if gone < 0.005 * size:
                return

    def untangle(self, mesh: HalfEdges, folded: float) -> bool:
        """Collapse edges of folded triangles and smooth about them while that helps; whether there were some."""
        for number in range(self.UNTANGLINGS):
            checkpoint()
            bad = np.flatnonzero(mesh.cosines < folded)
            if not len(bad):
                return number > 0
            marked = np.zeros(len(mesh.points), dtype=bool)
            marked[mesh.triangles[bad]] = True
            rows = np.flatnonzero(
                (marked[mesh.corners] | marked[mesh.ends]) & (mesh.twins < np.arange(len(mesh.corners)))
            )
            rows = rows[np.argsort(mesh.lengths(rows), kind="stable")]
            mesh.size_plainly()
            mesh.collapse(rows, 0.0, KEPT, self.settings.flat)
            self._relax_about(mesh, np.flatnonzero(mesh.cosines < folded))
            mesh.plain = False
            mesh.flip(self.fine)
        return True

    def _relax_about(self, mesh: HalfEdges, rows: Integers) -> None:
        """Smooth vertices of triangles in given rows, and those next to them, and project them."""
        if not len(rows):
            return
        about = np.zeros(len(mesh.points), dtype=bool)
        about[mesh.triangles[rows]] = True
        about[mesh.triangles[about[mesh.triangles].any(axis=1)]] = True
        mesh.flip(self.fine)
        self._smooth(mesh, about)

    def _smooth(self, mesh: HalfEdges, about: Bools) -> None:
        """Move chosen vertices (V,) to the middles of their triangles, or along curves, and project them."""
        to, rows = mesh.targets, np.flatnonzero(about & (mesh.kinds < VertexKind.CORNER))
        labels, reach = mesh.labels_about(rows), mesh.sizes[rows] / 4
        mesh.points[rows] = self.ground.placed(to[rows], labels, mesh.rims_of(mesh.outgoing[rows]), reach)
        moved = np.zeros(len(mesh.points), dtype=bool)
        moved[rows] = True
        self._evaluate(mesh, np.flatnonzero(moved[mesh.vertex_of]))
