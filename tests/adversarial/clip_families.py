"""Surfaces at clips of every kind, with verdicts that are known because of how they are made."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
from clip_cases import (
    NEVER_PROVED,
    PROVED,
    REFUTED,
    UNDECIDED,
    Case,
    T,
    below,
    ellipse,
    linear,
    near,
    number,
    positive,
)

import pas
from pas import Polynomial

# --- one curve in one plane -----------------------------------------------------------------------


def plain(rng: random.Random, order: int) -> Case:
    """A contact that is met."""
    f = ellipse(rng) + T * linear(rng, 1)
    g = f * positive(rng) + T ** (order + 1) * linear(rng, 2)
    return Case("plain", ((f, T),), order, g, PROVED)


def lower_order(rng: random.Random, order: int) -> Case:
    """A contact that is met with a lower order, be it by very little."""
    f = ellipse(rng) + T * linear(rng, 1)
    reached = rng.randint(-1, order - 1)
    bite = Fraction(rng.choice((-1, 1)), 10 ** rng.randint(0, 40))
    g = f * positive(rng) + T ** (reached + 1) * bite
    return Case("lower order", ((f, T),), order, g, REFUTED, near(f, T))


def partly_lower(rng: random.Random, order: int) -> Case:
    """The same, where what is missing vanishes at some points of the curve."""
    q = ellipse(rng, Fraction(0), Fraction(0))
    f = q + T * linear(rng, 1)
    what = Polynomial("y") - number(rng, -0.05, 0.05) + Polynomial("z") * number(rng, -1, 1)
    g = f * positive(rng) + T ** rng.randint(0, order) * what / 10 ** rng.randint(0, 40)
    return Case("partly lower", ((f, T),), order, g, REFUTED, lambda p: near(f, T)(p) and abs(what(p)) > 1e-9)


def bad_alpha(rng: random.Random, order: int) -> Case:
    """alpha changes its sign on the curve, or is negative all over."""
    f = ellipse(rng, Fraction(0), Fraction(0)) + T * linear(rng, 1)
    alpha = rng.choice(
        (-positive(rng), Polynomial("y") + Polynomial("z") * number(rng, -1, 1) + number(rng, -0.1, 0.1))
    )
    g = f * alpha + T ** (order + 1) * linear(rng, 2)
    return Case("bad alpha", ((f, T),), order, g, REFUTED, below(alpha, f, T))


def touching_alpha(rng: random.Random, order: int) -> Case:
    """alpha is nowhere negative on the curve, but has a zero there, or nearly."""
    f = ellipse(rng, Fraction(0), Fraction(0)) + T * linear(rng, 1)
    alpha = (Polynomial("y") - number(rng, -0.1, 0.1)) ** 2 - rng.choice((0, Fraction(1, 10 ** rng.randint(18, 40))))
    g = f * alpha + T ** (order + 1) * linear(rng, 2)
    return Case("touching alpha", ((f, T),), order, g, NEVER_PROVED, near(f, T), NEVER_PROVED)


def alpha_inside(rng: random.Random, order: int) -> Case:
    """alpha is positive on the curve and negative somewhere inside it: the surface meets the face there."""
    f = ellipse(rng, Fraction(0), Fraction(0)) + T * linear(rng, 1)
    alpha = Polynomial("x^2 + y^2 + z^2") - 1 - Fraction(rng.randint(1, 6), 100) ** 2
    g = f * alpha + T ** (order + 1) * linear(rng, 2)
    return Case("alpha inside", ((f, T),), order, g, PROVED, None, NEVER_PROVED)


def turned_surface(rng: random.Random, order: int) -> Case:
    """The contact's surface has its sign turned round; the patch follows it or does not."""
    f = ellipse(rng) + T * linear(rng, 1)
    g = f * positive(rng) * rng.choice((-1, 1)) + T ** (order + 1) * linear(rng, 1)
    return Case("turned surface", ((-f, T),), order, g, NEVER_PROVED, lambda p: f(p) > -1e-9)


def open_curve(rng: random.Random, order: int) -> Case:
    """The curve leaves the face through its edge, or goes past it."""
    q = ellipse(rng, Fraction(1), number(rng, -0.3, 0.3))
    f = q + T * linear(rng, 1)
    g = f * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("open curve", ((f, T),), order, g, NEVER_PROVED, below(f, T))


# --- clips with several factors -------------------------------------------------------------------


def harmless_factor(rng: random.Random, order: int) -> Case:
    """The clip has another factor, positive in the region: a plane beyond it or one without real points."""
    f = ellipse(rng) + T * linear(rng, 1)
    factor = rng.choice((Polynomial("x + y") + number(rng, 2.1, 4), positive(rng), 1 + linear(rng, 3) ** 2))
    g = f * positive(rng) + (T * factor) ** (order + 1) * linear(rng, 0.5)
    return Case("harmless factor", ((f, T * factor),), order, g, PROVED)


