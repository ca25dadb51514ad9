"""Whether the normal dP/dt x dP/dh of an exact surface vanishes somewhere, by Bernstein branch and bound.

With P = (X_a / W_a) the tangents are (X_a' W_a - X_a W_a') / W_a^2, so the normal vanishes iff three polynomials
do (numerators over the positive W_a^2 W_b^2).  Their common factor and the denominators are examined by themselves,
each without its multiple factors, so that it changes sign where it vanishes along a curve.

PROVED: no vanishing normal and no pole on the whole domain.  REFUTED: the three polynomials, or a denominator, are
exactly zero at a point, or one of them changes sign near.  UNDECIDED: the effort ran out.  For surfaces that are not
exact, and for high degrees, tangents are measured on a grid.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.lengths import lengths, scaled
from pas.algebra.rational import plain, to_float
from pas.algebra.rational_function import ONE, RationalFunction
from pas.limits import Report, limited
from pas.parametric.common_zeros import UNIT_SQUARE, Outcome, pieces_of, without_common_zero
from pas.verdicts import Status, Verdict

if TYPE_CHECKING:
    from pas.parametric.surface import ParametricSurface

GRID = 33
"""Points a side at which tangents are tried where there is no proof."""

LARGEST = 600
"""Bernstein coefficients (of one polynomial) up to which a proof is attempted."""


STILL, FLAT = 1e-9, 1e-6
"""A tangent below this share of the median one, and an angle below these degrees, count as zero where measured."""


@limited("proving that a surface is regular", "less effort or a smaller domain")
def regularity(
    surface: ParametricSurface, effort: int = 20_000, *, seconds: float | None = None, progress: Report | None = None
) -> Verdict:
    """Whether an exact surface is regular and free of poles on its whole domain.

    `effort` bounds the rectangles examined; the verdict's `measure` counts them.
    """
    claim = "regular, without poles, on its domain"
    if not surface.is_exact:
        return _sampled(surface, claim, f"the surface is not exact ({surface.inexact})")
    if _expected_size(surface) > LARGEST:
        return _sampled(surface, claim, f"the degree {surface.degree} is too high for a proof")
    examined, doubts = 0, list[str]()
    for what, polynomials in _systems(surface):
        for piece in pieces_of(surface.ends):
            outcome = without_common_zero(polynomials, piece, effort - examined)
            examined += outcome.cells
            if outcome.status is Status.REFUTED:
                return Verdict(Status.REFUTED, claim, what + _where(surface, outcome), measure=examined)
            if outcome.status is not Status.PROVED:
                doubts.append(f"it is open whether {what}{_where(surface, outcome)}")
    if doubts:
        return Verdict(Status.UNDECIDED, claim, doubts[0], measure=examined)
    return Verdict(Status.PROVED, claim, "the normal and the denominators vanish nowhere", measure=examined)


def positive_on_unit_square(function: RationalFunction, effort: int = 20_000) -> bool:
    """Whether it is proved that a rational function is positive and without poles on [0, 1]^2."""
    parts = [_radical(p) for p in (function.numerator, function.denominator) if not p.is_constant()]
    if function.is_zero or any(math.prod(int(d) + 1 for d in p.degrees()) > LARGEST for p in parts):
        return False
    proved = all(without_common_zero([p], UNIT_SQUARE, effort).status is Status.PROVED for p in parts)
    return proved and function.at("1/2", "1/2") > 0


def _systems(surface: ParametricSurface) -> list[tuple[str, list[fmpq_mpoly]]]:
    """Sets of polynomials without a common zero; a common factor of the normal stands by itself."""
    below = {str(c.denominator): c.denominator for c in surface.components if not c.is_polynomial}
    systems = [("a denominator vanishes", [_radical(d)]) for _, d in sorted(below.items())]
    normal = normal_numerators(surface)
    common = normal[0].gcd(normal[1]).gcd(normal[2])
    if not common.is_zero() and not common.is_constant():
        for _, d in below.items():  # its zeros are those of the denominators, already examined
            while not (shared := common.gcd(d)).is_constant():
                common = common / shared
        systems.append(("the normal vanishes", [_radical(common)]))
        whole = normal[0].gcd(normal[1]).gcd(normal[2])
        normal = [n / whole for n in normal]
    return [*systems, ("the normal vanishes", normal)]


def _radical(polynomial: fmpq_mpoly) -> fmpq_mpoly:
    """The product of the distinct factors: the same zeros, met with a change of sign."""
    return math.prod((factor for factor, _ in polynomial.factor_squarefree()[1]), start=ONE)


def _where(surface: ParametricSurface, outcome: Outcome) -> str:
    if outcome.place is None:
        return ""
    t, h = ((plain(x) if outcome.exact else f"{to_float(x):.6g}") for x in outcome.place)
    return f" {'at' if outcome.exact else 'near'} {surface.parameters[0]} = {t}, {surface.parameters[1]} = {h}"


def _expected_size(surface: ParametricSurface) -> int:
    """A bound on the number of coefficients of the normal's numerators."""
    degrees = [[int(a + b) for a, b in zip(*_tops(c), strict=True)] for c in surface.components]
    return math.prod(1 + sum(sorted(d[axis] for d in degrees)[1:]) for axis in (0, 1))


def _tops(component: RationalFunction) -> list[tuple[int, ...]]:
    return [p.degrees() if not p.is_zero() else (0, 0) for p in (component.numerator, component.denominator)]


def _sampled(surface: ParametricSurface, claim: str, why: str) -> Verdict:
    """What the tangents on a grid say: how small the sine between them and their lengths become."""
    ends = [(max(low, min(-1.0, high - 2)), min(high, max(1.0, low + 2))) for low, high in surface.domain]
    t, h = (np.linspace(low, high, GRID) for low, high in ends)
    tangents = surface.tangents(np.stack(np.meshgrid(t, h, indexing="ij"), axis=-1))
    known = tangents[np.isfinite(tangents).all(axis=(-1, -2))]
    if not len(known):
        return Verdict(Status.UNDECIDED, claim, f"{why}; it has no tangents at the points tried")
    sizes, ways = lengths(known), scaled(known)
    across = lengths(np.cross(ways[:, 0], ways[:, 1]))
    sines = across / np.maximum(lengths(ways).prod(axis=-1), 1 / 8)  # at least 1/4 but for zero vectors
    angle = math.degrees(math.asin(min(1.0, float(sines.min()))))
    still = bool((sizes <= STILL * np.median(sizes, axis=0)).any())
    reason = f"{why}; at {len(known)} points tried the tangents meet at angles of {angle:.3g} degrees or more"
    if still:
        reason += ", and at some of them one of the two vanishes"
    return Verdict(Status.FAILS_MEASURED if still or angle < FLAT else Status.HOLDS_MEASURED, claim, reason)


def normal_numerators(surface: ParametricSurface) -> list[fmpq_mpoly]:
    """Three polynomials that vanish together exactly where the normal does, away from poles."""
    slopes = [[_slope(c, index) for c in surface.components] for index in (0, 1)]
    return [
        slopes[0][(i + 1) % 3] * slopes[1][(i + 2) % 3] - slopes[0][(i + 2) % 3] * slopes[1][(i + 1) % 3]
        for i in range(3)
    ]


def _slope(component: RationalFunction, index: int) -> fmpq_mpoly:
    n, d = component.numerator, component.denominator
    return n.derivative(index) * d - n * d.derivative(index)
