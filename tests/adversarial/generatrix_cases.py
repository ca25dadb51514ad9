"""Seeded blends by a generatrix whose contact and sense are known by construction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random

import numpy as np

from pas.algebra.rational_function import RationalFunction
from pas.parametric.generatrix.blend import GeneratrixBlend, generatrix_blend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.sections import plane_section
from pas.parametric.generatrix.shape import GeneratrixShape
from pas.parametric.surface import ParametricSurface

S, ONE = (RationalFunction(e, ("s", "t")) for e in ("s", "1"))
T = RationalFunction("t", ("s", "t"))
TINY = Fraction(1, 10**40)
SIZES = (-270, -159, -100, -3, 0, 0, 3, 100, 159, 270)


@dataclass(frozen=True)
class ExactCase:
    """An exact blend, whether its curves run the same way, and how it was made."""

    blend: GeneratrixBlend
    same: bool
    kind: str


def exact_case(seed: int) -> ExactCase:
    """Two open rational curves along x, some way apart, whose fields lean towards each other."""
    draw = Random(seed)
    size = Fraction(10) ** draw.choice(SIZES)
    backwards = draw.random() < 0.3
    first = _edge(draw, size, Fraction(0), 1, False)
    second = _edge(draw, size, Fraction(4), -1, backwards)
    lengths = [Fraction(draw.randint(2, 6), 4) for _ in range(2)]
    slants = [draw.choice((0, 0, "3/5", "-4/5")) for _ in range(2)]
    middle = [f"{c}*{size}" for c in ("(4*s)", "2", "1")] if draw.random() < 0.2 else None
    if backwards and middle:
        middle = None
    shape = GeneratrixShape(*lengths, *slants, middle=middle)
    made = generatrix_blend(first, second, shape, align=False, unit=False)
    return ExactCase(
        made, not backwards, f"{seed}: 10^{size.numerator}" if size > 1 else f"{seed}: 1/{size.denominator}"
    )


def _edge(draw: Random, size: Fraction, y: Fraction, way: int, backwards: bool) -> Boundary:
    def small() -> Fraction:
        return Fraction(draw.randint(-4, 4), 9)

    s = 1 - S if backwards else S
    below = 1 + s * s * draw.choice((0, 0, 1))
    curve = (4 * s, ONE * y + s * (1 - s) * small(), s * small() + s**2 * small())
    curve = tuple(c * size / below * (1 if i else below) for i, c in enumerate(curve))
    field = tuple(f * size for f in (s * small(), ONE * way, s * small() + small()))
    return Boundary.along([str(c) for c in curve], tangent=[str(c) for c in field], name=f"the edge at {y}")


def tampered(blend: GeneratrixBlend, number: int, kind: str) -> GeneratrixBlend:
    """The blend with a surface whose contact `number` alone is gone by 10^-40: of the curve, or of the tangent plane.

    (1 - t)^2 moves the curve at t = 0 and t (1 - t)^2 its tangent plane; neither is felt at t = 1.
    """
    near = T if number else 1 - T
    bump = near**2 * (1 + 2 * (1 - near)) if kind == "curve" else near**2 * (1 - near)
    normal = blend.boundaries[number].exact.normal
    move = [bump * n.substitute(_own(blend, number), ONE * 0) * TINY for n in normal]
    parts = [c + m for c, m in zip(blend.surface.components, move, strict=True)]
    made = replace(blend)
    made.__dict__["surface"] = ParametricSurface(*parts, parameters=("s", "t"), domain=blend.surface.ends)
    return made


def _own(blend: GeneratrixBlend, number: int) -> RationalFunction:
    return 1 - S if blend.boundaries[number].backwards else S


def chord_product(blend: GeneratrixBlend) -> Fraction:
    """The scalar product of the curves' chords, from the blend's own surface."""
    ends = [[blend.surface.at(s, t) for s in (0, 1)] for t in (0, 1)]
    chords = [[b - a for a, b in zip(*pair, strict=True)] for pair in ends]
    return sum((a * b for a, b in zip(*chords, strict=True)), Fraction(0))


@dataclass(frozen=True)
class MeasuredCase:
    """A blend of two pipes, and which of its claims hold: sense, regular, simple (None: not known)."""

    blend: GeneratrixBlend
    sense: bool
    regular: bool | None
    simple: bool | None
    kind: str


def measured_case(seed: int) -> MeasuredCase:
    """Pipes in a row or around a corner; turned to fit, twisted, or with legs so long that they cross."""
    draw = Random(seed)
    size = Fraction(10) ** draw.choice((-120, -40, 0, 0, 0, 40, 120))
    radii = [size * Fraction(draw.randint(3, 6), 5) for _ in range(2)]
    kind, corner = draw.choice(("fits", "twisted", "crossing")), draw.random() < 0.5 or None
    first = plane_section(f"x^2 + y^2 - {radii[0] ** 2}", f"z - {3 * size}")
    if corner or kind == "crossing":
        second = plane_section(f"y^2 + z^2 - {radii[1] ** 2}", f"x - {3 * size}")
    else:
        second = plane_section(f"x^2 + y^2 - {radii[1] ** 2}", f"z - {7 * size}")
    length = size * (7 if kind == "crossing" else Fraction(draw.randint(2, 5), 4))
    blend = generatrix_blend(first, second, GeneratrixShape(length, length))
    if kind == "twisted":
        turned = blend.boundaries[1].turned(True, 0.0)
        blend = generatrix_blend(blend.boundaries[0], turned, blend.shape, align=False)
    holds = kind == "fits" or None
    return MeasuredCase(blend, kind != "twisted", holds, False if kind == "crossing" else holds, f"{seed}: {kind}")


def double_point_is_near(blend: GeneratrixBlend, reason: str) -> bool:
    """Whether the places that a reason names, P(a, b) = P(c, d), are far apart and their points near."""
    places = [[float(x) for x in part.split(")")[0].split(",")] for part in reason.split("P(")[1:3]]
    points = blend.surface(places)
    at = np.linspace(0, 1, 9)
    extent = float(np.ptp(blend.surface.on_grid(at, at).reshape(-1, 3), axis=0).max())
    near = float(np.abs(points[0] - points[1]).max()) < 1e-2 * extent
    return near and max(abs(a - b) for a, b in zip(*places, strict=True)) > 1e-3
