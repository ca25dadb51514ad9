"""The one power of two by which polynomials are divided before anything is worked out with them in doubles.

A positive factor changes neither a zero set nor its inside, but doubles end at 1e308 and 1e-308, and squares of
gradients at the roots of these.  So whatever evaluates, bounds or follows polynomials takes them `scaled`: exactly,
all by one factor, so that pieces which meet continuously still do.  Results are then the same to the bit for
`f` and `2^k f`; who shows values multiplies them by the power of two again, which is exact as well.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import binary_exponent
from pas.arrays import Floats


@dataclass(frozen=True)
class Scaled:
    """Polynomials over `2^exponent`, the largest of all their coefficients from 1 to 2 in size."""

    polynomials: tuple[Polynomial, ...]
    exponent: int

    @classmethod
    def of(cls, polynomials: Iterable[Polynomial]) -> Scaled:
        """Polynomials by their common power of two; those that are all 0 stay."""
        given = tuple(polynomials)
        exponent = binary_exponent(max((abs(c) for p in given for c in p.raw.coeffs()), default=fmpq(1)))
        factor = fmpq(2) ** -exponent
        found = {p: p if exponent == 0 else Polynomial.from_raw(p.raw * factor) for p in given}
        return cls(tuple(found[p] for p in given), exponent)

    def true(self, values: Floats) -> Floats:
        """The values of the polynomials themselves, given those of the scaled ones; infinite beyond doubles."""
        with np.errstate(over="ignore", under="ignore"):
            return values if self.exponent == 0 else np.ldexp(values, self.exponent)


def scaled(polynomial: Polynomial) -> Polynomial:
    """One polynomial by a power of two of its own."""
    return Scaled.of([polynomial]).polynomials[0]
