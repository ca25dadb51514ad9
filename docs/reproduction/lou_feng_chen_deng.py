"""Lou, Feng, Chen and Deng (2002): intersections of ideals, least squares, and a teapot of eight patches."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import comb, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from entries import Work
from figures import SIZE, openings
from scipy.linalg import eigh

import pas
from pas import Polynomial
from pas.algebra.monomials import exponents
from pas.designs import Body, Lid, PaperSpout, PrintedSpout

work = Work(
    "Lou, Feng, Chen and Deng (2002)",
    "The method of Groebner basis for constructing algebraic blending surfaces",
    "All surfaces that meet others with GC^k are an intersection of ideals; members by interpolation and least "
    "squares; a "
    "teapot.  Groebner bases are compared up to factors of their elements.",
)

# --- example 1: two hemispheres -------------------------------------------------------------------

BALLS = [("(x + 2)^2 + y^2 + z^2 - 4", "x + 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")]
P = [
    Polynomial("-16 + 28*x - 15*x^2 + x^3 + 2*x^4 + 9*y^2 - 9*x*y^2 + 9*z^2 - 9*x*z^2"),
    Polynomial("-16 + 36*x + 3*x^2 - 5*x^3 + 3*y^2 - 15*x*y^2 - 6*x^2*y^2 + 3*z^2 - 15*x*z^2 - 6*x^2*z^2"),
    Polynomial("-16 + 12*x - 3*x^2 + x^3 + 21*y^2 - 9*x*y^2 - 6*y^4 + 21*z^2 - 9*x*z^2 - 12*y^2*z^2 - 6*z^4"),
]
TWO = [
    Polynomial("-8 + 12*x + 6*x^2 - 11*x^3 - 3*x^4 + 3*x^5 + x^6"),
    Polynomial("-32 + 28*x - 29*x^2 + 27*y^2 + 27*z^2 - 4*x^3 + 8*x^4 + 2*x^5"),
]
COMMON = [("1/2", sqrt(3) / 2, 0), ("2/5", "4/5", 0), (-1, sqrt(3), 0), ("-4/5", "8/5", 0), (-2 + sqrt(2), sqrt(2), 0)]
PS1 = [(0, "1/2", 0), COMMON[0], COMMON[1], (1 - 1 / sqrt(2), 1 / sqrt(2), 0), *COMMON[2:]]
PS2 = list(PS1)
PS3 = [(0, 1, 0), *COMMON]
LINED = [("-x - 2" if h == "x + 2" else h) for _, h in BALLS]


@cache
def meeting() -> pas.Ideal:
    """All surfaces that meet both spheres with GC^2."""
    return pas.contact_ideal(BALLS[0], 2) & pas.contact_ideal(BALLS[1], 2)


def primitive(polynomials: Any) -> tuple[Polynomial, ...]:
    """Polynomials with whole coefficients without common factor, in an order of their own."""
    return tuple(sorted((p.primitive() for p in polynomials), key=str))


@cache
def space() -> pas.SolutionSpace:
    """The quartics, in the printed basis."""
    contacts = [(f, h) for (f, _), h in zip(BALLS, LINED, strict=True)]
    box = pas.SingleCell((-2, -3, -3), (1, 3, 3))
    return pas.solutions(contacts, 2, 4, box).restricted([(p,) for p in P])


@cache
def fitted(points: tuple[Any, ...]) -> pas.LeastSquares:
    """The member with the least sum of squares over |f|^2."""
    return space().least_squares(points)


def through() -> tuple[sympy.Rational, ...]:
    """The coefficients of the member through the first two points of PS1, the last one 1."""
    points = [(0, sympy.Rational(1, 2), 0), (sympy.Rational(1, 2), sympy.sqrt(3) / 2, 0)]
    rows = [[sympy.expand(p.to_sympy().subs(dict(zip("xyz", q, strict=True)))) for p in P] for q in points]
    (found,) = sympy.Matrix(rows).nullspace()
    return tuple(sympy.nsimplify(c / found[2]) for c in found)


def hemispheres(surface: pas.PiecewiseSurface) -> tuple[bool, int]:
    """Whether both contacts are proved, and the openings."""
    return all(v.proved for v in surface.certify().contacts), openings(surface.mesh(0.05))


# --- the teapot -----------------------------------------------------------------------------------

F3 = Polynomial("(x^2 + y^2)/121 + (z - 1)^2 - 1/100")
CONE = Polynomial("(z - 11/10)^2 - (x^2 + y^2)")
PLANE = Polynomial("z - 6/5")
RIM = (Fraction(11, 10), 0, 1)
ROOT, BEND = Polynomial("13 - 9*x + 2*z"), Polynomial("x + 8/3*(z - 6/5)")
WAIST = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
QUADRIC = Polynomial("4/9*(x^2 + y^2) + 25/36*z^2 - 1")
G0 = Polynomial("624 - 627*x + 135*x^2 - 424*z + 330*x*z - 80*z^2")
GD = Polynomial(
    "680076 - 412848*x - 511920*y^2 - 3378216*z + 2079360*x*z + 842400*y^2*z + 2038490*z^2 - 1928025*x*z^2 + "
    "1786300*z^3"
)
GE = Polynomial(
    "1364325462 - 635590386*x - 4532653080*y^2 + 1249360200*x*y^2 - 6640121892*z + 2973949920*x*z + 4211514000*y^2*z"
    " - 2176205555*z^2 + 7235982650*z^3"
)
SPOUT = PrintedSpout().printed
ORDER = ["1", "x", "x^2", "x^3", "y^2", "x*y^2", "z", "x*z", "x^2*z", "y^2*z", "z^2", "x*z^2", "z^3"]
DIGITS = [
    "-0.382086", "0.671121", "-0.390428", "0.0748303", "-0.124559", "0.093717", "-0.27378", "0.346645", "-0.10528",
    "-0.0386148", "-0.0905839", "0.062592", "-0.038205",
]  # fmt: skip


def lid_blends(height: str) -> pas.Ideal:
    """What meets the ellipsoid where it ends at a height, and the cone, both with GC^2."""
    return pas.contact_ideal((F3, Polynomial(f"z - ({height})")), 2) & pas.contact_ideal((CONE, PLANE), 2)


def cuts_the_dome(clip: str) -> bool:
    """Whether the plane z = height that a clip gives meets the ellipsoid at all."""
    height = -Polynomial(clip).at((0, 0, 0))
    return bool(F3.at((0, 0, height)) < 0)


def tops(cone: Polynomial, power: int) -> Fraction:
    """The factor a for which the cone and a (z - 6/5)^power make a knob that ends at z = 7/5."""
    return Fraction(str(-cone.at((0, 0, "7/5")) / PLANE.at((0, 0, "7/5")) ** power))


def has_gc2(power: int) -> bool:
    """Whether the cone and a multiple of (z - 6/5)^power have GC^2 for every multiple."""
    return PLANE**power in pas.contact_ideal((CONE, PLANE), 2)


def closes_the_body(factor: str) -> bool:
    """Whether the lower quadric with a factor of x^2 + y^2 gives the printed a = -209/324 for the upper one."""
    quadric = Polynomial(f"({factor})*(x^2 + y^2) + 25/36*z^2 - 1")
    seam = Polynomial("z - 2/5")
    return quadric + seam**2 * Fraction(-209, 324) == Body(lower=quadric).upper


def on_the_rim(point: tuple[Any, ...]) -> bool:
    """Whether a point of space lies where the lid's ellipsoid has its greatest circle."""
    return len(point) == 3 and F3.at(point) == 0 and point[2] == 1


