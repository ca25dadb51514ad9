"""Graded Groebner bases of modules over Q[x, y, z], and syzygies, by Buchberger's algorithm.

A tuple of polynomials is written as one polynomial: a term of the tuple's position j is marked by `u^a_j e^b_j`, no
mark dividing another, so that flint's S-polynomials and reductions (over the integers, primitive) do the work.  A
fourth variable t makes everything homogeneous; the order is graded reverse lexicographic with t last, position last of
all, so that t = 1 in a Groebner basis gives one of the inhomogeneous module (Cox, Little and O'Shea 2005, chapter 5).

Syzygies: the Groebner basis of the rows (v_i | unit_i), the v-part dominating, holds the syzygies as its rows with
v-part zero.  A pair of rows whose v-part reduces to zero gives one, and these generate all of them (Schreyer 1980),
also where pairs that are superfluous among leading terms are left out.  Hilbert functions say beforehand how many
leading terms each degree has, so that no pair is reduced once they are found (Traverso 1996); the chain criterion is
that of Gebauer and Moeller (1988).  All of it ends with certainty: when there are no pairs left.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import lcm
from typing import Any, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_mpoly_vec

from pas.algebra.monomials import Exponents, count_members, count_monomials, leading_exponents, minimal
from pas.algebra.polynomial import RING
from pas.limits import checkpoint

RINGS = fmpz_mpoly_ctx.get(("u", "e", "x", "y", "z", "t"), Ordering.degrevlex)
"""The ring in which tuples are written: two variables that mark positions, and x, y, z, t."""

Vector = tuple[fmpq_mpoly, ...]
Pair = tuple[int, int]
Work = Pair | fmpz_mpoly
Rows = list[tuple[int, tuple[bool, fmpz_mpoly]]]
T = TypeVar("T")


def vector_degree(vector: Sequence[fmpq_mpoly]) -> int:
    """The largest degree of the entries; 0 where all are zero."""
    return max((int(p.total_degree()) for p in vector if not p.is_zero()), default=0)


@dataclass(frozen=True)
class TupleEncoding:
    """How tuples are written as polynomials of `RINGS`.

    A unit at position j has degree `shifts[j]`; terms at the first `front` positions are greater
    than all others of the same degree.
    """

    shifts: tuple[int, ...]
    front: int = 0

    def mark(self, position: int) -> tuple[int, int]:
        """The exponents of u and e at a position: the first fall, the second rise."""
        step = max(self.shifts, default=0) + 2
        fall = step * (len(self.shifts) - position)
        return fall, step * len(self.shifts) - fall + self.shifts[position] + (position < self.front)

    def position(self, exponents: Exponents) -> int:
        """The position that a marked term stands at."""
        return len(self.shifts) - exponents[0] // (max(self.shifts, default=0) + 2)

    def write(self, vector: Sequence[fmpq_mpoly], degree: int | None = None) -> fmpz_mpoly:
        """An integral multiple of a tuple, made homogeneous of a degree where one is given."""
        denominator = lcm(*(int(c.q) for p in vector for c in p.coeffs()))
        terms = {}
        for position, polynomial in enumerate(vector):
            mark = self.mark(position)
            for exponents, c in polynomial.to_dict().items():
                e = tuple(int(i) for i in exponents)
                lift = 0 if degree is None else degree - self.shifts[position] - sum(e)
                terms[(*mark, *e, lift)] = int(c.p) * (denominator // int(c.q))
        return RINGS.from_dict(terms)

    def read(self, polynomial: fmpz_mpoly) -> Vector:
        """The tuple, with t = 1."""
        entries: list[dict[Exponents, fmpq]] = [{} for _ in self.shifts]
        for exponents, c in polynomial.terms():
            e = tuple(int(i) for i in exponents)
            entries[self.position(e)][e[2:5]] = fmpq(c)
        return tuple(RING.from_dict(entry) for entry in entries)


class GradedBasis:
    """A Groebner basis while it grows, degree by degree."""

    def __init__(self) -> None:
        self.elements: list[fmpz_mpoly] = []
        self.leads: list[Exponents] = []
        self.degrees: list[int] = []
        self.pairs: dict[int, list[Pair]] = {}
        self._divisors: fmpz_mpoly_vec | None = None

    def add(self, element: fmpz_mpoly, degree: int) -> None:
        """Add a reduced element that is not zero, and its pairs with the earlier ones.

        Of the syzygies among the leading terms those suffice whose new coefficients generate the
        ideal of all new coefficients.
        """
        number, new = len(self.elements), leading_exponents(element)
        steps: dict[Exponents, int] = {}
        for i, old in enumerate(self.leads):
            if old[0] == new[0]:
                steps.setdefault(tuple(max(a - b, 0) for a, b in zip(old[2:], new[2:], strict=True)), i)
        for step in minimal(steps):
            self.pairs.setdefault(degree + sum(step), []).append((steps[step], number))
        self.elements.append(element)
        self.leads.append(new)
        self.degrees.append(degree)
        self._divisors = None

    def reduce(self, work: Work) -> fmpz_mpoly:
        """The primitive part of the remainder of an element, or of a pair's S-polynomial."""
        if self._divisors is None:
            self._divisors = fmpz_mpoly_vec(self.elements, RINGS)
        element: Any = work  # flint's stubs know neither spoly nor reduction_primitive_part
        if isinstance(work, tuple):
            first: Any = self.elements[work[0]]
            element = first.spoly(self.elements[work[1]])
        return element.reduction_primitive_part(self._divisors)

    def divisible(self, degree: int, marks: dict[int, int]) -> int:
        """How many monomials of a degree are divisible by leading terms at some positions.

        `marks` maps these positions, as exponents of u, to the degrees of their units.
        """
        groups: dict[int, list[Exponents]] = {}
        for e in self.leads:
            if e[0] in marks:
                groups.setdefault(e[0], []).append(e[2:])
        return sum(count_members(leads, degree - marks[mark], 4) for mark, leads in groups.items())


