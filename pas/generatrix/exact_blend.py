"""The components of a blend as exact rational functions of s and t, where all its data are rational."""

from __future__ import annotations

from math import comb

from flint import fmpq

from pas.algebra.rational import rational
from pas.algebra.rational_function import GENERATORS, ONE, RationalFunction, total
from pas.generatrix.exact import square_root
from pas.generatrix.frames import Frames
from pas.generatrix.shape import GeneratrixShape, ShapeFunction
from pas.generatrix.space import NAMES
from pas.parametric.components import Components


def why_inexact(frames: Frames, shape: GeneratrixShape) -> str:
    """Why the surface is not exact; empty where it is."""
    if frames.unit:
        return "the vectors are made of length one (unit=False leaves them)"
    for boundary in frames.boundaries:
        if boundary.exact is None:
            return f"{boundary.name} is not rational"
        if boundary.phase not in (0.0, 1.0) or (boundary.closed and boundary.phase):
            return f"{boundary.name} starts at {boundary.phase:.4g}, between its ends"
    if frames.middle is not None and not frames.middle.is_exact:
        return "the middle curve is not rational"
    for name in ("l1", "l2"):
        if getattr(shape, name).exact is None:
            return f"{name} is no polynomial"
    for name in ("lambda1", "lambda2"):
        if _cosine_of(getattr(shape, name)) is None:
            return f"{name} is not a constant with a rational sqrt(1 - {name}^2), such as 0 or 3/5"
    return ""


def exact_components(frames: Frames, shape: GeneratrixShape) -> Components:
    """x, y, z of the blend as rational functions of s and t."""
    rows: list[tuple[RationalFunction, ...]] = []
    for boundary, sign, length, slant in zip(frames.boundaries, frames.signs, shape.lengths, shape.slants, strict=True):
        exact, slope, rest = boundary.exact, slant.value, _cosine_of(slant)
        assert exact is not None and length is not None and slope is not None and rest is not None
        back, along = (-1, -slope) if boundary.backwards else (1, slope)
        start = GENERATORS[0] if back > 0 else 1 - GENERATORS[0]
        own = RationalFunction.quotient(start, ONE, NAMES)
        point = tuple(c.substitute(own, own) for c in exact.curve)
        tangent = (
            (w * (rest * sign) + e * rational(along)).substitute(own, own)
            for w, e in zip(exact.across, exact.velocity, strict=True)
        )
        size = length.exact
        assert size is not None
        rows += [point, tuple(c + size * w for c, w in zip(point, tangent, strict=True))]
    rows = [
        rows[0],
        rows[1],
        *([] if frames.middle is None else [frames.middle.components]),
        rows[3],
        rows[2],
    ]
    x, y, z = (
        total([b * row[axis] for b, row in zip(_exact_bernstein(frames.degree), rows, strict=True)])
        for axis in range(3)
    )
    return x, y, z


def _cosine_of(slant: ShapeFunction) -> fmpq | None:
    """sqrt(1 - lambda^2) where it and lambda are rational numbers, else None."""
    value = slant.value
    return None if value is None else square_root(1 - rational(value) ** 2)


def _exact_bernstein(degree: int) -> list[RationalFunction]:
    t = GENERATORS[1]
    rows = (comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(degree + 1))
    return [RationalFunction.quotient(row, ONE, NAMES) for row in rows]
