"""From few triangles with the topology of a surface to triangles within a tolerance, graded by curvature.

One driver for open meshes of a surface and closed ones of a solid.  Edges are made as long as the curvature lets them
be at q^2 times the tolerance (see `pas.mesh.grading`).  Each edge is then cut into q parts, the new vertices are
projected onto the faces, and what is measured to be too far is halved.  Ruled faces are not cut.  Triangles that one of
these steps folds are untangled, as where a surface is singular and its normals turn at once; at last slender triangles
are mended.

The topology stays.  That no triangle is folded, and how far edges and triangles are from the surface at all points that
are looked at, is measured on the result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.grading import Grading
from pas.mesh.halfedges import HalfEdges, VertexKind
from pas.mesh.refusals import FaceMesh
from pas.mesh.rows import any_of, largest_of


@dataclass(frozen=True)
class Failure:
    """Why a mesh did not come out, and a point (3,) near which; how far it was from the surface with so many triangles.

    It is `crowded` where there would be too many."""

    why: str
    place: Floats
    reached: float = np.inf
    triangles: int = 0
    crowded: bool = False
    size: float = 0.0
    """The length of the longest edge."""


class Remesher(Grading):
    """The remeshing of a ground within a tolerance."""

    REFINEMENTS, ROUNDS = 40, 8
    """Passes of halvings and of mending at most: each ends when little changes."""

    def refined(self, mesh: HalfEdges) -> FaceMesh | Failure:
        """The mesh within the tolerance of a graded one, made for `parts`."""
        fits = int(np.sqrt(self.settings.most / len(mesh.labels)))
        inside, along = self.measured(mesh)
        parts = self._fewest_parts(mesh, inside, along)
        if fits < parts:
            return self._too_many(mesh, inside, along, max(fits, 1))
        if parts < self.parts:
            self.graded(mesh, parts, thin=False)
        while True:
            checkpoint(f"cutting the triangles ({len(mesh.labels)} into {parts**2} each)")
            cut = mesh.cut(parts) if parts > 1 else mesh
            checkpoint()
            cut.points[:], cut.normals[:] = self.ground.projected(cut)
            if self.ruled:
                cut.flip(self.fine)
            if not self.ground.knows_bends or parts == 1:  # else fewer parts are tried before
                self.untangle(cut, self.settings.folded)
            if parts == 1 or cut.cosines.min() >= self.settings.folded:
                break
            parts = max(1, parts // 4)  # next to curves that are close to one another finer triangles fold
            self.graded(mesh, parts, thin=False)
        return self.within(cut, upright=parts > 1)

    def _fewest_parts(self, mesh: HalfEdges, inside: Floats, along: Floats) -> int:
        """The number of parts into which to cut edges that gives the fewest triangles after the rest is halved."""
        bent = self.ground.faces[mesh.labels] == 0
        off = np.maximum(inside, largest_of(along.reshape(-1, 3)))[bent] / self.tolerance
        least = self.parts if self.ground.knows_bends else 1  # else edges may be shorter than they need be
        squares = np.arange(least, 2 * self.parts + 1)[:, None] ** 2  # by which distances fall and numbers grow
        costs = np.where(off <= squares, squares, 2 * np.maximum(off, squares)).sum(axis=1)
        return int(np.argmin(costs)) + least

    def _too_many(self, mesh: HalfEdges, inside: Floats, along: Floats, parts: int) -> Failure:
        """The failure of too many triangles, with the tolerance reached with as many as there may be."""
        reached = float(max(inside.max(), along.max())) / parts**2
        return Failure("too many triangles", mesh.points[0], reached, len(mesh.labels) * parts**2, True)

    def measured(self, mesh: HalfEdges, before: tuple[Integers, Floats, Floats] | None = None) -> tuple[Floats, Floats]:
        """Distances of triangles' insides (T,) and half edges (3 T,); those of triangles `before` are known."""
        inside, along = np.empty(len(mesh.labels)), np.empty(len(mesh.corners))
        rows, halves = np.arange(len(inside)), np.flatnonzero(mesh.twins < np.arange(len(along)))
        if before is not None:
            old, known_inside, known_along = before
            stale, count = np.ones(len(inside), dtype=bool), len(old)
            stale[:count] = any_of(mesh.triangles[:count] != old)
            inside[:count], along[: 3 * count] = known_inside, known_along
            rows = np.flatnonzero(stale)
            halves = (3 * rows[:, None] + np.arange(3)).ravel()
            twins = mesh.twins[halves]
            known = (twins >= 0) & ~stale[twins // 3]
            along[halves[known]] = along[twins[known]]
            halves = halves[~known & (twins < halves)]
        inside[rows], found = self.ground.measured(mesh, rows, halves)
        twins = mesh.twins[halves]
        along[halves] = along[np.where(twins < 0, halves, twins)] = found
        return inside, along

    def within(self, mesh: HalfEdges, mend: bool = True, upright: bool = False) -> FaceMesh | Failure:
        """The mesh, of which no triangle is folded if it is `upright`, with edges halved until all that is measured is
        within the tolerance."""
        before, worst, last = None, np.inf, np.inf
        for step in range(self.REFINEMENTS):
            checkpoint(f"measuring the mesh ({len(mesh.labels)} triangles)")
            if not (upright and step == 0) and self.untangle(mesh, self.settings.folded):
                before = None
            checkpoint()
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
        far = int(np.argmax(np.maximum(inside, largest_of(along.reshape(-1, 3)))))
        size = float(mesh.lengths(np.arange(len(mesh.corners))).max())
        return Failure("the tolerance was not reached", self._middle(mesh, far), worst, len(mesh.labels), size=size)

    def _far(self, mesh: HalfEdges, inside: Floats, along: Floats) -> Integers:
        """The half edges to halve, the longest first: those too far, and the longest of triangles too far inside."""
        far = along > self.tolerance
        rows = np.flatnonzero((inside > self.tolerance) & ~any_of(far.reshape(-1, 3)))
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
            mesh.fresh[mesh.triangles[any_of(mesh.triangles >= size)]] = True
            mesh.flip(self.tolerance, only_fresh=True)
        return old, inside, along

    def _finished(self, mesh: HalfEdges, worst: float, mend: bool) -> FaceMesh | Failure:
        if mend:
            worst = max(worst, self.mended(mesh))
        cosines = mesh.cosines
        if not cosines.min() >= self.settings.folded:
            size = float(mesh.lengths(np.arange(len(mesh.corners))).max())
            place = self._middle(mesh, int(np.argmin(cosines)))
            return Failure("some triangles are folded", place, worst, len(mesh.labels), size=size)
        return FaceMesh(mesh.value, worst)

    @staticmethod
    def _middle(mesh: HalfEdges, row: int) -> Floats:
        return np.asarray(mesh.points[mesh.triangles[row]].mean(axis=0))

    def mended(self, mesh: HalfEdges) -> float:
        """Move vertices of slender triangles inside faces to better places; the largest distance of what changed."""
        mesh.fresh[:], worst, good = True, 0.0, self.settings.good
        free = self._free(mesh)
        for _ in range(self.ROUNDS):
            sines = mesh.fresh_sines
            rows = np.flatnonzero(sines < good)
            rows = rows[self.ground.faces[mesh.labels[rows]] == 0]
            corners = mesh.triangles[rows[np.argsort(sines[rows], kind="stable")]].ravel()
            slender = np.zeros(len(mesh.points), dtype=bool)
            slender[corners] = True
            mesh.fresh[:] &= slender  # others are looked at again where a neighbour has moved
            vertices, places = mesh.better(good, corners[free[corners]])
            if not len(vertices):
                break
            checkpoint(f"mending slender triangles ({len(rows)})")
            labels, far = mesh.labels_at(vertices), np.full(len(vertices), np.inf)
            places = self.ground.placed(places, labels[:, None], np.full(len(labels), -1), far)
            off = self._off(mesh, vertices, places)
            near = off <= self.tolerance
            worst = max(worst, float(off[near].max(initial=0.0)))
            if not mesh.move(vertices, places, self.ground.local_geometry(places, labels)[0], near, good):
                break
        return worst

    @staticmethod
    def _free(mesh: HalfEdges) -> Bools:
        """The vertices (V,) inside faces, not beside the boundary, so that no move takes one out of the region."""
        result, edge = mesh.kinds == VertexKind.INSIDE, mesh.twins[mesh.outgoing] < 0
        result[mesh.triangles[any_of(edge.take(mesh.triangles))]] = False
        return result

    def _off(self, mesh: HalfEdges, vertices: Integers, places: Floats) -> Floats:
        """The largest distance of the triangles about vertices (K,) with these at positions (K, 3)."""
        rows, owners = mesh.stars(vertices)
        triangles = mesh.triangles[rows]
        own = (triangles == vertices[owners][:, None])[..., None]
        corners = np.where(own, places[owners][:, None], mesh.points.take(triangles, axis=0))
        result = np.zeros(len(vertices))
        np.maximum.at(result, owners, self.ground.farthest(corners, mesh.labels[rows]))
        return result
