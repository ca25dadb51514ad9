"""Joints whose verdict is known from how they were made: seeded, a hostile few dozen kinds.

All start from a curve with rational points P(t), on which a surface f = 0 and a clip h = 0 meet.  Two patches
f <= 0, h >= 0 ("A") and a f + b h^(k+1) <= 0, h <= 0 ("B") with a > 0 on the curve and b not 0 all along it
are joined with exactly GC^k.  Then something is done to one of them that breaks the joint, or nearly does.
All is exact, and moved by a random affine map in the end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random

from pas import Polynomial, Status, solid
from pas.solid import Solid, patch

PROVED, REFUTED, UNDECIDED = Status.PROVED, Status.REFUTED, Status.UNDECIDED
TINY = (Fraction(1, 10**3), Fraction(1, 10**9), Fraction(1, 10**30))
Point = tuple[Fraction, Fraction, Fraction]

X, Y, Z = (Polynomial(v) for v in "xyz")
ONE = Polynomial(1)


@dataclass(frozen=True)
class Curve:
    """A connected curve V(f, h) with its rational points."""

    f: Polynomial
    h: Polynomial
    point: Callable[[Fraction], Point]
    straight: bool = False


@dataclass(frozen=True)
class Case:
    """A solid with one claimed joint and the status that its verdict must have.

    `gap`, where there is one, is negative wherever a face is missing on the curve.
    """

    kind: str
    solid: Solid
    expected: Status
    gap: Polynomial | None = None


def _circle(t: Fraction) -> tuple[Fraction, Fraction]:
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def curves(random: Random) -> Curve:
    """One of: circles on a sphere, a cylinder, a hyperboloid; a parabola; space curves of degree 3, 4; a line."""
    circle = X * X + Y * Y - 1
    c = Fraction(random.choice((-3, -2, -1, 0, 2, 4, 5)), random.choice((1, 3)))
    kind = random.randrange(7)
    if kind < 2:
        return Curve(circle + Z * Z * c + Z * random.randint(-1, 1), Z, lambda t: (*_circle(t), Fraction(0)))
    if kind == 2:
        lift = X * Y * c + Y - X * X * Fraction(1, 3)
        return Curve(circle, Z - lift, lambda t: (*(p := _circle(t)), lift.at((*p, 0))))
    if kind == 3:
        return Curve(Y - X * X - X * Z * c, Z, lambda t: (t, t * t, Fraction(0)))
    if kind == 4:
        return Curve(Y - X * X, Z - X * Y, lambda t: (t, t * t, t**3))
    if kind == 5:
        return Curve(Y - X * X + Z * Z * c, X + Z, lambda t: (t, t * t * (1 - c), -t))
    return Curve(Y + X * Z * c + X * X, X, lambda t: (Fraction(0), Fraction(0), t), True)


def positive(random: Random) -> Polynomial:
    """A polynomial that is positive everywhere."""
    line = X * random.randint(-2, 2) + Y * random.randint(-2, 2) + Z * random.randint(-2, 2)
    return Polynomial(random.randint(1, 3)) + (line * line if random.random() < 0.4 else 0)


def other(random: Random) -> Polynomial:
    """A polynomial that does not vanish at all of the curve's points: a number, or a line's square and more."""
    sign = random.choice((-1, 1))
    return positive(random) * sign


def parameter(random: Random) -> Fraction:
    return Fraction(random.randint(-40, 40), random.randint(1, 20))


def plane_through(points: list[Point], random: Random) -> Polynomial:
    """A plane through two points and a random third."""
    p, q = points
    r = [Fraction(random.randint(-50, 50), 7) for _ in range(3)]
    u, v = ([b - a for a, b in zip(p, end, strict=True)] for end in (q, r))
    size = max(map(abs, u))
    u = [c / size for c in u]
    n = [u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3] for i in range(3)]
    return X * n[0] + Y * n[1] + Z * n[2] - sum(a * b for a, b in zip(n, p, strict=True))


def values(r: Polynomial, curve: Curve, near: list[Fraction]) -> list[Fraction]:
    """What a polynomial is at points of the curve, close to some parameters and far away."""
    steps = [Fraction(s, 10**e) for s in (-1, 1) for e in (0, 1, 2, 4, 11, 32)]
    middle = sum(near, Fraction(0)) / len(near)
    return [r.at(curve.point(t)) for t in [middle, *(n + s for n in near for s in steps)]]


@dataclass(frozen=True)
class Cut:
    """A polynomial `r` that is `most` somewhere on the curve and `least` somewhere else, above and below 0."""

    r: Polynomial
    least: Fraction
    most: Fraction


def cut(curve: Curve, random: Random) -> Cut:
    """A polynomial that is positive on a part of the curve and negative on another, of which one may be tiny."""
    while True:
        size = random.choice((*TINY, Fraction(1, 2), Fraction(3)))
        t = parameter(random)
        ends = [t, t + size]
        if curve.straight:
            slope = X * random.randint(-2, 2) + Y * random.randint(-2, 2)
            r = (Z - ends[0] + slope) * (Z - ends[1] + slope if random.random() < 0.7 else ONE)
        else:
            r = plane_through([curve.point(e) for e in ends], random)
        r = r if random.random() < 0.5 else -r
        found = values(r, curve, ends)
        if min(found) < 0 < max(found):
            return Cut(r, min(found), max(found))


Make = Callable[[Random], Case]
KINDS: dict[str, Make] = {}


def kind(make: Make) -> Make:
    """Register a kind of joint by the name of its function."""
    KINDS[make.__name__] = make
    return make


def make(number: int) -> Case:
    """The joint of a number, of kinds in turn."""
    names = list(KINDS)
    random = Random(number)
    name = names[number % len(names)]
    case = replace(KINDS[name](random), kind=name)
    return _moved(case, random) if random.random() < 0.5 else case


def _moved(case: Case, random: Random) -> Case:
    normal = random.choice(((1, 2, 2), (0, 3, 4), (1, 0, 1), (2, 3, 6), (1, 1, 1)))
    factors = [Fraction(random.randint(1, 9), random.randint(1, 9)) for _ in range(3)]
    if random.random() < 0.2:
        factors = [c * Fraction(10) ** random.choice((-9, -30, 6, 30)) for c in factors]
    offset = [Fraction(random.randint(-99, 99), 10) for _ in range(3)]
    shapes = [case.solid] + ([] if case.gap is None else [solid.implicit(case.gap, face="gap")])
    try:
        shapes = [s.mirror(normal).scale(factors).translate(offset) for s in shapes]
    except ValueError as error:  # coefficients of more than 10^300, which solids refuse
        assert "cannot be evaluated in floating point" in str(error)
        return case
    gap = None if case.gap is None else shapes[1].polynomials["gap"][0]
    return replace(case, solid=shapes[0], gap=gap)


def _joined(shape: Solid, curve: Curve, order: int, expected: Status, gap: Polynomial | None = None) -> Case:
    return Case("", shape.joined("A", "B", (curve.f, curve.h), order), expected, gap)


def _start(random: Random) -> tuple[Curve, int, Polynomial, Polynomial]:
    """A curve, an order k, and two polynomials that meet with exactly GC^k along it."""
    curve, k = curves(random), random.randrange(4)
    return curve, k, curve.f * positive(random), curve.f * positive(random) + curve.h ** (k + 1) * other(random)


@kind
def whole(random: Random) -> Case:
    """Nothing is missing; the claim is the order or a lower one."""
    curve, k, f1, f2 = _start(random)
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape, curve, random.randint(0, k), PROVED)


@kind
def too_high(random: Random) -> Case:
    """The claim is one order too high."""
    curve, k, f1, f2 = _start(random)
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape, curve, k + 1, REFUTED)


@kind
def missing(random: Random) -> Case:
    """One face's region leaves out a part of the curve: half, a small arc, a tiny one, or all but that."""
    curve, k, f1, f2 = _start(random)
    r = cut(curve, random).r
    bent = r + curve.h * curve.h * random.randint(0, 3)  # with the same zeros on the curve
    walls = [(bent,), ()] if random.random() < 0.5 else [(), (bent,)]
    shape = patch("A", f1, curve.h, *walls[0]) | patch("B", f2, -curve.h, *walls[1])
    return _joined(shape, curve, random.randint(0, k), REFUTED, r)