@cache
def spouts() -> pas.Ideal:
    """All surfaces through both curves of the lower spout."""
    return pas.contact_ideal((QUADRIC, ROOT), 0) & pas.contact_ideal((WAIST, BEND), 0)


def units(polynomial: Polynomial) -> dict[str, float]:
    """Its coefficients by monomial, their squares of sum 1, with the sign of the printed ones."""
    given = {name: next(iter(Polynomial(name).coefficients())) for name in ORDER}
    found = {name: float(polynomial.coefficients().get(e, 0)) for name, e in given.items()}
    length = sqrt(sum(c * c for c in found.values()))
    return {name: c / (length if found["x"] > 0 else -length) for name, c in found.items()}


def quotient(polynomial: Polynomial) -> float:
    """The sum of squares at the nine points, over that of the coefficients."""
    values = [float(polynomial.at((x, 0, z))) for x, z in PaperSpout().lower_outline]
    return float(np.dot(values, values)) / sum(float(c) ** 2 for c in polynomial.coefficients().values())


@cache
def cubic(kept: bool) -> Polynomial:
    """The lower cubic: the printed one put into the ideal, or the one with the least quotient."""
    return (PrintedSpout if kept else PaperSpout)().cubics(Body())[0]


def away(polynomial: Polynomial) -> float:
    """The largest difference of a coefficient from the printed one."""
    return max(abs(c - float(d)) for c, d in zip(units(polynomial).values(), DIGITS, strict=True))


