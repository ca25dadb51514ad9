"""Boundaries of blends' solids without a lattice: surfaces' own meshes, tubes along straight lines, and flat ends.

A contact of degree 2 whose matrix, in x, y, z and 1, has rank 3 is a cylinder or cone, made of straight lines through
one point, which may be at infinity.  Sections by parallel planes are images of one another under a homothety from that
point, or a translation, so that a mesh which ends on the clip goes on from it along these lines, with all its new
vertices on the contact.

Which solids are bounded like that: `SheetBody.of`.  Guaranteed of their meshes: closed if the surfaces' are manifolds,
each face within the tolerance as measured.  Not promised: what a proof of the surface would have to say, that it is one
sheet; a surface that ends elsewhere than in one loop on each contact has no such mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, to_float, to_floats
from pas.contacts.contact import Contact
from pas.mesh.closed import FaceMesh, refined_faces
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.projection import pair_normals
from pas.mesh.quality import Quality
from pas.mesh.rows import Integers
from pas.mesh.topology import Edges
from pas.mesh.walls import End, ring
from pas.piecewise import PiecewiseSurface
from pas.solid.field import SolidField, quadric


@dataclass(frozen=True, eq=False)
class RuledEnd:
    """A contact from its clip on, between two parallel planes: x goes along its line to `stretch x + shift`.

    `clip` is the first plane, positive on the tube's side; nothing goes on where `length` is 0.
    """

    contact: Contact
    clip: End
    length: float = 0.0
    stretch: float = 1.0
    shift: Floats | float = 0.0

    @classmethod
    def of(cls, contact: Contact, plane: Polynomial, length: fmpq, center: Vector | None = None) -> RuledEnd | None:
        """The tube of a `length` (the model's units) beyond a plane, positive on its side, in which a contact ends.

        None where the contact is no cylinder or cone, or `center` is not inside of it, on its nappe.
        """
        slope = plane.gradient(np.zeros(3))
        size = float(np.linalg.norm(slope))
        clip = End(plane, slope / size)
        if contact.surface.degree != 2 or length == 0:
            return cls(contact, clip) if contact.surface.degree == 2 else None
        matrix = quadric(contact.surface)
        found = nullspace([{j: matrix[i, j] for j in range(4)} for i in range(4)], 4).tolist()
        if len(found) != 1:
            return None
        apex, w = found[0][:3], found[0][3]
        x, y, z = apex if w == 0 else (c / w for c in apex)
        height = plane.raw(x, y, z) - (plane.raw(0, 0, 0) if w == 0 else 0)
        if height == 0 or (center is not None and not _within(contact.surface, plane, center, height, w != 0)):
            return None
        step = to_float(length) * size / to_float(height)
        shift = step * np.array(to_floats((x, y, z)))
        return cls(contact, clip, to_float(length), 1.0 - step if w != 0 else 1.0, shift)

    def carried(self, points: Floats) -> Floats:
        """Points (N, 3) of the clip moved to where the tube ends."""
        return self.stretch * points + self.shift

    def off(self, points: Floats) -> float:
        """How far points (N, 3) are at most from the curve in which it begins, to first order."""
        return max(self.clip.off(points), self.sides.off(points))

    @property
    def sides(self) -> End:
        """The contact's surface, seen along the tube."""
        return End(self.contact.surface, self.clip.axis)

    def holds(self, other: RuledEnd) -> bool:
        """Whether another one, between the same planes, is inside, as points of both of its ends show."""
        points = other.contact.rim.points()
        return bool((self.contact.surface(np.stack([points, other.carried(points)])) < 0).all())


def _within(surface: Polynomial, plane: Polynomial, center: Vector, apex: fmpq, cone: bool) -> bool:
    """Whether a point is inside a cylinder or cone, and of a cone, with the apex at a height, on the plane's nappe."""
    return bool(surface.raw(*center) <= 0 and (not cone or (plane.raw(*center) - apex) * -apex > 0))


@dataclass(frozen=True, eq=False)
class Side:
    """A surface with a tube at each of its ends."""

    surface: PiecewiseSurface
    tubes: tuple[RuledEnd, ...]

    def mesh(self, tolerance: float, quality: Quality) -> tuple[Mesh, list[Integers]] | None:
        """Its mesh, whose faces are the surface and each tube, and the loops in which the tubes end.

        None where the surface does not end in one loop on each contact and nowhere else.
        """
        found = self.surface.mesh(tolerance / max(1.0, *(tube.stretch for tube in self.tubes)), quality=quality)
        known = Edges(found.triangles, len(found.points)).loops
        nearest = [int(np.argmin([tube.off(found.points[loop]) for loop in known])) for tube in self.tubes if known]
        if sorted(nearest) != [*range(len(self.tubes))] or len(known) != len(nearest):
            return None
        loops = [known[number] for number in nearest]
        points, parts, normals = [found.points], [found.triangles], [found.normals]
        off, far = [found.deviation or 0.0], []
        for tube, begin in zip(self.tubes, loops, strict=True):
            rims = [found.points[begin], tube.carried(found.points[begin])]
            off += [tube.sides.off((rim + np.roll(rim, -1, axis=0)) / 2) for rim in rims]
            end = begin if tube.length == 0 else np.arange(len(begin)) + sum(map(len, points))
            points += rims[1:] if tube.length else []
            far.append(end)
            quads = [np.stack(corners, axis=1) for corners in _quads(begin, end)] if tube.length else []
            parts.append(np.concatenate(quads) if quads else np.empty((0, 3), dtype=np.intp))
            normals.append(tube.sides.normals(np.concatenate(points)[parts[-1]]))
        return _joined(points, parts, normals, ("",) * len(parts), max(off)), far


def _quads(begin: Integers, end: Integers) -> list[tuple[Integers, Integers, Integers]]:
    """The corners of two triangles for each edge of a loop that has its mesh to the left, between it and another."""
    after, beyond = np.roll(begin, -1), np.roll(end, -1)
    return [(after, begin, end), (after, end, beyond)]


def _joined(
    points: Sequence[Floats],
    parts: Sequence[Integers],
    normals: Sequence[Floats],
    names: tuple[str, ...],
    deviation: float,
) -> Mesh:
    """The mesh whose faces are given by their triangles; `names` are those of all of them."""
    faces = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return Mesh(
        np.concatenate(points), np.concatenate(parts), faces, names, np.concatenate(normals), deviation=deviation
    )


@dataclass(frozen=True, eq=False)
class SheetBody:
    """What bounds a blend's solid: one side, or an outer and an inner one, and flat ends.

    `names` are those of the faces: of each side its surface and its tubes, then of the ends.  `maps` are what it was
    moved by, the first one first.
    """

    sides: tuple[Side, ...]
    names: tuple[str, ...]
    maps: tuple[Affine, ...] = ()

    @classmethod
    def of(
        cls,
        surfaces: Sequence[PiecewiseSurface],
        planes: Sequence[Polynomial],
        lengths: Sequence[fmpq],
        names: Sequence[str],
    ) -> SheetBody | None:
        """The body of a surface, or of a wall between two, with contacts that go on from `planes` by `lengths`.

        There is one where

        - the region has a centre, from which all of it is seen, and each contact ends in a plane side of it;
        - each contact is of degree 2, and where it goes on a cylinder or a cone with the centre inside, on its nappe.
          Such a set is convex, so that all of it beyond the clip is seen from the centre through the disc in which the
          clip cuts it, which is in sides of the region; as no ray passes two sides, contacts that go on meet neither
          the region nor one another;
        - of a wall, inner contacts that go on are inside the outer ones where they begin and end, and so between;
        - the names differ.

        All else, plates, openings, spheres, tori and axes that miss the region's centre by more than the radius, has
        None, and its solid is meshed from a lattice.
        """
        center = surfaces[0].partition.center
        if center is None or len({*names}) != len(names) or any(j.opening for s in surfaces for j in s.joins):
            return None
        sides = []
        for surface, middle in zip(surfaces, (center, None), strict=False):
            cases = zip(surface.contacts, planes, lengths, strict=True)
            tubes = [tube for case in cases if (tube := RuledEnd.of(*case, middle)) is not None]
            sides.append(Side(surface, tuple(tubes)))
        if any(len(side.tubes) != len(planes) for side in sides):
            return None
        walls = zip(sides[0].tubes, sides[-1].tubes, strict=True) if len(sides) > 1 else ()
        return cls(tuple(sides), tuple(names)) if all(outer.holds(inner) for outer, inner in walls) else None

    def moved(self, map_: Affine) -> SheetBody:
        """Its image."""
        return replace(self, maps=(*self.maps, map_))

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where a surface is not as wished."""
        stretch = float(np.prod([np.linalg.norm(m.floats[0], 2) for m in self.maps]))
        found = [side.mesh(tolerance / stretch, quality) for side in self.sides]
        meshes, loops = [pair[0] for pair in found if pair], [pair[1] for pair in found if pair]
        if len(meshes) < len(self.sides):
            return None
        outer, inner = meshes[0], [mesh.flipped for mesh in meshes[1:]]
        start, planes = len(outer.points), [tube.clip for tube in self.sides[0].tubes]
        points = np.concatenate([mesh.points for mesh in (outer, *inner)])
        if inner:
            pairs = zip(loops[0], loops[1], planes, strict=True)
            ends = [ring(points, a, b + start, plane.axis, "an end") for a, b, plane in pairs]
        else:
            middles = np.array([points[loop].mean(axis=0) for loop in loops[0]])
            points = np.concatenate([points, middles])
            ends = [_fan(loop, start + number) for number, loop in enumerate(loops[0])]
        parts, normals = [], []
        for mesh, first in zip((outer, *inner), (0, start), strict=False):
            rows = [mesh.faces == face for face in range(1 + len(planes))]
            parts += [mesh.triangles[row] + first for row in rows]
            normals += [mesh.normals[row] for row in rows]
        normals += [plane.normals(points[end]) for plane, end in zip(planes, ends, strict=True)]
        made = _joined([points], [*parts, *ends], normals, self.names, max(m.deviation or 0.0 for m in meshes))
        return self._placed(_without_empty(made), stretch)

    def _placed(self, mesh: Mesh, stretch: float) -> Mesh:
        """A mesh of what it was before it was moved, moved."""
        for map_ in self.maps:
            matrix = map_.floats[0]
            turned = mesh.normals @ np.linalg.inv(matrix)
            normals = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
            triangles, step = mesh.triangles, -1 if np.linalg.det(matrix) < 0 else 1
            points, normals = map_.points(mesh.points), normals[:, ::step]
            mesh = replace(mesh, points=points, triangles=triangles[:, ::step], normals=normals)
        return replace(mesh, deviation=stretch * (mesh.deviation or 0.0))


def _fan(loop: Integers, middle: int) -> Integers:
    """The triangles (T, 3) between a loop that has its mesh to the left and a vertex."""
    return np.stack([np.roll(loop, -1), loop, np.full(len(loop), middle)], axis=1)


def _without_empty(mesh: Mesh) -> Mesh:
    """The mesh without names of faces that have no triangles."""
    kept = np.unique(mesh.faces)
    return replace(mesh, faces=np.searchsorted(kept, mesh.faces), names=tuple(mesh.names[k] for k in kept.tolist()))


def face_mesh(mesh: Mesh, field: SolidField, tolerance: float, quality: Quality) -> FaceMesh:
    """A mesh of a body with labels, by its faces' names, in a field's coordinates; remeshed where its long triangles
    are not wanted."""
    columns = field.evaluator.columns[: field.evaluator.used]
    numbers = np.array([next(n for n, c in enumerate(columns) if name in c.names) for name in mesh.names])
    points = field.evaluator.local(mesh.points)
    first = np.array([int(np.argmax(mesh.faces == face)) for face in range(len(numbers))])
    slopes = field.evaluator.jets(points[mesh.triangles[first, 0]], numbers)[:, 1:]
    sides = (slopes * mesh.normals[first, 0]).sum(axis=1) < 0
    made = Labelled.of(points, mesh.triangles, (2 * numbers + sides)[mesh.faces])
    if quality is Quality.ANGLES:
        return refined_faces(made, field, tolerance / field.scale, quality)
    return FaceMesh(made, pair_normals(made, field), (mesh.deviation or 0.0) / field.scale)
