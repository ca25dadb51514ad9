"""Xu, Chen and Deng: free parameters by least energy and by points inside; the corner of three pipes in six pieces."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from itertools import combinations
from operator import mul
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from entries import Work
from figures import SIZE, euler_characteristics, openings

import pas
from pas import Polynomial

work = Work(
    "Xu, Chen and Deng",
    "Determination of free parameters in algebraic surface blending",
    "Solutions are combinations of generators of syzygy modules; their coefficients, of sum 1, make the thin-plate "
    "energy "
    "over a box least, with points inside.",
)

ROOT = Path(__file__).parents[2]
GENERATORS = {
    1: [
        "4*y^2 + 4*z^2 - 16 + (6 - 3*x)*(x + 1)^2", "-4*x*(y^2 + z^2 - 4) - 3*(x + 1)^2",
        "(y^2 + z^2 - 1)*(x + 1)^2", "(y^2 + z^2 - 1)*(y^2 + z^2 - 4)",
    ],
    2: [
        "-8*x*(y^2 + 1/2*z^2 - 1) + (3*z^2 - 2)*(x - 1)^2", "16*x*(y^2 + 1/2*z^2 - 1) + (3*y^2 - 2)*(x - 1)^2",
        "(y^2 + 2*z^2 - 2)*(y^2 + 1/2*z^2 - 1)", "(2*x^2 + 4*x + 2)*(y^2 + 1/2*z^2 - 1)",
    ],
    3: [
        "(x + y - 4)*(y^2 + z^2 - 1) + (x + y)*(x - 2)^2",
        "(z^2 - 4*y + 11)*(y^2 + z^2 - 1) + (z^2 - 4*x - 5)*(x - 2)^2", "(y^2 - 4*y + 4)*(x - 2)^2",
        "(y^2 - 4*y + 4)*(y^2 + z^2 - 1) + (y^2 - 4*y + 4)*(x - 2)^2", "(x^2 + z^2 - 1)*(x - 2)^2",
    ],
}  # fmt: skip
CONTACTS = {
    1: [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "-x - 1")],
    2: [("2*y^2 + z^2 - 2", "x - 1"), ("y^2 + 2*z^2 - 2", "-x - 1")],
    3: [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")],
}
DOMAINS = {1: (1, 2, 2), 2: (1, "3/2", "3/2"), 3: (2, 2, 2)}
BOXES = {1: ((-1, -3, -3), (1, 3, 3)), 2: ((-1, -2, -2), (1, 2, 2)), 3: ((-3, -3, -3), (2, 2, 3))}


def fraction(value: Any) -> sympy.Rational:
    """A number of flint or of Python for sympy."""
    return sympy.Rational(str(value))


@cache
def ideal(example: int) -> pas.Ideal:
    """All surfaces that meet both contacts with GC^1."""
    first, second = (pas.contact_ideal(contact, 1) for contact in CONTACTS[example])
    return first & second


@cache
def quartics(example: int) -> pas.SolutionSpace:
    """All quartics that meet both contacts."""
    return pas.solutions(CONTACTS[example], 1, 4, pas.SingleCell())


def rows(example: int) -> sympy.Matrix:
    """The printed generators in terms of a basis of all quartics."""
    found = [quartics(example).coordinates((Polynomial(g),)) for g in GENERATORS[example]]
    return sympy.Matrix([[fraction(v) for v in row] for row in found])


def plate(example: int) -> pas.ThinPlate:
    """The energy over the printed domain."""
    upper = [Fraction(v) for v in DOMAINS[example]]
    return pas.ThinPlate(pas.Box([-v for v in upper], upper))


@cache
def energy(example: int) -> sympy.Matrix:
    """The products of second derivatives of the printed generators, which need not be independent."""
    matrix = quartics(example).energy_matrix(plate(example))
    return rows(example) * sympy.Matrix([[fraction(v) for v in row] for row in matrix]) * rows(example).T


def reduced(example: int) -> tuple[sympy.Matrix, sympy.Matrix]:
    """H and b of the energy 1/2 x^T H x + b^T x + const, where the last coefficient is 1 less the others."""
    k = energy(example)
    n = k.rows - 1
    h = sympy.Matrix(n, n, lambda i, j: k[i, j] - k[i, n] - k[n, j] + k[n, n])
    return h, sympy.Matrix(n, 1, lambda i, _: k[i, n] - k[n, n])


def optimum(example: int) -> tuple[sympy.Expr, ...]:
    """The coefficients at which the energy is stationary; those that are free keep their names."""
    h, b = reduced(example)
    x = sympy.symbols(f"a1:{h.rows + 1}")
    solved = sympy.solve(list(h * sympy.Matrix(x) + b), list(reversed(x)), dict=True)[0]
    return tuple(sympy.expand(solved.get(v, v)) for v in x)


def relation(example: int) -> tuple[sympy.Rational, ...]:
    """The whole numbers for which the generators' sum with them is 0; () if there are none."""
    null = rows(example).T.nullspace()
    return tuple(null[0] / sympy.gcd(tuple(null[0])) * sympy.sign(null[0][0])) if null else ()