def differs_along_least_growth() -> bool:
    """Whether more than 95% of the squared length of what is printed less what is computed is along the direction of
    the next least quotient, both put into the ideal, beside the computed one and in the metric of the coefficients."""
    members = spouts().members(3)
    values = np.array([[float(p.at((x, 0, z))) for x, z in PaperSpout().lower_outline] for p in members])
    rows = np.array([[float(c) for c in p.row(3)] for p in members])
    sums, directions = eigh(values @ values.T, rows @ rows.T)
    parts = []
    for polynomial in (cubic(True), cubic(False)):
        own = np.linalg.lstsq(rows.T, np.array([float(c) for c in polynomial.row(3)]), rcond=None)[0]
        parts.append(np.linalg.solve(directions, own))
    least = int(np.argmax(np.abs(parts[1])))
    printed, computed = (p / p[least] for p in parts)
    growth = np.delete((printed - computed) ** 2, range(least + 1))
    return bool(np.all(np.diff(sums[least:]) > 0) and growth[0] > 0.95 * growth.sum())


def distance(factor: str) -> float:
    """How far the printed f1 is from the cubics that join a body with this factor of x^2 + y^2, by coefficients."""
    body = pas.contact_ideal((f"({factor})*(x^2 + y^2) + 25/36*z^2 - 1", ROOT), 0)
    members = (body & pas.contact_ideal((WAIST, BEND), 0)).members(3)
    rows = np.array([[float(c) for c in p.row(3)] for p in (*members, SPOUT)])
    nearest = np.linalg.lstsq(rows[:-1].T / np.linalg.norm(rows[:-1], axis=1), rows[-1], rcond=None)[0]
    return float(np.linalg.norm(rows[:-1].T / np.linalg.norm(rows[:-1], axis=1) @ nearest - rows[-1]))


@cache
def pot() -> pas.Teapot:
    """The teapot with the printed spout."""
    return pas.teapot("paper", spout=PrintedSpout())


def joint(first: str, second: str) -> int:
    """The order of a joint, if it is proved."""
    found = [(j, v) for j, v in zip(pot().solid.joints, pot().solid.verdicts, strict=True)]
    return next(j.order for j, v in found if {j.first, j.second} == {first, second} and v.proved)


def patches(*names: str) -> tuple[int, int]:
    """How many patches of these names the teapot has, and their highest degree."""
    found = {n: p for n, p in pot().solid.polynomials.items() if n.startswith(names)}
    return len(found), max(q.degree for p in found.values() for q in p)


def even_cubics() -> int:
    """The dimension of the cubics through both curves that are symmetric in y."""
    members = spouts().members(3)
    return len(members) - len([m for m in members if all(e[1] % 2 for e in m.coefficients())])


def of_order(power: int) -> bool:
    """Whether all surfaces of <g1, h1^power> n <g2, h2^power> have GC^2 with both."""
    clip = Polynomial("z - 109/100")
    common = pas.Ideal(F3, clip**power) & pas.Ideal(CONE, PLANE**power)
    return all(p in lid_blends("109/100") for p in common.groebner_basis())


def draw(folder: Path) -> None:
    """The hemispheres of figures 1 and 2, and the teapot."""
    pas.draw(space().through(PS1[:2]).member([1]), folder / "hemispheres_1.png", size=SIZE)
    for name, points in (("2a", PS1), ("2c", PS3)):
        pas.draw(fitted(tuple(points)).surface, folder / f"hemispheres_{name}.png", size=SIZE)
    pot().solid.mesh(1e-2).draw(folder / "teapot.png", size=SIZE)
    pot().lid.mesh(1e-2).draw(folder / "lid.png", size=SIZE)


READ = (
    "the copy that was read, by a machine, has -2 x^4 in p1 and, in one place or the other, other signs in p2; signs "
    "are what machines misread, so these are not counted as misprints"
)
SIGN = "the copy that was read has - 1249360200 x y^2, which is not counted as a misprint"
KNOB = "the knob must end at z = 7/5 with the printed a = 45/4"