def reversed_clip(rng: random.Random, order: int) -> Case:
    """The clip is positive on the region's side, alone or by another factor."""
    f = ellipse(rng) + T * linear(rng, 1)
    factor = -rng.choice((Polynomial(1), positive(rng), Polynomial("x + 3")))
    g = f * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("reversed clip", ((f, T * factor),), order, g, REFUTED, near(f, T))


def crossing_factor(rng: random.Random, order: int) -> Case:
    """Another factor of the clip passes through the curve in the face."""
    f = ellipse(rng, Fraction(0), Fraction(0)) + T * linear(rng, 1)
    factor = Polynomial("y") + Polynomial("z") * number(rng, -1, 1) + T * number(rng, -1, 1) + number(rng, -0.05, 0.05)
    g = f * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("crossing factor", ((f, T * factor),), order, g, NEVER_PROVED, below(factor, f, T))


def inner_plane(rng: random.Random, order: int) -> Case:
    """The clip cuts the pipe a second time, inside the region; there it may be met, or not."""
    f = ellipse(rng, Fraction(0), Fraction(0))
    inner = Polynomial("x") - number(rng, -0.6, 0.6) + Polynomial("y") * number(rng, -0.3, 0.3)
    power = T ** (order + 1) * rng.choice((Polynomial(1), inner, inner ** (order + 1)))
    g = f * positive(rng) + power * rng.choice((-1, 1)) / 10 ** rng.randint(0, 20)
    return Case("inner plane", ((f, T * inner),), order, g, NEVER_PROVED, near(f, inner))


def inner_ball(rng: random.Random, order: int) -> Case:
    """Another factor of the clip vanishes in the region, and is positive on the surface."""
    f = ellipse(rng, Fraction(0), Fraction(0))
    factor = Polynomial("x^2 + y^2 + z^2") - Fraction(rng.randint(1, 9), 100) ** 2
    g = f * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("inner ball", ((f, T * factor),), order, g, PROVED)


def multiple(rng: random.Random, order: int) -> Case:
    """The clip has the face's plane for a factor twice or three times."""
    f = ellipse(rng) + T * linear(rng, 1)
    g = f * positive(rng)
    return Case("multiple", ((f, T ** rng.randint(2, 3)),), order, g, NEVER_PROVED)


def two_sides(rng: random.Random, order: int) -> Case:
    """One clip for two opposite sides of the box: both met, or one of them not."""
    f, other = ellipse(rng), Polynomial("x + 1")
    bite = rng.choice((0, 1)) * Fraction(rng.choice((-1, 1)), 10 ** rng.randint(0, 40))
    power = (T * other) ** (order + 1) * linear(rng, 0.2) / 2**order + T ** (order + 1) * bite
    allowed = REFUTED if bite else PROVED
    return Case("two sides", ((f, T * other),), order, f * positive(rng) + power, allowed, near(f, other))


def round_an_edge(rng: random.Random, order: int) -> Case:
    """One clip for two neighbouring sides, and a curve that goes round their edge."""
    other = Polynomial("y - 1")
    f = Polynomial("(x - 1)^2 + (y - 1)^2 + z^2") + T * other * number(rng, -1, 1) - number(rng, 0.2, 0.6) ** 2
    g = f * positive(rng) + (T * other) ** (order + 1) * linear(rng, 0.2)
    return Case("round an edge", ((f, -T * other),), order, g, NEVER_PROVED, lambda p: f(p) < 1e-9)


# --- several curves in one plane ------------------------------------------------------------------


def elsewhere(rng: random.Random, order: int) -> Case:
    """The contact's surface has a second curve in the clip's plane, beside or round the face, that is not met."""
    inner = ellipse(rng) + T * linear(rng, 1)
    beside, round_it = (
        ellipse(rng, number(rng, 2, 4), number(rng, -3, 3)),
        number(rng, 2.5, 6) - Polynomial("y^2 + z^2"),
    )
    outer = rng.choice((beside, round_it)) + T * linear(rng, 1)
    f = inner * outer + T ** (order + 1) * linear(rng, 1)
    g = inner * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("elsewhere", ((f, T),), order, g, PROVED)


def elsewhere_lower(rng: random.Random, order: int) -> Case:
    """The same, with the curve in the face met with a lower order."""
    inner = ellipse(rng) + T * linear(rng, 1)
    outer = ellipse(rng, number(rng, 2, 4), number(rng, -3, 3)) + T * linear(rng, 1)
    f = inner * outer + T ** (order + 1) * linear(rng, 1)
    g = inner * positive(rng) + T ** rng.randint(0, order) / 10 ** rng.randint(0, 40)
    return Case("elsewhere lower", ((f, T),), order, g, REFUTED, near(inner, T))


