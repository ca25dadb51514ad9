"""Conditions of intersections that two others imply, with a proof: without them the set is the same.

Where `z <= 1` follows from `x <= 1` and `z <= x^3`, three surfaces meet in one curve, though two of them bound the set
there, and a lattice cannot show which.  Proved is that g <= 0 follows from h <= 0 and k <= 0 in a box by polynomials
t > 0 and s, r >= 0 on it with

    t g = s h + r k

(the simplest kind of a Positivstellensatz, Stengle 1974).  All such t, s, r of some degrees, without their signs, are
a linear space, found exactly.  A linear programme looks in it for one whose least B-coefficient on parts of the box is
large; that one is rounded to rationals, and its signs are looked at exactly.  What is not found is kept: nothing is
wrong then, but that some faces are superfluous.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations, product
from math import ceil, comb, floor

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.monomials import Floats, exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import exact, to_float
from pas.algebra.scaling import scaled
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.solid.bounds import bounding_box
from pas.solid.tree import Atom, Node, Tree

AROUND = 0.4
"""Over the box's longest side: how far beyond the box conditions are looked at; a lattice about it goes less far."""

MOST, HIGHEST = 12, 6
"""Conditions of one intersection, and their degrees, up to which they are looked at: of each three in turn."""

PARTS = 4
"""Parts into which the box is cut in each direction, on each of which B-coefficients are looked at."""

ROUNDED = 1 << 24
"""The denominator of the rationals to which weights of members are rounded: 7 digits, and the least coefficient for
which it is worth looking exactly is ten times that, over the largest of the space's members."""


def needed(tree: Tree, box: Floats) -> tuple[Tree, Floats]:
    """A set, which is in a box (2, 3), by its conditions that are not implied, and a box (2, 3) that holds it.

    What was left out is only known to be implied near the box.  Where all that is left is bounded, and its own box is
    in there, that is taken; else the given one, about which nothing else is near.
    """
    found = without_implied(tree, box)
    if found == tree:
        return tree, box
    try:
        around = bounding_box(found)
    except GeometryError:
        return found, box
    ends = np.array([[to_float(start), to_float(start + length)] for start, length in _cube(box)]).T
    inside = (around[0] > ends[0]).all() and (around[1] < ends[1]).all()
    return found, around if inside else box


def without_implied(tree: Tree, box: Floats) -> Tree:
    """A set, which is in a box (2, 3), without conditions that two others of an intersection imply.

    Itself where there are none, or none are found.
    """
    if isinstance(tree, Atom):
        return tree
    parts = tuple(without_implied(part, box) for part in tree.parts)
    kept = parts if tree.union else _needed(parts, box)
    if kept == tree.parts:
        return tree
    return kept[0] if len(kept) == 1 else Node(kept, tree.union)


def _needed(parts: Sequence[Tree], box: Floats) -> tuple[Tree, ...]:
    cube, known = _cube(box), {}
    for part in parts:
        if isinstance(part, Atom) and isinstance(part.function, Polynomial) and part.function.degree <= HIGHEST:
            known[part] = _in_cube(part.function, part.outside, cube)
    if not 3 <= len(known) <= MOST:
        return tuple(parts)
    points = np.array(list(product(np.linspace(0, 1, 17), repeat=3)))  # where it is tried first
    kept, values = list(parts), {part: polynomial(points) for part, polynomial in known.items()}
    for atom, g in known.items():
        checkpoint("looking for conditions that others imply")
        for h, k in combinations([part for part in known if part in kept and part != atom], 2):
            below = (values[h] <= 0) & (values[k] <= 0)
            if (values[atom][below] <= 0).all() and implied(g, known[h], known[k]):
                kept.remove(atom)
                break
    return tuple(kept)


def _cube(box: Floats) -> list[tuple[fmpq, fmpq]]:
    """Of each coordinate the lower end and the length of a larger box, rounded outwards to a 16th of it."""
    longest = float(np.ptp(box, axis=0).max())
    step = 2.0 ** floor(np.log2(longest / 16))
    ends = [(floor((low - AROUND * longest) / step), ceil((high + AROUND * longest) / step)) for low, high in box.T]
    return [(first * exact(step), (last - first) * exact(step)) for first, last in ends]


