"""Several polynomials in two parameters at many points, in doubles, without common work done twice.

Powers of the first parameter times a matrix (BLAS) give the coefficients in the second, then
Horner's rule (Higham 2002, section 5.1).  On jets, Horner's rule in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.jets import Jet
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float


@dataclass(frozen=True)
class Bundle:
    """Quotients of polynomials in t, h: `coefficients[a, b, i]` belongs to t^a h^b.

    Quotient i is polynomial `above[i]` over polynomial `below[i]` (None: it is a polynomial).
    """

    coefficients: Floats
    above: tuple[int, ...]
    below: tuple[int | None, ...]

    @classmethod
    def of_pairs(cls, pairs: Sequence[tuple[fmpq_mpoly, fmpq_mpoly]]) -> Bundle:
        """Numerators and denominators; equal denominators are evaluated once."""
        columns: list[dict[tuple[int, int], float]] = []
        seen: dict[str, int] = {}
        above, below = [], list[int | None]()
        for numerator, denominator in pairs:
            scale = max(abs(c) for c in denominator.coeffs())
            above.append(len(columns))
            if denominator.is_constant():
                columns.append(_terms(numerator, denominator.leading_coefficient()))
                below.append(None)
                continue
            columns.append(_terms(numerator, scale))
            key = str(denominator)
            if key not in seen:
                seen[key] = len(columns)
                columns.append(_terms(denominator, scale))
            below.append(seen[key])
        keys = [e for column in columns for e in column]
        table = np.zeros(
            (max((a for a, _ in keys), default=0) + 1, max((b for _, b in keys), default=0) + 1, len(columns))
        )
        for i, column in enumerate(columns):
            for e, c in column.items():
                table[(*e, i)] = c
        return cls(table, tuple(above), tuple(below))

    def __call__(self, t: Any, h: Any) -> list[Any]:
        """All polynomials, in the order of the last axis, at arrays or jets that broadcast."""
        if isinstance(t, Jet) or isinstance(h, Jet):
            return [self._jet(i, t, h) for i in range(self.coefficients.shape[2])]
        t, h = as_arrays(t, h)
        rows = combinations(t, self.coefficients)
        result = rows[-1]
        for row in rows[-2::-1]:
            result = result * h + row
        return list(result)

    def quotients(self, t: Any, h: Any) -> tuple[Any, ...]:
        """The quotients at arrays or jets; infinities and nan at poles."""
        with np.errstate(all="ignore"):
            values = self(t, h)
            return tuple(
                values[i] if j is None else values[i] / values[j] for i, j in zip(self.above, self.below, strict=True)
            )

    def _jet(self, number: int, t: Any, h: Any) -> Any:
        result: Any = None
        for column in self.coefficients[:, ::-1, number].T:
            inner = horner(column, t)
            result = inner if result is None else result * h + inner
        return result


def as_arrays(t: Any, h: Any) -> tuple[Floats, Floats]:
    """Two arrays with equally many axes, to broadcast."""
    first, second = np.asarray(t, dtype=float), np.asarray(h, dtype=float)
    size = max(first.ndim, second.ndim)
    return (
        first.reshape((1,) * (size - first.ndim) + first.shape),
        second.reshape((1,) * (size - second.ndim) + second.shape),
    )


def horner(coefficients: Sequence[float] | Floats, x: Any) -> Any:
    """The polynomial with these coefficients (lowest first) at an array or a jet."""
    if len(coefficients) == 1:
        return x * 0.0 + coefficients[0]
    result = x if coefficients[-1] == 1.0 else x * coefficients[-1]
    for place in range(len(coefficients) - 2, -1, -1):
        if coefficients[place] != 0.0:
            result = result + coefficients[place]
        if place > 0:
            result = result * x
    return result


def combinations(t: Floats, coefficients: Floats) -> Floats:
    """sum_a coefficients[a, ...] t^a: shape (..., *t.shape)."""
    size, rest = len(coefficients), coefficients.shape[1:]
    powers = np.empty((size, t.size))
    powers[0] = 1.0
    flat = t.reshape(-1)
    for a in range(1, size):
        np.multiply(powers[a - 1], flat, out=powers[a])
    return product(np.ascontiguousarray(coefficients.reshape(size, -1).T), powers).reshape(rest + t.shape)


def product(matrix: Floats, stacked: Floats) -> Floats:
    """sum_m matrix[..., m] stacked[m, ...], in blocks small enough for BLAS to stay in one thread."""
    # Multiplications in one matrix product: above, OpenBLAS starts threads, which costs more than it saves here.
    most = 1 << 18
    rows, flat = matrix.reshape(-1, matrix.shape[-1]), stacked.reshape(len(stacked), -1)
    result = np.empty((len(rows), flat.shape[1]))
    step = max(64, most // max(rows.size, 1))
    for start in range(0, flat.shape[1], step):
        np.matmul(rows, flat[:, start : start + step], out=result[:, start : start + step])
    return result.reshape(matrix.shape[:-1] + stacked.shape[1:])


def _terms(polynomial: fmpq_mpoly, scale: fmpq) -> dict[tuple[int, int], float]:
    return {(int(a), int(b)): to_float(c / scale) for (a, b), c in polynomial.to_dict().items()}