def generate(example: int) -> bool:
    """Whether the printed generators generate the ideal of all solutions."""
    return pas.Ideal(*GENERATORS[example]) == ideal(example)


def enough(example: int) -> str:
    """Which of the generators do it alone."""
    first, others = GENERATORS[example][:2], GENERATORS[example][2:]
    if pas.Ideal(*first) == ideal(example):
        return "g1 and g2 alone do"
    found = [f"g{i}" for i, g in enumerate(others, 3) if pas.Ideal(*first, g) == ideal(example)]
    return f"g1, g2 and one of {', '.join(found)} do"


@cache
def surface(example: int, *coefficients: Any) -> pas.PiecewiseSurface:
    """A combination of the first generators, with the sign that makes it negative inside."""
    terms = [(Polynomial(g), Fraction(str(c))) for g, c in zip(GENERATORS[example], coefficients, strict=False)]
    total = sum((g * c for g, c in terms), Polynomial(0))
    space = pas.solutions(CONTACTS[example], 1, total.degree, pas.SingleCell(*BOXES[example]))
    for sign in (1, -1):
        found = space.restricted([(total,)]).member([sign])
        if all(v.proved for v in found.certify().contacts):
            return found
    return found


def whole(x: tuple[Any, ...]) -> tuple[Any, ...]:
    """The coefficients with the last one, which makes their sum 1."""
    return (*x, 1 - sum(x))


def figure(example: int, *coefficients: Any) -> tuple[bool, int]:
    """Whether both contacts are proved, and the openings of the largest sheet."""
    found = surface(example, *coefficients)
    return all(v.proved for v in found.certify().contacts), openings(found.mesh(0.05))


POINT = ("-1/4", "-1/4", 0)
FOUR = tuple(map(sympy.Rational, ("0.3387104474", "-0.2071533438", "-0.04550660490", "-0.2473380977")))


@cache
def constrained() -> tuple[sympy.Rational, ...]:
    """The coefficients of least energy among those with f <= 0 at the point, where there it is 0."""
    values = [fraction(Polynomial(g).at(POINT)) for g in GENERATORS[3]]
    free = whole(optimum(3))
    assert sum(v * a for v, a in zip(values, free, strict=True)) > 0, "the point must be outside before"
    sides = sympy.Matrix([[1] * 5, values])
    system = sympy.BlockMatrix([[energy(3), sides.T], [sides, sympy.zeros(2, 2)]]).as_explicit()
    return tuple(system.LUsolve(sympy.Matrix([0] * 5 + [1, 0]))[:5])


