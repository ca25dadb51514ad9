"""Boundaries of unions of blends' solids that go on in one another, as nodes of a lattice of struts do.

Where flat ends of two bodies are in one plane, seen from opposite sides, and neighbours of one surface end there, the
bodies are linked: their ends are within the union, and what goes on from one is joined to what goes on from the other.
Elsewhere they must be apart, as boxes of them show, or planes of ends that part them, in which they have nothing but
ends whose boxes are apart.  That is looked at on meshes, with their distances from the bodies added, so it is as sure
as these are measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.walls import End, ring
from pas.solid.sheets import ROOM, Faces, Loops, SheetBody, roomy
from pas.solid.strips import Sections, SolidStrip

EQUAL = 2.0**-40
"""Coefficients that are off by less, over the largest, are the same: heights of caps are rounded to doubles."""


class SolidBoundary(Protocol):
    """What bounds a solid, of which it gives a mesh without a lattice."""

    @property
    def size(self) -> float | None:
        """The longest side of a box around it, as a coarse mesh shows it."""

    @property
    def box(self) -> Floats | None:
        """Two corners (2, 3) of a box that holds it, as a coarse mesh shows with room around it."""

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where there is none."""

    def moved(self, map_: Affine) -> SolidBoundary:
        """Its image."""


@dataclass(frozen=True, eq=False)
class Link:
    """Chain `number` of part `part` ends where chain `other_number` of part `other` does."""

    part: int
    number: int
    other: int
    other_number: int


@dataclass(frozen=True, eq=False)
class LinkedPart:
    """One of the bodies of a union, with what is asked of it when it is united with others."""

    body: SheetBody

    def _placed(self, polynomial: Polynomial) -> Polynomial:
        return polynomial if self.body.place is None else self.body.place.polynomial(polynomial)

    @cached_property
    def ends(self) -> tuple[tuple[int, Polynomial, tuple[Polynomial, ...]], ...]:
        """Of the chains that may be linked, single straight strips of quadrics on each side, their numbers, the planes
        in which they end, positive outside, and the surfaces of all sides."""
        found = []
        for number, chain in enumerate(self.body.sides[0].chains):
            sides = [side.chains[number] for side in self.body.sides]
            kinds = [[isinstance(strip.rows, Sections) for strip in side.strips] for side in sides]
            if all(kind == [True] for kind in kinds) and not any(side.bowed[0] for side in sides):
                tubes = tuple(self._placed(side.contact.surface) for side in sides)
                found.append((number, self._placed(chain.end.surface), tubes))
        return tuple(found)

    @cached_property
    def boxes(self) -> dict[str, Floats]:
        """The box (2, 3) of each face of the coarse mesh, by its name."""
        mesh = self.body.coarse
        assert mesh is not None
        points = mesh.points[mesh.triangles]
        corners = {name: points[mesh.faces == face].reshape(-1, 3) for face, name in enumerate(mesh.names)}
        return {name: np.stack([some.min(axis=0), some.max(axis=0)]) for name, some in corners.items()}

    @cached_property
    def box(self) -> Floats:
        """The box (2, 3) of all."""
        found = np.array([*self.boxes.values()])
        return np.stack([found[:, 0].min(axis=0), found[:, 1].max(axis=0)])

    def carried(self, strip: SolidStrip, points: Floats) -> Floats:
        """Points (N, 3) of the loop in which a strip begins, moved to where it ends."""
        place = self.body.place
        return strip.rows(points, 1.0) if place is None else place.points(strip.rows(place.inverse.points(points), 1.0))

    def named(self, number: int) -> set[str]:
        """The names of the faces that go on from a contact, to its end."""
        chains = [side.chains[number] for side in self.body.sides]
        return {chains[0].name, *(strip.name for chain in chains for strip in chain.strips)}

    def beside(self, plane: Polynomial, room: float) -> set[str] | None:
        """The faces that come as near as `room` to a plane, positive outside; None where one is beyond it."""
        mesh = self.body.coarse
        assert mesh is not None
        slope = plane.gradient(np.zeros(3))
        heights = plane(mesh.points) / np.linalg.norm(slope)
        if heights.max() > EQUAL * (1 + np.abs(mesh.points).max()):
            return None
        return {mesh.names[face] for face in np.unique(mesh.faces[(heights > -room)[mesh.triangles].any(axis=1)])}


