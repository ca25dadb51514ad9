"""Boundaries of blends' solids without a lattice: surfaces' own meshes, the strips that continue them, and their ends.

A mesh of a surface ends in loops on its contacts; from these strips go on (see `pas.solid.strips`), and the last loops
are closed by a plane, or in walls by rings.

Which solids are bounded like that: `SheetBody.of`.  Guaranteed of their meshes: closed if the surfaces' are manifolds,
each face within the tolerance as measured.  Not promised: what a proof of the surface would have to say, that it is one
sheet; a surface that ends elsewhere than in one loop on each contact has no such mesh.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats, Integers
from pas.mesh.closed import refined_faces
from pas.mesh.field import label_of
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.refusals import FaceMesh
from pas.mesh.rows import norms
from pas.mesh.topology import Edges
from pas.piecewise import PiecewiseSurface
from pas.solid.bounds import hull
from pas.solid.faces import Faces, PlacedBody
from pas.solid.field import SolidField
from pas.solid.strips import Chain, Sections, SolidStrip, go_on

EQUAL = 2.0**-40
"""Coefficients that are off by less, over the largest, are the same: heights of caps are rounded to doubles."""

ROOM = 2.0
"""Over the distances of two such meshes from their bodies, how far these must be apart."""

Loops = dict[tuple[int, int], Integers]
"""Vertices of the loop in which chain `c` of side `s` ends, in order, by `(s, c)`."""

Loose: TypeAlias = tuple[Mesh, list[Integers]]
"""A mesh, and loops of its vertices that have it to their left."""


class Bounding(Protocol):
    """One side of a body, with the chains that continue it at its ends."""

    @property
    def chains(self) -> tuple[Chain, ...]:
        """The chains that continue it."""

    def mesh(self, tolerance: float, quality: Quality, without: Collection[int] = ()) -> Loose | None:
        """The mesh with the strips of chains, but for some by number, and the loops in which these end; None for
        none."""


@dataclass(frozen=True, eq=False)
class Side:
    """A surface, the name of its face, and the chain that continues each of its contacts."""

    surface: PiecewiseSurface
    name: str
    chains: tuple[Chain, ...]

    def mesh(self, tolerance: float, quality: Quality, without: Collection[int] = ()) -> Loose | None:
        """See `Bounding`; None where the surface does not end in one loop on each contact and nowhere else."""
        stretch = max(chain.stretch for chain in self.chains)
        found = self.surface.mesh(tolerance / stretch, quality=quality)
        known = Edges(found.triangles, len(found.points)).loops
        nearest = [int(np.argmin([chain.off(found.points[loop]) for loop in known])) for chain in self.chains if known]
        if sorted(nearest) != [*range(len(self.chains))] or len(known) != len(nearest):
            return None
        made = Faces()
        made.put(replace(found, names=(self.name,)))
        loops = [known[number] for number in nearest]
        return (made.mesh, loops) if go_on(made, self.chains, loops, tolerance, without) else None


def surface_box(mesh: Mesh) -> Floats:
    """A box (2, 3) that holds the surface of a mesh: the mesh's own, widened by its deviation."""
    return mesh.box + ROOM * (mesh.deviation or 0.0) * np.array([[-1.0], [1.0]])


def merged(mesh: Mesh, order: Sequence[str]) -> Mesh:
    """The mesh with faces of equal names merged, in a given order."""
    names = sorted({*mesh.names}, key=order.index)
    return replace(mesh, faces=np.array([names.index(name) for name in mesh.names])[mesh.faces], names=tuple(names))


class LinkableEnd(NamedTuple):
    """The end of a chain of straight strips: its number, the plane in which they end, positive outside, their length,
    the surfaces of all sides, and a point (3,) where they begin."""

    number: int
    plane: Polynomial
    length: float
    tubes: tuple[Polynomial, ...]
    place: Floats