def _in_cube(function: Polynomial, outside: bool, cube: list[tuple[fmpq, fmpq]]) -> Polynomial:
    """The condition's function in coordinates of the unit cube, not positive where it holds."""
    moved = [Polynomial.from_raw(start + length * g) for (start, length), g in zip(cube, GENERATORS, strict=True)]
    found = scaled(function.compose(*moved))
    return -found if outside else found


def implied(g: Polynomial, h: Polynomial, k: Polynomial) -> bool:
    """Whether it is proved that g <= 0 in the unit cube wherever h <= 0 and k <= 0; not, where that is not found."""
    top = max(p.degree for p in (g, h, k))
    return any(_has_member(g, h, k, degree) for degree in dict.fromkeys((0, top - g.degree)))


def _has_member(g: Polynomial, h: Polynomial, k: Polynomial, degree: int) -> bool:
    """Whether there are t of such a degree, and s and r."""
    top = max(g.degree + degree, h.degree, k.degree)
    degrees = degree, top - h.degree, top - k.degree
    rows: dict[tuple[int, ...], dict[int, fmpq]] = {}
    column, starts = 0, []
    for times, p in zip(degrees, (g, -h, -k), strict=True):
        starts.append(column)
        for exponent in exponents(times):
            for found, value in (RING.from_dict({exponent: 1}) * p.raw).to_dict().items():
                rows.setdefault(found, {})[column] = value
            column += 1
    members = nullspace(rows.values(), column)
    if not members.nrows():
        return False
    entries = members.tolist()
    parts = [
        fmpq_mat([row[start : start + len(exponents(times))] for row in entries])
        for start, times in zip(starts, degrees, strict=True)
    ]
    for weights in _tried(parts, degrees):
        first, *others = ((weights * part * _b_table(d)).entries() for part, d in zip(parts, degrees, strict=True))
        if all(v > 0 for v in first) and all(v >= 0 for other in others for v in other):
            return True
    return False


def _tried(parts: list[fmpq_mat], degrees: Sequence[int]) -> Iterator[fmpq_mat]:
    """Weights (1, n) of members that may have the right signs: one where there is one, else what is best in doubles."""
    number = parts[0].nrows()
    if number == 1:
        yield from (fmpq_mat(1, 1, [sign]) for sign in (1, -1))
        return
    from scipy.optimize import linprog

    tables = [_doubles(part) @ _doubles(_b_table(degree)) for part, degree in zip(parts, degrees, strict=True)]
    table = np.concatenate(tables, axis=1)
    sizes = np.abs(table).max(axis=1)
    cost, ones = np.append(np.zeros(number), -1.0), np.ones((table.shape[1], 1))
    above = np.concatenate([-(table / sizes[:, None]).T, ones], axis=1)
    found = linprog(cost, above, np.zeros(len(above)), bounds=[*[(-1, 1)] * number, (None, 1)])
    if found.status == 0 and found.x[-1] > 10 / ROUNDED:
        scaled = (found.x[:-1] / sizes * sizes.max()).tolist()
        yield fmpq_mat(1, number, [fmpq(round(x * ROUNDED), ROUNDED) for x in scaled])


def _doubles(matrix: fmpq_mat) -> Floats:
    return np.array([[to_float(v) for v in row] for row in matrix.tolist()])


@cache
def _b_table(degree: int) -> fmpq_mat:
    """From coefficients of polynomials of a degree n to B-coefficients on all parts of the unit cube, of that degree in
    each variable: those of v^q are `C(i, q) / C(n, q)` (Farin 2002, chapter 6), and x = (j + v) / PARTS."""
    places = list(product(range(PARTS), range(degree + 1)))

    def value(p: int, j: int, i: int) -> fmpq:
        """Of x^p on part j the coefficient of number i."""
        terms = (fmpq(comb(p, q) * j ** (p - q) * comb(i, q), PARTS**p * comb(degree, q)) for q in range(p + 1))
        return sum(terms, fmpq(0))

    one = [[value(p, *place) for place in places] for p in range(degree + 1)]
    rows = [[a * b * c for a in one[p] for b in one[q] for c in one[r]] for p, q, r in exponents(degree)]
    return fmpq_mat(rows)