def ovals(rng: random.Random, order: int) -> Case:
    """An irreducible quartic of two ovals, one in the face; met with the whole quartic, or not."""
    c = number(rng, 2.5, 3.5)
    f = Polynomial("y^2 + z^2") * ((Polynomial("y") - c) ** 2 + Polynomial("z^2")) - number(rng, 0.5, 1) ** 4
    f = f + T * linear(rng, 1)
    bite = rng.choice((0, 1)) * Fraction(1, 10 ** rng.randint(0, 40))
    g = f * positive(rng) + T ** rng.randint(0, order) * bite
    return Case("ovals", ((f, T),), order, g, REFUTED if bite else PROVED, near(f, T))


def both(rng: random.Random, order: int) -> Case:
    """Two curves in the face, both met."""
    first, second = _pair(rng)
    f = first * second + T * linear(rng, 1)
    return Case("both", ((f, T),), order, f * positive(rng) + T ** (order + 1) * linear(rng, 1), PROVED)


def one_of_two(rng: random.Random, order: int) -> Case:
    """Two curves in the face, one of them met."""
    first, second = _pair(rng)
    first, second = (q + T * linear(rng, 1) for q in (first, second))
    g = first * positive(rng) + T ** (order + 1) * linear(rng, 1)
    return Case("one of two", ((first * second, T),), order, g, REFUTED, near(second, T))


def one_of_two_lower(rng: random.Random, order: int) -> Case:
    """Two curves in the face, one of them met with a lower order."""
    first, second = _pair(rng)
    f = first * second
    g = f * positive(rng) + first * T ** rng.randint(0, order) / 10 ** rng.randint(0, 20)
    return Case("one of two lower", ((f, T),), order, g, REFUTED, near(second, T))


def _pair(rng: random.Random) -> tuple[Polynomial, Polynomial]:
    pair = [ellipse(rng, number(rng, -0.3, 0.3), side * number(rng, 0.45, 0.5), 0.3) for side in (-1, 1)]
    rng.shuffle(pair)
    return pair[0], pair[1]


# --- curved clips -----------------------------------------------------------------------------------


def bulge(rng: random.Random, order: int) -> Case:
    """A clip that vanishes at the corners of a side and bulges beyond it: its curve is there or not, and
    alpha is positive on it or not."""
    radius, height, bulging = number(rng, 0.2, 0.6), number(rng, 0.5, 2), number(rng, 1, 3)
    f = Polynomial("y^2 + z^2") - radius**2
    h = T + bulging * (Polynomial("y^2") - 1)
    first, last = 1 + bulging * (1 - radius**2), 1 + bulging
    length = rng.choice((1, (first + last) / 2, last + height))
    region = pas.SingleCell((-1, -1, -1), (length, 1, 1))
    where = rng.choice((last + 1, (first + last) / 2, first - Fraction(1, 10)))
    alpha = (where - Polynomial("x")) / 4
    reached = rng.choice((order, rng.randint(-1, order)))
    g = f * alpha + h ** (reached + 1) * Fraction(1, 8) ** (reached + 1)
    proved = length == last + height and where == last + 1 and reached == order
    allowed = PROVED if proved else UNDECIDED if length == 1 else NEVER_PROVED

    def wrong(p: np.ndarray) -> bool:
        return near(f, h)(p) and (reached < order or alpha(p) < 1e-9)

    return Case("bulge", ((f, h),), order, g, allowed, wrong, None if length == 1 else NEVER_PROVED, region)


def sphere_clip(rng: random.Random, order: int) -> Case:
    """A sphere inside the region clips a cone or a pipe in one or two closed curves."""
    f = Polynomial("y^2 + z^2") - (number(rng, 0.2, 0.3) + Polynomial("x") * number(rng, 0, 0.15)) ** 2
    h = Polynomial("x^2 + y^2 + z^2") + linear(rng, 0.2) - number(rng, 0.6, 0.7) ** 2
    bite = rng.choice((0, 0, 1)) * Fraction(1, 10 ** rng.randint(0, 20))
    g = f * positive(rng) + h ** (order + 1) * linear(rng, 0.1) + h ** rng.randint(0, order) * bite
    return Case("sphere clip", ((f, h),), order, g, REFUTED if bite else PROVED, near(f, h), NEVER_PROVED)


