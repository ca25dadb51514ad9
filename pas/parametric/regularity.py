"""Whether the normal dP/dt x dP/dh of an exact surface vanishes somewhere, by Bernstein branch and bound.

With P = (X_a / W_a) the tangents are (X_a' W_a - X_a W_a') / W_a^2, so the normal vanishes iff three polynomials
do (numerators over the positive W_a^2 W_b^2).  On a rectangle a polynomial lies in the convex hull of its
Bernstein coefficients (Farin 2002, chapter 6); so does a vector of them, and if the hull of the
coefficient vectors has positive scalar products with one direction, it avoids the origin.  Rectangles
where this fails are halved.  A side of the domain at infinity is brought to [0, 1] by t -> 1/t.

PROVED: no vanishing normal and no pole on the whole domain.  REFUTED: with a point where the three
polynomials, or a denominator, are exactly zero.  UNDECIDED: the effort ran out, or the surface is not exact.

Rounding: coefficients are scaled to at most 1 and rounded once; each halving averages neighbours, so after
m halvings in all every coefficient errs by at most (2 + m (n+1)) 2^-53, n the degree halved (Higham 2002,
section 3.1), and comparisons are made against twice that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.rational import plain, rational, to_float, to_fraction
from pas.bernstein.signs import UNIT_ROUNDOFF, Status
from pas.limits import checkpoint
from pas.parametric.nets import bernstein
from pas.parametric.rational_function import GENERATORS, ONE, RationalFunction
from pas.parametric.surface import ParametricSurface
from pas.surface.certificate import Verdict

GRID = 33
"""Points a side at which tangents are tried where there is no proof."""

LARGEST = 600
"""Bernstein coefficients (of one polynomial) up to which a proof is attempted."""

LOCATED = 24
"""Halvings after which a change of sign is reported: the place is then known to 1 in 4000."""

DEPTH = 60
"""Halvings after which a rectangle counts as undecided: it is then a point, as doubles go."""


@dataclass(frozen=True)
class _Piece:
    """A rectangle of the domain, seen from [0, 1]^2 by t = f(u), h = g(v); each map is (a u + b) / (c u + d)."""

    maps: tuple[tuple[fmpq, ...], tuple[fmpq, ...]]

    def place(self, u: Fraction, v: Fraction) -> tuple[fmpq, fmpq] | None:
        """The exact parameters of a point; None at infinity."""
        found = []
        for (a, b, c, d), w in zip(self.maps, (u, v), strict=True):
            x = rational(w)
            below = c * x + d
            if below == 0:
                return None
            found.append((a * x + b) / below)
        return found[0], found[1]


@dataclass(frozen=True)
class _Outcome:
    """What came of one system on one piece; `place` is a common zero (`exact`), near one, or a place left open."""

    status: Status
    place: tuple[fmpq, fmpq] | None = None
    exact: bool = False
    cells: int = 0


def regularity(surface: ParametricSurface, effort: int = 20_000) -> Verdict:
    """Whether an exact surface is regular and free of poles on its whole domain.

    `effort` bounds the rectangles examined; the verdict's `measure` counts them.
    """
    claim = "regular, without poles, on its domain"
    if not surface.is_exact:
        return Verdict(Status.UNDECIDED, claim, f"the surface is not exact ({surface.inexact}); {_sampled(surface)}")
    if _expected_size(surface) > LARGEST:
        return Verdict(
            Status.UNDECIDED, claim, f"the degree {surface.degree} is too high for a proof; {_sampled(surface)}"
        )
    examined, doubts = 0, list[str]()
    for what, polynomials in _systems(surface):
        for piece in _pieces(surface):
            outcome = _nonzero(polynomials, piece, effort - examined)
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
    square = _Piece(((fmpq(1), fmpq(0), fmpq(0), fmpq(1)),) * 2)
    parts = [_radical(p) for p in (function.numerator, function.denominator) if not p.is_constant()]
    if function.is_zero or any(math.prod(int(d) + 1 for d in p.degrees()) > LARGEST for p in parts):
        return False
    proved = all(_nonzero([p], square, effort).status is Status.PROVED for p in parts)
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


def _where(surface: ParametricSurface, outcome: _Outcome) -> str:
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


def _sampled(surface: ParametricSurface) -> str:
    """The smallest sine between the tangents on a grid, in words."""
    ends = [(max(low, min(-1.0, high - 2)), min(high, max(1.0, low + 2))) for low, high in surface.domain]
    t, h = (np.linspace(low, high, GRID) for low, high in ends)
    tangents = surface.tangents(np.stack(np.meshgrid(t, h, indexing="ij"), axis=-1))
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(tangents, axis=-1)
        sines = np.linalg.norm(np.cross(tangents[..., 0, :], tangents[..., 1, :]), axis=-1) / lengths.prod(axis=-1)
    known = sines[np.isfinite(sines)]
    if known.size == 0:
        return "it has no tangents at the points tried"
    angle = math.degrees(math.asin(min(1.0, float(known.min()))))
    return f"at {known.size} points tried the tangents meet at angles of {angle:.3g} degrees or more"


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


def _pieces(surface: ParametricSurface) -> list[_Piece]:
    firsts, seconds = (_maps(*interval) for interval in surface.domain)
    return [_Piece((first, second)) for first in firsts for second in seconds]


def _maps(low: float, high: float) -> list[tuple[fmpq, ...]]:
    """Maps of [0, 1] that cover the interval together."""
    zero, one = fmpq(0), fmpq(1)
    if math.isfinite(low) and math.isfinite(high):
        a, b = rational(low), rational(high)
        return [(b - a, a, zero, one)]
    if math.isinf(low) and math.isinf(high):
        return [(fmpq(2), -one, zero, one), (zero, one, one, zero), (zero, -one, one, zero)]
    end, sign = (rational(low), one) if math.isfinite(low) else (rational(high), -one)
    return [(sign, end, zero, one), (end, sign, one, zero)]


def _nonzero(polynomials: list[fmpq_mpoly], piece: _Piece, effort: int) -> _Outcome:
    """Whether the polynomials have no common zero on a piece; else a zero, or a place left open."""
    degrees = [max(int(p.degrees()[axis]) if not p.is_zero() else 0 for p in polynomials) for axis in (0, 1)]
    if effort <= 0:
        return _Outcome(Status.UNDECIDED)
    moved = [_moved(p, piece, degrees) for p in polynomials]
    net = np.stack([_bernstein(p, degrees) for p in moved], axis=-1)
    scale = float(np.abs(net).max())
    if scale == 0.0:
        return _Outcome(Status.REFUTED, piece.place(Fraction(1, 2), Fraction(1, 2)), True, 1)
    pending = [(net / scale, Fraction(0), Fraction(0), 0)]
    cells, sizes = 0, dict[int, tuple[Fraction, Fraction]]()
    while pending:
        coefficients, u, v, depth = pending.pop()
        cells += 1
        if cells % 256 == 0:
            checkpoint("proving that a surface is regular")
        if _avoids_origin(coefficients, depth, degrees):
            continue
        sizes.setdefault(depth, (Fraction(1, 2 ** ((depth + 1) // 2)), Fraction(1, 2 ** (depth // 2))))
        width, height = sizes[depth]
        for point in ((u + a * width, v + b * height) for a in (0, Fraction(1, 2), 1) for b in (0, Fraction(1, 2), 1)):
            place = piece.place(*point)
            if place is not None and all(p(*place) == 0 for p in polynomials):
                return _Outcome(Status.REFUTED, place, True, cells)
        middle = piece.place(u + width / 2, v + height / 2)
        if depth >= DEPTH or cells >= effort:
            simple = None if middle is None else _simplest(middle)
            if simple is not None and all(p(*simple) == 0 for p in polynomials):
                return _Outcome(Status.REFUTED, simple, True, cells)
            return _Outcome(Status.UNDECIDED, middle, False, cells)
        if depth == LOCATED and len(polynomials) == 1 and _changes_sign(polynomials[0], piece, (u, v), sizes[depth]):
            return _Outcome(Status.REFUTED, middle, False, cells)
        left, right = _halved(coefficients, depth % 2)
        step = (width / 2, Fraction(0)) if depth % 2 == 0 else (Fraction(0), height / 2)
        pending += [(right, u + step[0], v + step[1], depth + 1), (left, u, v, depth + 1)]
    return _Outcome(Status.PROVED, cells=cells)


def _simplest(place: tuple[fmpq, fmpq]) -> tuple[fmpq, fmpq]:
    """The point with small denominators near a place."""
    t, h = (rational(to_fraction(x).limit_denominator(1000)) for x in place)
    return t, h


def _avoids_origin(coefficients: Floats, depth: int, degrees: list[int]) -> bool:
    """Whether one direction has positive scalar products with all coefficient vectors, beyond rounding."""
    vectors = coefficients.reshape(-1, coefficients.shape[-1])
    error = _rounding(depth, degrees)
    for direction in (vectors.mean(axis=0), *np.eye(vectors.shape[1]), *-np.eye(vectors.shape[1])):
        length = float(np.abs(direction).sum())
        if length > 0 and float((vectors @ direction).min()) > error * length:
            return True
    return False


def _changes_sign(polynomial: fmpq_mpoly, piece: _Piece, corner: tuple[Fraction, Fraction], size: Any) -> bool:
    """Whether a polynomial has exact values of both signs around a rectangle, so that it vanishes near."""
    signs = set()
    for a in (-1, 2):
        for b in (-1, 2):
            at = (min(max(w + m * d, Fraction(0)), Fraction(1)) for w, m, d in zip(corner, (a, b), size, strict=True))
            place = piece.place(*at)
            if place is not None:
                value = polynomial(*place)
                signs.add((value > 0) - (value < 0))
    return {1, -1} <= signs


def _rounding(depth: int, degrees: list[int]) -> float:
    return 8 * (2 + depth * (max(degrees) + 1)) * UNIT_ROUNDOFF


def _halved(coefficients: Floats, axis: int) -> tuple[Floats, Floats]:
    """De Casteljau's subdivision at the middle along one axis."""
    row = np.moveaxis(coefficients, axis, 0)
    size = len(row)
    left, right = np.empty_like(row), np.empty_like(row)
    for i in range(size):
        left[i], right[size - 1 - i] = row[0], row[-1]
        row = (row[:-1] + row[1:]) * 0.5
    return np.moveaxis(left, 0, axis), np.moveaxis(right, 0, axis)


def _moved(polynomial: fmpq_mpoly, piece: _Piece, degrees: list[int]) -> fmpq_mpoly:
    """The numerator of the polynomial after the maps, as one of the degrees given."""
    powers = []
    for generator, (a, b, c, d), degree in zip(GENERATORS, piece.maps, degrees, strict=True):
        above, below = a * generator + b, c * generator + d
        powers.append([above**e * below ** (degree - e) for e in range(degree + 1)])
    result = ONE * 0
    rows: dict[int, Any] = {}
    for (i, j), coefficient in polynomial.to_dict().items():
        rows[int(i)] = rows.get(int(i), ONE * 0) + powers[1][int(j)] * coefficient
    for i, row in rows.items():
        result = result + row * powers[0][i]
    return result


def _bernstein(polynomial: fmpq_mpoly, degrees: list[int]) -> Floats:
    """The exact coefficients, rounded."""
    table = bernstein(polynomial, degrees)
    largest = max((abs(c) for row in table for c in row), default=fmpq(0)) or fmpq(1)
    return np.array([[to_float(c / largest) for c in row] for row in table]) * to_float(largest)