work.agrees(
    "section 3", "free coefficients of degree 1 to 6, C(n+3, 3) - 1", tuple(comb(n + 3, 3) - 1 for n in range(1, 7)),
    lambda: tuple(len(exponents(n)) - 1 for n in range(1, 7)),
)  # fmt: skip
work.agrees("example 1", "two polynomials generate the ideal", True, lambda: pas.Ideal(*TWO) == meeting())
work.agrees("example 1", "Groebner basis p1, p2, p3", primitive(P), lambda: primitive(meeting().groebner_basis()), READ)
work.agrees("example 1", "lowest degree", 4, lambda: next(n for n in range(1, 9) if meeting().members(n)))
work.agrees("example 1", "degrees of freedom", 2, lambda: len(meeting().members(4)) - 1)
work.agrees(
    "example 1", "a, b, c through two points", (sympy.Rational(-105, 16), sympy.Rational(83, 16), 1), through,
    note="with f = a p1 + b p2 + c p3, as in the printed f",
)  # fmt: skip
work.agrees(
    "figure 1", "contacts have GC^2; openings", (True, 2),
    lambda: hemispheres(space().through(PS1[:2]).member([1])), picture="pictures/hemispheres_1.png", slow=True,
)  # fmt: skip
for name, points in (("2(a)", PS1), ("2(c)", PS3)):
    work.agrees(
        f"figure {name}", f"least squares at {len(points)} points: contacts have GC^2; openings", (True, 2),
        lambda points=points: hemispheres(fitted(tuple(points)).surface),
        picture=f"pictures/hemispheres_{name[0]}{name[2]}.png", slow=True,
    )  # fmt: skip
work.misprint(
    "figure 2", "different surfaces of the point sets PS1, PS2, PS3", 3,
    lambda: len({tuple(np.round(fitted(tuple(p)).coefficients, 9)) for p in (PS1, PS2, PS3)}),
    "PS1 and PS2 are printed with the same seven points, and a set of points has one surface; as there are three "
    "pictures "
    "of three sets, one of the two sets is wrong in print, and figure 2(b) cannot be made",
    lambda number: number == len({frozenset(p) for p in (PS1, PS2, PS3)}),
)  # fmt: skip
work.misprint(
    "section 4, lid", "h1", "z + 109/100",
    lambda: next(filter(cuts_the_dome, ("z + 109/100", "z - 109/100"))),
    "the plane must cut the ellipsoid f3, which lies between z = 9/10 and z = 11/10", cuts_the_dome,
)  # fmt: skip
work.misprint(
    "section 4, "
    "lid", "sign of the cone g2", CONE, lambda: next(c for c in (CONE, -CONE) if tops(c, 3) == Fraction(45, 4)),
    KNOB, lambda cone: tops(cone, 3) == Fraction(45, 4),
)  # fmt: skip
work.misprint(
    "section 4, lid", "exponent of h1, h2 in the ideal", 1, lambda: next(filter(of_order, range(1, 5))),
    "all members of the ideal must have GC^2 with the ellipsoid and the cone", of_order,
)  # fmt: skip
work.agrees(
    "section 4, lid", "number of the blend f2 in the Groebner basis", 2,
    lambda: 1 + [p.primitive() for p in lid_blends("109/100").groebner_basis()].index(Lid().blend(Body()).primitive()),
    note="of three, by leading terms; the only one of degree 2 in x and y",
)  # fmt: skip
work.misprint(
    "section 4, lid", "what the knob f1 is made from", "g1",
    lambda: next(n for n, g in (("g1", F3), ("g2", -CONE)) if tops(g, 3) == Fraction(45, 4)),
    KNOB + "; g1 is the ellipsoid", lambda name: tops({"g1": F3, "g2": -CONE}[name], 3) == Fraction(45, 4),
)  # fmt: skip
work.misprint(
    "section 4, lid", "exponent of (z - 6/5) in the knob f1", 1, lambda: next(filter(has_gc2, range(1, 5))),
    lambda: f"a (z - 6/5)^power must lie in <cone, (z - 6/5)^3>, and with power 1 it would be a = {tops(-CONE, 1)}",
    has_gc2,
)  # fmt: skip
work.agrees("section 4, lid", "a", Fraction(45, 4), lambda: tops(-CONE, 3))
work.agrees("section 4, lid", "patches, highest degree", (3, 4), lambda: patches("lid"), slow=True)
work.agrees(
    "section 4, lid", "orders of both joints; openings of the lid in figure 3", (2, 2, 0),
    lambda: (joint("lid knob", "lid blend"), joint("lid blend", "lid dome"), openings(pot().lid.mesh(1e-2))),
    picture="pictures/lid.png", slow=True,
)  # fmt: skip
work.misprint(
    "section 4, body", "factor of x^2 + y^2 in f2", "9/4", lambda: next(filter(closes_the_body, ("9/4", "4/9"))),
    "with it the upper quadric through the rim must have the printed a = -209/324", closes_the_body,
)  # fmt: skip
work.agrees("section 4, body", "heights of f2", (Fraction(-4, 5), Fraction(2, 5)), lambda: (Body().bottom, Body().seam))
work.misprint(
    "section 4, body", "the point p of the rim", (1, 1, 0, 1), lambda: (Body().rim, Fraction(0), Body().top),
    "it must be a point of space on the greatest circle of the lid's ellipsoid; (1.1, 0, 1) with a comma for a point",
    on_the_rim,
)  # fmt: skip
work.agrees(
    "section 4, body", "a", Fraction(-209, 324),
    lambda: Fraction(str((Body().upper - QUADRIC).coefficients()[0, 0, 2])),
)  # fmt: skip
work.agrees(
    "section 4, body", "patches, degree, order of the joint", (2, 2, 1),
    lambda: (*patches("body"), joint("body upper", "body lower")), slow=True,
)  # fmt: skip
for name, generator in (("first", G0), ("d", GD), ("e", GE)):
    work.agrees(
        "section 4, spout", f"the generator {name} lies in both ideals", True, lambda g=generator: g in spouts(),
        note=SIGN if name == "e" else "",
    )  # fmt: skip