def plane_inside(rng: random.Random, order: int) -> Case:
    """A clip plane through the middle of the region."""
    f = ellipse(rng, Fraction(0), Fraction(0))
    h = Polynomial("x") + Polynomial("y") * number(rng, -0.5, 0.5) - number(rng, -0.3, 0.3)
    crossing = Polynomial("y") + number(rng, -0.05, 0.05)
    kinds = ((positive(rng), PROVED), (-positive(rng), REFUTED), (crossing, REFUTED), (crossing**2, NEVER_PROVED))
    alpha, allowed = rng.choice(kinds)
    g = f * alpha + h ** (order + 1) * linear(rng, 0.2)
    return Case("plane inside", ((f, h),), order, g, allowed, below(alpha, f, h), NEVER_PROVED)


def grazing(rng: random.Random, order: int) -> Case:
    """A curved clip whose curve ends at a wall of the region, or touches the surface."""
    f = ellipse(rng, Fraction(0), Fraction(0))
    cutting = Polynomial("x") + Polynomial("y") * number(rng, 20, 40)
    radius = number(rng, 0.2, 0.4)
    touching = Polynomial("(y - 1/2)^2 + x^2 + z^2") - (Fraction(1, 2) - radius) ** 2
    if rng.random() < 0.5:
        f, h = Polynomial("y^2 + z^2") - radius**2, touching
    else:
        h = cutting
    g = f * positive(rng) + h ** (order + 1) * linear(rng, 0.2)
    return Case("grazing", ((f, h),), order, g, UNDECIDED, None, NEVER_PROVED)


# --- a region that goes on beyond a clip plane --------------------------------------------------------

BENT = ((0, -1, -1), (0, 1, -1), (0, 0, "3/2"), (-1, "3/10", "1/5"), (1, 3, 1))
"""The first four make a tetrahedron with a face in the plane x = 0, the last four one that the plane cuts."""


def bent(rng: random.Random, order: int) -> Case:
    """The clip plane passes through another cell, and the surface has a curve there, too, or has not."""
    cells, plane = ((0, 1, 2, 3), (1, 2, 3, 4)), Polynomial("x")
    region = pas.Partition(BENT, cells, pieces=rng.choice((None, [(0, 1)])))
    y, z, radius = number(rng, -0.1, 0.1), number(rng, -0.3, 0), number(rng, 0.1, 0.3)
    first = (Polynomial("y") - y) ** 2 + (Polynomial("z") - z) ** 2 - radius**2
    there = rng.random() < 0.5
    second = Polynomial("(y - 9/10)^2 + (z - 7/20)^2") - Fraction(1, 100) if there else Polynomial(1)
    f = first * second + plane * linear(rng, 0.1)
    good = rng.random() < 0.5
    bite = Polynomial(0) if good else plane ** rng.randint(0, order) / 10 ** rng.randint(0, 20)
    g = f * (1 + Polynomial("y") / 10) + plane ** (order + 1) * linear(rng, 0.2) + bite
    allowed = NEVER_PROVED if there else PROVED if good else REFUTED
    return Case("bent", ((f, plane),), order, g, allowed, near(f, plane), None, region)


# --- a contact on every side ------------------------------------------------------------------------


def six_way(rng: random.Random, order: int) -> Case:
    """A node of six arms in a box whose every side has a contact: all met; one not; one side forgotten."""
    order = min(order, 2)  # the patch is of degree 5 (k + 1)
    f = Polynomial("x^2*y^2 + y^2*z^2 + z^2*x^2") - number(rng, 0.1, 0.4)
    order = min(order, 2)  # above, the bump is of a degree that surfaces may not have
    planes = [Polynomial(f"{sign}{v} - 1") for v in "xyz" for sign in ("", "-")]
    rng.shuffle(planes)
    bite = rng.choice((0, 1)) * Fraction(1, 10 ** rng.randint(3, 40))
    bump = Polynomial(bite)
    for plane in planes[1:] if bite else ():
        bump = bump * plane ** (order + 1)
    given = planes if rng.random() < 0.7 else planes[:5]
    enclosed = PROVED if len(given) == 6 and not bite else NEVER_PROVED
    contacts = tuple((f, plane) for plane in given)
    g = f * positive(rng) + bump
    return Case("six-way", contacts, order, g, REFUTED if bite else PROVED, near(f, planes[0]), enclosed)


FAMILIES = (
    *(plain, lower_order, partly_lower, bad_alpha, touching_alpha, alpha_inside, turned_surface, open_curve),
    *(harmless_factor, reversed_clip, crossing_factor, inner_plane, inner_ball, multiple, two_sides, round_an_edge),
    *(elsewhere, elsewhere_lower, ovals, both, one_of_two, one_of_two_lower),
    *(bulge, sphere_clip, plane_inside, grazing, bent, six_way),
)
