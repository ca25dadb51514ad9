"""Weights: T = sum f_i(h) P_i(t, h), the surfaces themselves perturbed.

    f_i = N_i / (N_i + (1 - u_i) (h - s_i)^m),   N_i = u_i prod_{j != i} (h - s_j)^m,   m >= k + 1

(for two surfaces Hartmann 2001, with u_2 = 1 - u_1 so that f_1 + f_2 = 1; for more Perez-Diaz and Sendra 2003, theorem
7, corrected).  f_i is 1 up to order m - 1 at s_i and 0 up to order m - 1 at the other values.  With m even and 0 < u_i
< 1 no denominator has a real zero: it is a sum of two squares that vanish nowhere together.  The printed exponent m = k
+ 1 has real poles for even k and more than two surfaces.  For two surfaces m = k + 1 is kept: a pole, if any, lies
outside the interval (and both signs are chosen so that there is none inside).

For more than two surfaces the f_i do not add up to 1, so the blend depends on the origin of space;
normalised weights f_i / sum f_j do, keep the order of contact, and commute with affine maps.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from math import prod
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly
from numpy.typing import ArrayLike

from pas.algebra.inputs import HIGHEST_EXPONENT, check_order, set_fields, short, shown, whole
from pas.algebra.jets import Jet, power
from pas.algebra.rational import Exact, plain, rational, to_float
from pas.algebra.rational_function import RationalFunction
from pas.algebra.roots import in_one
from pas.parametric.hermite import distinct
from pas.parametric.series import rounded_roots, univariate


@dataclass(frozen=True)
class WeightPole:
    """A real pole of weight number `weight` at `h`; `inside` where it lies between the outermost values."""

    weight: int
    h: float
    inside: bool


@dataclass(frozen=True, init=False)
class Weights:
    """The weights of n surfaces for contact of order k.

    `balance` is one number u in (0, 1), or one for each surface; for two surfaces one number u means
    (u, 1 - u).  `exponent` is m; by default k + 1 for two surfaces, else the even one of k + 1, k + 2.

    Raises `ValueError` for a balance outside (0, 1), an exponent below k + 1 or equal values.
    """

    values: tuple[fmpq, ...]
    balance: tuple[fmpq, ...]
    exponent: int
    normalized: bool

    def __init__(
        self,
        values: Sequence[Exact],
        order: int,
        balance: Exact | Sequence[Exact] = "1/2",
        normalized: bool = False,
        exponent: int | None = None,
    ) -> None:
        at, k = distinct(values), check_order(order)
        if len(at) < 2:
            raise ValueError("weights need at least two values")
        if not isinstance(normalized, bool):
            raise TypeError(f"normalized must be true or false, not {shown(normalized)}")
        if exponent is None:
            exponent = k + 1 if len(at) == 2 or k % 2 else k + 2
        m = whole(exponent, "exponent", k + 1, HIGHEST_EXPONENT, f"for contact of order {k}")
        set_fields(self, values=at, balance=_balance(balance, len(at)), exponent=m, normalized=normalized)

    @cached_property
    def functions(self) -> tuple[RationalFunction, ...]:
        """The weights as exact functions of h."""
        pairs = self._pairs([fmpq_poly([-s, 1]) for s in self.values], self.balance)
        quotients = [(above, above + rest) for above, rest in pairs]
        if self.normalized:
            everything = prod((below for _, below in quotients), start=fmpq_poly([1]))
            tops = [above * (everything / below) for above, below in quotients]
            quotients = [(top, sum(tops, fmpq_poly([0]))) for top in tops]
        return tuple(RationalFunction.quotient(univariate(a, 1), univariate(b, 1)) for a, b in quotients)

    def poles(self) -> tuple[WeightPole, ...]:
        """All real poles of the weights, by weight and place (exactly isolated, then rounded)."""
        found = []
        for i, f in enumerate(self.functions):
            below = in_one(f.denominator, 1)
            inside = rounded_roots(below, min(self.values), max(self.values))  # none is at a value
            found += [WeightPole(i, root, root in inside) for root in rounded_roots(below)]
        return tuple(found)

    def __call__(self, h: ArrayLike) -> list[Any]:
        """Values of all weights at an array, or jets at a jet, from the factors as they stand."""
        at: Any = h if isinstance(h, Jet) else np.asarray(h, dtype=float)
        with np.errstate(all="ignore"):
            pairs = self._pairs([at - to_float(s) for s in self.values], [to_float(u) for u in self.balance])
            result = [above / (above + rest) for above, rest in pairs]
            everything: Any = sum(result[1:], result[0])
            return [f / everything for f in result] if self.normalized else result

    def _pairs(self, steps: Sequence[Any], shares: Sequence[Any]) -> list[tuple[Any, Any]]:
        """N_i and (1 - u_i) (h - s_i)^m from the steps h - s_i: polynomials, arrays or jets.

        For two surfaces and an odd exponent (s_j - h)^m stands in place of (h - s_j)^m.
        """
        sign = -1 if len(steps) == 2 and self.exponent % 2 else 1
        pairs = []
        for i, (step, u) in enumerate(zip(steps, shares, strict=True)):
            others = reduce(operator.mul, [s for j, s in enumerate(steps) if j != i])
            pairs.append((power(others * sign, self.exponent) * u, power(step, self.exponent) * (1 - u)))
        return pairs


def _balance(balance: Any, size: int) -> tuple[fmpq, ...]:
    if isinstance(balance, str) or not hasattr(balance, "__len__"):
        u = rational(balance, "balance")
        balances: tuple[fmpq, ...] = (u, 1 - u) if size == 2 else (u,) * size
    else:
        balances = tuple(rational(u, f"balance[{i}]") for i, u in enumerate(balance))
    if len(balances) != size:
        raise ValueError(f"balance must be one number or {size}, one for each surface, not {len(balances)}")
    for i, u in enumerate(balances):
        if not 0 < u < 1:
            raise ValueError(f"balance must lie strictly between 0 and 1, not {short(plain(u))} (for surface {i})")
    return balances
