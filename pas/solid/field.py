"""A solid as the mesher wants it: labels are columns and the side that is inside."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import cached_property
from itertools import combinations, product

import numpy as np

from pas.algebra.affine import quadratic_form
from pas.algebra.inputs import shown_point
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import exact, exact_vector, to_float
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.contacts.rims import rim_of
from pas.errors import GeometryError, MeshError
from pas.mesh.diagnostics import touching
from pas.mesh.field import FaceField, ShellWall, column_of, is_above, label_of, orientation
from pas.mesh.mesh import joined_names
from pas.solid.bounds import bounding_box
from pas.solid.evaluator import TreeEvaluator
from pas.solid.functions import followed_by
from pas.solid.seams import Seams, seams_of
from pas.solid.tree import Atom, Function, Node, Tree, combined, complement, splits_of
from pas.verdicts import Status


class SolidField:
    """The boundary of a tree inside a box, in the evaluator's local coordinates; see `pas.mesh.field.FaceField`.

    `seams` are curves, each given by two functions, along which faces are joined, with the least order of continuity;
    see `pas.solid.seams`.
    """

    def __init__(
        self,
        tree: Tree,
        box: Floats,
        seams: Mapping[tuple[Polynomial, Polynomial], int],
        special_points: Floats,
    ) -> None:
        center = exact_vector(np.round(box.mean(axis=0), 6).tolist())
        scale = exact(2.0 ** float(np.round(np.log2(max(float(np.ptp(box, axis=0).max()) / 2, 1e-30)))))
        given = seams_of(tree, seams, box)
        self.evaluator = TreeEvaluator(tree, center, scale, tuple(f for seam in given for f in seam.functions))
        self.box = self.evaluator.local(box)
        self._seams = Seams(self.evaluator, given, self.box)
        self.special_points = self.evaluator.local(special_points)
        self._made_of = tree, box, seams, special_points
        self._placing: dict[tuple[int, ...], tuple[int, ...]] = {}

    def shells(self) -> list[SolidField]:
        """The connected surfaces of the boundary, if they are apart: those of hollows inside, and the outer one."""
        tree, box, seams, special = self._made_of
        for part, others in splits_of(tree):
            if _is_within(complement(part), box):
                fields = [SolidField(some, box, seams, special) for some in (part, others)]
                return [shell for field in fields for shell in field.shells()]
        return [self]

    def wall(self) -> ShellWall | None:
        """The solid that this is a shell of, and which inner face follows each of its faces; None if it is none."""
        tree, box, seams, special = self._made_of
        found = followed_by(tree)
        if found is None:
            return None
        others, walls = found
        solid = SolidField(others, box, seams, special)
        labels = np.arange(label_of(solid.evaluator.used))
        faces = [solid.evaluator.columns[column].face for column in column_of(labels).tolist()]
        inner = np.full(len(labels), -1, dtype=np.intp)
        for distance, follows in walls:
            inner[[face in follows.faces for face in faces]] = label_of(self.evaluator.column_of(distance))
        return ShellWall(solid, walls[0][1].thickness / self.scale, self.labels_of(solid, labels), inner)

    def needed(self, within: float) -> SolidField:
        """The boundary without conditions that others imply, or itself: see `without_implied`."""
        tree, box, seams, special = self._made_of
        found = without_implied(tree, box, within * self.scale)
        if found == tree:
            return self
        result = SolidField(found, box, seams, special)  # in the same local coordinates
        if _is_within(found, _around(box)):
            result.box = self.evaluator.local(bounding_box(found))
        return result

    def labels_of(self, shell: FaceField, labels: Integers) -> Integers:
        assert isinstance(shell, SolidField)
        columns, turned = self.evaluator.number(shell.evaluator, column_of(labels))
        return label_of(columns, is_above(labels) ^ turned)

    @property
    def scale(self) -> float:
        return to_float(self.evaluator.scale)

    def world(self, points: Floats) -> Floats:
        return self.evaluator.world(points)

    def crossed(self, centers: Floats, half: float) -> Bools:
        true, false = self.evaluator.decided(*self.evaluator.taylor(centers, np.full((1, 3), half)))
        return ~(true | false)

    def turning(self, centers: Floats, half: float) -> Floats:
        """How much faces turn in cubes that the boundary may pass (N,); infinite where it may not be one sheet.

        It is one where all functions that matter rise in one direction: the set then holds with each point
        those below it.  A wall that matters from both sides only says which function holds where; the
        two faces are taken to meet on it.
        """
        parts = np.array_split(centers, 1 + len(centers) // 4096)  # of which all gradients are kept at once
        return np.concatenate([self._turning(part, np.full((1, 3), half)) for part in parts])

    def _turning(self, centers: Floats, halves: Floats) -> Floats:
        """How much faces turn in few cubes (N,), all functions of each together."""
        yes, no = self.evaluator.taylor(centers, halves)
        below, above = self.evaluator.sides(yes, no)
        both = below & above
        switches = both & (self.evaluator.walls[:, None] | self._seams.hidden(yes, no, below, above))
        below, above = below & ~switches, above & ~switches
        faces = below | above
        faces[:, (below & above).any(axis=0)] = False
        risen = np.zeros((2, *faces.shape, 3))  # gradients, positive outside, and how much they change
        for column in np.flatnonzero(faces.any(axis=1)):
            rows = np.flatnonzero(faces[column])
            gradients, changes = self.evaluator.slopes(np.array([column]), centers[rows], halves)
            risen[:, column, rows] = gradients[0] * np.where(below[column, rows], 1.0, -1.0)[:, None], changes[0]
        result, times = np.full(len(centers), np.inf), faces.sum(axis=0)
        for number in np.unique(times[times > 0]):
            rows = np.flatnonzero(times == number)
            columns = np.nonzero(faces[:, rows].T)[1].reshape(-1, number).T
            gradients, changes = risen[:, columns, rows]
            turn = np.sqrt((changes**2).sum(axis=2) / np.maximum((gradients**2).sum(axis=2), 1e-300)).max(axis=0)
            result[rows] = np.where(_rise(gradients, changes), turn, np.inf)
        return result

    def signs(self, points: Floats) -> Bools:
        return self.evaluator.signs(points)

    def inside(self, signs: Bools) -> Bools:
        return self.evaluator.inside(signs)

    def jets(self, points: Floats, labels: int | Integers) -> Floats:
        """Values and gradients (N, 4) of a label's function, or each point's own (N,), positive outside.

        At special points both are 0 where they are rounding, which has no direction.
        """
        labels = np.broadcast_to(np.asarray(labels, dtype=np.intp), len(points))
        jets = self.evaluator.jets(points, column_of(labels)) * orientation(labels)[:, None]
        for special in self.special_points:
            rounding = 2.0**-36  # of coordinates and functions that are of size 1
            here = (np.abs(points - special).max(axis=1) < rounding) & (np.abs(jets).max(axis=1) < rounding)
            jets[here] = 0.0
        return jets

    def ruled(self, labels: Integers) -> Integers:
        """2 for planes, 1 for cylinders and cones, which are quadrics without a determinant, 0 for others (N,)."""
        return self._ruled[column_of(labels)]

    def walls(self, labels: Integers) -> Bools:
        return self.evaluator.walls[column_of(labels)]

    @cached_property
    def _ruled(self) -> Integers:
        """The kinds, as of `ruled`, of the functions of the tree's columns (M,)."""
        return np.array([_ruled(c.function) for c in self.evaluator.columns[: self.evaluator.used]])

    def functions(self, labels: tuple[int, ...]) -> tuple[int, ...]:
        if labels not in self._placing:
            columns = sorted({*map(column_of, labels)})
            seams = {pair: self._seams.between(*pair) for pair in combinations(columns, 2)}
            joined = {column for pair, seam in seams.items() if seam for column in pair}
            known = [c for seam in seams.values() for c in seam] + [c for c in columns if c not in joined]
            self._placing[labels] = tuple(dict.fromkeys(map(label_of, known))) if len(labels) > 1 else labels
        return self._placing[labels]

    def face(self, label: int) -> str:
        """The name of a label's face; of an end left open by walls, its equation."""
        column = self.evaluator.columns[column_of(label)]
        return column.face or f"{column.function} = 0"

    def faces_within(self, label: int, centers: Floats, halves: Floats) -> tuple[str, ...]:
        """The names of a label's faces that may be in boxes of given half edges (N, 3)."""
        above = bool(is_above(label))
        return self.evaluator.names_within(column_of(label), above, centers, halves) or (self.face(label),)

    def refuse_coincident(self) -> None:
        """Raise `GeometryError` where two functions share a surface, `MeshError` where `Seams` finds a place."""
        used = enumerate(self.evaluator.columns[: self.evaluator.used])
        faces = {i: c.function for i, c in used if c.names and isinstance(c.function, Polynomial)}
        for a, b in combinations(faces, 2):
            common = faces[a].raw.gcd(faces[b].raw)
            if not common.is_constant():
                raise GeometryError(
                    f"the faces {self.face(label_of(a))!r} and {self.face(label_of(b))!r} coincide on {common} = 0; "
                    "write one of them without that factor"
                )
        for point, a, b, both in self._seams.pinched():
            raise MeshError(f"the solid could not be meshed: {touching(self, point, a, b, both)}")
        for number, seam in enumerate(self._seams.given):
            plane, surface = sorted(seam.functions, key=lambda function: function.degree)
            if surface.degree > 1 == plane.degree and seam.order:
                with suppress(GeometryError):  # curves that are not closed
                    rim = self.evaluator.local(rim_of(surface, plane).points())
                    self._refuse_passing(number, surface.primitive(), rim)

    def _refuse_passing(self, number: int, surface: Polynomial, rim: Floats) -> None:
        """Raise `MeshError` where a surface continues beyond a rim (N, 3), the seam of that number, at which a face
        touches it, and leaves the face without an angle, in some places outwards and in others inwards."""
        faces = {c: self.evaluator.columns[c].function for c in np.flatnonzero(~self.evaluator.walls).tolist()}
        for a in (c for c, f in faces.items() if isinstance(f, Polynomial) and f.primitive() == surface):
            across = np.cross(self.jets(rim, label_of(a))[:, 1:], np.roll(rim, -1, axis=0) - rim)
            step = 2.0**-6 * np.ptp(rim, axis=0).max() * unit(across)
            for moved, b in product((rim + step, rim - step), (c for c in faces if number in self._seams.of(c))):
                jets = self.jets(moved, label_of(a))
                beside = moved - jets[:, :1] * jets[:, 1:] / (jets[:, 1:] ** 2).sum(axis=1)[:, None]
                signs, held = self.signs(beside), np.empty((2, 2, len(rim)), dtype=int)
                inwards = signs[b].copy()
                for i, j in product(range(2), repeat=2):
                    signs[a], signs[b] = i == 0, j == 0
                    held[i, j] = self.inside(signs)
                both = held.sum(axis=(0, 1)) % 2 == 1  # the set depends on either as the other one is
                for k in np.flatnonzero(both & np.roll(both, -1) & (inwards != np.roll(inwards, -1)) & (a != b)):
                    labels = [label_of(c, bool(held.sum(axis=axis)[:, k].argmax())) for c, axis in ((a, 1), (b, 0))]
                    within = beside[[k]], np.full((1, 3), 2.0**-6)
                    going, left = (joined_names(self.faces_within(label, *within)) for label in labels)
                    raise MeshError(
                        f"the solid has no mesh: near {shown_point(self.world(beside[k]))} what lies on the surface of "
                        f"{going!r} goes on beyond the curve in which that meets {left!r}, and leaves it without an "
                        "angle; end it there, or make one blend of all"
                    )


