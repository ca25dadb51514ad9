"""A tree of inequalities compiled for arrays of points and boxes.

Polynomials are evaluated together (`pas.solid.taylor`), in coordinates local to the solid (all points
here are), so that far from the origin nothing is lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq

from pas.algebra.affine import ORIGIN
from pas.algebra.evaluation import CHUNK_ENTRIES, PolynomialBatch
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, to_float
from pas.algebra.scaling import Scaled
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.mesh import joined_names
from pas.solid.taylor import TaylorForms
from pas.solid.tree import Atom, Columns, Function, ScalarField, Tree, atoms
from pas.solid.truths import CompiledTree
from pas.surface.geometry import derivative_batch


@dataclass(frozen=True)
class Column:
    """A function of the tree and the different names of the faces on it, in the order of the tree (none: a wall)."""

    function: Function
    names: tuple[str, ...]

    @property
    def face(self) -> str:
        """The name of its face, "" for a wall."""
        return joined_names(self.names)


class TreeEvaluator(CompiledTree):
    """The columns of a tree and the code that combines their signs.

    A polynomial and its multiples are one column, so that `{w <= 0}` and `{w >= 0}` leave no gap between them, and so
    are planes that are equal to rounding; the column has the names of all faces on it.  `extra` functions are columns
    that the code does not use.
    """

    def __init__(self, tree: Tree, center: Vector = ORIGIN, scale: fmpq = fmpq(1), extra: tuple[Function, ...] = ()):
        self.center, self.scale = center, scale
        # Planes through points that are doubles are one up to their rounding, unless that is far from the origin.
        self._tree, self._numbers = tree, Columns(rounded=max(map(abs, center)) < 2**8 * scale)
        super().__init__(tree, self._read)
        names: list[dict[str, None]] = [{} for _ in self._numbers.functions]
        for atom in atoms(tree):
            names[self._read(atom)[0]] |= {atom.face: None} if atom.face else {}
        self._sides = {(*self._read(atom), atom.face) for atom in atoms(tree)}
        self.columns = [Column(f, tuple(n)) for f, n in zip(self._numbers.functions, names, strict=True)]
        self.used = len(self.columns)
        self.columns += [Column(function, ()) for function in extra]

    def _read(self, atom: Atom) -> tuple[int, bool]:
        """The column of an inequality, and whether that is to be > 0."""
        checkpoint()  # of some ten thousand in lattices of struts
        number, sign = self._numbers.of(atom.function)
        return number, atom.outside != (sign < 0)

    @cached_property
    def _named(self) -> tuple[dict[tuple[int, str], int], CompiledTree]:
        """Each column once for each name on it, "" included, and the tree over these."""
        rows: dict[tuple[int, str], int] = {}

        def row_of(atom: Atom) -> tuple[int, bool]:
            column, negated = self._read(atom)
            return rows.setdefault((column, atom.face), len(rows)), negated

        return rows, CompiledTree(self._tree, row_of)

    def names_within(self, number: int, above: bool, centers: Floats, halves: Floats) -> tuple[str, ...]:
        """The names on a column that may be on the boundary in some boxes of given half edges (N, 3).

        `above` says whether the inside is where it is positive.  A name is not there whose inequalities are all of the
        other side; nor where, with all other inequalities on that surface held to be true, or to be false, the tree
        does not depend on its own.
        """
        on_it = self.columns[number].names
        names = tuple(name for name in on_it if (number, above, name) in self._sides) or on_it
        if len(names) < 2:
            return names
        rows, tree = self._named
        columns = np.array([column for column, _ in rows])
        yes, no = (known[columns] for known in self.taylor(centers, halves))
        yes[columns == number] = no[columns == number] = False
        open_ = np.asarray(np.logical_or(*tree.relevant(yes, no)).any(axis=1))  # no more are, if more is known
        found = []
        for name in (name for name in names if open_[rows[number, name]]):
            own = rows[number, name]
            for held in (True, False):
                yes[columns == number], no[columns == number] = held, not held
                yes[own], no[own] = False, False
                if any(side[own].any() for side in tree.relevant(yes, no)):
                    found.append(name)
                    break
        return tuple(found) or names

    def inside(self, signs: Bools) -> Bools:
        """Where the tree is true (N,), given which columns are <= 0 (M, N)."""
        return self.holds(signs, ~signs)

    def contains(self, points: Floats) -> Bools:
        """Where the tree is true (N,) at points (N, 3); in a block of these no values are needed of columns that have
        one sign all over it, or on which the tree does not depend there."""
        blocks, most = [np.arange(len(points))], max(64, len(points) // 64)
        while len(blocks[0]) > most:  # all are halved along the longest sides of their boxes
            sorted_ = (rows[points[rows, np.ptp(points[rows], axis=0).argmax()].argsort()] for rows in blocks)
            blocks = [half for rows in sorted_ for half in np.array_split(rows, 2)]
        if len(blocks) == 1:
            return self.inside(self.signs(points))
        low, high = (np.array([end(points[rows], axis=0) for rows in blocks]) for end in (np.min, np.max))
        yes, no = self.taylor((low + high) / 2, (high - low) / 2)
        unknown = np.logical_or(*self.relevant(yes, no)) & ~(yes | no)
        result = np.empty(len(points), dtype=bool)
        for rows, certain, open_ in zip(blocks, yes.T, unknown.T, strict=True):
            signs = np.repeat(certain[:, None], len(rows), axis=1)
            signs[open_] = self.values(points[rows], np.flatnonzero(open_)) <= 0
            result[rows] = self.inside(signs)
        return result

    def local(self, points: Floats) -> Floats:
        """Points (..., 3) in local coordinates."""
        return (points - self._shift) / to_float(self.scale)

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3) given in local ones."""
        return points * to_float(self.scale) + self._shift

    @cached_property
    def _shift(self) -> Floats:
        return np.array([to_float(c) for c in self.center])

    def signs(self, points: Floats) -> Bools:
        """Which columns (M, N) are <= 0 at points (N, 3)."""
        parts = np.array_split(points, 1 + len(points) * self.used // CHUNK_ENTRIES)
        return np.concatenate([self.values(part, np.arange(self.used)) <= 0 for part in parts], axis=1)

    def values(self, points: Floats, columns: Integers) -> Floats:
        """Values of some of the tree's columns (m, N) at points (N, 3), each by a positive factor."""
        result, known = np.empty((len(columns), len(points))), np.isin(columns, self._rows)
        result[known] = self._bank.values(points, np.searchsorted(self._rows, columns[known]))
        for place in np.flatnonzero(~known).tolist():
            result[place] = self._field_jets(int(columns[place]), points)[:, 0]
        return result

    def field(self, points: Floats) -> Floats:
        """Minimum and maximum of the columns (N,), as they were given, at points (N, 3).

        Inside, walls only select which parts count, so that the value is not 0 where parts adjoin.
        """
        values = self._true(self.values(points, np.arange(self.used)))
        plain = self.extremes(values)
        selecting = values.copy()
        selecting[self.walls] = np.where(values[self.walls] <= 0, -np.inf, np.inf)
        chosen = self.extremes(selecting)
        return np.where(self.inside(values <= 0) & np.isfinite(chosen), chosen, plain)

    def _true(self, values: Floats) -> Floats:
        """Values (M, N) of the tree's functions themselves, given those of the columns."""
        scaled: dict[int, ScalarField | Scaled] = {**self._fields, **self._scaled}
        exponents = np.array([scaled[number].exponent for number in range(self.used)], dtype=np.intp)
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(np.ldexp(values, exponents[:, None]))

    def jets(self, points: Floats, numbers: Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3), each of a column of its own (N,), extra ones included."""
        places = self._places[numbers]
        if places.min(initial=0) >= 0:
            return self._jets(points, places)
        result, known = np.empty((len(points), 4)), places >= 0
        result[known] = self._jets(points[known], places[known])
        for number in np.unique(numbers[~known]):
            rows = numbers == number
            result[rows] = self._field_jets(int(number), points[rows])
        return result

    def _field_jets(self, number: int, points: Floats) -> Floats:
        """Values and gradients (N, 4) of a column that is no polynomial, in local coordinates."""
        jets = self._fields[number].jets(self.world(points))
        return jets * np.array([1 / to_float(self.scale), 1.0, 1.0, 1.0])

    def _boxes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Centres and half edges of boxes in the user's coordinates."""
        return self.world(centers), np.broadcast_to(halves * to_float(self.scale), centers.shape)

    @cached_property
    def walls(self) -> Bools:
        """Which columns of the tree (M,) are no faces."""
        return np.array([not c.names for c in self.columns[: self.used]])

    @cached_property
    def _fields(self) -> dict[int, ScalarField]:
        """The columns that are no polynomials."""
        return {i: c.function for i, c in enumerate(self.columns) if not isinstance(c.function, Polynomial)}

    @cached_property
    def _scaled(self) -> dict[int, Scaled]:
        """The columns that are polynomials in local coordinates, each scaled by itself."""
        moved = [Polynomial.from_raw(g * self.scale + c) for g, c in zip(GENERATORS, self.center, strict=True)]
        known = {i: c.function for i, c in enumerate(self.columns) if isinstance(c.function, Polynomial)}
        return {i: Scaled.of([f.compose(*moved)]) for i, f in known.items()}

    @cached_property
    def _rows(self) -> Integers:
        """The columns of the tree that are polynomials, in the order of the bank."""
        return np.array([i for i in self._scaled if i < self.used], dtype=np.intp)

    @cached_property
    def _bank(self) -> TaylorForms:
        return TaylorForms([p for i in self._rows.tolist() for p in self._scaled[i].polynomials])

    def polynomial(self, number: int) -> Polynomial | None:
        """The polynomial of a column in local coordinates, scaled; None where it is none."""
        return self._scaled[number].polynomials[0] if number in self._scaled else None

    def column_of(self, function: Function) -> int:
        """The column of a function of the tree."""
        return self._numbers.of(function)[0]

    def number(self, other: TreeEvaluator, columns: Integers) -> tuple[Integers, Bools]:
        """The columns that hold those of another evaluator, and whether with the opposite sign."""
        wanted, places = np.unique(columns, return_inverse=True)
        pairs = [self._numbers.of(other.columns[c].function) for c in wanted.tolist()]
        found = np.array(pairs, dtype=np.intp).reshape(-1, 2)
        return found[places, 0], found[places, 1] < 0

    @cached_property
    def _places(self) -> Integers:
        """The number of each column in `_jets`, -1 where it is no polynomial."""
        result = np.full(len(self.columns), -1, dtype=np.intp)
        result[[*self._scaled]] = np.arange(len(self._scaled))
        return result

    @cached_property
    def _jets(self) -> PolynomialBatch:
        """Values and gradients of the polynomials of all columns, extra ones after those of the tree."""
        every = [p for found in self._scaled.values() for p in found.polynomials]
        return derivative_batch([p.dense(max(p.degree, 0)) for p in every], (0, 1))

    def taylor(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Which columns (M, N) are certainly <= 0 and > 0 in boxes of given half edges (N, 3), or (1, 3) for all."""
        yes, no = np.zeros((2, self.used, len(centers)), dtype=bool)
        yes[self._rows], no[self._rows] = self._bank.taylor(centers, halves)
        for number, field in self._fields.items():
            yes[number], no[number] = field.decided(*self._boxes(centers, halves))
        return yes, no

    def slopes(self, columns: Integers, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (m, N, 3) of columns at the centres of boxes (N, 3), and how much they may change in these."""
        gradients, changes = np.zeros((2, len(columns), len(centers), 3))
        known = np.isin(columns, self._rows)
        rows = np.searchsorted(self._rows, columns[known])
        gradients[known], changes[known] = self._bank.slopes(rows, centers, halves)
        for place in np.flatnonzero(~known):
            boxes = self._boxes(centers, halves)
            gradients[place], changes[place] = self._fields[int(columns[place])].slopes(*boxes)
        return gradients, changes

    @cached_property
    def is_empty(self) -> bool:
        """Whether the tree is false whatever the signs of its columns are, as for a solid less itself."""
        unknown = np.zeros((self.used, 1), dtype=bool)
        return bool(self.decided(unknown, unknown)[1][0])

    def decided(self, yes: Bools, no: Bools, splits: int = 6) -> tuple[Bools, Bools]:
        """Where the tree is certainly true, and certainly false (N,), as far as its columns say.

        `yes` and `no` (M, N) say where columns are certainly <= 0 and > 0.  A column that the tree reads
        from both sides is tried as either, up to `splits` of them together: a box that meets more is halved first.
        """
        true, false = self.holds(yes, no), ~self.holds(~no, ~yes)
        open_ = np.flatnonzero(~(true | false))
        if not splits or not len(open_):
            return true, false
        both = np.logical_and(*self.relevant(yes[:, open_], no[:, open_]))
        chosen = both.any(axis=0)
        rows, columns, number = open_[chosen], both[:, chosen].argmax(axis=0), np.arange(chosen.sum())
        always, never = np.ones((2, len(rows)), dtype=bool)
        for side in (True, False):
            certain, excluded = yes[:, rows], no[:, rows]
            certain[columns, number], excluded[columns, number] = side, not side
            whole, nothing = self.decided(certain, excluded, splits - 1)
            always &= whole
            never &= nothing
        true[rows], false[rows] = always, never
        return true, false

    def sides(self, yes: Bools, no: Bools) -> tuple[Bools, Bools]:
        """Where the solid may be on the side `<= 0` alone of each column (M, N), and where on the side `> 0` alone.

        That is `relevant`, but that a face which the tree reads from both sides is tried as either: where a rib stands
        on a plate, both say on which side of the plate's plane they are, and the plate alone ends there.  Of walls
        both sides stay: on them two faces are taken to meet.
        """
        below, above = self.relevant(yes, no)
        both = below & above & ~self.walls[:, None]
        for column in np.flatnonzero(both.any(axis=1)):
            rows = np.flatnonzero(both[column])
            for here, there, side in ((below, above, True), (above, below, False)):
                certain, excluded = yes[:, rows], no[:, rows]
                certain[column], excluded[column] = side, not side
                whole, nothing = self.decided(certain, excluded)
                here[column, rows] &= ~nothing
                there[column, rows] &= ~whole
        return below, above
