"""Turning two boundaries so that corresponding points fit, and the sides to which a blend leaves them.

Side: T_i points to the middle of the other curve, on the average; it cannot flip on the way round.
Sense, closed curves: with the vector area A = 1/2 int C x C' and the mean direction d of travel along
the generatrices (T_1 at the start, -T_2 at the end) the boundaries of a tube have A_1 . d_1 and A_2 . d_2 of
one sign, however the tube bends; where these are too small to tell (curves in flat surfaces) and for open
curves, the sense with the smaller mean distance of corresponding points is taken.
Start, closed curves: least mean distance of corresponding points over all shifts.  (Not least squares: for two
perpendicular pipes both senses give the same sum of squares, for two parallel ones joined by a bend all shifts.)
Speed: curves that are not exact take their lengths as parameters where corresponding points then are nearer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pas.algebra.inputs import shown_point
from pas.algebra.lengths import exponent, lengths, unit
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.parametric.generatrix.boundary import Boundary

SAMPLES = 240
"""Points of each curve that are compared."""


@dataclass(frozen=True)
class Alignment:
    """How the second curve was turned: `reversed`, and `shift` (of a turn, applied after).

    `distance` is the mean distance of corresponding points, `opposed` tells that, as the curves now run, they
    run against each other; `reason` says by what that was judged.  `by_length` tells that both curves were given their
    lengths as parameters.
    """

    reversed: bool
    shift: float
    distance: float
    opposed: bool
    reason: str
    by_length: bool = False


def sides(first: Boundary, second: Boundary) -> tuple[int, int]:
    """The signs of N x C' (or V) that point to the other curve; raises `GeometryError` where that is unclear."""
    s = _samples(first)
    one, two = first(s), second(s)
    return _side(first, one, two), _side(second, two, one)


def _side(boundary: Boundary, own: Floats, other: Floats) -> int:
    if boundary.side is not None:
        return boundary.side
    across = unit(boundary.across(_samples(boundary)))
    way = other.mean(axis=0) - own
    way = np.ldexp(way, -exponent(way))
    cosine = float((across * way).sum() / lengths(way).sum())
    if abs(cosine) < 0.03:
        raise GeometryError(
            f"{boundary.name}: it is not clear on which side of the curve the blend is to lie (the other curve is "
            "as near on both); say it by side=1 or side=-1"
        )
    return 1 if cosine > 0 else -1


def require_apart(first: Boundary, second: Boundary) -> None:
    """Raise `GeometryError` where the two curves meet."""
    from scipy.optimize import least_squares
    from scipy.spatial import cKDTree

    s = np.linspace(0.0, 1.0, 4 * SAMPLES + 1)
    a, b = first(s), second(s)
    both = np.concatenate([a, b])
    power = exponent(both)
    distance, partner = cKDTree(np.ldexp(b, -power)).query(np.ldexp(a, -power))
    i = int(distance.argmin())

    def gap(pair: Floats) -> Floats:
        return np.asarray(np.ldexp(first(pair[:1]) - second(pair[1:]), -power)[0])

    found = least_squares(gap, [s[i], s[int(partner[i])]], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    size = math.ldexp(float(np.ptp(both, axis=0).max()), -power)
    if np.linalg.norm(found.fun) <= 1e-6 * size:
        where = shown_point(first(found.x[:1])[0], 6)
        raise GeometryError(f"{first.name} and {second.name} touch at {where}; move them apart")


def alignment(first: Boundary, second: Boundary, signs: tuple[int, int], turn: bool = True) -> Alignment:
    """How the second curve is to be turned; with `turn` false it is left, and only judged."""
    if first.closed != second.closed:
        names = (first.name, second.name) if first.closed else (second.name, first.name)
        raise GeometryError(f"{names[0]} is closed but {names[1]} is not; take a part of the one, or close the other")
    ways = [_fit(first, second.turned(backwards, 0.0)) for backwards in (False, True)]
    opposed, reason = _opposed(first, second, signs, ways)
    if not turn:
        distance = float(lengths(first(_samples(first)) - second(_samples(first))).mean())
        return Alignment(False, 0.0, distance, opposed, reason)
    shift, distance = ways[int(opposed)]
    return Alignment(opposed, shift, distance, False, reason)


def aligned(
    first: Boundary, second: Boundary, signs: tuple[int, int], turn: bool
) -> tuple[Boundary, Boundary, Alignment]:
    """Both boundaries as the blend takes them, and what was done.

    Curves that are not exact are also tried by their lengths; that is taken where points then fit much better.
    """
    found = alignment(first, second, signs, turn)
    if turn and first.exact is None and second.exact is None:
        pair = first.by_length(), second.by_length()
        other = alignment(pair[0], pair[1], signs)
        if other.distance < 0.97 * found.distance:
            first, second, found = *pair, replace(other, by_length=True)
    turned = second.turned(found.reversed, 0.0)
    return first, turned.turned(False, found.shift) if found.shift else turned, found


def _samples(boundary: Boundary) -> Floats:
    return np.linspace(0.0, 1.0, SAMPLES, endpoint=not boundary.closed)


def _fit(first: Boundary, second: Boundary) -> tuple[float, float]:
    """The best shift of the second curve (0 for open ones) and the mean distance then."""
    s = _samples(first)
    a, b = first(s), second(s)
    if not first.closed:
        return 0.0, float(lengths(a - b).mean())
    from scipy.optimize import minimize_scalar
    from scipy.spatial.distance import cdist

    rows = np.arange(SAMPLES)
    power = exponent(np.concatenate([a, b]))
    gaps = cdist(np.ldexp(a, -power), np.ldexp(b, -power))
    means = np.array([gaps[rows, (rows + k) % SAMPLES].mean() for k in range(SAMPLES)])
    start = int(means.argmin()) / SAMPLES if means.min() < means[0] * (1 - 1e-9) else 0.0

    def mean(shift: float) -> float:
        return float(lengths(a - second(s + shift)).mean())

    width = 1.0 / SAMPLES
    found = minimize_scalar(mean, bounds=(start - width, start + width), method="bounded", options={"xatol": 1e-10})
    best = float(found.x) if found.fun < mean(start) * (1 - 1e-9) else start
    return best % 1.0, mean(best)


def _opposed(
    first: Boundary, second: Boundary, signs: tuple[int, int], ways: list[tuple[float, float]]
) -> tuple[bool, str]:
    """Whether the curves run against each other, and why."""
    if first.closed:
        turns = [_turn(b, sign * way) for b, sign, way in zip((first, second), signs, (1, -1), strict=True)]
        if min(map(abs, turns)) > 0.15:
            same = turns[0] * turns[1] > 0
            return not same, f"seen along the blend they turn {'the same way' if same else 'opposite ways'}"
    (_, straight), (_, back) = ways
    reason = f"corresponding points are {straight:.4g} apart on the average, {back:.4g} if one is reversed"
    return back < straight * (1 - 1e-9), reason


def _turn(boundary: Boundary, sign: int) -> float:
    """The mean cosine between the vector area and the direction of travel across the curve."""
    s = _samples(boundary)
    points = boundary(s)
    rays, speeds = points - points.mean(axis=0), boundary.derivative(s)
    area = np.cross(np.ldexp(rays, -exponent(rays)), np.ldexp(speeds, -exponent(speeds))).sum(axis=0)
    across = unit(boundary.across(s)).mean(axis=0)
    length = float(lengths(area))
    return sign * float(area @ across) / length if length > 0 else 0.0
