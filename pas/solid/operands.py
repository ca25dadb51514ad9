"""First meshes of what a set operation made: the meshes of two solids, one of which sheets bound, cut by one another.

Where faces go on smoothly in one another in a corner, as rounds do, a lattice shows which is where only if it is far
finer than they are.  The meshes of such solids know it, and that of what is made of them inherits it.

Guaranteed: nothing.  The mesh is refined on the faces of the whole, and looked at there (see `pas.mesh.closed`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from operator import and_, or_, sub
from typing import Any, Protocol

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.inputs import FINEST
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import rational
from pas.arrays import Floats
from pas.errors import GeometryError, MeshError
from pas.mesh.booleans import BooleanStep, Triangles, boolean, carried_out
from pas.mesh.closed import refined_faces
from pas.mesh.field import label_of, opposite
from pas.mesh.labelled import Labelled
from pas.mesh.nodes import SAME
from pas.mesh.quality import Quality
from pas.mesh.rows import area_vectors, norms, spans
from pas.mesh.topology import connected, euler_characteristic, piece_count
from pas.settings import RELATIVE_TOLERANCE
from pas.solid.bounds import hull, overlap
from pas.solid.faces import SolidBoundary
from pas.solid.field import SolidField
from pas.solid.linked import LinkedBodies, RenamedBoundary, united
from pas.solid.runs import plain_run
from pas.solid.sheets import SheetBody
from pas.solid.shell import Hollowable
from pas.solid.tree import Atom, combined


class Operand(Hollowable, Protocol):
    """The queries of a solid that is united with another one, or cut by it."""

    @property
    def sheets(self) -> SolidBoundary | None:
        """The boundary that is meshed without a lattice, where it is known."""

    @property
    def _around(self) -> Floats:
        """Two corners (2, 3) of a box that holds it."""

    def _moved(self, map_: Affine) -> Any:
        """Its image."""


def combined_boundary(first: Operand, second: Operand, operation: str) -> SolidBoundary | None:
    """The known boundary of the result of an operation, named as for `boolean`; None where sheets bound neither."""
    before, new = first.sheets, second.sheets
    if before is None and new is None:
        return None
    blends = [known if isinstance(known, SheetBody | LinkedBodies) else None for known in (before, new)]
    ends = (blend or plain_run(solid.tree) for blend, solid in zip(blends, (first, second), strict=True))
    linked = united(*ends) if operation == "Add" and any(blends) else None
    return linked or Operands.of((first, second), operation)


def renamed_boundary(body: SolidBoundary | None, names: Mapping[str, str]) -> SolidBoundary | None:
    """A boundary of a solid with other names of its faces; operands are told apart by their functions alone."""
    return body if body is None or isinstance(body, Operands) else RenamedBoundary(body, names)


@dataclass(frozen=True, eq=False)
class Operands(SolidBoundary):
    """Solids that are not results of set operations, and the steps that make another one of them; see `carried_out`."""

    parts: tuple[Operand, ...]
    steps: tuple[BooleanStep, ...]
    coarse = None

    @classmethod
    def of(cls, solids: Sequence[Operand], operation: str) -> Operands:
        """The operands and steps of an operation on at least two solids, as few steps as their form allows."""
        known = [s.sheets if isinstance(s.sheets, Operands) else Operands((s,), ()) for s in solids]
        parts, steps, many = list[Operand](), list[BooleanStep](), 0
        for number, one in enumerate(known):  # a - (b | c) is a - b - c
            joined = operation if operation != "Subtract" or number == 0 else "Add"
            *others, last = one.steps or (BooleanStep(1, "", 1),)
            opened, count = (others, last.many) if last.operation in ("", joined) else (one.steps, 1)
            steps += (replace(step, read=step.read + len(parts)) for step in opened)
            parts, many = [*parts, *one.parts], many + count
        return cls(tuple(parts), (*steps, BooleanStep(len(parts), operation, many)))

    @cached_property
    def box(self) -> Floats | None:
        """A box, two corners (2, 3), that holds the result, by those of the parts; None where these have none."""
        return carried_out(self.steps, [*map(_box, self.parts)], _joint_box)

    @property
    def is_union(self) -> bool:
        """Whether nothing is cut, so that the box is the result's own."""
        return all(step.operation == "Add" for step in self.steps)

    @property
    def is_difference(self) -> bool:
        """Whether it is the first part less others."""
        parts: list[object] = [None, *self.parts[1:]]
        return carried_out(self.steps, parts, lambda name, some: some[0] if name == "Subtract" else name) is None

    def made_with(self, first: Any) -> Any:
        """The result of the steps with another solid in place of the first part."""
        done: dict[str, Callable[[Any, Any], Any]] = {"Add": or_, "Intersect": and_, "Subtract": sub}
        return carried_out(self.steps, [first, *self.parts[1:]], lambda name, some: reduce(done[name], some))

    @cached_property
    def turned(self) -> list[int]:
        """For each part 1 if it is subtracted, an odd number of times, else 0."""
        return carried_out(self.steps, [[0] for _ in self.parts], _turned)

    def mesh(self, tolerance: float, quality: Quality) -> None:
        """None: a cut mesh is only a first mesh."""

    def moved(self, map_: Affine) -> Operands:
        return replace(self, parts=tuple(part._moved(map_) for part in self.parts))

    def first_mesh(self, field: SolidField, tolerance: float) -> Labelled | None:
        """A mesh to begin with of the boundary of a field, with its labels, for a tolerance in its coordinates.

        None where there is none, or a finer one has other pieces or holes, other faces or one of much less area: where
        rims of both parts are one curve, slivers are left between their polygons; or where a piece encloses nothing, as
        is left of parts that touch in a face.
        """
        try:
            found, finer = (self._cut(field, tolerance, parts) for parts in (4, 16))
        except (GeometryError, MeshError):  # of a part: what is wrong with the whole, if anything is, that says
            return None
        first, second = map(_areas, (found, finer))
        known = found.faces.max() < label_of(field.evaluator.used)
        same = known and _shape(found) == _shape(finer) and not _is_flat(finer)
        return Labelled.of(*found) if same and np.all(second > first / 2) else None

    def _cut(self, field: SolidField, tolerance: float, parts: int) -> Triangles:
        if self.box is None:
            raise GeometryError("what is made of the parts has no bounds")
        bounded = [_within(part, self.box) if _box(part) is None else part for part in self.parts]
        cuts = [_cut(part, field, tolerance, parts) for part in bounded]
        turns = zip(cuts, self.turned, strict=True)
        return boolean([cut._replace(faces=opposite(cut.faces)) if turn else cut for cut, turn in turns], self.steps)


