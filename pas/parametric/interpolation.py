"""The Hermite blend, exactly: T = sum_i sum_{j<=k} (d^j P_i/dh^j)(t, s_i) L_ij(h).

Source: Perez-Diaz and Sendra (2003), algorithm 1.  The denominators are polynomials in t alone, so the sum
is a product of two matrices of rationals, and lowest terms need greatest common divisors in t only.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.expressions import Names
from pas.algebra.rational_function import RING, RationalFunction
from pas.limits import checkpoint
from pas.parametric.components import Components
from pas.parametric.data import BlendingData, Expansion
from pas.parametric.hermite import taylor_basis
from pas.parametric.series import univariate


def exact_hermite(data: BlendingData, order: int, names: Names) -> Components:
    """The exact Hermite blend in lowest terms."""
    rows = [p for i in range(len(data.surfaces)) for p in taylor_basis(data.values, i, order)]
    width = max(p.length() for p in rows)
    basis = fmpq_mat(len(rows), width, [c for p in rows for c in _padded(p, width)])
    expansions = [data.expansions(i, order) for i in range(len(data.surfaces))]
    x, y, z = (_component([parts[axis] for parts in expansions], basis, names) for axis in range(3))
    return x, y, z


def _component(parts: Sequence[Expansion], basis: fmpq_mat, names: Names) -> RationalFunction:
    """One component: coefficients in t (columns) times the basis (rows) is a matrix of coefficients."""
    checkpoint("adding up the Hermite blend")
    below = fmpq_poly([1])
    for part in parts:
        below = below * (part.denominator / below.gcd(part.denominator))
    tops = [n * (below / part.denominator) for part in parts for n in part.numerators]
    height = max(p.length() for p in tops)
    if height == 0:
        return RationalFunction(0, names)
    product = fmpq_mat(len(tops), height, [c for p in tops for c in _padded(p, height)]).transpose() * basis
    table = [[product[a, b] for b in range(product.ncols())] for a in range(height)]
    common = below
    for column in zip(*table, strict=True):
        common = common.gcd(fmpq_poly(list(column)))
    if common.degree() > 0:
        below = below / common
        table = _columns_divided(table, common)
    terms: dict[tuple[int, ...], fmpq] = {(a, b): c for a, row in enumerate(table) for b, c in enumerate(row) if c != 0}
    return RationalFunction.from_lowest_terms(RING.from_dict(terms), univariate(below, 0), names)


def _columns_divided(table: list[list[fmpq]], divisor: fmpq_poly) -> list[list[fmpq]]:
    columns = [fmpq_poly(list(column)) / divisor for column in zip(*table, strict=True)]
    height = max(p.length() for p in columns)
    return [list(row) for row in zip(*(_padded(p, height) for p in columns), strict=True)]


def _padded(polynomial: fmpq_poly, length: int) -> list[fmpq]:
    coefficients = polynomial.coeffs()
    return [*coefficients, *[fmpq(0)] * (length - len(coefficients))]
