"""Boundaries of blends' solids without a lattice: surfaces' own meshes, strips that go on from them, and their ends.

A mesh of a surface ends in loops on its contacts; from these strips go on (see `pas.solid.strips`), and the last loops
are closed by a plane, or in walls by rings.  Where two bodies end in one plane and go on from it in each other with the
same neighbour, one strip joins their loops instead.

Guaranteed of their meshes: closed if the surfaces' are manifolds, each face within the tolerance as measured.  Not
promised: what a proof of the surface would have to say, that it is one sheet; a surface that ends elsewhere than in one
loop on each contact has no such mesh, nor have bodies whose meshes are not apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.mesh.closed import FaceMesh, refined_faces
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.projection import pair_normals
from pas.mesh.quality import Quality
from pas.mesh.rows import Integers
from pas.mesh.topology import Edges
from pas.mesh.walls import End, ring
from pas.piecewise import PiecewiseSurface
from pas.solid.field import SolidField
from pas.solid.strips import Chain, Sections, Strip, off_strip, rows_within

EQUAL = 2.0**-40
"""Coefficients that are off by less, over the largest, are the same: heights of caps are rounded to doubles."""

Loops = dict[tuple[int, int], Integers]
"""Vertices of the loop in which chain `c` of side `s` ends, in order, by `(s, c)`."""


@dataclass(frozen=True, eq=False)
class Side:
    """A surface, the name of its face, and what goes on from each of its contacts."""

    surface: PiecewiseSurface
    name: str
    chains: tuple[Chain, ...]

    def mesh(self, tolerance: float, quality: Quality, short: Sequence[int] = ()) -> tuple[Mesh, list[Integers]] | None:
        """Its mesh, and the loops in which chains end; those whose numbers are `short` end where they begin.

        None where the surface does not end in one loop on each contact and nowhere else.
        """
        stretch = max(chain.stretch for chain in self.chains)
        found = self.surface.mesh(tolerance / stretch, quality=quality)
        known = Edges(found.triangles, len(found.points)).loops
        nearest = [int(np.argmin([chain.off(found.points[loop]) for loop in known])) for chain in self.chains if known]
        if sorted(nearest) != [*range(len(self.chains))] or len(known) != len(nearest):
            return None
        made = _Faces([found.points], deviation=found.deviation or 0.0)
        made.add(self.name, found.triangles, found.normals)
        loops = [known[number] for number in nearest]
        for number, chain in enumerate(self.chains):
            for strip in chain.strips if number not in short else ():
                if not made.goes_on(strip, loops, number, tolerance):
                    return None
        return made.mesh, loops


class _Faces:
    """A mesh while it is made: blocks of points, and triangles by the names of their faces."""

    def __init__(self, points: Sequence[Floats], deviation: float) -> None:
        self.blocks, self.deviation = [*points], deviation
        self._faces: list[tuple[str, Integers, Floats]] = []

    @property
    def points(self) -> Floats:
        return np.concatenate(self.blocks)

    def add(self, name: str, triangles: Integers, normals: Floats) -> None:
        if len(triangles):
            self._faces.append((name, triangles, normals))

    def added(self, points: Floats) -> Integers:
        """The numbers of points (N, 3), now among those of the mesh."""
        first = sum(map(len, self.blocks))
        self.blocks.append(points)
        return np.arange(first, first + len(points))

    def goes_on(self, strip: Strip, loops: list[Integers], number: int, tolerance: float) -> bool:
        """Whether a strip goes on from a loop, which it then replaces by that in which it ends."""
        begin = self.points[loops[number]]
        rows = rows_within(strip, begin, tolerance)
        if rows is None:
            return False
        side, here, parts = End(strip.surface, np.zeros(3)), loops[number], []
        for row in rows:
            there = self.added(row)
            parts += [np.stack(corners, axis=1) for corners in _quads(here, there)]
            here = there
        triangles = np.concatenate(parts)
        self.add(strip.name, triangles, side.normals(self.points[triangles]))
        self.deviation = max(self.deviation, off_strip(strip.surface, [begin, *rows]))
        loops[number] = here
        return True

    @property
    def mesh(self) -> Mesh:
        """Faces of one name are one."""
        names = tuple(dict.fromkeys(name for name, _, _ in self._faces))
        faces = np.repeat([names.index(name) for name, _, _ in self._faces], [len(t) for _, t, _ in self._faces])
        triangles, normals = (np.concatenate([face[i] for face in self._faces]) for i in (1, 2))
        return Mesh(self.points, triangles, faces, names, normals, deviation=self.deviation)


def _quads(begin: Integers, end: Integers) -> list[tuple[Integers, Integers, Integers]]:
    """The corners of two triangles for each edge of a loop that has its mesh to the left, between it and another."""
    after, beyond = np.roll(begin, -1), np.roll(end, -1)
    return [(after, begin, end), (after, end, beyond)]


@dataclass(frozen=True, eq=False)
class SheetPart:
    """What bounds a blend's solid, one side, or an outer and an inner one; `place` is how it was moved."""

    sides: tuple[Side, ...]
    place: Affine | None = None

    def moved(self, map_: Affine) -> SheetPart:
        """Its image."""
        if self.place is None:
            return replace(self, place=map_)
        a, b, c = zip(*(map_.direction(column) for column in zip(*self.place.matrix, strict=True)), strict=True)
        return replace(self, place=Affine((a, b, c), map_.exact(self.place.shift)))

    def polynomial(self, polynomial: Polynomial) -> Polynomial:
        """The image of one."""
        return polynomial if self.place is None else self.place.polynomial(polynomial)

    @property
    def ends(self) -> Iterator[tuple[int, Polynomial]]:
        """The numbers of the chains that end in planes, and these, in place, positive outside."""
        for number, chain in enumerate(self.sides[0].chains):
            if chain.end is not None and chain.end.surface.degree == 1:
                yield number, self.polynomial(chain.end.surface)

    def tubes(self, number: int) -> list[Polynomial] | None:
        """The surfaces of a chain of each side, in place; None where it is no single straight strip of one quadric."""
        chains = [side.chains[number] for side in self.sides]
        if any(len(c.strips) > 1 or any(c.bowed) or not all(isinstance(s.rows, Sections) for s in c.strips) for c in chains):
            return None
        return [self.polynomial(chain.contact.surface) for chain in chains]

    def mesh(self, tolerance: float, quality: Quality, open_: Sequence[int], short: Sequence[int]) -> tuple[Mesh, Loops] | None:
        """Its mesh in place, and the loops of chains that are left open, all of them or but for their strips."""
        stretch = 1.0 if self.place is None else float(np.linalg.norm(self.place.floats[0], 2))
        found = [side.mesh(tolerance / stretch, quality, short) for side in self.sides]
        meshes, ends = [pair[0] for pair in found if pair], [pair[1] for pair in found if pair]
        if len(meshes) < len(self.sides):
            return None
        start = len(meshes[0].points)
        made = _Faces([mesh.points for mesh in meshes], max(mesh.deviation or 0.0 for mesh in meshes))
        for mesh, first in zip((meshes[0], *(mesh.flipped for mesh in meshes[1:])), (0, start), strict=False):
            for face, name in enumerate(mesh.names):
                made.add(name, mesh.triangles[mesh.faces == face] + first, mesh.normals[mesh.faces == face])
        loops = {(s, c): loop + s * start for s, side in enumerate(ends) for c, loop in enumerate(side)}
        for number, chain in enumerate(self.sides[0].chains):
            if number in (*open_, *short):
                continue
            if chain.end is None:
                return None
            if len(self.sides) > 1:
                triangles = ring(made.points, loops[0, number], loops[1, number], chain.end.axis, chain.name)
            else:
                (middle,) = made.added(made.points[loops[0, number]].mean(axis=0)[None])
                triangles = _fan(loops[0, number], int(middle))
                if chain.end.facing(made.points[triangles]).min() <= 0:
                    return None
            made.add(chain.name, triangles, chain.end.normals(made.points[triangles]))
        kept = {key: loop for key, loop in loops.items() if key[1] in (*open_, *short)}
        return made.mesh if self.place is None else made.mesh._moved(self.place), kept

    def through(self, number: int, side: int, points: Floats) -> Floats:
        """Points (N, 3) of a loop, in place, in which a chain begins, moved to where it ends."""
        chain, place = self.sides[side].chains[number], self.place
        local = points if place is None else place.inverse.points(points)
        for strip in chain.strips:
            local = strip.rows(local, 1.0)
        return local if place is None else place.points(local)


