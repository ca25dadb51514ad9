"""Seeded parametric surfaces whose truth is known by construction: regular and without poles, or not.

A map of known kind is carried over by steps that keep the kind: an invertible affine map of space, scales of any size
for all coordinates or one by one, exchanged parameters, and a change of parameters that is invertible on the domain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from pas.algebra.rational_function import RationalFunction
from pas.parametric.surface import ParametricSurface

Map = tuple[RationalFunction, RationalFunction, RationalFunction]
Side = tuple[Fraction | None, Fraction | None]
Box = tuple[Side, Side]
T, H, ONE = (RationalFunction(e) for e in ("t", "h", "1"))
POWERS = (-1000, -400, -300, -200, -159, -154, -100, -30, -3, 0, 0, 0, 3, 30, 100, 154, 155, 200, 300, 400, 1000)
GAPS = (2, 6, 12, 17, 40, 120, 320)
"""How far outside a domain something is planted: 10 to minus these."""


@dataclass(frozen=True)
class Case:
    """A surface, whether it is regular without poles on its domain, and how it was made."""

    surface: ParametricSurface
    regular: bool
    kind: str


def case(seed: int, kinds: Sequence[str] = (), powers: Sequence[int] = POWERS) -> Case:
    """The case of a number, of any kind or of these, with scales 10^p for these p."""
    draw = Random(seed)
    kind = draw.choice(list(kinds or KINDS))
    components, box, regular = KINDS[kind](draw)
    components, box = disguised(draw, components, box, powers)
    return Case(ParametricSurface(*components, domain=box), regular, f"{seed}: {kind}")


def number(draw: Random, size: int = 4, below: int = 6) -> Fraction:
    """A small fraction."""
    return Fraction(draw.randint(-size * below, size * below), draw.randint(1, below))


def box_of(draw: Random) -> Box:
    """A domain with small rational ends, some of which no double is."""
    sides = []
    for _ in range(2):
        low = number(draw, 2)
        sides.append((low, low + Fraction(draw.randint(1, 18), draw.randint(3, 9))))
    return sides[0], sides[1]


def polynomial(draw: Random, degree: int, terms: int = 4) -> RationalFunction:
    """A few terms t^a h^b with small coefficients."""
    total = ONE * 0
    for _ in range(terms):
        a = draw.randint(0, degree)
        total = total + ONE * number(draw) * T**a * H ** draw.randint(0, degree - a)
    return total


def positive(draw: Random) -> RationalFunction:
    """A polynomial that is at least 1/50 everywhere."""
    return polynomial(draw, 2, 2) ** 2 * Fraction(draw.randint(0, 3), 4) + Fraction(1, draw.choice((1, 2, 9, 50)))


def place(draw: Random, side: tuple[Fraction, Fraction], inside: bool) -> Fraction:
    """A parameter inside an interval (or at an end), or outside by little."""
    low, high = side
    if inside:
        return draw.choice((low, high, low + (high - low) * Fraction(draw.randint(1, 16), 17), (low + high) / 2))
    gap = Fraction(1, 10 ** draw.choice(GAPS)) * (high - low)
    return draw.choice((low - gap, high + gap))


def vanishing(
    draw: Random, variable: RationalFunction, side: tuple[Fraction, Fraction], inside: bool
) -> RationalFunction:
    """A polynomial in one parameter with a simple zero inside an interval and no other, or one just outside of it.

    Half of those inside are irrational: square roots.
    """
    low, high = side
    if not inside or draw.random() < 0.5:
        return variable - place(draw, side, inside)
    root = low + (high - low) * Fraction(draw.randint(1, 9), 10)
    far = high - low + 1  # (x - low + far)^2 is increasing on the interval
    square = (root - low + far) ** 2
    square = square + min((high - low) ** 2, Fraction(1)) / Fraction(10**9 + draw.randint(1, 99))
    return (variable - low + far) ** 2 - square if square < (high - low + far) ** 2 else variable - root


def graph(draw: Random) -> tuple[Map, Box, bool]:
    """(u, v, f(u, v)), f rational without poles."""
    return (T, H, polynomial(draw, 3) / positive(draw)), box_of(draw), True


def revolution(draw: Random) -> tuple[Map, Box, bool]:
    """A meridian that never stops nor meets its axis, turned."""
    meridian = (
        H * H * Fraction(draw.randint(0, 4), 3) + Fraction(1, draw.randint(1, 40)),
        H + H**3 * draw.randint(0, 2),
    )
    circle = (1 - T * T) / (1 + T * T), 2 * T / (1 + T * T)
    return (circle[0] * meridian[0], circle[1] * meridian[0], meridian[1]), box_of(draw), True


def offset(draw: Random) -> tuple[Map, Box, bool]:
    """(t + p, h + q, anything) with slopes of p, q below 1/4: the first minor of the Jacobian stays above 3/8."""
    box = box_of(draw)
    far = 1 + max(abs(e) for side in box for e in side)
    parts = []
    for variable in (T, H):
        bend = polynomial(draw, 4, 3)
        bound = sum(abs(c) * 4 * far**4 for c in coefficients(bend)) or Fraction(1)
        parts.append(variable + bend * (Fraction(1, 4) / bound))
    return (parts[0], parts[1], polynomial(draw, 3) / positive(draw)), box, True


def double_minor(draw: Random) -> tuple[Map, Box, bool]:
    """(t, (h - c)^3, h + ...): a minor has a double root, the normal none."""
    box = box_of(draw)
    step = vanishing(draw, H, box[1], True)
    return (T, step**3, H + polynomial(draw, 2, 2).substitute(T, ONE * 0)), box, True


def cusp(draw: Random) -> tuple[Map, Box, bool]:
    """A graph over (w(t), h) with w' = 0 at a parameter in the domain, or just outside."""
    box, inside = box_of(draw), draw.random() < 0.6
    step = vanishing(draw, T, box[0], inside)
    bent = integral(step ** draw.choice((1, 1, 2)))
    return (bent, H, (polynomial(draw, 2) / positive(draw)).substitute(bent, H)), box, not inside