def energy_of(x: tuple[Any, ...]) -> float:
    """The energy of coefficients."""
    return float((sympy.Matrix([x]) * energy(3) * sympy.Matrix(x))[0] / 2)


def claims(found: pas.PiecewiseSurface) -> tuple[bool, bool]:
    """Whether a surface is not refuted to be closed but for its openings, and not to be one sheet."""
    verdicts = found.certify()
    return tuple(v.status is not pas.Status.REFUTED for v in (verdicts.enclosed, verdicts.one_sheet))


# --- example 4: three pipes, six tetrahedra -------------------------------------------------------

H = sympy.symbols("h1:4", positive=True)
h1, h2, h3 = H
Z = [(h1, h2, h3), (-h1, -h2, -h3)]
V = [(h1, 0, -h3), (0, h2, -h3), (-h1, h2, 0), (-h1, 0, h3), (0, -h2, h3), (h1, -h2, 0)]
PI = [
    "h2*h3*x - 2*h1*h3*y + h1*h2*z", "-2*h2*h3*x + h1*h3*y + h1*h2*z", "-h2*h3*x - h1*h3*y + 2*h1*h2*z",
]  # fmt: skip
FILES = {"a": "-0.2", "b": "-0.1", "c": "0"}


def plane(i: int) -> sympy.Expr:
    """The plane through Z1, Z2 and V_i, with the coefficient of x in PI."""
    x = sympy.Matrix(sympy.symbols("x y z"))
    volume = sympy.Matrix([list(x), Z[0], V[i]]).det()
    given = sympy.sympify(PI[i % 3], dict(zip(("h1", "h2", "h3"), H, strict=True)))
    return sympy.expand(volume * given.coeff(x[0]) / sympy.expand(volume).coeff(x[0]))


def printed_plane(i: int) -> sympy.Expr:
    """PI as expressions."""
    return sympy.expand(sympy.sympify(PI[i % 3], dict(zip(("h1", "h2", "h3"), H, strict=True))))


def axis_of(patch: int) -> int:
    """The pipe, 1 to 3, whose clip plane holds a face of the tetrahedron T_i = Z1 Z2 V_(i-1) V_i."""
    corners = [*Z, V[patch - 2], V[patch - 1]]
    return next(k + 1 for k in range(3) if any(all(c[k] == H[k] for c in face) for face in combinations(corners, 3)))


def greatest_radius() -> sympy.Expr:
    """The largest r / h for which the circle lies in its face of T_1, for equal h."""
    a, b, c = (sympy.Matrix([p[1], p[2]]).subs({h2: 1, h3: 1}) for p in (Z[0], V[5], V[0]))
    edges = ((a, b), (b, c), (c, a))
    return min(abs(sympy.Matrix.hstack(p, q - p).det()) / (q - p).norm() for p, q in edges)


def leaves_its_face(radius: sympy.Expr) -> bool:
    """Whether some point of the circle is outside of its face of T_1, for equal h; at angles 1/200 of a turn apart."""
    a, b, c = (sympy.Matrix([p[1], p[2]]).subs({h2: 1, h3: 1}) for p in (Z[0], V[5], V[0]))
    angles = np.linspace(0, 2 * np.pi, 200)
    circle = float(radius) * np.array([np.cos(angles), np.sin(angles)])
    sides = []
    for p, q in ((a, b), (b, c), (c, a)):
        start, along = (np.array(w, dtype=float).ravel() for w in (p, q - p))
        sides.append(along[0] * (circle[1] - start[1]) - along[1] * (circle[0] - start[0]))
    return bool(np.min(np.array(sides) * np.sign(np.mean(sides))) < 0)