def _cut(part: Operand, field: SolidField, tolerance: float, parts: int) -> Triangles:
    """The mesh of a solid with the labels and in the coordinates of a field that has its functions, so many times as
    fine as a tolerance; that of lattices, which take long, no finer than by default, but refined for more than 4 parts.
    """
    own, size, within = part.field, float(np.ptp(part._around, axis=0).max()), tolerance * field.scale / parts
    if part.sheets is None:
        within = max(within * parts / 4, RELATIVE_TOLERANCE * size)
    mesh = part.face_mesh(max(within, FINEST * size)).mesh
    if part.sheets is None and parts > 4:
        mesh = refined_faces(mesh, own, within * 4 / parts / own.scale, Quality.BALANCED).mesh
    return Triangles(field.evaluator.local(own.world(mesh.points)), mesh.triangles, field.labels_of(own, mesh.labels))


def _areas(cut: Triangles) -> Floats:
    """The area of each label that occurs, in their order (K,)."""
    areas = norms(area_vectors(cut.points[cut.triangles])) / 2
    return np.asarray(np.bincount(np.unique(cut.faces, return_inverse=True)[1], areas), dtype=np.float64)


def _is_flat(cut: Triangles) -> bool:
    """Whether a piece encloses no volume, in coordinates of about one."""
    corners = cut.points[cut.triangles]
    owners = connected(cut.triangles[:, [0, 1, 1, 2]].reshape(-1, 2), len(cut.points))[cut.triangles[:, 0]]
    volumes = np.bincount(owners, spans(corners)[0])
    return bool((np.abs(volumes) <= SAME * np.bincount(owners, norms(area_vectors(corners))))[owners].any())


def _shape(cut: Triangles) -> tuple[int, int, set[int]]:
    """The number of pieces, the Euler characteristic and the labels."""
    return piece_count(cut.triangles), euler_characteristic(cut.triangles), {*cut.faces.tolist()}


def _within(part: Any, box: Floats) -> Any:
    """The part of a solid in a box (2, 3) and an eighth of its sides around it, with walls where it is cut."""
    wider = box + np.ptp(box, axis=0) / 8 * np.array([[-1.0], [1.0]])
    ends = [(g, rational(x)) for g, side in zip(GENERATORS, wider.T.tolist(), strict=True) for x in side]
    walls = (Atom(Polynomial.from_raw(g - x), "", number % 2 == 0) for number, (g, x) in enumerate(ends))
    return replace(part, tree=combined(False, part.tree, *walls), joints=(), sheets=None)


def _turned(operation: str, turns: list[list[int]]) -> list[int]:
    """For each operand of an operation 1 if it is subtracted, else 0, given these of the whole."""
    first, *others = turns
    return first + [turn ^ (operation == "Subtract") for other in others for turn in other]


def _joint_box(operation: str, boxes: list[Floats | None]) -> Floats | None:
    """The box (2, 3) of an operation's result on sets in boxes; None where these have none."""
    if operation == "Subtract":
        return boxes[0]
    known = [box for box in boxes if box is not None]
    if len(known) < (len(boxes) if operation == "Add" else 1):
        return None
    return hull(known) if operation == "Add" else overlap(known)


def _box(part: Operand) -> Floats | None:
    """The box in which a solid is meshed; None of an unbounded one."""
    try:
        return part._around
    except GeometryError:
        return None
