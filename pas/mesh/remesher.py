"""From few triangles with the topology of a surface to triangles within a tolerance, graded by curvature.

One driver for open meshes of a surface and closed ones of a solid.  Edges are made as long as the curvature lets them be
at q^2 times the tolerance: collapsed, split, flipped, vertices moved to the middle of their triangles.  Each edge is then
cut into q parts, the new vertices are projected onto the faces, and what is measured to be too far is halved.  On ruled
faces an edge is as long as its own sag allows, so that triangles along straight lines are long ones; these are not cut.
At last slender triangles are mended.

The topology stays.  That no triangle is folded, and how far edges and triangles are from the surface at all points that
are looked at, is measured on the result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.limits import checkpoint
from pas.mesh.field import Floats, Integers
from pas.mesh.ground import Ground
from pas.mesh.halfedges import TURNED, HalfEdges, Kind, following
from pas.mesh.labelled import Labelled
from pas.mesh.refine import LARGEST
from pas.mesh.rows import dots

NOWHERE = np.empty(0, dtype=np.intp)


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

    most: int = LARGEST
    """Triangles at most."""


@dataclass(frozen=True)
class Failure:
    """Why a mesh did not come out, and a point (3,) near which; how far it was from the surface with so many triangles.

    It is `crowded` where there would be too many."""

    why: str
    place: Floats
    reached: float = np.inf
    triangles: int = 0
    crowded: bool = False


@dataclass(frozen=True)
class Remeshed:
    """A mesh, and the largest distance from the surface that was measured."""

    mesh: Labelled
    deviation: float


class Remesher:
    """What makes a mesh of a ground, within a tolerance."""

    THINNINGS, SPLITTINGS, REFINEMENTS, ROUNDS, CALM = 40, 24, 40, 8, 3
    """Passes of collapses, of splits, of halvings and of mending at most: each ends when little changes.  And smoothings
    without splits at the end of these."""

    def __init__(self, ground: Ground, tolerance: float, settings: Settings) -> None:
        self.ground, self.tolerance, self.settings = ground, tolerance, settings
        self.ruled = bool(ground.faces.any())
        self.fine = settings.aim * tolerance

    def begun(self, first: Labelled) -> HalfEdges:
        """The half edges of a first mesh, with what is known of the surface at its vertices."""
        mesh = HalfEdges(first, self.ground.faces)
        self._look(mesh, np.arange(len(mesh.vertex_of)))
        return mesh

    @property
    def parts(self) -> int:
        """Into how many parts edges may be cut, so that the triangles before that are coarse."""
        return max(1, int(np.sqrt(self.settings.coarse * self.ground.reach / self.tolerance) + self.settings.more))

    # Edges as long as the curvature lets them be

    def graded(self, mesh: HalfEdges, parts: int, thin: bool = True) -> None:
        """Give the edges the lengths for a tolerance of `parts` squared times the one aimed at."""
        tolerance = self.fine * parts**2
        if thin:
            self._thin(mesh, tolerance)
        if self.ruled:
            self._grow_curves(mesh, tolerance)
        self._grow(mesh, tolerance)
        if self.ruled:
            self._straighten(mesh, tolerance)

    def _sizes(self, mesh: HalfEdges, tolerance: float) -> None:
        if not self.ground.knows_bends:
            mesh.bend()
        s = self.settings
        mesh.size(tolerance, self.fine, s.longest * self.ground.reach, s.bent, s.grade)

    def _thin(self, mesh: HalfEdges, tolerance: float) -> None:
        """Collapse edges that are shorter than they may be, smoothing now and then, until few vertices go."""
        for step in range(self.THINNINGS):
            checkpoint(f"coarsening the first triangles ({len(mesh.labels)})")
            self._sizes(mesh, tolerance)
            few = self._collapse(mesh) <= 0.02 * len(mesh.points)
            if few or step % 6 == 5:
                self._relax(mesh)
            if few:
                return

    def _collapse(self, mesh: HalfEdges, only_fresh: bool = False) -> int:
        """Collapse edges that are too short, the shortest for what they should be first."""
        ratios, corners, ends = mesh.ratios, mesh.corners, mesh.ends
        chosen = (ratios < self.settings.short) & (mesh.twins < np.arange(len(corners)))
        if only_fresh:
            chosen &= mesh.fresh[corners] | mesh.fresh[ends]
            mesh.fresh[:] = False
        rows = np.flatnonzero(chosen)
        order, straight = ratios[rows], np.flatnonzero(ratios[rows] <= 0.05)
        order[straight] = 1e-3 * mesh.lengths(rows[straight])  # along lines of ruled faces
        rows = rows[np.argsort(order, kind="stable")]
        return mesh.collapse(rows, self.settings.longer, TURNED, 1.0)

    def _grow(self, mesh: HalfEdges, tolerance: float) -> None:
        """Split edges that are longer than they may be, and smooth, until none is after some smoothings without splits."""
        smoothed = 0
        for _ in range(self.SPLITTINGS):
            checkpoint(f"making the first triangles ({len(mesh.labels)})")
            self._sizes(mesh, tolerance)
            long, size = self._longest(mesh), len(mesh.points)
            if len(long):
                self._split(mesh, long, careful=True)
            if len(mesh.points) == size:
                smoothed += 1
                if smoothed > self.CALM:
                    return
            self._relax(mesh)

    def _grow_curves(self, mesh: HalfEdges, tolerance: float) -> None:
        """Split edges on curves that are longer than they may be, so that ruled faces get their corners there."""
        for _ in range(self.SPLITTINGS):
            self._sizes(mesh, tolerance)
            long = self._long_curves(mesh)
            if not len(long):
                return
            self._split(mesh, long)
            mesh.flip(self.fine)

    @staticmethod
    def _long_curves(mesh: HalfEdges) -> Integers:
        """The half edges on curves that are too long, the longest first."""
        ratios, halves = mesh.ratios, np.arange(len(mesh.corners))
        rows = np.flatnonzero(mesh.on_curves & (ratios > 1.0) & ((mesh.twins < 0) | (mesh.twins > halves)))
        return rows[np.argsort(-ratios[rows], kind="stable")]

    def _longest(self, mesh: HalfEdges) -> Integers:
        """The half edges that are the longest of a triangle, and too long, the longest first."""
        ratios, count = mesh.ratios, len(mesh.labels)
        rows = 3 * np.arange(count) + ratios.reshape(-1, 3).argmax(axis=1)
        rows = rows[ratios[rows] > self.settings.long]
        rows = rows[np.argsort(-ratios[rows], kind="stable")]
        edge = np.maximum(rows, mesh.twins[rows])
        first = np.unique(edge, return_index=True)[1]
        return rows[np.sort(first)]

    def _split(self, mesh: HalfEdges, halves: Integers, careful: bool = False) -> None:
        """Split half edges, the new vertices on the surface; if `careful`, not those whose middles are nearer to another
        side of it, as around a thin arm, so that the normal there is turned away from one at an end."""
        size, twins = len(mesh.points), mesh.twins[halves]
        own = mesh.labels[halves // 3]
        other = np.where(twins < 0, -1, mesh.labels[twins // 3])
        labels = np.stack([np.where(other < 0, own, np.minimum(own, other)), np.maximum(own, other)], axis=1)
        labels[other == own, 1] = labels[other < 0, 1] = -1
        middles = mesh.middles(NOWHERE, halves)[1]
        places = self.ground.placed(middles, labels, np.where(twins < 0, -1 - twins, -1), mesh.lengths(halves))
        if careful:
            normals = self.ground.looked(places, own)[0]
            ends = mesh.normals[mesh.wedge_of[halves]], mesh.normals[mesh.wedge_of[following(halves)]]
            good = (dots(normals, ends[0]) > 0) & (dots(normals, ends[1]) > 0)
            halves, places = halves[good], places[good]
        mesh.split(halves)
        mesh.points[size:] = places
        self._look(mesh, np.flatnonzero(mesh.vertex_of >= size))

    def _look(self, mesh: HalfEdges, wedges: Integers) -> None:
        normals, bends = self.ground.looked(mesh.points[mesh.vertex_of[wedges]], mesh.face_of[wedges])
        mesh.normals[wedges] = normals
        mesh.bends[wedges] = 0.0 if bends is None else bends

    def _relax(self, mesh: HalfEdges, turned: float = TURNED, about: NDArray[np.bool_] | None = None) -> None:
        """Flip edges and smooth once, all vertices or those `about` (V,)."""
        mesh.flip(self.fine)
        to = mesh.targets
        if about is not None:
            to[~about] = mesh.points[~about]
        mesh.settle(*self.ground.drawn(mesh, to), turned)

    def _straighten(self, mesh: HalfEdges, tolerance: float) -> None:
        """Leave out vertices on the lines of ruled faces."""
        self._sizes(mesh, tolerance)
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

    # Cut into parts, and halved where it is too far

    def refined(self, mesh: HalfEdges) -> Remeshed | Failure:
        """The mesh within the tolerance of a graded one, made for `parts`."""
        fits = int(np.sqrt(self.settings.most / len(mesh.labels)))
        inside, along = self.measured(mesh)
        parts = self._fewest_parts(mesh, inside, along)
        if fits < parts:
            return self._too_many(mesh, inside, along, max(fits, 1))
        if parts < self.parts:
            self.graded(mesh, parts, thin=False)
        while True:
            cut = mesh.cut(parts) if parts > 1 else mesh
            cut.points[:], cut.normals[:] = self.ground.projected(cut)
            if parts == 1 or cut.cosines.min() >= self.settings.folded:
                break
            parts = max(1, parts // 4)  # next to curves that are close to one another finer triangles fold
            self.graded(mesh, parts, thin=False)
        return self.within(cut)

    def _fewest_parts(self, mesh: HalfEdges, inside: Floats, along: Floats) -> int:
        """Into how many parts to cut edges, so that few triangles come out after the rest is halved."""
        bent = self.ground.faces[mesh.labels] == 0
        off = np.maximum(inside, along.reshape(-1, 3).max(axis=1))[bent] / self.tolerance
        least = self.parts if self.ground.knows_bends else 1  # else edges may be shorter than they need be
        squares = np.arange(least, 2 * self.parts + 1)[:, None] ** 2  # by which distances fall and numbers grow
        costs = np.where(off <= squares, squares, 2 * np.maximum(off, squares)).sum(axis=1)
        return int(np.argmin(costs)) + least

    def _too_many(self, mesh: HalfEdges, inside: Floats, along: Floats, parts: int) -> Failure:
        """That there would be too many triangles, and what is reached with as many as there may be."""
        reached = float(max(inside.max(), along.max())) / parts**2
        return Failure("too many triangles", mesh.points[0], reached, len(mesh.labels) * parts**2, True)

    def measured(self, mesh: HalfEdges, before: tuple[Integers, Floats, Floats] | None = None) -> tuple[Floats, Floats]:
        """Distances of triangles' insides (T,) and half edges (3 T,); those of triangles `before` are known."""
        stale, count = np.ones(len(mesh.labels), dtype=bool), 0
        inside, along = np.empty(len(mesh.labels)), np.empty(len(mesh.corners))
        if before is not None:
            old, known_inside, known_along = before
            count = len(old)
            stale[:count] = (mesh.triangles[:count] != old).any(axis=1)
            inside[:count], along[: 3 * count] = known_inside, known_along
        rows = np.flatnonzero(stale)
        halves = (3 * rows[:, None] + np.arange(3)).ravel()
        twins = mesh.twins[halves]
        known = (twins >= 0) & ~stale[twins // 3]
        along[halves[known]] = along[twins[known]]
        halves = halves[~known & (twins < halves)]
        inside[rows], found = self.ground.measured(mesh, rows, halves)
        along[halves] = found
        twins = mesh.twins[halves]
        along[twins[twins >= 0]] = found[twins >= 0]
        return inside, along

    def within(self, mesh: HalfEdges, mend: bool = True) -> Remeshed | Failure:
        """The mesh with edges halved until all that is measured is within the tolerance."""
        before, worst, last = None, np.inf, np.inf
        for step in range(self.REFINEMENTS):
            checkpoint(f"measuring the mesh ({len(mesh.labels)} triangles)")
            if not self.ground.knows_bends and self.untangle(mesh):
                before = None
            inside, along = self.measured(mesh, before)
            worst = float(max(inside.max(), along.max()))
            if worst <= self.tolerance:
                return self._finished(mesh, worst, mend)
            if step % 4 == 0:
                if step > 8 and not worst < 0.9 * last:
                    break
                last = worst
            halves = self._far(mesh, inside, along)
            if len(mesh.labels) + 2 * len(halves) > self.settings.most:
                return Failure("too many triangles", mesh.points[0], worst, len(mesh.labels), True)
            before = self._halved(mesh, halves, step, inside, along)
        far = int(np.argmax(np.maximum(inside, along.reshape(-1, 3).max(axis=1))))
        return Failure("the tolerance was not reached", self._middle(mesh, far), worst, len(mesh.labels))

    def _far(self, mesh: HalfEdges, inside: Floats, along: Floats) -> Integers:
        """The half edges to halve, the longest first: those too far, and the longest of triangles too far inside."""
        far = along > self.tolerance
        rows = np.flatnonzero((inside > self.tolerance) & ~far.reshape(-1, 3).any(axis=1))
        sides = 3 * rows[:, None] + np.arange(3)
        far[3 * rows + mesh.lengths(sides.ravel()).reshape(-1, 3).argmax(axis=1)] = True
        halves = np.flatnonzero(far)
        twins = mesh.twins[halves]
        halves = halves[(twins < 0) | (twins > halves) | ~far[twins]]
        return halves[np.argsort(-mesh.lengths(halves), kind="stable")]

    def _halved(
        self, mesh: HalfEdges, halves: Integers, step: int, inside: Floats, along: Floats
    ) -> tuple[Integers, Floats, Floats]:
        """Halve edges, and flip others beside them at first; what is known of the triangles before."""
        old, size = mesh.triangles.copy(), len(mesh.points)
        mesh.fresh[:] = False
        self._split(mesh, halves)
        if step < 2 or (self.ruled and step < 12):  # a flip may leave an edge that is too far again
            mesh.fresh[mesh.triangles[(mesh.triangles >= size).any(axis=1)]] = True
            mesh.flip(self.tolerance, only_fresh=True)
        return old, inside, along

    def _finished(self, mesh: HalfEdges, worst: float, mend: bool) -> Remeshed | Failure:
        if mend:
            worst = max(worst, self.mended(mesh))
        cosines = mesh.cosines
        least = 0.2 if not self.ground.knows_bends else self.settings.folded
        if not cosines.min() >= least:
            return Failure("some triangles are folded", self._middle(mesh, int(np.argmin(cosines))))
        return Remeshed(mesh.value, worst)

    @staticmethod
    def _middle(mesh: HalfEdges, row: int) -> Floats:
        return np.asarray(mesh.points[mesh.triangles[row]].mean(axis=0))

    # Mending

    def mended(self, mesh: HalfEdges) -> float:
        """Move vertices of slender triangles inside faces to better places; how far what changed is at most."""
        mesh.fresh[:], worst = True, 0.0
        still = np.zeros(len(mesh.points), dtype=bool)
        still[mesh.triangles[(mesh.kinds != Kind.INSIDE)[mesh.triangles].any(axis=1) & self._on_boundary(mesh)]] = True
        for _ in range(self.ROUNDS):
            sines = mesh.sines
            rows = np.flatnonzero((sines < self.settings.good) & (self.ground.faces[mesh.labels] == 0))
            corners = mesh.triangles[rows[np.argsort(sines[rows], kind="stable")]].ravel()
            vertices, places = mesh.better(
                self.settings.good, corners[(mesh.kinds[corners] == Kind.INSIDE) & ~still[corners]]
            )
            if not len(vertices):
                break
            checkpoint(f"mending slender triangles ({len(rows)})")
            labels = mesh.label_of[vertices]
            places = self.ground.placed(places, labels[:, None], np.full(len(labels), -1), np.full(len(labels), np.inf))
            rows, owners = mesh.stars(vertices)
            triangles = mesh.triangles[rows]
            corners3 = np.where(
                (triangles == vertices[owners][:, None])[..., None], places[owners][:, None], mesh.points[triangles]
            )
            off = self.ground.farthest(corners3, mesh.labels[rows])
            good = np.ones(len(vertices), dtype=bool)
            good[owners[off > self.tolerance]] = False
            worst = max(worst, float(off[good[owners]].max(initial=0.0)))
            if not mesh.move(vertices, places, self.ground.looked(places, labels)[0], good, self.settings.good):
                break
        return worst

    @staticmethod
    def _on_boundary(mesh: HalfEdges) -> NDArray[np.bool_]:
        """The triangles (T,) with a vertex on the boundary: what is next to that stays, so that nothing leaves it."""
        edge = mesh.rim_of >= 0
        return np.asarray(edge[mesh.triangles].any(axis=1))

    def untangle(self, mesh: HalfEdges, folded: float = 0.2) -> bool:
        """Collapse edges of folded triangles and smooth about them, as far as that goes; whether there were some."""
        for number in range(8):
            bad = np.flatnonzero(mesh.cosines < folded)
            if not len(bad):
                return number > 0
            marked = np.zeros(len(mesh.points), dtype=bool)
            marked[mesh.triangles[bad]] = True
            chosen = (marked[mesh.corners] | marked[mesh.ends]) & (mesh.twins < np.arange(len(mesh.corners)))
            rows = np.flatnonzero(chosen)
            rows = rows[np.argsort(mesh.lengths(rows), kind="stable")]
            mesh.plain = True
            mesh.collapse(rows, 0.0, 0.35, 1e9)
            left = np.flatnonzero(mesh.cosines < folded)
            if len(left):
                about = np.zeros(len(mesh.points), dtype=bool)
                about[mesh.triangles[left]] = True
                about[mesh.triangles[about[mesh.triangles].any(axis=1)]] = True
                self._relax(mesh, -2.0, about)
            mesh.plain = False
            mesh.flip(self.fine)
        return True