def least_energy(name: str) -> float:
    """The least energy of members of sum 1 with G_1 <= 0 at both points, over all choices of which of them are 0."""
    found, value = optimum_of(name), FILES[name]
    matrix = np.array(found.space.energy_matrix(found.plate), dtype=float)
    at = [[float(g[0].at(p)) for g in found.basis] for p in (("1/2",) * 3, (value,) * 3)]
    least = np.inf
    for active in ((), (0,), (1,), (0, 1)):
        sides = np.array([[1.0] * len(matrix), *(at[i] for i in active)])
        size = len(matrix) + len(sides)
        system = np.zeros((size, size))
        system[: len(matrix), : len(matrix)], system[len(matrix) :, : len(matrix)] = matrix, sides
        system[: len(matrix), len(matrix) :] = sides.T
        member = np.linalg.lstsq(system, np.eye(size)[len(matrix)], rcond=None)[0][: len(matrix)]
        if np.all(np.array(at) @ member <= 1e-9 * np.abs(member).max()):
            least = min(least, float(member @ matrix @ member) / 2)
    return least


@cache
def corner() -> pas.SolutionSpace:
    """All solutions of the lowest degree for h = 3/5, r = 1/5 and k = 1."""
    return pas.solutions([pas.Pipe(a, "1/5", "3/5") for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], 1)


def consistent() -> bool:
    """Whether alpha_i = (G_(i+1) - G_i) / pi_i^2 are polynomials for all members, and their sum with pi_i^2 is 0."""
    planes = [Polynomial(re.sub("h[123]", "(3/5)", text)) for text in PI] * 2
    for patches in corner().basis:
        alphas = [divmod((patches[(i + 1) % 6] - patches[i]).raw, (planes[i] ** 2).raw) for i in range(6)]
        total = sum((Polynomial.from_raw(a) * p**2 for (a, _), p in zip(alphas, planes, strict=True)), Polynomial(0))
        if any(not r.is_zero() for _, r in alphas) or total != 0:
            return False
    return True


def six() -> tuple[int, int]:
    """The tetrahedra of the corner, and the vertices that are in all of them."""
    cells = corner().partition.cells
    return len(cells), len(set.intersection(*map(set, cells)))


@cache
def optimum_of(name: str) -> pas.Blend:
    """The optimum of a problem file of the published corner."""
    return pas.read_problem(ROOT / f"examples/corners/published_{name}.toml").solve()


def held(name: str) -> tuple[int, bool]:
    """The degree, and whether G_1 <= 0 at both points."""
    surface, point = optimum_of(name).surface, FILES[name]
    values = [surface.polynomials[0].at(p) for p in (("1/2",) * 3, (point,) * 3)]
    return surface.degree, all(v <= 1e-9 for v in values)


def clean(name: str) -> str:
    """What is refuted of an optimum, with its energy."""
    found = [f"{v.claim} ({v.reason})" for v in optimum_of(name).certificate.verdicts if v.status is pas.Status.REFUTED]
    return f"energy {optimum_of(name).energy:.4g}; refuted: " + "; ".join(found)


def draw(folder: Path) -> None:
    """The surfaces of figures 1, 2 and 4."""
    shown = {
        "1a": (1, *whole(optimum(1))),
        "1b": (1, *least_cubic()),
        "2": (2, *at(1)),
        "4a": (3, 1),
        "4b": (3, *constrained()),
    }
    for name, arguments in shown.items():
        pas.draw(surface(*arguments), folder / f"xu_chen_deng_{name}.png", size=SIZE)


def at(t: int) -> tuple[Any, ...]:
    """The printed coefficients of example 2 for a value of t."""
    return whole((t, 2 * t - sympy.Rational(36207, 81682), sympy.Rational(4634, 40841)))


def at_symbol() -> tuple[sympy.Expr, ...]:
    """The second and the third coefficient of example 2 with the first one, t, free."""
    return 2 * sympy.Symbol("a1") - sympy.Rational(36207, 81682), sympy.Rational(4634, 40841)


PRINTED_H = (234112, 218368, 213248, 218368, 391552, 192128, 213248, 192128, sympy.Rational(9 * 470656, 15))


