"""Membership in contact ideals with parameters, as linear equations.

Where the leading monomials of f and h^(k+1) in some graded order have no variable in common and
constant coefficients, {f, h^(k+1)} is a Groebner basis for all values of the parameters
(Buchberger's first criterion), and g lies in the ideal iff its remainder, linear in the
coefficients of g, is zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import permutations

from flint import fmpq_mpoly

from pas.algebra.monomials import Exponents, exponents
from pas.limits import checkpoint

Terms = dict[Exponents, fmpq_mpoly]
"""A polynomial in x, y, z whose coefficients are polynomials in the parameters."""


class Remainders:
    """Remainders modulo polynomials whose leading terms are constant and have no common variable.

    Raises `ValueError` where no graded order makes them so.
    """

    def __init__(self, generators: Sequence[Mapping[Exponents, fmpq_mpoly]]) -> None:
        self._rules: list[tuple[Exponents, Terms]] = []
        self._known: dict[Exponents, Terms] = {}
        for order in permutations(range(3)):
            leads = [max((_grevlex(e, order), e) for e in g)[1] for g in generators]
            apart = all(
                min(a, b) == 0 for i, p in enumerate(leads) for q in leads[:i] for a, b in zip(p, q, strict=True)
            )
            if apart and all(g[lead].is_constant() for g, lead in zip(generators, leads, strict=True)):
                for g, lead in zip(generators, leads, strict=True):
                    scale = -1 / g[lead].leading_coefficient()
                    self._rules.append((lead, {e: c * scale for e, c in g.items() if e != lead}))
                return
        raise ValueError("the leading terms have a variable in common or depend on the parameters")

    def of_monomial(self, e: Exponents) -> Terms:
        """The remainder of one monomial."""
        if e not in self._known:
            self._known[e] = self._divided(e)
        return self._known[e]

    def _divided(self, e: Exponents) -> Terms:
        rule = next((r for r in self._rules if all(a >= b for a, b in zip(e, r[0], strict=True))), None)
        if rule is None:
            return {e: self._one}
        shift = tuple(a - b for a, b in zip(e, rule[0], strict=True))
        total: Terms = {}
        for tail, factor in rule[1].items():
            for target, value in self.of_monomial(tuple(a + b for a, b in zip(tail, shift, strict=True))).items():
                total[target] = total[target] + factor * value if target in total else factor * value
        return {m: v for m, v in total.items() if not v.is_zero()}

    @property
    def _one(self) -> fmpq_mpoly:
        return next(c for _, tail in self._rules for c in tail.values()).context().constant(1)


def membership_rows(remainders: Remainders, degree: int) -> list[dict[int, fmpq_mpoly]]:
    """The equations on the coefficients of g (in the order of `exponents(degree)`)."""
    rows: dict[Exponents, dict[int, fmpq_mpoly]] = {}
    for unknown, e in enumerate(exponents(degree)):
        checkpoint("writing the conditions with parameters")
        for target, value in remainders.of_monomial(e).items():
            rows.setdefault(target, {})[unknown] = value
    return list(rows.values())


def power(polynomial: Mapping[Exponents, fmpq_mpoly], exponent: int) -> Terms:
    """A power of a polynomial with parameters."""
    result = dict(polynomial)
    for _ in range(exponent - 1):
        product: Terms = {}
        for a, u in result.items():
            for b, v in polynomial.items():
                e = tuple(i + j for i, j in zip(a, b, strict=True))
                product[e] = product[e] + u * v if e in product else u * v
        result = {e: c for e, c in product.items() if not c.is_zero()}
    return result


def _grevlex(e: Exponents, order: Sequence[int]) -> tuple[int, ...]:
    """A key that grows with the graded reverse lexicographic order for a permutation of x, y, z."""
    return (sum(e), *(-e[i] for i in reversed(order)))