def _ruled(function: Function) -> int:
    """The kind, as of `SolidField.ruled`, of a function: the symmetric matrix of a quadric, in x, y, z and 1, tells."""
    if not isinstance(function, Polynomial) or function.degree > 2:
        return 0
    return 2 if function.degree == 1 else int(quadratic_form(function).det() == 0)


def _rise(gradients: Floats, changes: Floats) -> Bools:
    """Whether functions with gradients (M, N, 3), up to changes, all rise steeply in some direction (N,).

    Tried are the mean of the gradients' directions and three that are turned towards the steepest.
    """
    size = np.maximum(np.sqrt((gradients * gradients).sum(axis=2)), 1e-300)
    units = gradients / size[..., None]
    direction = units.sum(axis=0)
    result = np.zeros(len(direction), dtype=bool)
    for _ in range(4):
        direction /= np.maximum(np.sqrt((direction * direction).sum(axis=1, keepdims=True)), 1e-300)
        margins = (gradients * direction).sum(axis=2) - (changes * np.abs(direction)).sum(axis=2)
        # Slope, over the gradient's length, with which faces must rise: of sharper edges a lattice shows beads.
        steep = 0.3
        result |= (margins > steep * size).all(axis=0)
        if len(gradients) == 1 or result.all():
            break
        worst = (units * direction).sum(axis=2).argmin(axis=0)
        direction += units[worst, np.arange(len(worst))]
    return result