@kind
def missing_by_difference(random: Random) -> Case:
    """A half space, or what is beyond a surface, is taken from one face's patch alone."""
    curve, k, f1, f2 = _start(random)
    r = cut(curve, random).r
    first, second = patch("A", f1, curve.h), patch("B", f2, -curve.h)
    beyond = solid.implicit(r, face="cut")
    shape = (first - beyond) | second if random.random() < 0.5 else first | (second - beyond)
    return _joined(shape, curve, random.randint(0, k), REFUTED, r)


@kind
def cut_off(random: Random) -> Case:
    """What is beyond a surface is taken from both: where neither face is, nothing is asked."""
    curve, k, f1, f2 = _start(random)
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape - solid.implicit(cut(curve, random).r, face="cut"), curve, random.randint(0, k), PROVED)


@kind
def swallowed(random: Random) -> Case:
    """Another body swallows a part of the curve: also where one face is missing, or only where both are."""
    curve, k, f1, f2 = _start(random)
    r = cut(curve, random).r
    walls, expected = random.choice((((), PROVED), ((r,), PROVED), ((-r,), REFUTED)))
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h, *walls) | solid.implicit(r, face="other")
    return _joined(shape, curve, random.randint(0, k), expected)


@kind
def swallowed_but_for_a_bit(random: Random) -> Case:
    """The missing part is swallowed, but for a strip on its edge, or with one."""
    curve, k, f1, f2 = _start(random)
    found = cut(curve, random)
    r, width = found.r, min(found.most, -found.least) / 10**9 * random.choice((-1, 1))
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h, r) | solid.implicit(r + width, face="other")
    return _joined(shape, curve, random.randint(0, k), REFUTED if width > 0 else PROVED)