def pinch(draw: Random) -> tuple[Map, Box, bool]:
    """Whitney's umbrella (a, b^2, a b), a and b simple zeros: singular where both vanish, and there alone."""
    box, inside = box_of(draw), (draw.random() < 0.8, draw.random() < 0.8)
    a, b = (vanishing(draw, v, side, i) for v, side, i in zip((T, H), box, inside, strict=True))
    return (a, b * b, a * b), box, not all(inside)


def fold(draw: Random) -> tuple[Map, Box, bool]:
    """A graph over (t, (h - g(t))^k): singular along h = g(t), where that is in the domain."""
    box, inside = box_of(draw), draw.random() < 0.6
    where = place(draw, box[1], inside)
    bend = (T - box[0][0]) * number(draw, 1, 9) if inside else ONE * 0
    inside_at = where  # g(low) = where
    step = (H - inside_at - bend) ** draw.choice((2, 3))
    return (T, step, polynomial(draw, 2).substitute(T, step)), box, not inside


def pole(draw: Random) -> tuple[Map, Box, bool]:
    """A denominator that vanishes along a line in the domain, or just outside."""
    box, inside = box_of(draw), draw.random() < 0.6
    below = vanishing(draw, T, box[0], inside)
    return (T, H, (polynomial(draw, 2) * below + 1) / below ** draw.choice((1, 2))), box, not inside


def point_pole(draw: Random) -> tuple[Map, Box, bool]:
    """A denominator a^2 + b^2 (+ 10^-k) that vanishes at one point of the domain, or nowhere."""
    box, kind = box_of(draw), draw.choice(("inside", "outside", "raised"))
    inside = (True, kind != "outside")
    a, b = (vanishing(draw, v, side, i) for v, side, i in zip((T, H), box, inside, strict=True))
    raised = Fraction(1, 10 ** draw.choice(GAPS)) if kind == "raised" else 0
    return (T, H, 1 / (a * a + b * b + raised)), box, kind != "inside"


