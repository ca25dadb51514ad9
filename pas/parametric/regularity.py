"""The singularities of an exact surface: whether its normal vanishes or it has poles, and its base points.

By Bernstein branch and bound it is decided whether dP/dt x dP/dh vanishes.  With P = (X_a / W_a) the tangents are
(X_a' W_a - X_a W_a') / W_a^2, so the normal vanishes iff three polynomials do (numerators over the positive
W_a^2 W_b^2).  Their common factor and the denominators are examined by themselves, each without its multiple factors,
so that it changes sign where it vanishes along a curve.

PROVED: no vanishing normal and no pole on the whole domain.  REFUTED: the three polynomials, or a denominator, are
exactly zero at a point, or one of them changes sign near.  UNDECIDED: the effort ran out.  For surfaces that are not
exact, and for high degrees, tangents are measured on a grid.

Base points are isolated parameters at which a component is 0/0, numerator and denominator in lowest terms.  Resultants
give the candidates for each parameter; real roots are isolated exactly, and a pair of them is kept unless interval
arithmetic shows that one of the two polynomials is not zero there.  Guaranteed: no base point is missed.  Not
guaranteed: that a pair at which both vanish to the precision of 256 bits is one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Unpack

import numpy as np
from flint import arb, ctx, fmpq_mpoly

from pas.algebra.lengths import lengths, scaled
from pas.algebra.rational import cross, plain, to_float
from pas.algebra.rational_function import ONE, PARAMETERS, RationalFunction
from pas.algebra.roots import in_one, middle_of, real_roots
from pas.limits import WorkLimits, limited
from pas.parametric.common_zeros import UNIT_SQUARE, ZeroSearch, charts_of, without_common_zero
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import finite_part
from pas.verdicts import Status, Verdict

LARGEST = 600
"""Bernstein coefficients (of one polynomial) up to which a proof is attempted."""


@limited("proving that a surface is regular", "less effort or a smaller domain")
def regularity(surface: ParametricMap, effort: int = 20_000, **limits: Unpack[WorkLimits]) -> Verdict:
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
        for chart in charts_of(surface.ends):
            outcome = without_common_zero(polynomials, chart, effort - examined)
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


def _systems(surface: ParametricMap) -> list[tuple[str, list[fmpq_mpoly]]]:
    """Sets of polynomials without a common zero; a common factor of the normal stands by itself."""
    below = {str(c.denominator): c.denominator for c in surface.components if not c.is_polynomial}
    systems = [("a denominator vanishes", [_radical(d)]) for _, d in sorted(below.items())]
    parts = [(c.numerator, c.denominator) for c in surface.components]
    first, second = ([n.derivative(i) * d - n * d.derivative(i) for n, d in parts] for i in (0, 1))
    normal = list(cross(first, second))  # they vanish together exactly where the normal does, away from poles
    common = normal[0].gcd(normal[1]).gcd(normal[2])
    if not common.is_zero() and not common.is_constant():
        normal = [n / common for n in normal]
        for d in below.values():  # its zeros are those of the denominators, already examined
            while not (shared := common.gcd(d)).is_constant():
                common = common / shared
        systems.append(("the normal vanishes", [_radical(common)]))
    return [*systems, ("the normal vanishes", normal)]


def _radical(polynomial: fmpq_mpoly) -> fmpq_mpoly:
    """The product of the distinct factors: the same zeros, met with a change of sign."""
    return math.prod((factor for factor, _ in polynomial.factor_squarefree()[1]), start=ONE)


def _where(surface: ParametricMap, outcome: ZeroSearch) -> str:
    if outcome.place is None:
        return ""
    t, h = ((plain(x) if outcome.exact else f"{to_float(x):.6g}") for x in outcome.place)
    return f" {'at' if outcome.exact else 'near'} {surface.parameters[0]} = {t}, {surface.parameters[1]} = {h}"


def _expected_size(surface: ParametricMap) -> int:
    """A bound on the number of coefficients of the normal's numerators."""
    parts = [(c.numerator, c.denominator) for c in surface.components]
    sizes = [[sum(0 if p.is_zero() else int(p.degrees()[axis]) for p in pair) for pair in parts] for axis in (0, 1)]
    return math.prod(1 + sum(sorted(size)[1:]) for size in sizes)