work.agrees("section 4, spout", "free coefficients a, b, c, d, e of f1", 5, even_cubics)
work.agrees(
    "section 4, spout", "points for f1 and f2", (9, 10),
    lambda: (len(PaperSpout().lower_outline), len(PaperSpout().upper_outline)), note="of the ten, two are there twice",
)  # fmt: skip
work.agrees(
    "section 4, spout", "f1 as printed meets both curves, to six digits", True,
    lambda: distance("4/9") < 1e-6 and distance("9/4") > 1e-2,
    note=lambda: f"its coefficients are {distance('4/9'):.1e} from the nearest cubic that meets them exactly; with 9/4 "
    f"in place of 4/9 {distance('9/4'):.1e}",
)  # fmt: skip
work.differs(
    "section 4, spout", "13 coefficients of f1", tuple(map(float, DIGITS)), lambda: tuple(units(cubic(False)).values()),
    lambda: f"both make the sum of f(p)^2 over the squared length of the coefficients least: {quotient(SPOUT):.5e} as "
    f"printed, {quotient(cubic(True)):.5e} with the printed digits put into the ideal, {quotient(cubic(False)):.5e} "
    f"here; all coefficients are the same to {away(cubic(False)):.1e}, more than their last digit, as they differ "
    "along the direction in which the sum grows least",
    lambda: {
        "the sums are the same to a millionth": quotient(cubic(True)) < (1 + 1e-6) * quotient(cubic(False)),
        "no coefficient is further away than 5e-6": away(cubic(False)) < 5e-6,
        "they differ along the direction in which the sum grows least": differs_along_least_growth(),
    },
)  # fmt: skip
work.agrees(
    "section 4, spout", "patches, degree, order of the joint", (2, 3, 1),
    lambda: (*patches("spout"), joint("spout lower", "spout upper")), slow=True,
)  # fmt: skip
work.agrees("section 4, handle", "patches, degree", (1, 4), lambda: patches("handle"), slow=True)
work.agrees(
    "figure 4", "patches of the teapot", 8,
    lambda: len(pot().solid.polynomials) - len({"bottom disc", "mouth"} & set(pot().solid.polynomials)),
    note="a closed solid, all joints proved, with the printed spout; its bottom and its mouth are flat",
    picture="pictures/teapot.png", slow=True,
)  # fmt: skip
