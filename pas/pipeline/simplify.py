"""A member with short coefficients near one that was chosen, for which all that was proved is proved anew."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from math import floor, log10

from flint import fmpq

from pas.algebra.inputs import whole
from pas.algebra.rational import binary_exponent, rational
from pas.blending.space import Space
from pas.errors import NotProvedError
from pas.fairing.contradictions import check_kept
from pas.fairing.wishes import MeanAlpha, UnitCoefficients, Wishes
from pas.limits import checkpoint
from pas.piecewise import PiecewiseSurface


def simplified(surface: PiecewiseSurface, space: Space, wishes: Wishes, denominator: int) -> PiecewiseSurface:
    """The member with coefficients of that denominator which is nearest to one; see `pas.Blend.simplified`."""
    digits = 9  # of the largest denominator: a choice in doubles has no more that mean anything
    whole(denominator, "denominator", 1, 10**digits)
    if wishes.handles or wishes.coefficients or not isinstance(wishes.normalize, MeanAlpha | UnitCoefficients):
        raise ValueError("what handles, coefficients or a normalisation fix at a number is lost in shorter numbers")
    space = (space.through(wishes.through) if wishes.through else space).reduced()
    exact = [rational(c) for c in space.coordinates(surface.polynomials)]
    largest = _power_of_ten(c for patch in surface.patches for c in patch.raw.coeffs())
    rows = zip(*(patch.tolist() for patch in space.patches), strict=True)
    units = [fmpq(10) ** (largest - _power_of_ten(chain(*row))) for row in rows]

    def member(denominator: int) -> PiecewiseSurface:
        checkpoint(f"proving with the denominator {denominator}")
        steps = [unit / denominator for unit in units]
        return space.member([(c / s + fmpq(1, 2)).floor() * s for c, s in zip(exact, steps, strict=True)])

    found = member(denominator)
    lost = _lost(surface, found, wishes)
    if lost:
        larger = (10**more for more in range(len(str(denominator)), digits + 1))
        enough = next((d for d in larger if not _lost(surface, member(d), wishes)), None)
        hint = f"{enough} is enough" if enough else f"nor is one up to {10**digits} enough"
        raise NotProvedError(f"coefficients of the denominator {denominator} are too short: {lost}; {hint}", found)
    return found


def _lost(surface: PiecewiseSurface, found: PiecewiseSurface, wishes: Wishes) -> str:
    """What holds of a surface and not of one that was found, as the end of a sentence; empty where all does."""
    try:
        check_kept(wishes, found)
    except ValueError as error:
        return str(error)
    proved = {verdict.claim for verdict in surface.certificate.verdicts if verdict.proved}
    return next((str(v) for v in found.certificate.verdicts if v.claim in proved and not v.proved), "")


def _power_of_ten(numbers: Iterable[fmpq]) -> int:
    """The exponent of a power of ten near the largest of some numbers, which are not all zero."""
    return floor(binary_exponent(max(map(abs, numbers))) * log10(2))
