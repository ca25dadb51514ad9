"""Boundaries of unions of blends' solids that continue one another, as nodes of a lattice of struts do.

Where neighbours of one surface end flat in one plane, seen from opposite sides, or overlap without reaching beyond
where the other one begins, the bodies are linked: their ends are within the union, and what goes on from one is joined
to what goes on from the other.  What reaches farther is refused where it leaves a blend (see `pas.solid.field`).

Elsewhere bodies must be apart, as boxes of them show, or planes that part them: any, or those of ends, in which they
have nothing but ends whose boxes are apart.  That is looked at on meshes, with their distances from the bodies added,
so it is as sure as these are measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational
from pas.arrays import Floats
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.solid.faces import Faces, SolidBoundary, ring
from pas.solid.runs import gap_between
from pas.solid.sheets import EQUAL, ROOM, Loops, SheetBody


@dataclass(frozen=True, eq=False)
class Link:
    """Chain `number` of part `part` continues chain `other_number` of part `other`, which is not shorter: its strip is
    omitted and replaced by the other's, from a `share` of the way along that; where it is None both strips are."""

    part: int
    number: int
    other: int
    other_number: int
    share: float | None

    def of(self, part: int) -> int:
        """The number of the chain of one of the two parts."""
        return self.number if part == self.part else self.other_number


@dataclass(frozen=True, eq=False)
class LinkedBodies(SolidBoundary):
    """Several bodies that are apart but for the `links` in which they continue one another."""

    parts: tuple[SheetBody, ...]
    links: tuple[Link, ...] = ()

    @cached_property
    def coarse(self) -> Mesh:
        made = Faces()
        for part in self.parts:
            made.put(part.coarse)  # type: ignore[arg-type]  # without which it is no part
        return made.mesh

    def moved(self, map_: Affine) -> LinkedBodies:
        return replace(self, parts=tuple(part.moved(map_) for part in self.parts))

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        made, loops = Faces(), list[Loops]()
        for number, part in enumerate(self.parts):
            ends = {k.number: k.share is not None for k in self.links if k.part == number}
            ends |= {k.other_number: False for k in self.links if k.other == number}
            found = part.opened(tolerance, quality, ends)
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
        _, plane, _, tubes, _ = next(end for end in other.ends if end.number == link.other_number)
        axis = unit(-plane.gradient(np.zeros(3)))
        for side, tube in enumerate(tubes):
            loop, begin = near[side, link.number], far[side, link.other_number]
            (strip,) = other.sides[side].chains[link.other_number].strips
            flat = np.concatenate([points[loop], other.carried(strip, points[begin], link.share or 1.0)])
            found = ring(flat, np.arange(len(loop)), np.arange(len(loop), len(flat)), axis, strip.name)
            triangles = np.concatenate([loop, begin])[found if side == 0 else found[:, ::-1]]
            made.put_curved(strip.name, triangles, tube.jets)


def united(one: SolidBoundary | None, other: SolidBoundary | None) -> LinkedBodies | None:
    """The boundary of a union; None where the two are not found to be apart but for links."""
    if not isinstance(one, SheetBody | LinkedBodies) or not isinstance(other, SheetBody | LinkedBodies):
        return None
    these, those = ((b if isinstance(b, LinkedBodies) else LinkedBodies((b,))) for b in (one, other))
    first, links = len(these.parts), list(these.links)
    links += [replace(k, part=k.part + first, other=k.other + first) for k in those.links]
    for i, mine in enumerate(these.parts):
        for j, its in enumerate(those.parts, first):
            meshes = mine.coarse, its.coarse
            if meshes[0] is None or meshes[1] is None:
                return None
            room = ROOM * sum(mesh.deviation or 0.0 for mesh in meshes if mesh)
            if box_gap(mine.box, its.box) > room:
                continue
            found = dict(_links(i, mine, j, its))
            gone = [{name for k in found for name in part.named(k.of(n))} for n, part in ((i, mine), (j, its))]
            planes = found.values() or [*(end.plane for end in mine.ends), *(-end.plane for end in its.ends)]
            parted = any(_parted(mine, gone[0], its, gone[1], plane, room) for plane in planes)
            if not parted and (found or gap_between(meshes[0].points, meshes[1].points) <= room):
                return None
            links += found
    return LinkedBodies((*these.parts, *those.parts), tuple(links))


def _links(i: int, one: SheetBody, j: int, other: SheetBody) -> Iterator[tuple[Link, Polynomial]]:
    """The links between two parts, `i` and `j`, each with a plane amid the shared tube, positive towards `j`."""
    for mine, its in product(one.ends, other.ends):
        if len(mine.tubes) != len(its.tubes) or not all(map(_same, mine.tubes, its.tubes)):
            continue
        way, its_way = (unit(end.plane.gradient(np.zeros(3))) for end in (mine, its))
        rounding, (short, long) = EQUAL * (1 + np.abs(mine.place).max()), sorted((mine.length, its.length))
        overlap = short + long - float((its.place - mine.place) @ way)
        if way @ its_way <= EQUAL - 1 and long > rounding and -rounding <= overlap <= short + rounding:
            ends, share = [(i, mine.number), (j, its.number)], 1 - overlap / long
            first, second = ends if its.length >= mine.length else ends[::-1]
            raised = float(np.linalg.norm(mine.plane.gradient(mine.place))) * overlap / 2
            yield Link(*first, *second, share if share > EQUAL else None), mine.plane + rational(raised)


def _parted(
    one: SheetBody, gone: set[str], other: SheetBody, its_gone: set[str], plane: Polynomial, room: float
) -> bool:
    """Whether a plane, positive towards the other one, is between two parts without some faces, and what comes as near
    as `room` to it is further apart than that."""
    mine, its = one.beside(plane, room, gone), other.beside(-plane, room, its_gone)
    if mine is None or its is None:
        return False
    return all(box_gap(one.boxes[a], other.boxes[b]) > room for a in mine for b in its)


def box_gap(one: Floats, other: Floats) -> float:
    """The largest distance of two boxes (2, 3) along an axis; negative where they meet."""
    return float(np.maximum(one[0] - other[1], other[0] - one[1]).max())


def _same(one: Polynomial, other: Polynomial) -> bool:
    """Whether two polynomials are one another's multiples by a positive factor, to rounding."""
    degree = max(one.degree, other.degree)
    a, b = (p.dense(degree) / np.abs(p.dense(degree)).max() for p in (one, other))
    return bool(np.abs(a - b).max() <= EQUAL)


@dataclass(frozen=True, eq=False)
class RenamedBoundary(SolidBoundary):
    """A boundary of a solid with other names of its faces."""

    body: SolidBoundary
    names: Mapping[str, str]

    @property
    def coarse(self) -> Mesh | None:
        return self.body.coarse

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """The mesh of the body, in which several faces may have one name."""
        found = self.body.mesh(tolerance, quality)
        return found and replace(found, names=tuple(self.names.get(name, name) for name in found.names))

    def moved(self, map_: Affine) -> RenamedBoundary:
        return replace(self, body=self.body.moved(map_))
