"""Syzygies of polynomials and of tuples, and submodules of free modules over Q[x, y, z].

Generators of all syzygies come from Groebner bases (see `pas.algebra.buchberger`), those of
bounded degree from linear algebra; each syzygy is multiplied out exactly before it is returned.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, Unpack

from flint import fmpq, fmpz_mpoly, fmpz_mpoly_vec

from pas.algebra.brief import whole_or_brief
from pas.algebra.buchberger import RINGS, TupleEncoding, Vector, graded_basis, graded_syzygies, vector_degree
from pas.algebra.inputs import natural
from pas.algebra.monomials import Exponents, exponents, leading_exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import RING, Polynomial, PolynomialLike
from pas.algebra.systems import Exchanged, Exported, Rows
from pas.limits import WorkLimits, checkpoint, limited

Syzygy = tuple[Polynomial, ...]


class Syzygies(tuple[Syzygy, ...], Exported):
    """A tuple of syzygies, which notebooks show as formulas and other programs read."""

    __slots__ = ()

    @property
    def rows(self) -> Rows:
        return tuple(self)


@limited("finding syzygies", "a lower degree")
def syzygies(
    polynomials: Sequence[PolynomialLike | Sequence[PolynomialLike]],
    degree: int | None = None,
    **limits: Unpack[WorkLimits],
) -> Syzygies:
    """All relations `a_1 v_1 + .. + a_m v_m = 0` with polynomial coefficients.

    `polynomials` are m polynomials (anything that `Polynomial` takes) or m tuples of equally many
    of them.  A syzygy is the tuple (a_1, .., a_m); its degree is the largest degree of a product,
    `deg(a_i) + deg(v_i)`, where deg(v_i) is the largest degree of its entries (0 for zero).

    Without a `degree`: generators of all syzygies, by ascending degree, with coprime integers as coefficients.  They
    are minimal as graded generators: those of degree <= d, times monomials, span all syzygies of degree <= d, and none
    is a combination of others of at most its own degree.  (One may be a combination in which higher degrees cancel:
    `Submodule.irredundant` drops such, and with them the promise on degrees.)  With a `degree`: a basis of the vector
    space of all syzygies of degree <= `degree`.

    Raises `ValueError` or `TypeError` for no polynomials, tuples of different lengths, or entries that are no
    polynomials in x, y, z.

    Source: Buchberger (1965) and Schreyer (1980); see Cox, Little and O'Shea (2005, chapter 5).

    >>> [[str(a) for a in s] for s in syzygies(["x", "y"])]
    [['-y', 'x']]
    """
    vectors = _vectors(polynomials, "polynomials")
    if degree is not None:
        natural(degree, "degree", words=" or None")
    found = graded_syzygies(vectors) if degree is None else _bounded(vectors, degree)
    for syzygy in found:
        if not all(p.is_zero() for p in combination(syzygy, vectors)):
            raise ArithmeticError("a syzygy that was found is none")  # pragma: no cover
    return Syzygies(tuple(map(Polynomial.from_raw, syzygy)) for syzygy in found)


class Submodule(Exchanged):
    """The submodule of Q[x, y, z]^s that tuples of s polynomials generate: several, or a list of them.

    The order of terms is graded reverse lexicographic, x > y > z, and position after that, the
    first the greatest.

    Raises `ValueError` or `TypeError` for no tuples, tuples of different lengths, or entries that
    are no polynomials in x, y, z.

    >>> module = Submodule(("x", "y"), ("0", "z"))
    >>> ("x*z", "0") in module, ("x", "0") in module
    (True, False)
    """

    def __init__(self, *generators: Sequence[PolynomialLike] | Sequence[Sequence[PolynomialLike]]) -> None:
        one = generators[0] if len(generators) == 1 else None
        several = isinstance(one, list | tuple) and all(isinstance(row, list | tuple) for row in one)
        given: Sequence[Any] = one if several and one is not None else generators
        self.generators = tuple(tuple(map(Polynomial.from_raw, v)) for v in _vectors(given, "generators"))

    @property
    def rows(self) -> Rows:
        return self.generators

    @property
    def width(self) -> int:
        """The length s of the tuples."""
        return len(self.generators[0])

    def groebner_basis(self) -> tuple[Syzygy, ...]:
        """The reduced Groebner basis, monic, by descending leading terms; () for the zero module."""
        return tuple(self._monic(g) for g in self._basis)

    def normal_form(self, element: Sequence[PolynomialLike]) -> Syzygy:
        """The remainder of a tuple modulo the Groebner basis: zero iff it is a member."""
        vector = self._element(element)
        # flint's remainder is one up to a constant factor: a 1 at a last position tells it
        tagged = self._encoding.write((*vector, RING.constant(1)))
        *remainder, tag = self._encoding.read(_remainder(tagged, self._basis))
        return tuple(Polynomial.from_raw(p * (1 / tag.leading_coefficient())) for p in remainder)

    def contains(self, element: Sequence[PolynomialLike]) -> bool:
        """Whether a tuple is a member."""
        vector = self._element(element)
        return bool(_remainder(self._encoding.write((*vector, RING.constant(0))), self._basis).is_zero())

    __contains__ = contains

    def irredundant(self) -> Submodule:
        """This module, generated by some of its generators of which none is in the span of the others.

        Goes through the generators from the last to the first.  Each step is a Groebner basis of
        its own, and can take long where the generators are many.
        """
        kept = list(self.generators)
        for candidate in reversed(self.generators):
            others = [g for g in kept if g is not candidate]
            if others and candidate in Submodule(*others):
                kept = others
        return Submodule(*kept)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Submodule):
            return NotImplemented
        return self.width == other.width and self.groebner_basis() == other.groebner_basis()

    def __hash__(self) -> int:
        return hash((self.width, self.groebner_basis()))

    def __repr__(self) -> str:
        rows = [f"({', '.join(repr(str(p)) for p in g)})" for g in self.generators]
        return whole_or_brief("Submodule", rows, "generators")

    @cached_property
    def _encoding(self) -> TupleEncoding:
        return TupleEncoding((0,) * (self.width + 1))

    @cached_property
    def _basis(self) -> tuple[fmpz_mpoly, ...]:
        zero = RING.constant(0)
        basis = graded_basis([self._encoding.write((*(p.raw for p in g), zero)) for g in self.generators])
        reduced = fmpz_mpoly_vec(basis.elements, RINGS).autoreduction() if basis.elements else ()
        return tuple(sorted(reduced, key=_descending, reverse=True))

    def _element(self, element: Sequence[PolynomialLike]) -> Vector:
        (vector,) = _vectors([element], "tuple")
        if len(vector) != self.width:
            raise ValueError(f"the tuple must have {self.width} polynomials, not {len(vector)}")
        return vector

    def _monic(self, element: fmpz_mpoly) -> Syzygy:
        scale = fmpq(1, element.leading_coefficient())
        return tuple(Polynomial.from_raw(p * scale) for p in self._encoding.read(element)[:-1])


def combination(coefficients: Sequence[Any], vectors: Sequence[Vector]) -> Vector:
    """The sum of the vectors times their (raw) coefficients."""
    zero = RING.constant(0)
    return tuple(sum((c * p for c, p in zip(coefficients, v, strict=True)), zero) for v in zip(*vectors, strict=True))


def _bounded(vectors: Sequence[Vector], degree: int) -> list[Vector]:
    """A basis of the syzygies with every product of degree <= `degree`."""
    unknowns = [(i, e) for i, v in enumerate(vectors) for e in exponents(degree - vector_degree(v))]
    rows: dict[tuple[int, Exponents], dict[int, fmpq]] = {}
    for number, (i, shift) in enumerate(unknowns):
        checkpoint(f"setting up the syzygies of degree {degree}", number / len(unknowns))
        for position, polynomial in enumerate(vectors[i]):
            for e, c in polynomial.to_dict().items():
                monomial = tuple(int(a) + b for a, b in zip(e, shift, strict=True))
                rows.setdefault((position, monomial), {})[number] = c
    found = []
    for solution in nullspace(rows.values(), len(unknowns)).tolist():
        entries: list[dict[Exponents, fmpq]] = [{} for _ in vectors]
        for (i, e), c in zip(unknowns, solution, strict=True):
            if c != 0:
                entries[i][e] = c
        found.append(tuple(RING.from_dict(entry) for entry in entries))
    return found


def _remainder(element: fmpz_mpoly, basis: Iterable[fmpz_mpoly]) -> fmpz_mpoly:
    raw: Any = element
    return raw.reduction_primitive_part(fmpz_mpoly_vec(list(basis), RINGS))


def _descending(element: fmpz_mpoly) -> tuple[int, ...]:
    """A key that sorts leading terms by the order of the ring."""
    u, _, *e = leading_exponents(element)
    return (sum(e), *(-i for i in reversed(e)), u)


def _vectors(items: Sequence[Any], name: str) -> list[Vector]:
    """Tuples of raw polynomials of one length, from polynomials or tuples of them."""
    if isinstance(items, (str, Polynomial)) or not isinstance(items, Iterable):
        raise TypeError(f"{name} must be a sequence of polynomials or of tuples of them, not {items!r}")
    rows = list(items)
    if not rows:
        raise ValueError(f"{name} must be at least one polynomial or tuple, not an empty sequence")
    tuples = [isinstance(row, (tuple, list)) for row in rows]
    if any(tuples) and not all(tuples):
        raise TypeError(
            f"{name} must be all polynomials or all tuples; number {tuples.index(not tuples[0]) + 1} differs"
        )
    vectors = [
        tuple(Polynomial.named(p, f"{name}[{i}]").raw for p in (row if tuples[i] else (row,)))
        for i, row in enumerate(rows)
    ]
    for i, vector in enumerate(vectors):
        if not vector or len(vector) != len(vectors[0]):
            wanted = len(vectors[0]) or "at least 1"
            raise ValueError(
                f"{name}[{i}] must be a tuple of {wanted} polynomials like the first, not of {len(vector)}"
            )
    return vectors