def _fan(loop: Integers, middle: int) -> Integers:
    """The triangles (T, 3) between a loop that has its mesh to the left and a vertex."""
    return np.stack([np.roll(loop, -1), loop, np.full(len(loop), middle)], axis=1)


@dataclass(frozen=True)
class Link:
    """Chain `number` of a part goes on through chain `other_number` of another one, from its end to its beginning."""

    part: int
    number: int
    other: int
    other_number: int


@dataclass(frozen=True, eq=False)
class SheetBody:
    """What bounds a solid: that of one blend, or of several that go on in one another by `links`."""

    parts: tuple[SheetPart, ...]
    links: tuple[Link, ...] = ()

    @classmethod
    def of(cls, sides: Sequence[Side]) -> SheetBody | None:
        """The body of a surface, or of a wall between two.

        There is one where

        - the region has a centre, from which all of it is seen;
        - each contact ends in a plane side of it, and where it goes on is a convex part of a quadric with the centre
          inside.  So all of that beyond the clip is seen from the centre through the disc in which the clip cuts it,
          which is in sides of the region; as no ray passes two sides, contacts that go on meet neither the region nor
          one another;
        - or the region opens through the contact by a cone from the centre, in or out of which what goes on stays;
        - of a wall, inner strips are inside the outer ones, as points of them show.

        All else, tori that go on and axes that miss the region's centre by more than the radius, has none, and its
        solid is meshed from a lattice.
        """
        chains = [chain for side in sides for chain in side.chains]
        if sides[0].surface.partition.center is None or not all(chain.sound for chain in chains):
            return None
        walls = zip(sides[0].chains, sides[-1].chains, strict=True) if len(sides) > 1 else ()
        return cls((SheetPart(tuple(sides)),)) if all(outer.holds(inner) for outer, inner in walls) else None

    def moved(self, map_: Affine) -> SheetBody:
        """Its image."""
        return replace(self, parts=tuple(part.moved(map_) for part in self.parts))

    def united(self, other: SheetBody) -> SheetBody:
        """Both together; where ends of two parts are in one plane, and their neighbours are the same, they are linked."""
        first = len(self.parts)
        shifted = [replace(k, part=k.part + first, other=k.other + first) for k in other.links]
        parts, links = (*self.parts, *other.parts), [*self.links, *shifted]
        taken = {pair for k in links for pair in ((k.part, k.number), (k.other, k.other_number))}
        free = [
            [(p, number, plane) for p, part in enumerate(some, start) for number, plane in part.ends]
            for some, start in ((self.parts, 0), (other.parts, first))
        ]
        for p, number, plane in free[0]:
            for q, other_number, facing in free[1]:
                if {(p, number), (q, other_number)} & taken or not _same(plane, -facing):
                    continue
                pair = parts[p].tubes(number), parts[q].tubes(other_number)
                if pair[0] and pair[1] and len(pair[0]) == len(pair[1]) and all(map(_same, *pair)):
                    there = parts[q].sides[0].chains[other_number].strips
                    ways = ((p, number), (q, other_number)) if there else ((q, other_number), (p, number))
                    if parts[ways[1][0]].sides[0].chains[ways[1][1]].strips:
                        links.append(Link(*ways[0], *ways[1]))
                        taken |= {(p, number), (q, other_number)}
        return SheetBody(parts, tuple(links))

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where a surface is not as wished."""
        made = _Faces([], 0.0)
        loops: list[Loops] = []
        spans = []
        for number, part in enumerate(self.parts):
            open_ = [k.number for k in self.links if k.part == number]
            short = [k.other_number for k in self.links if k.other == number]
            found = part.mesh(tolerance, quality, open_, short)
            if found is None:
                return None
            first = sum(map(len, made.blocks))
            made.blocks.append(found[0].points)
            made.deviation = max(made.deviation, found[0].deviation or 0.0)
            for face, name in enumerate(found[0].names):
                rows = found[0].faces == face
                made.add(name, found[0].triangles[rows] + first, found[0].normals[rows])
            loops.append({key: loop + first for key, loop in found[1].items()})
            spans.append(slice(first, first + len(found[0].points)))
        if len(self.parts) > 1 and not self._apart(made.points, spans, loops, made.deviation):
            return None
        for link in self.links:
            self._join(made, link, loops)
        return made.mesh if made.deviation <= tolerance else None

    def _join(self, made: _Faces, link: Link, loops: Sequence[Loops]) -> None:
        """The strip of a link, on each side."""
        one, other = self.parts[link.part], self.parts[link.other]
        plane = one.polynomial(one.sides[0].chains[link.number].end.surface)
        axis = plane.gradient(np.zeros(3))
        for side in range(len(one.sides)):
            chain = other.sides[side].chains[link.other_number]
            near, far = loops[link.part][side, link.number], loops[link.other][side, link.other_number]
            points = made.points
            flat = points.copy()
            flat[far] = other.through(link.other_number, side, points[far])
            triangles = ring(flat, near, far, axis / np.linalg.norm(axis), chain.strips[0].name)
            tube = End(other.polynomial(chain.contact.surface), axis)
            corners = points[triangles]
            made.deviation = max(made.deviation, tube.off(((corners + np.roll(corners, 1, axis=1)) / 2).reshape(-1, 3)))
            turned = triangles if side == 0 else triangles[:, ::-1]
            made.add(chain.strips[0].name, turned, tube.normals(points[turned]) * (1 if side == 0 else -1))

    def _apart(self, points: Floats, spans: Sequence[slice], loops: Sequence[Loops], off: float) -> bool:
        """Whether planes of ends, or boxes, show that parts have nothing in common but the loops by which they are
        linked; `off` is how far meshes are from them."""
        planes = [(p, n, plane) for p, part in enumerate(self.parts) for n, plane in part.ends]
        slopes = np.array([[1 / np.linalg.norm(s), *(s / np.linalg.norm(s))] for s in (q.dense(1)[1:] for *_, q in planes)])
        raise NotImplementedError


def _same(one: Polynomial, other: Polynomial) -> bool:
    """Whether two polynomials are one another's multiples by a positive factor, to rounding."""
    degree = max(one.degree, other.degree)
    a, b = (p.dense(degree) / np.abs(p.dense(degree)).max() for p in (one, other))
    return bool(np.abs(a - b).max() <= EQUAL)