@dataclass(frozen=True, eq=False)
class LinkedBodies:
    """Several bodies that are apart but for the `links` in which they go on in one another."""

    parts: tuple[LinkedPart, ...]
    links: tuple[Link, ...] = ()

    @property
    def size(self) -> float:
        """The longest side of a box around all of them, as coarse meshes show it."""
        return float(np.ptp(self._box, axis=0).max())

    @property
    def box(self) -> Floats:
        """Two corners (2, 3) of a box that holds all of them, as coarse meshes show with room around them."""
        known = [part.body.coarse.deviation or 0.0 for part in self.parts if part.body.coarse]
        return roomy(self._box, max(known))

    @cached_property
    def _box(self) -> Floats:
        boxes = np.array([part.box for part in self.parts])
        return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])

    def moved(self, map_: Affine) -> LinkedBodies:
        """Its image."""
        return replace(self, parts=tuple(LinkedPart(part.body.moved(map_)) for part in self.parts))

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where a body has none."""
        made, loops = Faces([], 0.0), list[Loops]()
        for number, part in enumerate(self.parts):
            ends = {k.number: True for k in self.links if k.part == number}
            ends |= {k.other_number: False for k in self.links if k.other == number}
            found = part.body.opened(tolerance, quality, ends)
            if found is None:
                return None
            first = made.put(found[0])
            loops.append({key: loop + first for key, loop in found[1].items()})
        points = made.points
        for link in self.links:
            self._join(made, points, link, loops[link.part], loops[link.other])
        return made.mesh if made.deviation <= tolerance else None

    def _join(self, made: Faces, points: Floats, link: Link, near: Loops, far: Loops) -> None:
        """The strip of a link, on each side, between the loops in which one chain ends and the other begins."""
        other = self.parts[link.other]
        _, plane, tubes = next(end for end in other.ends if end[0] == link.other_number)
        slope = -plane.gradient(np.zeros(3))
        axis = slope / np.linalg.norm(slope)
        for side, tube in enumerate(tubes):
            loop, begin = near[side, link.number], far[side, link.other_number]
            (strip,) = other.body.sides[side].chains[link.other_number].strips
            flat = np.concatenate([points[loop], other.carried(strip, points[begin])])
            found = ring(flat, np.arange(len(loop)), np.arange(len(loop), len(flat)), axis, strip.name)
            triangles = np.concatenate([loop, begin])[found if side == 0 else found[:, ::-1]]
            corners, end = points[triangles], End(tube, axis)
            made.deviation = max(made.deviation, end.off((corners + np.roll(corners, 1, axis=1)) / 2))
            made.add(strip.name, triangles, end.normals(corners) * (1 if side == 0 else -1))


def united(one: SolidBoundary, other: SolidBoundary) -> LinkedBodies | None:
    """Both together; None where they are not found to be apart but for links."""
    if not isinstance(one, SheetBody | LinkedBodies) or not isinstance(other, SheetBody | LinkedBodies):
        return None
    these, those = ((b if isinstance(b, LinkedBodies) else LinkedBodies((LinkedPart(b),))) for b in (one, other))
    first, links = len(these.parts), list(these.links)
    links += [replace(k, part=k.part + first, other=k.other + first) for k in those.links]
    for i, mine in enumerate(these.parts):
        for j, its in enumerate(those.parts, first):
            meshes = mine.body.coarse, its.body.coarse
            if meshes[0] is None or meshes[1] is None:
                return None
            room = ROOM * sum(mesh.deviation or 0.0 for mesh in meshes if mesh)
            if _gap(mine.box, its.box) > room:
                continue
            found = tuple(_links(i, mine, j, its))
            if not _apart(mine, its, found, room):
                return None
            links += found
    return LinkedBodies((*these.parts, *those.parts), tuple(links))


def _links(i: int, one: LinkedPart, j: int, other: LinkedPart) -> Iterator[Link]:
    """Where two parts, `i` and `j`, go on in one another."""
    for number, plane, tubes in one.ends:
        for other_number, facing, surfaces in other.ends:
            if len(tubes) == len(surfaces) and _same(plane, -facing) and all(map(_same, tubes, surfaces)):
                yield Link(i, number, j, other_number)


def _apart(one: LinkedPart, other: LinkedPart, links: Sequence[Link], room: float) -> bool:
    """Whether two parts have nothing in common but the ends that `links` join, and are further apart than `room`."""
    joined = [(one.named(k.number), other.named(k.other_number)) for k in links]
    for plane in [plane for _, plane, _ in one.ends] + [-plane for _, plane, _ in other.ends]:
        mine, its = one.beside(plane, room), other.beside(-plane, room)
        if mine is None or its is None:
            continue
        if all(
            _gap(one.boxes[a], other.boxes[b]) > room or any(a in some and b in others for some, others in joined)
            for a in mine
            for b in its
        ):
            return True
    return False


def _gap(one: Floats, other: Floats) -> float:
    """How far two boxes (2, 3) are apart along an axis at least; negative where they meet."""
    return float(np.maximum(one[0] - other[1], other[0] - one[1]).max())


def _same(one: Polynomial, other: Polynomial) -> bool:
    """Whether two polynomials are one another's multiples by a positive factor, to rounding."""
    degree = max(one.degree, other.degree)
    a, b = (p.dense(degree) / np.abs(p.dense(degree)).max() for p in (one, other))
    return bool(np.abs(a - b).max() <= EQUAL)


@dataclass(frozen=True, eq=False)
class RenamedBoundary:
    """What bounds a solid, with other names of its faces."""

    body: SolidBoundary
    names: Mapping[str, str]

    @property
    def size(self) -> float | None:
        """That of the body."""
        return self.body.size

    @property
    def box(self) -> Floats | None:
        """That of the body."""
        return self.body.box

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """That of the body, in which several faces may have one name."""
        found = self.body.mesh(tolerance, quality)
        return found and replace(found, names=tuple(self.names.get(name, name) for name in found.names))

    def moved(self, map_: Affine) -> RenamedBoundary:
        """Its image."""
        return replace(self, body=self.body.moved(map_))
