"""A tree of inequalities compiled for arrays of points and boxes.

Functions are evaluated together, by one matrix product, in coordinates local to the solid (all points
here are), so that far from the origin nothing is lost.  Over a box a polynomial is bounded by its
Taylor expansion about the centre, which is exact:
`|p(c + u) - p(c)| <= sum over a != 0 of |p^(a)(c)| / a! r^a` for `|u_i| <= r_i`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.monomials import CHUNK_ENTRIES, Floats, count, evaluate, exponents, positions
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import to_float
from pas.solid.tree import Atom, Distance, Function, Tree

Bools = NDArray[np.bool_]
Integers = NDArray[np.intp]

SEPARATOR = " + "
"""Between the names of faces that lie on one surface."""

SAMPLE = 200
"""Boxes that are looked at to choose the side to halve."""

BOX_CHUNK = 1 << 22
"""Numbers held at once while boxes are bounded."""


@dataclass(frozen=True)
class Column:
    """A function of the tree and the name of its face ("" for a wall)."""

    function: Function
    face: str


@dataclass(frozen=True)
class Leaf:
    """A column that must be <= 0, or the opposite where negated."""

    column: int
    negated: bool


@dataclass(frozen=True)
class Branch:
    """A union or an intersection."""

    parts: tuple[Code, ...]
    union: bool


Code = Leaf | Branch


class Program:
    """The columns of a tree and the code that combines their signs.

    A polynomial and its multiples are one column, so that `{w <= 0}` and `{w >= 0}` leave no gap between
    them; the column has the names of all faces on it.  `extra` functions are columns that the code
    does not use.
    """

    def __init__(self, tree: Tree, center: tuple[fmpq, fmpq, fmpq], scale: fmpq, extra: tuple[Function, ...] = ()):
        self.center, self.scale = center, scale
        self._numbers: dict[object, int] = {}
        self.columns: list[Column] = []
        self._signs: list[int] = []
        self.code = self._compile(tree)
        self.used = len(self.columns)
        for function in extra:
            self.columns.append(Column(function, ""))

    def _compile(self, tree: Tree) -> Code:
        if not isinstance(tree, Atom):
            return Branch(tuple(map(self._compile, tree.parts)), tree.union)
        key, sign = _key(tree.function)
        number = self._numbers.setdefault(key, len(self.columns))
        if number == len(self.columns):
            self.columns.append(Column(tree.function, tree.face))
            self._signs.append(sign)
        names = dict.fromkeys(filter(None, (*self.columns[number].face.split(SEPARATOR), tree.face)))
        self.columns[number] = Column(self.columns[number].function, SEPARATOR.join(names))
        return Leaf(number, tree.outside != (sign != self._signs[number]))

    def holds(self, yes: Bools, no: Bools) -> Bools:
        """Where the tree is certainly true (N,), given where each column is certainly <= 0 or > 0 (M, N)."""
        return _holds(self.code, yes, no)

    def inside(self, signs: Bools) -> Bools:
        """Where the tree is true (N,), given which columns are <= 0 (M, N)."""
        return _holds(self.code, signs, ~signs)

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
        result = np.empty((self.used, len(points)), dtype=bool)
        rows, matrix = self._polynomials
        step = max(1, CHUNK_ENTRIES // max(len(matrix), 1))
        for start in range(0, len(points), step):
            block = points[start : start + step]
            if len(rows):
                result[rows, start : start + step] = evaluate(block, matrix).T <= 0
        for number in self._distances:
            result[number] = self._distance(number, points)[:, 0] <= 0
        return result

    def values(self, points: Floats) -> Floats:
        """Values of the tree's columns (M, N) at points (N, 3)."""
        result = np.empty((self.used, len(points)))
        rows, matrix = self._polynomials
        if len(rows):
            result[rows] = evaluate(points, matrix).T
        for number in self._distances:
            result[number] = self._distance(number, points)[:, 0]
        return result

    def field(self, points: Floats) -> Floats:
        """Minimum and maximum of the columns (N,) at points (N, 3).

        Inside, walls only select which parts count, so that the value is not 0 where parts adjoin.
        """
        values = self.values(points)
        plain = _extremes(self.code, values)
        walls = [i for i in range(self.used) if not self.columns[i].face]
        selecting = values.copy()
        selecting[walls] = np.where(values[walls] <= 0, -np.inf, np.inf)
        chosen = _extremes(self.code, selecting)
        return np.where(self.inside(values <= 0) & np.isfinite(chosen), chosen, plain)

    def jets(self, points: Floats, number: int) -> Floats:
        """Values and gradients (N, 4) of a column at points (N, 3)."""
        if isinstance(self.columns[number].function, Polynomial):
            return evaluate(points, self._jet_matrix(number))
        return self._distance(number, points)

    def _distance(self, number: int, points: Floats) -> Floats:
        """Values and gradients (N, 4) of a column that is no polynomial, in local coordinates."""
        jets = self.columns[number].function.jets(self.world(points))  # type: ignore[union-attr]
        return jets * np.array([1 / to_float(self.scale), 1.0, 1.0, 1.0])

    def _jet_matrix(self, number: int) -> Floats:
        if number not in self._jet_matrices:
            p = self._localised(number)
            degree = max(p.degree, 0)
            self._jet_matrices[number] = np.stack([q.dense(degree) for q in (p, *map(p.diff, range(3)))], axis=1)
        return self._jet_matrices[number]

    @cached_property
    def _jet_matrices(self) -> dict[int, Floats]:
        return {}

    def _localised(self, number: int) -> Polynomial:
        p = self.columns[number].function
        assert isinstance(p, Polynomial)
        moved = [Polynomial.from_raw(g * self.scale + c) for g, c in zip(GENERATORS, self.center, strict=True)]
        return p.compose(*moved)

    @cached_property
    def _distances(self) -> list[int]:
        return [i for i in range(self.used) if not isinstance(self.columns[i].function, Polynomial)]

    @cached_property
    def _polynomials(self) -> tuple[Integers, Floats]:
        """The numbers of the polynomial columns, and their coefficients as columns of one matrix."""
        rows = [i for i in range(self.used) if isinstance(self.columns[i].function, Polynomial)]
        local = [self._localised(i) for i in rows]
        degree = max((p.degree for p in local), default=0)
        matrix = np.zeros((count(max(degree, 0)), len(rows)))
        for k, p in enumerate(local):
            matrix[:, k] = p.dense(max(degree, 0))
        return np.array(rows, dtype=np.intp), matrix

    def taylor(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools, Floats]:
        """Which columns (M, N) are certainly <= 0 and > 0 in boxes of given half edges (N, 3) or (3,).

        Also a bound (M, N) for the second-order part of what a column changes inside the box.
        """
        halves = np.broadcast_to(halves, centers.shape)
        yes, no = np.zeros((2, self.used, len(centers)), dtype=bool)
        second = np.zeros((self.used, len(centers)))
        rows, table = self._derivatives
        size = table.shape[2]
        step = max(1, BOX_CHUNK // max(1, table.shape[1] * table.shape[2]))
        for start in range(0, len(centers) if len(rows) else 0, step):
            part = slice(start, start + step)
            values = evaluate(centers[part], table.reshape(table.shape[0], -1))
            values = values.reshape(len(values), len(rows), size)
            powers = _powers(halves[part], self._degree)
            change = np.einsum("nmk,nk->mn", np.abs(values[:, :, 1:]), powers[:, 1:])
            yes[rows, part] = values[:, :, 0].T + change <= 0
            no[rows, part] = values[:, :, 0].T - change > 0
            times = self._second_order
            second[rows, part] = np.einsum("nmk,nk->mn", np.abs(values) * times, powers)
        reach = np.sqrt((halves * halves).sum(axis=1))
        for number in self._distances:
            value = self._distance(number, centers)[:, 0]
            yes[number], no[number] = value + reach <= 0, value - reach > 0
        return yes, no, second

    def widest(self, centers: Floats, half: Floats, undecided: Bools, hull: Floats) -> Floats:
        """How much each side of boxes (N, 3) adds to what the undecided columns (M, N) change in them (3,).

        Sides that are small beside the hull (2, 3) of all boxes count less.
        """
        rows, table = self._derivatives
        if not len(rows):
            return half / np.ptp(hull, axis=0)
        some = np.linspace(0, len(centers) - 1, min(len(centers), SAMPLE)).astype(int)
        values = evaluate(centers[some], table.reshape(table.shape[0], -1))
        values = np.abs(values.reshape(len(some), len(rows), -1))
        terms = values * _powers(np.broadcast_to(half, (len(some), 3)), self._degree)[:, None]
        share = np.array(exponents(self._degree), dtype=float)
        parts = terms @ share
        total = np.maximum(parts.sum(axis=2, keepdims=True), 1e-300)
        weight = (parts / total * undecided[rows][:, some].T[:, :, None]).sum(axis=(0, 1))
        return weight + 1e-6 * half / np.ptp(hull, axis=0)

    def gradient_bounds(self, centers: Floats, half: float, second: Floats) -> tuple[Bools, Bools]:
        """As `taylor` for cubes, given bounds (M, N) of second-order changes for cubes of this size."""
        yes, no = np.zeros((2, self.used, len(centers)), dtype=bool)
        rows, matrix = self._polynomials
        if len(rows):
            jets = np.concatenate([self._gradient_matrix, matrix], axis=1)
            step = max(1, BOX_CHUNK // jets.shape[1])
            for start in range(0, len(centers), step):
                part = slice(start, start + step)
                values = evaluate(centers[part], jets).T.reshape(4, len(rows), -1)
                change = np.abs(values[:3]).sum(axis=0) * half + second[rows, part]
                yes[rows, part], no[rows, part] = values[3] + change <= 0, values[3] - change > 0
        for number in self._distances:
            value = self._distance(number, centers)[:, 0]
            reach = half * 3**0.5
            yes[number], no[number] = value + reach <= 0, value - reach > 0
        return yes, no

    @property
    def _degree(self) -> int:
        matrix = self._polynomials[1]
        return next(n for n in range(len(matrix) + 1) if count(n) >= len(matrix))

    @cached_property
    def _gradient_matrix(self) -> Floats:
        """Coefficients of all first derivatives, the x ones first (count, 3 M)."""
        matrix = self._polynomials[1]
        return np.concatenate([_shift_operator(self._degree, i) @ matrix for i in range(3)], axis=1)

    @cached_property
    def _derivatives(self) -> tuple[Integers, Floats]:
        """Coefficients (count, M, count) of `p^(a) / a!` for each column and exponent a."""
        rows, matrix = self._polynomials
        degree = self._degree
        where = positions(degree)
        table = np.zeros((len(matrix), len(rows), len(matrix)))
        operators = [_shift_operator(degree, i) for i in range(3)]
        table[:, :, 0] = matrix
        for e in exponents(degree)[1:]:
            axis = next(i for i in range(3) if e[i])
            lower = tuple(v - (i == axis) for i, v in enumerate(e))
            table[:, :, where[e]] = operators[axis] @ table[:, :, where[lower]] / e[axis]
        return rows, table

    @cached_property
    def _second_order(self) -> Floats:
        """How often each Taylor term counts in a bound of the second-order change: C(|a|, 2)."""
        orders = np.array([sum(e) for e in exponents(self._degree)])
        return orders * (orders - 1) / 2.0


def _holds(code: Code, yes: Bools, no: Bools) -> Bools:
    if isinstance(code, Leaf):
        return no[code.column] if code.negated else yes[code.column]
    result = _holds(code.parts[0], yes, no).copy()
    for part in code.parts[1:]:
        if code.union:
            result |= _holds(part, yes, no)
        else:
            result &= _holds(part, yes, no)
    return result


def _extremes(code: Code, values: Floats) -> Floats:
    if isinstance(code, Leaf):
        return -values[code.column] if code.negated else values[code.column]
    parts = (_extremes(part, values) for part in code.parts)
    result = next(parts).copy()
    for part in parts:
        (np.minimum if code.union else np.maximum)(result, part, out=result)
    return result


def _key(function: Function) -> tuple[object, int]:
    """What makes a column, and the sign of the function in it."""
    if isinstance(function, Distance):
        return function, 1
    primitive = function.primitive()
    return primitive, 1 if function.raw.coeffs()[0] > 0 else -1


def _powers(half: Floats, degree: int) -> Floats:
    """`r^a` for all exponents (N, count)."""
    table = np.array(exponents(degree))
    result = np.ones((len(half), len(table)))
    for axis in range(3):
        result *= half[:, axis, None] ** table[:, axis]
    return result


def _shift_operator(degree: int, axis: int) -> Floats:
    """The matrix that maps a polynomial's coefficients to those of its derivative."""
    where = positions(degree)
    result = np.zeros((len(where), len(where)))
    for e, column in where.items():
        if e[axis]:
            result[where[tuple(v - (i == axis) for i, v in enumerate(e))], column] = e[axis]
    return result
