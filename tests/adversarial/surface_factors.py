"""Surfaces times a polynomial: bubbles, bites, second sheets, singular points.

Faces stay C^k and patches stay in the contacts' ideals whatever the factor; what becomes of the
inequalities follows from where the factor is negative.  Every function takes a random generator
and returns a `Known`.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
from adversarial.exact_checks import Point, exact
from adversarial.surface_bases import Known, Truth, base, with_patches
from adversarial.surface_places import away, distance2, holds, length, outer_vertices, size, some_place

from pas import Polynomial

HOLDS, FAILS, UNKNOWN = Truth.HOLDS, Truth.FAILS, Truth.UNKNOWN
SIZES = [Fraction(1, 5), Fraction(1, 20), Fraction(1, 300), *(Fraction(1, 10**e) for e in (4, 6, 8, 12, 16, 25, 40))]
"""Of balls and gaps, as shares of the region."""

VARIABLES = tuple(map(Polynomial, "xyz"))


def ball_factor(random: Random) -> Known:
    """Times `|x-p|^2 - r^2`: a bubble, or a bite in a wall, a clip face or a curve.

    Membership and smoothness stay, whatever the factor.  A ray that meets both the surface and the
    ball, or leaves the ball within the region, meets the product twice.
    """
    known = base(random, 8)
    place, p = some_place(known, random)
    r = random.choice(SIZES) * size(known)
    q = distance2(p) - r**2
    truths = {"contacts": curves_under(known, q, p, r), "sheet": sheet_under_ball(known, p, r)}
    depth = [f.plane.at(p) / length(f.plane) for f in known.surface.partition.outer_faces]
    on_boundary = place in ("wall", "clip face", "vertex", "edge")
    truths["enclosed"] = (
        FAILS if on_boundary else HOLDS if max(depth) < -1.001 * float(r) or away(known, p, r) else UNKNOWN
    )
    return multiplied(known, q, f"times a ball of radius {float(r):.3g} around a point: {place}", **truths)


def point_factor(random: Random) -> Known:
    """Times `|x-p|^2`: a surface with one more point, which any ray meets twice at once.

    Where p is off the region nothing is changed; on a wall the surface touches it.
    """
    known = base(random, 8)
    place, p = some_place(known, random)
    inside = place != "outside"
    truths = {"sheet": FAILS if inside else HOLDS}
    truths["enclosed"] = FAILS if place in ("wall", "clip face", "vertex", "edge") else HOLDS
    truths["contacts"] = curves_under(known, distance2(p), p, Fraction(0))
    return multiplied(known, distance2(p), f"times the square of the distance from a point: {place}", **truths)


def positive_factor(random: Random) -> Known:
    """Times a factor that is positive everywhere, if barely so: all stays true."""
    known = base(random, 8)
    place, p = some_place(known, random)
    r = random.choice(SIZES) * size(known)
    kind = random.randrange(3)
    g = sum((random.randint(-3, 3) * v for v in VARIABLES), Polynomial(random.randint(-2, 2)))
    factor = [distance2(p) + r**2, g * g + r, distance2(p) * g * g + r][kind]
    if known.surface.degree + factor.degree > 10:
        factor = distance2(p) + r**2
    return multiplied(known, factor, f"times a positive factor, {float(r):.3g} at least, least at a point: {place}")


def plane_factor(random: Random) -> Known:
    """Times a plane that cuts off a corner of the region, or passes it by, by 1e-40 or more.

    The corner is a vertex where f > 0: cut off or touched, it is on the wrong side, and the ray to
    it meets both factors.
    """
    known = base(random, 9)
    region = known.surface.partition
    corner_point = exact(region.vertices[random.choice(outer_vertices(region))])
    center = exact(region.center)
    toward = [a - b for a, b in zip(corner_point, center, strict=True)]
    weights = [Fraction(random.randint(1, 9)) for _ in range(3)]
    slopes = [w * t for w, t in zip(weights, toward, strict=True)]
    gap = random.choice([*SIZES, Fraction(0)]) * random.choice((1, -1))
    raw = sum((s * (v - c) for s, v, c in zip(slopes, VARIABLES, center, strict=True)), Polynomial(0))
    # L(centre) = 1, L(corner) = gap
    factor = 1 - raw * ((1 - gap) / raw.at(corner_point))
    values = [factor.at(exact(region.vertices[i])) for i in outer_vertices(region)]
    cut = min(values) <= 0
    truths = {"sheet": FAILS if cut else HOLDS, "enclosed": FAILS if cut else HOLDS}
    contacts = []
    for join in known.surface.joins:
        there = factor(region.frame.global_points(join.curve()))
        contacts.append(
            HOLDS if not cut or there.min() > 1e-6 * np.abs(there).max() else FAILS if there.min() < -1e-3 else UNKNOWN
        )
    return multiplied(
        known, factor, f"times a plane that passes a corner at {float(gap):.3g}", contacts=tuple(contacts), **truths
    )


def turned(random: Random) -> Known:
    """Inside out: the centre is outside, alpha negative, the walls inside."""
    known = base(random)
    contacts = (FAILS,) * len(known.contacts)
    return multiplied(known, Polynomial(-1), "turned inside out", contacts=contacts, sheet=FAILS, enclosed=FAILS)


def cubed(random: Random) -> Known:
    """f^3: the same surface, on which every point is singular and alpha vanishes."""
    known = base(random, 4)
    contacts = (FAILS,) * len(known.contacts)
    f = known.surface
    changed = with_patches(f, [p**3 for p in f.patches])
    return known.but(changed, "cubed", contacts=contacts, sheet=FAILS)


def multiplied(known: Known, factor: Polynomial, story: str, **truths: object) -> Known:
    """Every patch times one polynomial."""
    f = known.surface
    local = f.partition.frame.localise(factor)
    return known.but(with_patches(f, [p * local for p in f.patches]), story, **truths)


def sheet_under_ball(known: Known, p: Point, r: Fraction) -> Truth:
    """What is true of the one sheet of a product with a ball's equation."""
    f = known.surface
    center = exact(f.partition.center)
    squared = sum((a - b) ** 2 for a, b in zip(p, center, strict=True))
    if squared <= r**2:
        return FAILS  # the centre is in the ball or on it
    if away(known, p, r):
        return HOLDS
    region = [c for c in range(len(f.partition.cells)) if holds(f.partition, c, p)]
    if not region:
        return UNKNOWN
    if any(f.polynomials[f.partition.piece_of[c]].at(p) >= 0 for c in region):
        return FAILS  # the ray to p meets both
    beyond = tuple(
        c + (a - c) * (1 + Fraction(float(r) / float(squared) ** 0.5 * 1.01)) for a, c in zip(p, center, strict=True)
    )
    return FAILS if any(holds(f.partition, c, beyond) for c in region) else UNKNOWN


def curves_under(known: Known, q: Polynomial, p: Point, r: Fraction) -> tuple[Truth, ...]:
    """What a factor that is negative in a ball of radius r around p makes of alpha's sign on the curves."""
    truths = []
    for join in known.surface.joins:
        curve = known.surface.partition.frame.global_points(join.curve())
        distances = np.linalg.norm(curve - np.array([float(c) for c in p]), axis=1)
        # two samples are closer than this
        spacing = 0.15 * np.ptp(curve, axis=0).max()
        if distances.min() > float(r) + spacing:
            truths.append(HOLDS)
        elif distances.min() < 0.99 * float(r):
            truths.append(FAILS)
        else:
            truths.append(UNKNOWN)
    return tuple(truths)