@kind
def opposite(random: Random) -> Case:
    """One of the two patches is inside out."""
    curve, k, f1, f2 = _start(random)
    f1, f2 = random.choice(((-f1, f2), (f1, -f2)))
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape, curve, random.randint(0, k), REFUTED)


@kind
def half_opposite(random: Random) -> Case:
    """One of the two patches turns inside out on a part of the curve."""
    curve, k = curves(random), random.randrange(4)
    f2 = curve.f * cut(curve, random).r + curve.h ** (k + 1) * other(random)
    shape = patch("A", curve.f, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape, curve, random.randint(0, k), REFUTED)


@kind
def both_on_one_side(random: Random) -> Case:
    """The second patch ends on the curve too, but lies on the same side of it as the first."""
    curve, k, f1, f2 = _start(random)
    shape = patch("A", f1, curve.h) | patch("B", f2, curve.h)
    return _joined(shape, curve, random.randint(0, k), REFUTED)


@kind
def apart(random: Random) -> Case:
    """Between the curve and the second patch is a gap."""
    curve, k, f1, f2 = _start(random)
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h - random.choice(TINY))
    return _joined(shape, curve, random.randint(0, k), REFUTED)


@kind
def over_or_under(random: Random) -> Case:
    """The second patch goes on beyond the curve: under the first that is no matter, over it the first ends."""
    curve, k = curves(random), random.randrange(4)
    b = other(random)
    f2 = curve.f * positive(random) + curve.h ** (k + 1) * b
    shape = patch("A", curve.f, curve.h) | patch("B", f2, -curve.h + random.choice(TINY))
    return _joined(shape, curve, random.randint(0, k), PROVED if b.at((0, 0, 0)) > 0 else REFUTED)


@kind
def touched(random: Random) -> Case:
    """A wall touches the curve, comes close to it, or crosses it at a point and back a little later."""
    curve, k, f1, f2 = _start(random)
    found = cut(curve, random)
    d = min(found.most, -found.least) ** 2 * random.choice((0, Fraction(1, 10**3), Fraction(1, 10**30)))
    square = found.r * found.r
    r, expected = random.choice(((square + d, PROVED), (d - square, REFUTED), (square - d, REFUTED if d else PROVED)))
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h, r)
    return _joined(shape, curve, random.randint(0, k), expected)


