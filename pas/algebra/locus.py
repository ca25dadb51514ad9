"""Sets of real parameters given by equations and inequations, split without overlap.

A `Locus` is the set where some polynomials in the parameters vanish and others do not.  What is
known of the parameters' signs decides more than algebra alone: a sum of terms of one sign
vanishes only where each of them does, so r^2 + d^2 = 0 is impossible for positive r.

Guaranteed: `where_zero(p)` and `where_nonzero(p)` are disjoint and together the locus; what is
dropped is empty.  Not guaranteed: that what is kept has a real point (that would take
quantifier elimination); it has a complex one, and no contradiction of signs was seen.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly_ctx, fmpz_mpoly_vec

from pas.algebra.ideal import divided, groebner, integral
from pas.algebra.polynomial import primitive
from pas.limits import checkpoint

Sign = frozenset[int]
ANY: Sign = frozenset({-1, 0, 1})

EFFORT = (60, 400, 2000)
"""Sizes (members, terms, bits) up to which a test for emptiness may grow before it is given up:
a locus that is kept although it is empty is no error, only a case too many."""


class Parameters:
    """The ring of polynomials in the parameters, and the signs that each may have.

    `signs` maps each name to a set of -1, 0, 1.
    """

    def __init__(self, signs: Mapping[str, Sign]) -> None:
        self.names = tuple(signs)
        self.allowed = tuple(signs.values())
        self.ring = fmpq_mpoly_ctx.get(self.names, Ordering.degrevlex)
        self.integers = fmpz_mpoly_ctx.get(self.names, Ordering.degrevlex)
        self.one = self.ring.constant(1)

    def sign(self, polynomial: fmpq_mpoly) -> Sign:
        """Signs that the polynomial may have, as far as the signs of its terms tell."""
        return _sum_sign(self._term_signs(polynomial))

    def factors(self, polynomial: fmpq_mpoly) -> tuple[fmpq_mpoly, ...]:
        """The irreducible factors that may vanish, primitive and without repetition."""
        found = (primitive(q) for q, _ in polynomial.factor()[1])
        return tuple(q for q in found if 0 in self.sign(q))

    def summands(self, polynomial: fmpq_mpoly) -> list[fmpq_mpoly]:
        """Terms that vanish wherever the polynomial does, since all have one sign; else none."""
        signs = self._term_signs(polynomial)
        if len(signs) > 1 and (not any(-1 in s for s in signs) or not any(1 in s for s in signs)):
            return [self.ring.from_dict({e: 1}) for e in polynomial.to_dict()]
        return []

    def _term_signs(self, polynomial: fmpq_mpoly) -> list[Sign]:
        result = []
        for exponents, coefficient in polynomial.to_dict().items():
            signs = {1 if coefficient > 0 else -1}
            for power, allowed in zip(exponents, self.allowed, strict=True):
                if power:
                    signs = {s * a ** int(power) for s in signs for a in allowed}
            result.append(frozenset(signs))
        return result


@dataclass(frozen=True)
class Locus:
    """Where all of `equations` vanish and none of `inequations`.

    The equations are a reduced Groebner basis, the inequations irreducible.
    """

    parameters: Parameters
    equations: tuple[fmpq_mpoly, ...] = ()
    inequations: tuple[fmpq_mpoly, ...] = ()

    @cached_property
    def _excluded(self) -> set[str]:
        return {str(q) for q in self.inequations}

    def reduce(self, polynomial: fmpq_mpoly) -> fmpq_mpoly:
        """The normal form modulo the equations."""
        return divided(polynomial, self.equations)[-1] if self.equations else polynomial

    def doubtful(self, polynomial: fmpq_mpoly) -> tuple[fmpq_mpoly, ...]:
        """The irreducible factors of a reduced polynomial that may vanish somewhere on the locus."""
        return tuple(q for q in self.parameters.factors(polynomial) if str(q) not in self._excluded)

    def excludes(self, polynomial: fmpq_mpoly) -> bool:
        """Whether the polynomial is known to vanish nowhere on the locus."""
        reduced = self.reduce(polynomial)
        return not reduced.is_zero() and not self.doubtful(reduced)

    def where_zero(self, *polynomials: fmpq_mpoly) -> list[Locus]:
        """The part where all of the polynomials vanish, as disjoint loci."""
        return split(self.parameters, [*self.equations, *polynomials], self.inequations)

    def where_nonzero(self, *polynomials: fmpq_mpoly) -> list[Locus]:
        """The part where none of the polynomials vanishes, as disjoint loci."""
        return split(self.parameters, self.equations, [*self.inequations, *polynomials])

    def within(self, other: Locus) -> bool:
        """Whether it is certain that this locus is a part of the other."""
        outside_zero = all(not self.where_nonzero(q) for q in other.equations if not self.reduce(q).is_zero())
        return outside_zero and all(self.excludes(q) or not self.where_zero(q) for q in other.inequations)

    def outside(self, other: Locus) -> list[Locus]:
        """The part of this locus that is not in the other, as disjoint loci."""
        found: list[Locus] = []
        inside = [self]
        for q in other.equations:
            found += [part for piece in inside for part in piece.where_nonzero(q)]
            inside = [part for piece in inside for part in piece.where_zero(q)]
        for q in other.inequations:
            found += [part for piece in inside for part in piece.where_zero(q)]
            inside = [part for piece in inside for part in piece.where_nonzero(q)]
        return found

    def tidied(self) -> Locus:
        """This locus without inequations that follow from the rest."""
        kept = list(self.inequations)
        for q in self.inequations:
            rest = [p for p in kept if str(p) != str(q)]
            if not split(self.parameters, [*self.equations, q], rest):
                kept = rest
        return Locus(self.parameters, self.equations, tuple(kept))


def split(parameters: Parameters, equations: Sequence[fmpq_mpoly], inequations: Iterable[fmpq_mpoly]) -> list[Locus]:
    """Disjoint loci that together are the set; equations that factor become several loci."""
    pending = [(list(equations), list(inequations))]
    done: list[Locus] = []
    while pending:
        checkpoint("splitting conditions on the parameters")
        zero, nonzero = pending.pop()
        basis = _basis(parameters, zero)
        draft = Locus(parameters, basis)
        excluded = [draft.reduce(q) for q in nonzero]
        if any(g.is_constant() for g in basis) or any(q.is_zero() for q in excluded):
            continue
        distinct = {str(f): f for q in excluded for f in parameters.factors(q)}
        locus = Locus(parameters, basis, tuple(distinct[key] for key in sorted(distinct)))
        simpler = _simpler(locus)
        if simpler is not None:
            pending += simpler
        elif not _is_empty(locus):
            done.append(locus)
    return done


def _simpler(locus: Locus) -> list[tuple[list[fmpq_mpoly], list[fmpq_mpoly]]] | None:
    """The locus in parts, where an equation factors or is a sum of terms of one sign; else None."""
    for i, g in enumerate(locus.equations):
        others = [*locus.equations[:i], *locus.equations[i + 1 :]]
        factors = locus.doubtful(g)
        if len(factors) != 1 or factors[0] != primitive(g):
            given = list(locus.inequations)
            return [([*others, q], [*given, *factors[:j]]) for j, q in enumerate(factors)]
        terms = locus.parameters.summands(g)
        if terms:
            return [([*others, *terms], list(locus.inequations))]
    return None


def _is_empty(locus: Locus) -> bool:
    """Whether 1 lies in the ideal of the equations and `1 - t * (product of the inequations)`."""
    if not locus.equations or not locus.inequations:
        return False
    context = fmpz_mpoly_ctx.get((*locus.parameters.names, "1/product"), Ordering.degrevlex)
    product = locus.parameters.one
    for q in locus.inequations:
        product = locus.reduce(product * q)
    *lifted, whole = (
        integral(p, locus.parameters.integers).project_to_context(context) for p in (*locus.equations, product)
    )
    system = fmpz_mpoly_vec([*lifted, 1 - context.gens()[-1] * whole], context)
    found: Any = system.buchberger_naive(limits=EFFORT)
    basis, complete = found
    return bool(complete) and any(g.is_constant() and not g.is_zero() for g in basis)


def _basis(parameters: Parameters, equations: Sequence[fmpq_mpoly]) -> tuple[fmpq_mpoly, ...]:
    generators = [integral(g, parameters.integers) for g in equations if not g.is_zero()]
    basis = groebner(generators, parameters.integers)
    return tuple(primitive(parameters.ring.from_dict(g.to_dict())) for g in basis)


def _sum_sign(signs: Sequence[Sign]) -> Sign:
    if any(-1 in s for s in signs) and any(1 in s for s in signs):
        return ANY
    definite = any(0 not in s for s in signs)
    union = frozenset().union(*signs)
    return union - {0} if definite else union | {0}