def unbounded(draw: Random) -> tuple[Map, Box, bool]:
    """A graph over (t, h^3/3 - c^2 h) or with the pole t = c, on a domain without end one way or both."""
    ends = number(draw), number(draw) + 60
    start = number(draw, 2)
    box = draw.choice(((ends[0], None), (None, ends[1]), (None, None))), (start, start + 3)
    zero = draw.choice((number(draw), ends[0] - Fraction(1, 10**12), ends[1] + Fraction(1, 10**12), Fraction(10**6, 7)))
    low, high = box[0]
    inside = (low is None or low <= zero) and (high is None or zero <= high)
    if draw.random() < 0.5:
        return (T, H, (T * H + 1) / (T - zero)), box, not inside
    bent = integral((T - zero) ** draw.choice((1, 2)) * (T * T + 1))
    return (bent, H, bent * H), box, not inside


KINDS: dict[str, Callable[[Random], tuple[Map, Box, bool]]] = {
    f.__name__: f for f in (graph, revolution, offset, double_minor, cusp, pinch, fold, pole, point_pole, unbounded)
}


def integral(function: RationalFunction) -> RationalFunction:
    """The polynomial in t with this derivative and value 0 at 0."""
    total = ONE * 0
    for (a, b), c in function.numerator.to_dict().items():
        assert b == 0 and function.is_polynomial
        total = total + ONE * Fraction(int(c.p), int(c.q)) * T ** (int(a) + 1) / (int(a) + 1)
    return total


def coefficients(function: RationalFunction) -> list[Fraction]:
    """Those of a polynomial."""
    return [Fraction(int(c.p), int(c.q)) for c in function.numerator.to_dict().values()]


def disguised(draw: Random, components: Map, box: Box, powers: Sequence[int] = POWERS) -> tuple[Map, Box]:
    """The same in other parameters and coordinates."""
    for axis in (0, 1):
        if draw.random() < 0.5:
            components, box = reparametrised(draw, components, box, axis)
    if draw.random() < 0.3:
        components, box = tuple(c.substitute(H, T) for c in components), (box[1], box[0])
    if draw.random() < 0.7:
        rows = [[Fraction(int(i == j)) if i <= j else number(draw, 1) for j in range(3)] for i in range(3)]
        draw.shuffle(rows)  # unit triangular, so invertible
        components = tuple(
            sum((c * r for c, r in zip(components, row, strict=True)), ONE * number(draw)) for row in rows
        )
    common = draw.choice(powers)
    scales = [Fraction(10) ** (common if draw.random() < 0.8 else draw.choice(powers)) for _ in range(3)]
    x, y, z = (c * s for c, s in zip(components, scales, strict=True))
    return (x, y, z), box


def reparametrised(draw: Random, components: Map, box: Box, axis: int) -> tuple[Map, Box]:
    """Another parameter in place of one: linear with any scale, or fractional linear with its pole outside."""
    (low, high), variable = box[axis], (T, H)[axis]
    if low is None or high is None or draw.random() < 0.5:
        size = Fraction(10) ** draw.choice((-150, -20, -2, 2, 20, 150))
        own, ends = variable / size, [None if e is None else e * size for e in (low, high)]
        if draw.random() < 0.5:
            own, ends = -own, [None if e is None else -e for e in reversed(ends)]
    else:
        pole = Fraction(draw.randint(5, 40), 4)  # u -> low + (high - low) u (1 - 1/pole) / (1 - u/pole) on [0, 1]
        own = low + (high - low) * variable * (1 - 1 / pole) / (1 - variable / pole)
        ends = [Fraction(0), Fraction(1)]
    both = [T, H]
    both[axis] = own
    x, y, z = (c.substitute(*both) for c in components)
    sides = [*box]
    sides[axis] = (ends[0], ends[1])
    return (x, y, z), (sides[0], sides[1])