@kind
def in_two_patches(random: Random) -> Case:
    """A face is two patches, which overlap, adjoin, or leave a strip between them."""
    curve, k, f1, f2 = _start(random)
    r, d = cut(curve, random).r, random.choice((*TINY, Fraction(0))) * random.choice((-1, 1))
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h, r + d) | patch("B", f2, -curve.h, d - r)
    return _joined(shape, curve, random.randint(0, k), REFUTED if d < 0 else PROVED)


@kind
def sizes(random: Random) -> Case:
    """Coefficients of sizes up to 10^100."""
    curve, k, f1, f2 = _start(random)
    a, b, c = (Polynomial(Fraction(10) ** random.choice((-100, -40, 40, 100))) for _ in range(3))
    r = cut(curve, random).r
    walls, expected = random.choice((((), PROVED), ((r * c,), REFUTED)))
    shape = patch("A", f1 * a, curve.h * b) | patch("B", f2 * c, -curve.h * a, *walls)
    return _joined(shape, curve, random.randint(0, k), expected)


@kind
def slightly_off(random: Random) -> Case:
    """The second polynomial is off by 10^-40 times a lower power of the clip."""
    curve, k, f1, f2 = _start(random)
    j = random.randint(0, k)
    f2 += curve.h**j * other(random) * Fraction(1, 10**40)
    shape = patch("A", f1, curve.h) | patch("B", f2, -curve.h)
    claim = random.randint(0, k)
    return _joined(shape, curve, claim, PROVED if claim < j else REFUTED)


@kind
def two_circles(random: Random) -> Case:
    """A ball and a pipe about its axis meet in two circles, at times close together, of which one is joined."""
    radius = random.choice((Fraction(9, 25), Fraction(1, 4), 1 - Fraction(1, 10**20)))
    ball, pipe, k = X * X + Y * Y + Z * Z - 1, X * X + Y * Y - radius, random.randrange(4)
    f2 = ball * positive(random) + pipe ** (k + 1) * other(random)
    r = X * random.randint(1, 3) + Y * random.randint(-3, 3)
    regions, expected = random.choice(
        (([(Z,)], PROVED), ([(Z,), (-Z,)], PROVED), ([(Z, r)], REFUTED), ([(r,)], REFUTED), ([(Z,), (-Z, r)], REFUTED))
    )
    shape = solid.union([patch("A", ball, pipe), *(patch("B", f2, -pipe, *walls) for walls in regions)])
    return Case("", shape.joined("A", "B", (ball, pipe), random.randint(0, k)), expected)


@kind
def one_loop_or_two(random: Random) -> Case:
    """A pipe leaves a ball in one loop or in two, close to one another; below, the second face is missing."""
    off = random.choice(TINY) * random.choice((-1, 1))
    ball, pipe = X * X + Y * Y + Z * Z - 1, (X - Fraction(1, 2)) ** 2 + Y * Y - Fraction(1, 4) + off
    k = random.randrange(4)
    f2 = ball * positive(random) + pipe ** (k + 1) * other(random)
    shape = patch("A", ball, pipe) | patch("B", f2, -pipe, Z)
    joined = shape.joined("A", "B", (ball, pipe), random.randint(0, k))
    return Case("", joined, PROVED if off > 0 else REFUTED, None if off > 0 else Z)


@kind
def oval_and_branch(random: Random) -> Case:
    """A plane cubic of two components; one of them is joined, or a wall cuts one."""
    cubic, k = Y * Y - X**3 + X + Z * random.randint(-2, 2), random.randrange(4)
    f2 = cubic * positive(random) + Z ** (k + 1) * other(random)
    side = random.choice((-1, 1))
    wall, expected = random.choice(
        (((X - Fraction(1, 2)) * side, PROVED), ((X + Fraction(1, 2)) * side, REFUTED), ((X - 2) * side, REFUTED))
    )
    shape = patch("A", cubic, Z) | patch("B", f2, -Z, wall)
    return Case("", shape.joined("A", "B", (cubic, Z), random.randint(0, k)), expected)


@kind
def edges(random: Random) -> Case:
    """Sharp edges of intersections, unions and differences, also where a part of them is cut off or swallowed."""
    curve = curves(random)
    a, b = solid.implicit(curve.f, face="A"), solid.implicit(curve.h, face="B")
    shape = random.choice((a & b, a | b, a - b, b - a))
    more = solid.implicit(cut(curve, random).r, face="more")
    shape = random.choice((shape, shape | more, shape - more, shape & more))
    order = random.choice((0, 0, 0, 1))
    return _joined(shape, curve, order, REFUTED if order else PROVED)