def least_cubic() -> tuple[sympy.Rational, ...]:
    """The coefficients of g1 and g2 alone, of sum 1 and least energy."""
    k = energy(1)[:2, :2]
    found = k.LUsolve(sympy.ones(2, 1))
    return tuple(found / sum(found))


for example in (1, 2, 3):
    work.agrees(
        f"example {example}", "all printed generators meet both surfaces with G^1", True,
        lambda e=example: all(Polynomial(g) in ideal(e) for g in GENERATORS[e]),
    )  # fmt: skip
    if example != 2:
        work.agrees(
            f"example {example}", "they generate all solutions", True, lambda e=example: generate(e),
            note=lambda e=example: enough(e),
        )  # fmt: skip
    if example == 1:
        work.agrees(
            "example 1", "solutions of degree 2 and 3", (0, 2), lambda: tuple(len(ideal(1).members(n)) for n in (2, 3)),
        )  # fmt: skip
        work.agrees("section 3.1", "9 H", PRINTED_H, lambda: tuple(9 * v for v in reduced(1)[0]))
        work.agrees("section 3.1", "9 b", (-218368, -270592, -253184), lambda: tuple(9 * v for v in reduced(1)[1]))
        work.agrees(
            "section 3.1", "17070338 x at the optimum", (-146624, 6476809, 11008845),
            lambda: tuple(17070338 * v for v in optimum(1)),
        )  # fmt: skip
        work.agrees(
            "figure 1.a", "contacts have G^1; openings", (True, 2), lambda: figure(1, *whole(optimum(1))),
            picture="pictures/xu_chen_deng_1a.png", slow=True,
        )  # fmt: skip
        work.agrees(
            "figure 1.b", "the least cubic: contacts have G^1; openings", (True, 2), lambda: figure(1, *least_cubic()),
            note=lambda: "its coefficients are " + " and ".join(map(str, least_cubic())),
            picture="pictures/xu_chen_deng_1b.png", slow=True,
        )  # fmt: skip
    if example == 2:
        work.differs(
            "example 2", "independent generators", 4, lambda: rows(2).rank(),
            lambda: "the sum of the generators with the numbers "
            "" + ", ".join(map(str, relation(2))) + " is 0; of degree 4 "
            f"there are {quartics(2).dimension} independent solutions, so these generators are not all",
            lambda: {
                "that sum is 0": sum(map(mul, map(Polynomial, GENERATORS[2]), map(int, relation(2)))) == 0,
                "there are more independent solutions": quartics(2).dimension > rows(2).rank(),
            },
        )  # fmt: skip
        work.agrees(
            "example 2", "x at the optimum, t free", (sympy.Symbol("a1"), *at_symbol()), lambda: optimum(2),
            note="t is free because of that sum: it changes the coefficients, but not the surface",
        )  # fmt: skip
        work.agrees(
            "figure 2", "t = 1: contacts have G^1; openings", (True, 2), lambda: figure(2, *at(1)),
            picture="pictures/xu_chen_deng_2.png", slow=True,
        )  # fmt: skip
