"""Nodes in the place of fillets where no edge can be filled: pipes of one radius that cross, three and more in a point.

The pipes, or bores, whose axes pass through a common point and whose faces meet one another, are cut off across their
axes as far from it as a ball that touches each two of them does, where these are seen from the side.  Between the cuts
is the blend of `pas.node`.  What was united with the pipes, or taken away from all of them, stays as it is.

Guaranteed: the joints of the solid, which are proved before it is given.  Looked at on its mesh: that nothing else ends
where the pipes were cut off.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import combinations, permutations
from operator import or_, sub

import numpy as np
from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.inputs import shown_point
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, decimal, dot, minus, three, to_float, to_floats
from pas.arrays import Floats
from pas.contacts.endless import Pipe
from pas.errors import GeometryError, NoSolutionError, NotProvedError
from pas.limits import checkpoint
from pas.piecewise import PiecewiseSurface
from pas.pipeline.blend import node
from pas.pipeline.bodies import clip_plane
from pas.solid.face_seams import edges_between, face_numbers
from pas.solid.fillet_forms import revolved
from pas.solid.fillets import strays, title_of
from pas.solid.functions import Pieces, region
from pas.solid.joints import Joint
from pas.solid.linked import RenamedBoundary
from pas.solid.runs import tube_of
from pas.solid.sheets import SheetBody, Side
from pas.solid.solid import Solid
from pas.solid.strips import Chain, chain_between
from pas.solid.tree import Atom, Node, Tree, atoms, combined, complement, parts_of


@dataclass(frozen=True, eq=False)
class PipeFace:
    """A face of a solid on a circular cylinder: its name, a point and a direction of its axis, and the radius.

    A bore has the solid around it.
    """

    face: str
    surface: Polynomial
    point: Vector
    way: Vector
    radius: fmpq
    is_bore: bool

    @classmethod
    def of(cls, face: str, surfaces: Sequence[Polynomial]) -> PipeFace | None:
        """The cylinder of a face and its polynomials; None for other faces, and for an irrational radius."""
        found = revolved(surfaces[0]) if len(surfaces) == 1 else None
        if found is None or len(found[2]) != 1:
            return None
        (surface,), (value, point, (way,)) = surfaces, found
        square = -surface.raw(*point) / value
        radius = decimal(to_float(square) ** 0.5) if square > 0 else fmpq(0)
        if radius**2 != square or surface.primitive() != Pipe(way, radius, 0, point).contact.surface.primitive():
            return None
        return cls(face, surface, point, way, radius, value < 0)


@dataclass(frozen=True, eq=False)
class PipeArm:
    """The part of a tube on one side of the centre: its direction (of any length), and how far it reaches."""

    tube: PipeFace
    way: Vector
    reach: float

    @cached_property
    def direction(self) -> Floats:
        """The unit direction (3,)."""
        return unit(to_floats(self.way))

    def clip(self, other: PipeArm, radius: float) -> float:
        """The distance from the centre at which a ball of a radius touches this tube and another, from the side."""
        cosine = float(self.direction @ other.direction)
        sine = np.sqrt(1 - cosine**2)
        mine, its = to_float(self.tube.radius), to_float(other.tube.radius)
        return float((its + mine * cosine + radius * (1 + cosine)) / sine)

    def radius(self, other: PipeArm, clip: float) -> float:
        """The radius of the ball for which that is the clip."""
        there, beyond = (self.clip(other, radius) for radius in (0.0, 1.0))
        return (clip - there) / (beyond - there)


@dataclass(frozen=True, eq=False)
class PipeNode:
    """Tubes of a solid through a point, to be replaced by a node of an order, which is a face.

    `level` is the smallest part of the solid's tree that unites the tubes or subtracts them, `parts` are its operands
    that have the tubes.
    """

    solid: Solid
    level: Tree
    parts: tuple[Tree, ...]
    tubes: tuple[PipeFace, ...]
    center: Vector
    order: int
    face: str

    @classmethod
    def of(cls, solid: Solid, names: tuple[str, str], order: int, face: str | None) -> PipeNode | None:
        """The node of two tubes by name and of all that meet them there; None where these are no tubes, their axes miss
        one another, or they are not parts of one union or subtracted from one solid."""
        polynomials = solid.polynomials
        one, other = (PipeFace.of(name, polynomials.get(name, ())) for name in names)
        center = _meet(one, other) if one and other and one.is_bore == other.is_bore else None
        level = _level(solid.tree, {*names})
        if one is None or center is None or not isinstance(level, Node) or level.union == one.is_bore:
            return None
        found = (PipeFace.of(name, some) for name, some in polynomials.items() if name != one.face)
        alike = (tube for tube in found if tube and tube.is_bore == one.is_bore)
        near = [one, *(tube for tube in alike if not any(cross(minus(center, tube.point), tube.way)))]
        parts = tuple(part for part in level.parts if _has(part, near))
        node = cls(solid, level, parts, tuple(near), center, order, title_of(solid, order, face))
        mesh, joined = node.pipes.mesh(), [one]
        for tube in joined:  # grows
            joined += [
                t
                for t in near
                if t not in joined
                and len(edges_between(mesh, face_numbers(mesh, tube.face), face_numbers(mesh, t.face)))
            ]
        parts = tuple(part for part in parts if _has(part, joined))
        return replace(node, parts=parts, tubes=tuple(joined)) if any(t.face == names[1] for t in joined) else None

    @cached_property
    def pipes(self) -> Solid:
        """The union of the tubes, or what is subtracted, before all other operations."""
        return Solid(combined(True, *(complement(part) if self.tubes[0].is_bore else part for part in self.parts)))

    @property
    def is_needed(self) -> bool:
        """Whether two tubes of one radius cross, so that they touch, or edges between two end on a third."""
        mesh = self.pipes.mesh()
        numbers = [face_numbers(mesh, tube.face) for tube in self.tubes]
        around = [np.unique(mesh.triangles[np.isin(mesh.faces, some)]) for some in numbers]
        pairs = combinations(zip(self.tubes, numbers, strict=True), 2)
        return any(reduce(np.intersect1d, some).size for some in combinations(around, 3)) or any(
            a.radius == b.radius and any(cross(a.way, b.way)) and edges_between(mesh, mine, its).size
            for (a, mine), (b, its) in pairs
        )

    @cached_property
    def arms(self) -> tuple[PipeArm, ...]:
        """The parts of tubes that reach out of the others; shorter ones end inside these."""
        mesh, found = self.pipes.mesh(), list[PipeArm]()
        for tube in self.tubes:
            points = mesh.points[mesh.triangles[np.isin(mesh.faces, face_numbers(mesh, tube.face))]].reshape(-1, 3)
            heights = (points - to_floats(self.center)) @ unit(to_floats(tube.way))
            hidden = 1.001 * max(to_float(t.radius) for t in self.tubes if t is not tube)
            sides = ((tube.way, heights.max()), (three(-w for w in tube.way), -heights.min()))
            found += [PipeArm(tube, way, float(reach)) for way, reach in sides if reach > hidden]
        return tuple(found)

    @property
    def _pairs(self) -> Iterator[tuple[PipeArm, PipeArm]]:
        """Each two that are not opposite, both ways round."""
        yield from ((a, b) for a, b in permutations(self.arms, 2) if abs(a.direction @ b.direction) < 1 - 1e-9)

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a node for a radius, or why there is none."""
        checkpoint("making a node of pipes")
        size, items, clips = to_float(radius), list[tuple[Vector, fmpq, fmpq]](), list[float]()
        for arm in self.arms:
            clip = max((a.clip(b, size) for a, b in self._pairs if a is arm), default=np.inf)
            if clip >= arm.reach:
                return f"{arm.tube.face!r} ends {arm.reach:.4g} from where the axes meet, before a ball touches it"
            clips.append(clip)
            items.append((arm.way, arm.tube.radius, decimal(clip / float(np.linalg.norm(to_floats(arm.way))))))
        if lost := self._lost(clips):
            return lost
        try:
            blend = node(items, self.order, center=self.center)
        except (GeometryError, NoSolutionError, NotProvedError) as error:
            return str(error)
        return self._placed(blend.surface)

    def _placed(self, surface: PiecewiseSurface) -> Solid | str:
        """The solid with a surface between its arms, or what is wrong with it."""
        planes = [clip_plane(surface, number) for number in range(len(self.arms))]
        ends = [*zip(self.arms, planes, strict=True)]
        parts = parts_of(self.pipes.tree, union=True)
        left = [combined(False, p, Atom(-plane, "")) for p in parts for arm, plane in ends if _has(p, [arm.tube])]
        pieces = Atom(Pieces(surface.partition, surface.polynomials), self.face)
        inner = combined(False, pieces, region(surface.partition))
        joined = Solid(combined(True, inner, *left), sheets=self._sheets(surface, planes))
        whole = self._replaced(self.solid.tree, joined)
        claims = tuple(
            Joint(self.face, arm.tube.face, (contact.surface, contact.clip), self.order)
            for arm, contact in zip(self.arms, surface.contacts, strict=True)
        )
        names = {tube.face for tube in self.tubes}
        known = [joint for joint in self.solid.joints if not names.isdisjoint((joint.first, joint.second))]
        made = replace(whole, joints=(*known, *claims), special_points=self.solid.special_points)
        wrong = next((f"{v.claim}: {v.reason}" for v in made.verdicts if not v.proved), None)
        made = replace(made, joints=(*self.solid.joints, *claims))
        return wrong or strays(made) or made

    def _replaced(self, tree: Tree, joined: Solid) -> Solid:
        """A tree with others in place of its tubes."""
        assert isinstance(tree, Node)
        if tree is self.level:
            others = [part for part in tree.parts if part not in self.parts]
            if not tree.union:
                return Solid(combined(False, *others)) - joined
        else:
            (inner,) = (part for part in tree.parts if _has(part, self.tubes))
            others, joined = [part for part in tree.parts if part is not inner], self._replaced(inner, joined)
        return reduce(or_ if tree.union else sub, (Solid(p if tree.union else complement(p)) for p in others), joined)

    def _sheets(self, surface: PiecewiseSurface, planes: Sequence[Polynomial]) -> RenamedBoundary | None:
        """The boundary of the node with its tubes, where each is one part with a flat end across it; else None."""
        chains, names = list[Chain](), {self.face: self.face}
        for number, (arm, plane) in enumerate(zip(self.arms, planes, strict=True)):
            own = [part for part in parts_of(self.pipes.tree, True) if _has(part, [arm.tube])]
            end = self._end(arm, own[0]) if len(own) == 1 else None
            if end is None:
                return None
            tip, name = end
            cap = plane - Polynomial(plane.raw(*tip))
            titles = f"{number}", f"{number} end"
            names |= zip(titles, (arm.tube.face, name), strict=True)
            chain = chain_between(surface.contacts[number], plane, cap, titles, surface.partition.center)
            if chain is None:
                return None
            chains.append(chain)
        body = SheetBody.of([Side(surface, self.face, tuple(chains))])
        return None if body is None else RenamedBoundary(body, names)

    def _end(self, arm: PipeArm, part: Tree) -> tuple[Vector, str] | None:
        """Where an arm of a part ends on the axis, and the name of that face; None where it is more than a cylinder."""
        tube = tube_of(parts_of(part, union=False))
        for plane, name in () if tube is None else tube[2]:
            if (rise := dot(slope_at(plane), arm.way)) > 0:
                height = -plane.raw(*self.center) / rise
                return three(c + height * w for c, w in zip(self.center, arm.way, strict=True)), name
        return None

    def _lost(self, clips: Sequence[float]) -> str | None:
        """The fault where another face than the ends of the pipes would be cut between clips; None where none is."""
        mesh, own = self.pipes.mesh(), {tube.face for tube in self.tubes}
        ways = np.array([arm.direction for arm in self.arms])
        heights = (mesh.points - to_floats(self.center)) @ ways.T - np.array(clips)
        for number, names in enumerate(mesh.solid_faces):
            starts = mesh.triangles[mesh.faces == number]
            ends = np.stack([starts, np.roll(starts, -1, axis=1)], axis=-1).reshape(-1, 2)
            here, there = heights[ends].transpose(1, 0, 2)
            # Of each edge the part, from 0 to 1, in which all heights are negative.
            share = here / np.where(here == there, np.inf, here - there)
            low = np.where(here >= 0, np.where(here > there, share, 1.0), 0.0).max(axis=1)
            high = np.where(here < 0, np.where(there > here, share, 1.0), 1.0).min(axis=1)
            rows = np.flatnonzero(low < high)
            for name in names if len(rows) and own.isdisjoint(names) else ():
                (surface, *_) = self.solid.polynomials.get(name) or (self.tubes[0].surface,)
                slope = slope_at(surface, self.center)
                if surface.degree > 1 or all(any(cross(slope, tube.way)) for tube in self.tubes):
                    start, end = mesh.points[ends[rows[0]]]
                    place = shown_point(start + (low + high)[rows[0]] / 2 * (end - start))
                    return f"the face {name!r} near {place} would end there; take it away from the solid afterwards"
        return None

    def largest(self, above: fmpq) -> float | None:
        """A radius for which there is a node, nearly the largest if that serves before which pipes end; the larger the
        more room a node has, so that it may be above the given one.  None where a quarter of that does not serve."""
        most = decimal(59 / 60 * min((a.radius(b, a.reach) for a, b in self._pairs), default=0.0))
        tried = (most / share for share in (1, 2, 4) if most > 0)
        return next((to_float(radius) for radius in tried if not isinstance(self.made(radius), str)), None)


def _meet(one: PipeFace, other: PipeFace) -> Vector | None:
    """The point in which the axes of two tubes meet; None where they do not."""
    across, gap = cross(one.way, other.way), minus(other.point, one.point)
    if not any(across) or dot(across, gap) != 0:
        return None
    share = dot(cross(gap, other.way), across) / dot(across, across)
    return three(p + share * w for p, w in zip(one.point, one.way, strict=True))


def _has(tree: Tree, tubes: Iterable[PipeFace]) -> bool:
    """Whether a part of a tree has the face of one of the tubes."""
    return not {tube.face for tube in tubes}.isdisjoint(atom.face for atom in atoms(tree))


def _level(tree: Tree, faces: set[str]) -> Tree:
    """The smallest part of a tree that has two faces in different parts, or one part that has both."""
    inner = [
        part
        for part in parts_of(tree, isinstance(tree, Node) and tree.union)
        if faces.issubset(atom.face for atom in atoms(part))
    ]
    return _level(inner[0], faces) if inner and inner[0] is not tree else tree