def _sampled(surface: ParametricMap, claim: str, why: str) -> Verdict:
    """The verdict by the tangents on a grid: how small the sine between them and their lengths become."""
    t, h = (np.linspace(*finite_part(interval), 33) for interval in surface.domain)
    places = np.stack(np.meshgrid(t, h, indexing="ij"), axis=-1).reshape(-1, 2)
    tangents = surface.tangents(places)
    finite = np.isfinite(tangents).all(axis=(-1, -2))
    if not finite.all():
        where = ", ".join(f"{n} = {x:.6g}" for n, x in zip(surface.parameters, places[~finite][0], strict=True))
        why += f"; at {(~finite).sum()} of {len(places)} points tried it has no finite tangents, as at {where}"
    if not finite.any():
        return Verdict(Status.UNDECIDED, claim, why)
    sizes, ways = lengths(tangents[finite]), scaled(tangents[finite])
    across = lengths(np.cross(ways[:, 0], ways[:, 1]))
    sines = across / np.maximum(lengths(ways).prod(axis=-1), 1 / 8)  # at least 1/4 but for zero vectors
    angle = math.degrees(math.asin(min(1.0, float(sines.min()))))
    still, flat = bool((sizes <= 1e-9 * np.median(sizes, axis=0)).any()), angle < 1e-6  # beyond what rounding makes
    reason = f"{why}; at {len(sizes)} points tried the tangents meet at angles of {angle:.3g} degrees or more"
    if still:
        reason += ", and at some of them one of the two vanishes"
    good = Status.HOLDS_MEASURED if finite.all() else Status.UNDECIDED
    return Verdict(Status.FAILS_MEASURED if still or flat else good, claim, reason)


@dataclass(frozen=True)
class BasePoint:
    """Parameters at which component `axis` of a surface is not defined, being 0/0."""

    axis: str
    t: float
    h: float

    def __str__(self) -> str:
        return f"{self.axis} is 0/0 at ({self.t:.6g}, {self.h:.6g})"


def base_points(surface: ParametricMap) -> tuple[BasePoint, ...]:
    """The base points of an exact surface in its domain, by component (resultants: Cox, Little and O'Shea 2015, 3.6).

    Near one the surface has no limit, whatever a blend does.  Raises `ValueError` for a surface that is not exact.
    """
    return tuple(
        BasePoint(axis, t, h)
        for axis, component in zip("xyz", surface.components, strict=True)
        for t, h in _base_points(component)
        if all(low <= x <= high for x, (low, high) in zip((t, h), surface.domain, strict=True))
    )


def _base_points(component: RationalFunction) -> list[tuple[float, float]]:
    both = component.numerator, component.denominator
    with ctx.workprec(256):
        firsts, seconds = _roots(*both, 0), _roots(*both, 1)
        pairs = [(t, h) for t in firsts for h in seconds if all(_may_vanish(p, t, h) for p in both)]
    return [(to_float(middle_of(t)), to_float(middle_of(h))) for t, h in pairs]


def _roots(above: fmpq_mpoly, below: fmpq_mpoly, kept: int) -> list[arb]:
    """Real balls around the values of a parameter at common zeros."""
    result = in_one(above.resultant(below, PARAMETERS[1 - kept]), kept)
    return [root.ball(256) for root in sorted(real_roots(result))]


def _may_vanish(polynomial: fmpq_mpoly, t: arb, h: arb) -> bool:
    terms = polynomial.to_dict().items()
    return bool(sum((arb(c) * t ** int(a) * h ** int(b) for (a, b), c in terms), arb(0)).contains(0))