work.agrees(
    "example 3",
    "g1 is the only cubic, there is no quadric",
    (0, 1),
    lambda: tuple(len(ideal(3).members(n)) for n in (2, 3)),
)
work.agrees(
    "figure 3", "the optimum without points: closed; one sheet", (False, False),
    lambda: claims(surface(3, *whole(optimum(3)))), note="it is too thin in places to be meshed",
)  # fmt: skip
work.misprint(
    "example 3", "a1 .. a5 with f(-1/4, -1/4, 0) <= 0", FOUR, constrained,
    lambda: "there must be five numbers of sum 1, and no others that satisfy the constraint may have less energy; "
    "with a5 = 1 "
    f"- a1 - a2 - a3 - a4 the printed four have energy {energy_of(whole(FOUR)):.0f}, the five "
    f"{energy_of(constrained()):.2f}",
    lambda x: len(x) == 5 and sum(x) == 1 and energy_of(x) <= energy_of(constrained()) < energy_of(whole(FOUR)),
)  # fmt: skip
work.agrees(
    "figure 4.a", "the cubic: contacts have G^1; openings", (True, 2), lambda: figure(3, 1),
    picture="pictures/xu_chen_deng_4a.png", slow=True,
)  # fmt: skip
work.differs(
    "figure "
    "4.b", "the optimum with the point: closed; one sheet", (True, True), lambda: claims(surface(3, *constrained())),
    lambda: "its contacts are proved, but it has other sheets in the box of +-3 (Euler characteristics "
    f"{', '.join(map(str, euler_characteristics(surface(3, *constrained()).mesh(0.05))))}); as the printed "
    f"coefficients are "
    "not the optimum's, the picture is of another surface",
    lambda: {
        "its contacts are proved": all(v.proved for v in surface(3, *constrained()).certify().contacts),
        "it has other sheets": len(euler_characteristics(surface(3, *constrained()).mesh(0.05))) > 1,
        "the printed coefficients have more energy": energy_of(whole(FOUR)) > energy_of(constrained()),
    },
    picture="pictures/xu_chen_deng_4b.png", slow=True,
)  # fmt: skip
work.agrees(
    "example 4", "planes pi_1 .. pi_6", tuple(map(printed_plane, range(6))), lambda: tuple(map(plane, range(6)))
)
work.agrees("figure 5", "tetrahedra; vertices that all have in common", (6, 2), six)
work.agrees("example 4", "the tetrahedron T_1 ends at the clip of pipe", 1, lambda: axis_of(1))
for what, printed in (("index of f and F in G_i for i = 3", 3), ("index of f in G_i^j for i = 3", 1)):
    work.misprint(
        "example 4", what, printed, lambda: axis_of(3),
        "the tetrahedron T_3 must have a face in the clip plane of the pipe that its patch meets; the index is (i+1)/2",
        lambda index: axis_of(3) == index,
    )  # fmt: skip
work.differs(
    "example 4", "r / h must be below, for equal h", sympy.Integer(1), greatest_radius,
    lambda: "h > r > 0 lets the circle cross the edges of its face of T_1, where another patch begins; it lies in "
    "the face "
    f"for r < h {greatest_radius()}, that is {float(greatest_radius()):.4f} h; the printed 1/5 and 3/5 satisfy this",
    lambda: {
        "a circle that is larger by little leaves the face, and one that is smaller does not": leaves_its_face(
            greatest_radius() * sympy.Rational(101, 100)
        )
        and not leaves_its_face(greatest_radius() * sympy.Rational(99, 100)),
        "(1/5) / (3/5) is below": sympy.Rational(1, 3) < greatest_radius(),
    },
)  # fmt: skip
work.agrees(
    "example 4", "lowest degree, generators of that degree (k = 1, h = 3/5, r = 1/5)", (3, 3),
    lambda: (corner().degree, corner().dimension),
)  # fmt: skip
work.agrees("example 4", "sum of alpha_i pi_i^2 is 0", True, consistent)
for name, value in FILES.items():
    work.agrees(
        f"figure 6, {value}", "degree; G_1 <= 0 at both points", (3, True), lambda name=name: held(name),
        picture=f"../../examples/corners/pictures/published_{name}.png", slow=True,
    )  # fmt: skip
    work.differs(
        f"figure 6, {value}", "one clean surface that meets the three pipes", True,
        lambda name=name: optimum_of(name).certificate.proved, lambda name=name: clean(name),
        lambda name=name: {
            "it has the least energy": abs(least_energy(name) / optimum_of(name).energy - 1) < 1e-6,
            "something is refuted of it": any(
                v.status is pas.Status.REFUTED for v in optimum_of(name).certificate.verdicts
            ),
        }, slow=True,
    )  # fmt: skip
