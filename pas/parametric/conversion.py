"""Exact parametric surfaces as exact rational Bezier patches.

Over a rectangle an exact surface is a rational Bezier patch over its least common denominator; weights are the
denominator's Bernstein coefficients.  Where these are not all positive the rectangle is halved: if the
denominator has no zero they become positive (Farouki and Rajan 1988 on convergence).

Guaranteed: `bezier_patches` are the surface, identically.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.inputs import short
from pas.algebra.monomials import Floats
from pas.algebra.rational import plain, rational, to_float, to_fraction
from pas.bernstein.subdivision import halves
from pas.errors import GeometryError
from pas.limits import Report, checkpoint, limited
from pas.parametric.domain import DomainLike
from pas.parametric.framed import exact_rectangle
from pas.parametric.nets import ExactNet, exact_net
from pas.parametric.patches import ExactControl, RationalPatch
from pas.parametric.surface import ParametricSurface


def bezier_patch(surface: ParametricSurface, domain: DomainLike = None) -> RationalPatch:
    """The exact rational Bezier patch of an exact surface over a rectangle of rational numbers.

    `domain` is by default the surface's own, None for an interval or an end that is its own.  Raises `ValueError` for a
    surface that is not exact or an infinite domain, `GeometryError` where a weight is not positive: then
    `bezier_patches` gives several patches, if there is no pole (Farouki and Rajan 1988).
    """
    net = exact_net(surface, exact_rectangle(surface, domain))
    least = min(w for row in net.below for w in row)
    if least <= 0:
        raise GeometryError(
            f"a weight of this patch is not positive ({short(plain(least))}); bezier_patches splits it into several"
        )
    return _patch(net)


@limited("splitting a surface into patches", "a smaller domain")
def bezier_patches(
    surface: ParametricSurface,
    domain: DomainLike = None,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
) -> tuple[RationalPatch, ...]:
    """Exact rational Bezier patches of positive weights that cover a rectangle; one where that is possible.

    The rectangle is halved until all weights are positive (Farouki and Rajan 1988).

    Raises what `bezier_patch` raises, but `GeometryError` only for a pole.
    """
    pending = [(exact_net(surface, exact_rectangle(surface, domain)), 0)]
    found: list[RationalPatch] = []
    while pending:
        net, depth = pending.pop()
        checkpoint("splitting a surface into patches")
        if min(w for row in net.below for w in row) > 0:
            found.append(_patch(net))
            continue
        corners = [net.below[i][j] for i in (0, -1) for j in (0, -1)]
        if depth >= 16 or min(corners) <= 0:  # by then the denominator has a zero
            place = ", ".join(
                f"{name} = {to_float((a + b) / 2):.6g}"
                for name, (a, b) in zip(surface.parameters, net.rectangle, strict=True)
            )
            raise GeometryError(
                f"the surface has, or nearly has, a pole or base point near {place}; give a domain that avoids it"
            )
        splits = [_split(net, axis) for axis in (0, 1)]
        best = max(splits, key=lambda halves: min(_least(half) for half in halves))
        pending += [(half, depth + 1) for half in reversed(best)]
    return tuple(found)


def _patch(net: ExactNet) -> RationalPatch:
    scale = _weight_scale(net)
    weights = np.array([[to_fraction(w / scale) for w in row] for row in net.below], dtype=object)
    points = np.empty((*weights.shape, 3), dtype=object)
    for axis, table in enumerate(net.tops):
        for i, (row, below) in enumerate(zip(table, net.below, strict=True)):
            points[i, :, axis] = [to_fraction(c / w) for c, w in zip(row, below, strict=True)]
    ends = np.array([[to_fraction(e) for e in interval] for interval in net.rectangle], dtype=object)
    knots = tuple(np.repeat(e, size) for e, size in zip(_doubles(ends), weights.shape, strict=True))
    exact = ExactControl(points, weights, ends)
    return RationalPatch(_doubles(points), _doubles(weights), (knots[0], knots[1]), exact)


def _weight_scale(net: ExactNet) -> fmpq:
    """What the weights are divided by: 1, or the greatest of them where doubles would not hold them as they are."""
    weights, lightest = [w for row in net.below for w in row], fmpq(1, 10**100)
    least, greatest = min(weights), max(weights)
    if least / greatest < lightest:
        raise GeometryError(
            "the weights of this patch differ by more than a factor of 1e+100; convert a part of the domain where the "
            "denominators vary less"
        )
    return fmpq(1) if least > lightest and greatest < 1 / lightest else greatest


def _doubles(numbers: Any) -> Floats:
    """An array of fractions in doubles; raises `GeometryError` where one is beyond their range."""
    found = np.vectorize(lambda x: to_float(rational(x)), otypes=[float])(numbers)
    if not np.isfinite(found).all():
        raise GeometryError("a control point is beyond the range of doubles (1.8e308); scale the surface")
    return np.asarray(found)


def _split(net: ExactNet, axis: int) -> tuple[ExactNet, ExactNet]:
    tables = [halves(np.array(table, dtype=object), axis) for table in (*net.tops, net.below)]
    low, high = net.rectangle[axis]
    parts = []
    for side, interval in ((0, (low, (low + high) / 2)), (1, ((low + high) / 2, high))):
        x, y, z, w = (pair[side].tolist() for pair in tables)
        sides = (interval, net.rectangle[1]) if axis == 0 else (net.rectangle[0], interval)
        parts.append(ExactNet((x, y, z), w, sides))
    return parts[0], parts[1]


def _least(net: ExactNet) -> Fraction:
    """The least weight over the greatest."""
    weights = [w for row in net.below for w in row]
    return to_fraction(min(weights) / max(abs(w) for w in weights))