def graded_basis(inputs: Sequence[fmpz_mpoly]) -> GradedBasis:
    """A Groebner basis (not reduced) of elements, homogeneous or not, at positions of degree 0."""
    basis = GradedBasis()
    waiting = _by_degree([(_degree(p), p) for p in inputs if not p.is_zero()])
    while waiting or basis.pairs:
        degree = min([*waiting, *basis.pairs])
        todo: list[Work] = [*basis.pairs.pop(degree, []), *waiting.pop(degree, [])]
        for work in todo:
            checkpoint(f"finding a Groebner basis of a module, degree {degree}, {len(basis.elements)} elements")
            remainder = basis.reduce(work)
            if not remainder.is_zero():
                basis.add(remainder, _degree(remainder))
    return basis


def graded_syzygies(vectors: Sequence[Vector], known: Sequence[Vector] = ()) -> list[Vector]:
    """The syzygies of `vectors`: minimal generators of those of the homogenised vectors.

    Sorted by degree (the largest degree of a product), with coprime integers as coefficients.  Those of degree <= d,
    times monomials, span all syzygies of degree <= d.  With `known` syzygies: what is needed beside them.
    """
    width, units = len(vectors[0]), [vector_degree(v) for v in vectors]
    encoding = TupleEncoding((*(0 for _ in range(width)), *units), front=width)
    nothing = (RING.constant(0),) * len(vectors)
    images, rows = [], []
    for i, (vector, degree) in enumerate(zip(vectors, units, strict=True)):
        images.append(encoding.write((*vector, *nothing), degree))
        unit = (*nothing[:i], RING.constant(1), *nothing[i + 1 :])
        rows.append((degree, (True, encoding.write((*vector, *unit), degree))))
    for syzygy in known:
        degree = max(int(a.total_degree()) + d for a, d in zip(syzygy, units, strict=True) if not a.is_zero())
        rows.append((degree, (False, encoding.write((*nothing[:1] * width, *syzygy), degree))))
    found = _zero_rows(encoding, graded_basis(images), rows)
    return [encoding.read(row)[width:] for row in found]


def _zero_rows(encoding: TupleEncoding, images: GradedBasis, rows: Rows) -> list[fmpz_mpoly]:
    """Minimal generators of the combinations of rows that are zero at the front positions.

    `images` is the Groebner basis of the rows cut off after the front positions; rows come with
    their degrees and whether they are fresh (False: such a combination already known).  In each
    degree come first those that are known, and their pairs: what is new after them is a generator.
    """
    marks = [(encoding.mark(j)[0], shift) for j, shift in enumerate(encoding.shifts)]
    front, back = dict(marks[: encoding.front]), dict(marks[encoding.front :])
    basis, waiting = GradedBasis(), _by_degree(rows)
    found: list[fmpz_mpoly] = []
    while waiting or any(basis.leads[i][0] in front for pairs in basis.pairs.values() for i, _ in pairs):
        degree = min([*waiting, *basis.pairs])
        every = sum(count_monomials(degree - d, 4) for d in back.values())
        missing = {
            True: images.degrees.count(degree),
            False: every - images.divisible(degree, front) - basis.divisible(degree, back),
        }
        todo: list[tuple[bool, Work]] = [(basis.leads[p[0]][0] in front, p) for p in basis.pairs.pop(degree, [])]
        todo += waiting.pop(degree, [])
        for is_fresh, work in sorted(todo, key=lambda item: item[0]):
            checkpoint(f"finding syzygies, degree {degree}, {len(found)} generators")
            if not missing[False] and not (is_fresh and missing[True]):
                continue
            remainder = basis.reduce(work)
            if remainder.is_zero():
                continue
            basis.add(remainder, degree)
            in_front = basis.leads[-1][0] in front
            missing[in_front] -= 1
            if is_fresh and not in_front:
                found.append(remainder)
    return found


def _degree(element: fmpz_mpoly) -> int:
    """The degree of the leading term, at a position of degree 0."""
    return sum(leading_exponents(element)[2:])


def _by_degree(inputs: Iterable[tuple[int, T]]) -> dict[int, list[T]]:
    waiting: dict[int, list[T]] = {}
    for degree, item in inputs:
        waiting.setdefault(degree, []).append(item)
    return waiting
