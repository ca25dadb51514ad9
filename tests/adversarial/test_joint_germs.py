"""What a solid looks like around a curve, against its membership at points beside the curve, told exactly.

The curve is the z-axis, and the surfaces through it are x = 0 and y p(z) = c x^m q(z) with p, q > 0: at
x = +-epsilon they are crossed at known rational heights, however closely they touch.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from pas import Polynomial
from pas.algebra.curve import SpaceCurve
from pas.algebra.roots import middle_of
from pas.solid import Solid, patch
from pas.solid.arcs import AlongCurve, arcs
from pas.solid.germs import Sheets
from pas.solid.tree import Atom, Tree
from pas.solid.truths import LeafTree

X, Y, Z = (Polynomial(v) for v in "xyz")
NAMES = ("A", "B", "C")
EPSILON = Fraction(1, 10**25)


def surface(random: Random) -> Polynomial:
    """A surface through the z-axis, at times with a factor or a power that changes nothing near it."""
    p, q = (Z * Z * random.randint(0, 2) + random.randint(1, 3) for _ in range(2))
    power, c = random.randint(1, 4), random.choice((-2, -1, 0, 1, 2))
    found = random.choice((X, Y * p - X**power * q * c, Y * p - X**power * q * c, Y * p - X**power * q * c))
    found *= random.choice((1, 1, X * X + 1, Z - Fraction(1, 3), found * found))
    return found * random.choice((1, -1))


def body(random: Random, depth: int) -> Solid:
    """A random tree of such surfaces, and of some planes across the curve or beside it."""
    if depth == 0:
        plane = random.choice((Z + X - 1, Z * Z - X - 2, X + 1))
        walls = [random.choice((surface(random), plane, -plane)) for _ in range(random.randint(0, 2))]
        return patch(random.choice(NAMES), surface(random), *walls)
    a, b = body(random, depth - 1), body(random, depth - 1)
    return random.choice((a | b, a | b, a & b, a - b))


def holds(tree: Tree, point: tuple[Fraction, ...], turned: tuple[str, Polynomial] | None = None) -> bool:
    """Membership of a point on no surface; with a face and a sheet, its inequalities that change there turned round."""
    if isinstance(tree, Atom):
        inside = (tree.function.at(point) < 0) != tree.outside
        return inside != (turned is not None and tree.face == turned[0] and changes(tree.function, turned[1]))
    parts = [holds(part, point, turned) for part in tree.parts]
    return any(parts) if tree.union else all(parts)


def changes(polynomial: Polynomial, sheet: Polynomial) -> bool:
    """Whether a polynomial changes its sign on a sheet: it is a factor an odd number of times."""
    return sum(p for f, p in polynomial.raw.factor()[1] if Polynomial.from_raw(f).primitive() == sheet.primitive()) % 2


def height(sheet: Polynomial, x: Fraction, z: Fraction) -> Fraction:
    """Where a surface that is linear in y has its zero."""
    low = sheet.at((x, 0, z))
    return -low / (sheet.at((x, 1, z)) - low)


def beside(sheets: list[Polynomial], number: int, side: int, z: Fraction) -> list[tuple[Fraction, ...]]:
    """Two points just below and just above a sheet (in y, or in x for x = 0), on one side of the curve."""
    q = sheets[number]
    if q.primitive() == X:
        return [(s * EPSILON**9, side * EPSILON, z) for s in (-1, 1)]
    x = side * EPSILON
    own = height(q, x, z)
    others = [abs(height(p, x, z) - own) for i, p in enumerate(sheets) if i != number and p.primitive() != X]
    step = min([*others, EPSILON]) / 2
    return [(x, own + s * step, z) for s in (-1, 1)]


def expected(tree: Tree, sheets: list[Polynomial], z: Fraction) -> set[tuple[int, int, frozenset[str]]]:
    """Borders: sheet, side of the curve in x (in y for x = 0), names."""
    found = set()
    for number, sheet in enumerate(sheets):
        for side in (-1, 1):
            points = beside(sheets, number, side, z)
            plain = [holds(tree, p) for p in points]
            if plain[0] != plain[1]:
                names = (n for n in NAMES if [holds(tree, p, (n, sheet)) for p in points] != plain)
                found.add((number, side, frozenset(names)))
    return found


def check(number: int) -> int:
    """Compare all arcs of one random body; how many borders there were."""
    random = Random(number)
    tree = body(random, random.randint(1, 3)).tree
    curve, reading = SpaceCurve(X, Y), LeafTree(tree)
    sheets = Sheets(curve.whole, reading.polynomials)
    count = 0
    for arc in arcs(sheets, reading, AlongCurve(reading.leaves, curve, lambda: None), NAMES):
        assert arc.unknown is None
        z = middle_of(arc.point.balls(256)[2])
        found = set()
        for border in arc.borders:
            q = sheets.polynomials[border.ray.sheet]
            along = 1 if q.primitive() == X else 0
            direction = curve.form.coefficients()
            # grad q x grad form at the curve
            slope = [q.diff(i).at((0, 0, Fraction(int(z.p), int(z.q)))) for i in range(3)]
            a = [direction.get(e, 0) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
            field = [slope[(i + 1) % 3] * a[(i + 2) % 3] - slope[(i + 2) % 3] * a[(i + 1) % 3] for i in range(3)]
            found.add((border.ray.sheet, border.ray.side * (1 if field[along] > 0 else -1), border.names))
        assert found == expected(tree, sheets.polynomials, Fraction(int(z.p), int(z.q))), number
        count += len(found)
    return count


@pytest.mark.parametrize("block", range(4))
def test_borders_are_those_beside_the_curve(block):
    assert sum(check(100 * block + n) for n in range(15)) > 15


@pytest.mark.slow
def test_many_borders_are_those_beside_the_curve():
    assert sum(check(n) for n in range(1000, 4000)) > 3000