@dataclass(frozen=True, eq=False)
class SheetBody(PlacedBody):
    """The boundary of a blend's solid: one side, or an outer and an inner one."""

    sides: tuple[Bounding, ...]

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
        - of a wall, inner strips are inside the outer ones, as points of them show;
        - the names of faces differ.

        All else, tori that go on and axes that miss the region's centre by more than the radius, has none, and its
        solid is meshed from a lattice.
        """
        chains = [chain for side in sides for chain in side.chains]
        names = [
            *(s.name for s in sides),
            *(c.name for c in sides[0].chains),
            *(t.name for c in chains for t in c.strips),
        ]
        if sides[0].surface.partition.center is None or not all(chain.sound for chain in chains):
            return None
        if len({*names}) != len(names):
            return None
        walls = zip(sides[0].chains, sides[-1].chains, strict=True) if len(sides) > 1 else ()
        return cls(tuple(sides)) if all(outer.holds(inner) for outer, inner in walls) else None

    @property
    def extent(self) -> float:
        """The longest side of a box around the curves in which surfaces end, before it was moved."""
        points = np.concatenate([chain.curve for side in self.sides for chain in side.chains])
        return float(np.ptp(points, axis=0).max())

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        found = self.opened(tolerance, quality, {})
        return None if found is None else found[0]

    def opened(self, tolerance: float, quality: Quality, ends: Mapping[int, bool]) -> tuple[Mesh, Loops] | None:
        """The mesh without the ends of some chains, by number, and if false without their strips, with the open loops.

        None where a surface has no mesh that ends as it should.
        """
        stretch = self.stretch
        short = [number for number, whole in ends.items() if not whole]
        found = [side.mesh(tolerance / stretch, quality, short) for side in self.sides]
        made, loops = Faces(), Loops({})
        for number, pair in enumerate(found):
            if pair is None:
                return None
            first = made.put(pair[0], flipped=number > 0)
            loops |= {(number, chain): loop + first for chain, loop in enumerate(pair[1])}
        for number, chain in enumerate(self.sides[0].chains):
            outer, inner = loops[0, number], loops.get((1, number))
            if number not in ends and not made.ended(chain.end, chain.name, outer, inner):
                return None
        if made.deviation > tolerance / stretch:
            return None
        mesh = made.mesh
        left = {key: loop for key, loop in loops.items() if key[1] in ends}
        return mesh if self.place is None else mesh._moved(self.place), left

    def _placed(self, polynomial: Polynomial) -> Polynomial:
        return polynomial if self.place is None else self.place.polynomial(polynomial)

    @cached_property
    def ends(self) -> tuple[LinkableEnd, ...]:
        """The ends of chains that may be linked: with at most one straight strip of a quadric on each side."""
        found, place = list[LinkableEnd](), self.place
        for number, chain in enumerate(self.sides[0].chains):
            sides = [side.chains[number] for side in self.sides]
            strips = [(strip, bowed) for side in sides for strip, bowed in zip(side.strips, side.bowed, strict=True)]
            straight = not any(bowed or not isinstance(strip.rows, Sections) for strip, bowed in strips)
            if straight and len(strips) <= len(sides) and chain.clip.surface.degree == 1:
                tubes = tuple(self._placed(side.contact.surface) for side in sides)
                plane, start = self._placed(chain.end.surface), chain.curve[0]
                start = start if place is None else place.points(start)
                length = -float(plane(start) / np.linalg.norm(plane.gradient(start)))
                found.append(LinkableEnd(number, plane, length if strips else 0.0, tubes, start))
        return tuple(found)

    @cached_property
    def boxes(self) -> dict[str, Floats]:
        """The box (2, 3) of each face of the coarse mesh, by its name."""
        mesh = self.coarse
        assert mesh is not None
        points = mesh.points[mesh.triangles]
        corners = {name: points[mesh.faces == face].reshape(-1, 3) for face, name in enumerate(mesh.names)}
        return {name: np.stack([some.min(axis=0), some.max(axis=0)]) for name, some in corners.items()}

    @cached_property
    def box(self) -> Floats:
        """The box (2, 3) of all."""
        return hull([*self.boxes.values()])

    def carried(self, strip: SolidStrip, points: Floats, share: float) -> Floats:
        """Points (N, 3) of the loop in which a strip begins, moved a share of the way along it."""
        if self.place is None:
            return strip.rows(points, share)
        return self.place.points(strip.rows(self.place.inverse.points(points), share))

    def named(self, number: int) -> set[str]:
        """The names of the faces that continue a contact, its end included."""
        chains = [side.chains[number] for side in self.sides]
        return {chains[0].name, *(strip.name for chain in chains for strip in chain.strips)}

    def beside(self, plane: Polynomial, room: float, without: set[str]) -> set[str] | None:
        """The faces, but for some, that come as near as `room` to a plane, positive outside; None where one is beyond
        it."""
        mesh = self.coarse
        assert mesh is not None
        kept = np.array([name not in without for name in mesh.names])[mesh.faces]
        heights = (plane(mesh.points) / np.linalg.norm(plane.gradient(np.zeros(3))))[mesh.triangles[kept]]
        if heights.max() > EQUAL * (1 + np.abs(mesh.points).max()):
            return None
        return {mesh.names[face] for face in np.unique(mesh.faces[kept][(heights > -room).any(axis=1)])}


def face_mesh(mesh: Mesh, field: SolidField, tolerance: float, quality: Quality) -> FaceMesh:
    """A mesh of a body with labels, by its faces' names, in a field's coordinates; remeshed where its long triangles
    are not wanted.  Faces of one name that are on different functions are apart in the mesh.
    """
    columns = field.evaluator.columns[: field.evaluator.used]
    points = field.evaluator.local(mesh.points)
    numbers, sides = np.zeros((2, len(mesh.names)), dtype=np.intp)
    for face, name in enumerate(mesh.names):
        known = np.array([n for n, c in enumerate(columns) if name in c.names])
        rows = np.flatnonzero(mesh.faces == face)[:16]
        corners, normals = points[mesh.triangles[rows]].reshape(-1, 3), mesh.normals[rows].reshape(-1, 3)
        jets = field.evaluator.jets(np.tile(corners, (len(known), 1)), known.repeat(len(corners)))
        jets = (jets / np.maximum(norms(jets[:, 1:]), 1e-300)[:, None]).reshape(len(known), -1, 4)
        cosines = (jets[..., 1:] * normals).sum(axis=-1)
        # Where two faces meet both are zero, so that one corner does not tell, nor do normals alone.
        off = (np.abs(jets[..., 0]) + 1 - np.abs(cosines)).mean(axis=1)
        best = int(np.argmin(np.nan_to_num(off, nan=np.inf)))
        numbers[face], sides[face] = known[best], cosines[best].sum() < 0
    # Apexes are exact up to rounding.
    special = [np.flatnonzero(norms(points - point) < 2.0**-36) for point in field.special_points]
    pinned = np.concatenate([np.empty(0, dtype=np.intp), *special])
    made = Labelled.of(points, mesh.triangles, label_of(numbers, sides)[mesh.faces], pinned)
    if quality is Quality.ANGLES:
        return refined_faces(made, field, tolerance / field.scale, quality)
    return FaceMesh(made, (mesh.deviation or 0.0) / field.scale)
