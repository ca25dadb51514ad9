"""Base points: isolated parameters at which a rational component is 0/0, numerator and denominator in lowest terms.

Resultants give the candidates for each parameter (Cox, Little and O'Shea 2015, chapter 3, section 6); real roots
are isolated exactly, and a pair of them is kept unless interval arithmetic shows that one of the two
polynomials is not zero there.  Guaranteed: no base point is missed.  Not guaranteed: that a pair at
which both vanish to the precision of 256 bits is one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mpoly, fmpq_poly

from pas.algebra.rational_function import PARAMETERS, RationalFunction
from pas.parametric.surface import ParametricSurface

BITS = 256


@dataclass(frozen=True)
class BasePoint:
    """Parameters at which component `axis` of a surface is not defined, being 0/0."""

    axis: str
    t: float
    h: float

    def __str__(self) -> str:
        return f"{self.axis} is 0/0 at ({self.t:.6g}, {self.h:.6g})"


def base_points(surface: ParametricSurface) -> tuple[BasePoint, ...]:
    """The base points of an exact surface in its domain, by component (resultants: Cox, Little and O'Shea 2015).

    Near one the surface has no limit, whatever a blend does.  Raises `ValueError` for a surface that is not exact.
    """
    found = []
    for axis, component in zip("xyz", surface.components, strict=True):
        for t, h in _common_zeros(component):
            inside = all(low <= x <= high for x, (low, high) in zip((t, h), surface.domain, strict=True))
            if inside:
                found.append(BasePoint(axis, t, h))
    return tuple(found)


def _common_zeros(component: RationalFunction) -> list[tuple[float, float]]:
    above, below = component.numerator, component.denominator
    if below.is_constant() or above.is_constant():
        return []
    precision = ctx.prec
    ctx.prec = BITS
    try:
        firsts = _roots(above, below, 1)
        seconds = _roots(above, below, 0) if firsts else []
        pairs = [(t, h) for t in firsts for h in seconds]
        return [(float(t), float(h)) for t, h in pairs if _may_vanish(above, t, h) and _may_vanish(below, t, h)]
    finally:
        ctx.prec = precision


def _roots(above: fmpq_mpoly, below: fmpq_mpoly, eliminated: int) -> list[Any]:
    """Real balls around the values of the parameter that is kept, at common zeros."""
    kept = 1 - eliminated
    degrees = [int(p.degrees()[eliminated]) for p in (above, below)]
    if degrees == [0, 0]:  # coprime polynomials in one parameter have no common zero
        return []
    result = above.resultant(below, PARAMETERS[eliminated])
    terms = {int(e[kept]): c for e, c in result.to_dict().items()}
    polynomial = fmpq_poly([terms.get(a, fmpq(0)) for a in range(max(terms, default=0) + 1)])
    if polynomial.degree() < 1:
        return []
    pairs: Any = polynomial.complex_roots()
    return [root.real for root, _ in pairs if root.imag == 0]


def _may_vanish(polynomial: fmpq_mpoly, t: Any, h: Any) -> bool:
    total = arb(0)
    for (a, b), c in polynomial.to_dict().items():
        total = total + arb(c) * t ** int(a) * h ** int(b)
    return bool(total.contains(0))
