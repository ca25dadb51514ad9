"""Curves in space as CAD programs have them: lines, circles and ellipses where points are on such, else quintic splines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from pas.algebra.monomials import Floats
from pas.limits import checkpoint

DEGREE = 5

EXACT = 1e-9
"""Distance of points from a line or conic, over their extent, up to which they are on it."""

MOST_POINTS = 1025


class CurveKind(Enum):
    """Kinds of curves."""

    LINE = "line"
    CIRCLE = "circle"
    ELLIPSE = "ellipse"
    SPLINE = "spline"


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve from parameter `start` to `end`: origin + t first, origin + cos t first + sin t second, or a spline.

    `error` is the largest distance from what it stands for that was measured.
    """

    kind: CurveKind
    start: float
    end: float
    error: float
    origin: Floats | None = None
    first: Floats | None = None
    second: Floats | None = None
    spline: BSpline | None = None

    def __call__(self, parameters: Floats) -> Floats:
        """Points (N, 3) at parameters (N,)."""
        t = np.asarray(parameters)[:, None]
        if self.spline is not None:
            return np.asarray(self.spline(parameters))
        assert self.origin is not None and self.first is not None
        if self.second is None:
            return np.asarray(self.origin + t * self.first)
        return np.asarray(self.origin + np.cos(t) * self.first + np.sin(t) * self.second)

    def parameters(self, number: int) -> Floats:
        """So many parameters from the start to the end."""
        return np.linspace(self.start, self.end, number)


def curve_through(points: Floats, placed: Callable[[Floats], Floats], tolerance: float) -> Curve:
    """The curve along points (N, 3) from the first to the last, which may be one; `placed` moves points onto it.

    Splines are within `tolerance`, or have MOST_POINTS.
    """
    dense = resampled(points, max(33, len(points)), placed)
    found = _line(dense) or _conic(dense)
    if found is not None:
        return found
    number = 9
    while True:
        checkpoint()
        knots = resampled(dense, 2 * number - 1, placed)
        lengths = _lengths(knots)
        spline = make_interp_spline(lengths[::2], knots[::2], k=DEGREE)
        between = spline(np.concatenate([lengths[1::2], (lengths[1:] + lengths[:-1])[[0, 1, -2, -1]] / 2]))
        error = float(np.linalg.norm(placed(between) - between, axis=1).max())
        if error <= tolerance or number >= MOST_POINTS:
            return Curve(CurveKind.SPLINE, 0.0, float(lengths[-1]), error, spline=spline)
        number, dense = 2 * number - 1, knots


def _lengths(points: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def resampled(points: Floats, number: int, placed: Callable[[Floats], Floats]) -> Floats:
    """So many points, evenly along others (N, 3), moved onto the curve; both ends stay."""
    lengths = _lengths(points)
    even = np.linspace(0, lengths[-1], number)
    spread = np.stack([np.interp(even, lengths, column) for column in points.T], axis=1)
    moved = placed(spread)
    moved[0], moved[-1] = points[0], points[-1]
    return moved


def _line(points: Floats) -> Curve | None:
    way = points[-1] - points[0]
    length = float(np.linalg.norm(way))
    if length < EXACT:
        return None
    way = way / length
    moved = points - points[0]
    off = float(np.linalg.norm(moved - (moved @ way)[:, None] * way, axis=1).max())
    return Curve(CurveKind.LINE, 0.0, length, off, points[0], way) if off < EXACT * length else None


def _conic(points: Floats) -> Curve | None:
    """The circle or ellipse through points, its parameter rising along them."""
    middle = points.mean(axis=0)
    size = float(np.ptp(points, axis=0).max())
    scaled = (points - middle) / size
    axes = np.linalg.svd(scaled, full_matrices=False)[2]
    if np.abs(scaled @ axes[2]).max() > EXACT:
        return None
    x, y = scaled @ axes[0], scaled @ axes[1]
    one = np.ones_like(x)
    circle = np.linalg.lstsq(np.stack([x, y, one], axis=1), -(x * x + y * y), rcond=None)[0]
    center = -circle[:2] / 2
    radius = float(np.sqrt(max(center @ center - circle[2], 0.0)))
    matrix = np.eye(2) / max(radius, 1e-300) ** 2
    if not 0 < radius < 1e4 or np.abs(np.hypot(x - center[0], y - center[1]) - radius).max() > EXACT:
        values = np.linalg.svd(np.stack([x * x, x * y, y * y, x, y, one], axis=1), full_matrices=False)
        a, b, c, d, e, f = values[2][-1]
        form, slope = np.array([[a, b / 2], [b / 2, c]]), np.array([d, e])
        if a * c - b * b / 4 < 1e-9 or values[1][-1] > EXACT or values[1][-2] < 1e-7:
            return None
        center = np.linalg.solve(form, -slope / 2)
        matrix = form / (center @ form @ center - f)
        radius = 0.0
    weights, ways = np.linalg.eigh(matrix)
    if weights[0] <= 0:
        return None
    place = middle + size * (center @ axes[:2])
    if radius:
        first = points[0] - place
        first = first * (radius * size / np.linalg.norm(first))
        second = np.cross(axes[0], axes[1])
        second = np.cross(second / np.linalg.norm(second), first)
    else:
        first, second = (size / np.sqrt(w) * (way @ axes[:2]) for w, way in zip(weights, ways.T, strict=True))

    def angles(flipped: Floats) -> Floats:
        moved = points - place
        return np.unwrap(np.arctan2(moved @ flipped / (flipped @ flipped), moved @ first / (first @ first)))

    turn = angles(second)
    if turn[-1] < turn[0]:
        second = -second
        turn = angles(second)
    turn = turn + 2 * np.pi * np.ceil(-turn[0] / (2 * np.pi) - EXACT)  # readers begin with positive angles
    whole = np.linalg.norm(points[-1] - points[0]) < EXACT * size
    start = float(turn[0])
    end = start + 2 * np.pi if whole else float(turn[-1])
    off = np.linalg.norm(place + np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second - points, axis=1).max()
    if off > 10 * EXACT * size or (np.diff(turn) <= 0).any():
        return None
    kind = CurveKind.CIRCLE if radius else CurveKind.ELLIPSE
    return Curve(kind, start, end, float(off), place, first, second)
