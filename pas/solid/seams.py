"""The curves along which faces of a solid touch, each given by two functions that vanish on it.

Where two faces touch, their own two functions do not say where.  What says it is a claimed joint; the line along which
a plane touches a cylinder or cone; else a wall that cuts one of the surfaces where the other one does.  Two faces may
touch along several curves, as a blend does along both circles in which a pipe that goes through it ends: where all of
them are cut from one surface f by functions h, the faces' seam is f = 0 with the product of the h, so that each point
is sought on the curve that is nearest to it.

Not guaranteed: of curves that have no function in common only the first is a seam.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from pas.algebra.ideal import Ideal
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.scaling import scaled
from pas.solid.evaluator import TreeEvaluator
from pas.solid.functions import polynomials_of
from pas.solid.tree import Tree, atoms

Curve = tuple[Polynomial, Polynomial]

LINEAR = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0))
"""The exponents of x, y, z and 1."""

INDEPENDENT = 1e-6
"""Length of what is left of a vector of length 1 without its parts along others, above which it is not in their span:
rounding leaves 1e-9 at most."""


@dataclass(frozen=True)
class Seam:
    """Two functions, and the ideals of the curves that are their common zeros."""

    functions: Curve
    curves: tuple[Ideal, ...]

    def is_on(self, surfaces: Sequence[Polynomial]) -> bool:
        """Whether each of the curves is on one of some surfaces."""
        return all(any(map(curve.contains, surfaces)) for curve in self.curves)


def seams_of(tree: Tree, claimed: Sequence[Curve]) -> list[Seam]:
    """The seams of claimed curves and of lines along which faces of a tree touch, those of several curves first."""
    curves = [*claimed, *_lines(tree)]
    single = [Seam(curve, (Ideal(*curve),)) for curve in curves]
    cutting: dict[Polynomial, list[int]] = {}
    for number, curve in enumerate(curves):
        for function in curve:
            cutting.setdefault(function.primitive(), []).append(number)
    surfaces = [polynomials_of(f) for f in dict.fromkeys(atom.function for atom in atoms(tree))]
    several: dict[tuple[Polynomial, frozenset[int]], Seam] = {}
    for common, numbers in cutting.items():
        if len(numbers) > 1:
            times = Counter(frozenset(n for n in numbers if single[n].is_on(surface)) for surface in surfaces)
            for first, second in combinations_with_replacement(times, 2):
                shared = first & second if first != second or times[first] > 1 else frozenset()
                if len(shared) > 1:
                    several[common, shared] = _united(common, [single[n] for n in sorted(shared)])
    return [*sorted(several.values(), key=lambda seam: -len(seam.curves)), *single]


def _lines(tree: Tree) -> list[Curve]:
    """The lines along which faces on planes touch others on cylinders or cones: each plane, and one across it.

    On the plane the quadric's form is then c m^2, and the polar plane of a point off the line passes through it.
    """
    faces = dict.fromkeys(a.function.primitive() for a in atoms(tree) if a.face and isinstance(a.function, Polynomial))
    quadrics = [form for form in map(quadratic_form, (f for f in faces if f.degree == 2)) if form.det() == 0]
    result = []
    for plane in (f for f in faces if f.degree == 1 and quadrics):
        basis = _basis(plane)
        for form in quadrics:
            polars = form * basis
            on_plane = basis.transpose() * polars
            if on_plane.rank() == 1:
                off = next(i for i in range(3) if on_plane[i, i] != 0)
                numbers = [polars[i, off] for i in range(4)]
                across: dict[tuple[int, ...], fmpq] = {
                    exponent: c for exponent, c in zip(LINEAR, numbers, strict=True) if c != 0
                }
                result.append((plane, Polynomial(across)))
    return result


def quadratic_form(function: Polynomial) -> fmpq_mat:
    """Twice the symmetric matrix (4, 4) of a polynomial of degree at most 2 in x, y, z and 1."""
    entries: dict[tuple[int, int], fmpq] = {}
    for exponent, coefficient in function.raw.to_dict().items():
        i, j = [*(axis for axis, power in enumerate(exponent) for _ in range(power)), 3, 3][:2]
        entries[i, j] = entries[j, i] = coefficient * (2 if i == j else 1)
    return fmpq_mat(4, 4, [entries.get((i, j), fmpq(0)) for i in range(4) for j in range(4)])


def _basis(plane: Polynomial) -> fmpq_mat:
    """Three points (4, 3) in homogeneous coordinates that span a plane."""
    numbers = [quadratic_form(plane)[i, 3] * (1 if i < 3 else fmpq(1, 2)) for i in range(4)]
    pivot = next(i for i in range(3) if numbers[i] != 0)
    others = [i for i in range(4) if i != pivot]
    return fmpq_mat(
        [[-numbers[j] / numbers[pivot] if i == pivot else fmpq(int(i == j)) for j in others] for i in range(4)]
    )


def _united(common: Polynomial, seams: Sequence[Seam]) -> Seam:
    """The seam of several that have a function in common, up to its factor; each curve once."""
    curves: list[Ideal] = []
    product = Polynomial(1)
    for seam in seams:
        if not any(all(map(known.contains, seam.functions)) for known in curves):
            first, second = seam.functions
            other = second if first.primitive() == common else first
            curves += seam.curves
            product = Polynomial.from_raw(product.raw * other.raw / product.raw.gcd(other.raw))
    return Seam((common, product), tuple(curves))


class Seams:
    """The seams of the faces of an evaluator, in whose extra columns the functions of given ones are, in pairs."""

    def __init__(self, evaluator: TreeEvaluator, given: Sequence[Seam]) -> None:
        self._program, self._given = evaluator, tuple(given)
        self._found: dict[tuple[int, int], tuple[int, ...]] = {}

    def between(self, a: int, b: int) -> tuple[int, ...]:
        """The columns of the curves in which two columns' faces touch, or nothing where they cross."""
        if (a, b) not in self._found:
            self._found[a, b] = self._find(a, b)
        return self._found[a, b]

    def _find(self, a: int, b: int) -> tuple[int, ...]:
        columns = self._program.columns
        first, second = (polynomials_of(columns[c].function) for c in (a, b))
        for number, seam in enumerate(self._given):
            if seam.is_on(first) and seam.is_on(second):
                start = self._program.used + 2 * number
                return start, start + 1
        if len(first) != 1 or len(second) != 1:
            return ()
        f, g = first[0], second[0]
        for number in np.flatnonzero(self._may_join(a, b)).tolist():
            w = columns[number].function
            if not isinstance(w, Polynomial) or number in (a, b):
                continue
            for kept, p, q in ((a, f, g), (b, g, f)):
                ideal = Ideal(p, w)
                if ideal.contains(q) and not ideal.is_whole_ring:
                    return kept, number
        return ()

    def _may_join(self, a: int, b: int) -> NDArray[np.bool_]:
        """Which columns are walls (M,) on which two faces may touch: three planes must depend on each other."""
        result, units = self._program.walls.copy(), self._units
        first, second = units[a], units[b]
        second = second - (second @ first) * first
        length = float(np.sqrt(second @ second))
        if length > INDEPENDENT:  # not where it is NaN
            second = second / length
            rest = units - np.outer(units @ first, first) - np.outer(units @ second, second)
            result &= ~(np.sqrt((rest * rest).sum(axis=1)) > INDEPENDENT)
        return result

    @cached_property
    def _units(self) -> Floats:
        """The four coefficients (M, 4) of the tree's planes, as vectors of length 1; NaN for others."""
        result = np.full((self._program.used, 4), np.nan)
        for number in np.flatnonzero(self._program.planes).tolist():
            function = self._program.columns[number].function
            if isinstance(function, Polynomial):
                row = scaled(function).dense(1)
                result[number] = row / np.sqrt(row @ row)
        return result