@kind
def edges_of_two_patches(random: Random) -> Case:
    """A sharp edge between two patches with a wall through it; with one of them inside out it is none."""
    curve = curves(random)
    wall = curve.f * random.randint(1, 3) - curve.h * random.randint(1, 3)  # along it, f and h have one sign
    f, h = random.choice(((curve.f, curve.h), (-curve.f, -curve.h)))
    shape, expected = random.choice(
        (
            (patch("A", f, wall) | patch("B", h, -wall), PROVED),
            (patch("A", -f, wall) | patch("B", h, -wall), REFUTED),
            (patch("A", f, wall) | patch("B", -h, -wall), REFUTED),
            (patch("A", f, wall) | patch("B", h, -wall, cut(curve, random).r), REFUTED),
        )
    )
    return _joined(shape, curve, 0, expected)


@kind
def four_faces_at_an_edge(random: Random) -> Case:
    """What is in just one of two bodies: along the edge four pieces of the boundary meet."""
    curve = curves(random)
    a, b = solid.implicit(curve.f, face="A"), solid.implicit(curve.h, face="B")
    return _joined((a - b) | (b - a), curve, 0, REFUTED)


@kind
def cusps(random: Random) -> Case:
    """Two surfaces that touch, with the solid in the narrow wedge on one side: an edge of order 0 only."""
    curve, k = curves(random), random.randrange(4)
    f2 = curve.f * positive(random) + curve.h ** (k + 1) * positive(random)
    order = random.randint(0, k)
    shape = patch("A", curve.f, curve.h) - solid.implicit(f2, face="B")
    return _joined(shape, curve, order, REFUTED if order else PROVED)


@kind
def bubbles(random: Random) -> Case:
    """A factor that changes its sign in a small ball about a point of the curve, or never."""
    curve, k, f1, f2 = _start(random)
    away = [c - p for c, p in zip((X, Y, Z), curve.point(parameter(random)), strict=True)]
    square = sum((c * c for c in away), Polynomial(0))
    factor, expected = random.choice(((square - random.choice(TINY), REFUTED), (square + random.choice(TINY), PROVED)))
    shape = patch("A", f1 * factor, curve.h) | patch("B", f2, -curve.h)
    return _joined(shape, curve, random.randint(0, k), expected)


@kind
def apexes(random: Random) -> Case:
    """A cone and what continues it beyond a plane through its apex, with the apex, without, or swallowed."""
    cone, plane = X * X + Y * Y - Z * Z, Y - X * random.randint(-2, 2)
    k, d = random.randrange(4), random.choice(TINY)
    f2 = cone * positive(random) + plane ** (k + 1) * other(random)
    ball = solid.ball((0, 0, 0), random.choice(TINY), "ball")
    first, second = patch("A", cone, plane), patch("B", f2, -plane)
    shape, expected = random.choice(
        (
            (first | second, UNDECIDED),
            (patch("A", cone, plane, Z) | patch("B", f2, -plane, Z), UNDECIDED),
            (patch("A", cone, plane, Z - d) | patch("B", f2, -plane, Z - d), PROVED),
            (patch("A", cone, plane, Z - d) | second, REFUTED),
            (first | patch("B", f2, -plane, Z + d), REFUTED),
            (first | second | ball, PROVED),
            ((first | second) - ball, PROVED),
        )
    )
    return Case("", shape.joined("A", "B", (cone, plane), random.randint(0, k)), expected)


@kind
def crossing_lines(random: Random) -> Case:
    """Two lines that cross, on a surface regular there; one wall goes through that point."""
    saddle, k = X * Y + Z * random.choice((-2, 1, 3)), random.randrange(4)
    f2 = saddle * positive(random) + Z ** (k + 1) * other(random)
    walls, expected = random.choice((((), PROVED), ((X + Y - 1,), REFUTED), ((X + Y,), REFUTED)))
    shape = patch("A", saddle, Z) | patch("B", f2, -Z, *walls)
    return Case("", shape.joined("A", "B", (saddle, Z), random.randint(0, k)), expected)