def _is_within(tree: Tree, box: Floats) -> bool:
    """Whether a set lies in a box (2, 3), and is not empty."""
    evaluator = TreeEvaluator(tree)
    beyond = box.mean(axis=0) + np.array(list(product((-2.0, 2.0), repeat=3))) * np.ptp(box, axis=0)
    if evaluator.contains(beyond).any():  # as most complements are there, whose boxes take long
        return False
    try:
        own = bounding_box(tree)
    except GeometryError:
        return False
    return bool((own[0] >= box[0]).all() and (own[1] <= box[1]).all())


def _around(box: Floats) -> Floats:
    """A box (2, 3) around another one beyond which no lattice about that goes."""
    return box + 0.4 * np.ptp(box, axis=0).max() * np.array([[-1.0], [1.0]])


def without_implied(tree: Tree, box: Floats, within: float) -> Tree:
    """A set, which is in a box (2, 3), without conditions of intersections that the others imply.

    Where `z <= 1` follows from `x <= 1` and `z <= x^3`, three surfaces meet in one curve, though two of them bound the
    set there, and a lattice cannot show which.  No ball of more than twice the radius `within` is in what is left and
    not in the set.
    """
    if isinstance(tree, Atom):
        return tree
    kept = [without_implied(part, box, within) for part in tree.parts]
    if not tree.union and len(kept) > 2:
        for atom in [part for part in kept if isinstance(part, Atom) and isinstance(part.function, Polynomial)]:
            others = [part for part in kept if part is not atom]
            if others and _is_thin(combined(False, complement(atom), *others), _around(box), within):
                kept = others
    return tree if tuple(kept) == tree.parts else kept[0] if len(kept) == 1 else Node(tuple(kept), tree.union)


def _is_thin(tree: Tree, box: Floats, within: float) -> bool:
    """Whether no boxes in another (2, 3) that are smaller than `within` have their centres in a set; they cover it."""
    evaluator = TreeEvaluator(tree)

    def judge(boxes: Boxes, depth: int) -> Fates:
        open_ = ~evaluator.decided(*evaluator.taylor(boxes.centers, boxes.halves))[1]
        fates = np.where(open_ & (boxes.halves.max(axis=1) >= within), Fate.SPLIT, Fate.SETTLED)
        return np.where(evaluator.contains(boxes.centers), Fate.REFUTE, fates)

    most, task = Limits(cells=1 << 14), "looking for conditions that others imply"
    return search(Boxes.of(box), judge, Boxes.eighths, most, task).status is Status.PROVED
