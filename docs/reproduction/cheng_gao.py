"""Cheng and Gao: a Bezier curve from point to point of two boundary curves; quadrics, a helicoid, closed surfaces."""

from __future__ import annotations

from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from entries import Work
from figures import SIZE, euler_characteristics

import pas
from pas.parametric.generatrix.quadric import Quadric, QuadricKind
from pas.parametric.generatrix.shape import FOUR

work = Work(
    "Cheng and Gao",
    "",
    "Blends of two surfaces of any kind: for each s a Bezier curve leads from one boundary curve to the other, its "
    "inner control points in the tangent planes. "
    "Most figures are printed without numbers; they are made again with numbers chosen here, and what the text says "
    "of them "
    "is checked.",
)

GENERATRIX = Path(__file__).parents[2] / "examples" / "parametric" / "generatrix"
PICTURES = "../../examples/parametric/generatrix/pictures"
s, t, u, d, l1, l2, v, a, x, y, z = sympy.symbols("s t u delta l1 l2 v alpha x y z")
theta = sympy.Symbol("theta", real=True)
Vector = sympy.Matrix


def in_tangent_plane(crossed: bool) -> sympy.Expr:
    """The product of the vector of formula (3) or (4) with the normal, of any length."""
    n, w, q = (Vector(sympy.symbols(f"{name}1:4")) for name in "nwq")
    slant = sympy.Symbol("lambda")
    along = n.cross(w) if crossed else n.cross(q)
    vector = sympy.sqrt(1 - slant**2) * (n.cross(along) if crossed else n.cross(w)) + slant * along
    return sympy.expand(vector.dot(n))


# --- the worked example of section 3.3 ------------------------------------------------------------

HELICOID = Vector([v * sympy.sin(a), v * sympy.cos(a), 2 + a])
CUBIC = x**3 + y + z**2 + 4 * z + 5
C2 = Vector([u, -17 - u**3, 2])
"""In u, whose derivative in s is delta = 21^(1/3) - 17^(1/3)."""

PRINTED_C22 = C2 + l2 * Vector([24 * d * u**2, 8, -(9 * d * u**4 + 1)])
PRINTED_P = Vector(
    [
        -12 * t * (1 - t) ** 2 * s + 3 * t**2 * (1 - t) * (u + 24 * d * u**2) + t**3 * u,
        4 * (1 - t) ** 3 * s + 12 * t * (1 - t) ** 2 * s - 3 * t**2 * (1 - t) * (9 + u**3) - t**3 * (17 + u**3),
        (1 - t) * ((1 - t) * (2 + t) + 3 * t**2 * (1 - 9 * d * u**4)) + 2 * t**3,
    ]
)


def on_cubic(expression: Any) -> Any:
    """An expression in x, y, z along the second boundary."""
    return expression.subs(dict(zip((x, y, z), C2, strict=True)))


def normal() -> sympy.Matrix:
    """The gradient of the cubic along its boundary."""
    return Vector([on_cubic(CUBIC.diff(w)) for w in (x, y, z)])


def across() -> sympy.Matrix:
    """N x C2', with the derivative in s."""
    return (normal().cross(C2.diff(u)) * d).applyfunc(sympy.expand)


def first_boundary() -> sympy.Matrix:
    """C1 and, as a second column, C11 of formula (4) with -dr/dalpha."""
    there = {v: 4 * s, a: 0}
    return Vector.hstack(HELICOID.subs(there), (HELICOID - l1 * HELICOID.diff(a)).subs(there))


def bezier(c22: sympy.Matrix) -> sympy.Matrix:
    """Formula (5) for l1 = l2 = 1."""
    controls = (first_boundary()[:, 0], first_boundary()[:, 1], c22, C2)
    parts = [c * sympy.binomial(3, i) * t**i * (1 - t) ** (3 - i) for i, c in enumerate(controls)]
    total = sum(parts, sympy.zeros(3, 1))
    return total.subs({l1: 1, l2: 1}).applyfunc(sympy.expand)


def leaves_along_cross_product(component: int, value: sympy.Expr) -> bool:
    """Whether a component of P leaves the second boundary along N x C2', as formula (3) has it."""
    slope = -sympy.diff(value, t).subs(t, 1) / 3
    return sympy.expand(slope - across()[component]) == 0


def tangent_but_not_crossed() -> tuple[bool, bool]:
    """Whether the printed C22 - C2 lies in the cubic's tangent plane, and is orthogonal to the boundary."""
    vector = (PRINTED_C22 - C2) / l2
    return tuple(sympy.expand(vector.dot(w)) == 0 for w in (normal(), C2.diff(u)))


@cache
def solved(name: str) -> pas.GeneratrixBlend:
    """The blend of an example file."""
    return pas.read_parametric_problem(GENERATRIX / f"{name}.toml").blend()


def same_way() -> bool:
    """Whether the two printed boundaries run in the same direction, by the vectors from their ends to their starts."""
    roots = [-sympy.root(n, 3) for n in (21, 17)]
    second = C2.subs(u, roots[1]) - C2.subs(u, roots[0])
    first = first_boundary()[:, 0].subs(s, 1) - first_boundary()[:, 0].subs(s, 0)
    return bool(first.dot(second) > 0)


# --- section 5.1: a cone and a turned ellipsoid ---------------------------------------------------

CONE = -(x**2) / 9 + y**2 / 4 + z**2
ELLIPSOID = x**2 + y**2 / 9 + z**2 / 16 - 1
ON_CONE = Vector([t, 2 * t / 3 * sympy.cos(theta), t / 3 * sympy.sin(theta)])
BELOW = 491776 - 57056 * sympy.sin(theta) ** 2 + 96721 * sympy.sin(theta) ** 4
UNDER = 1040 - 768 * sympy.cos(theta) - 311 * sympy.sin(theta) ** 2
PRINTED_T = 36 * sympy.sqrt(UNDER / BELOW)


def turned(angle: sympy.Expr) -> sympy.Expr:
    """F2 of formula (10) at (x, y, z), with its centre in the origin."""
    c, n = sympy.cos(angle), sympy.sin(angle)
    return ELLIPSOID.subs({x: c * x - n * y, y: n * x + c * y}, simultaneous=True)


def equation(angle: sympy.Expr) -> sympy.Poly:
    """Formula (10) for points of the cone, as a polynomial in t."""
    return sympy.Poly(turned(angle).subs(dict(zip((x, y, z), ON_CONE, strict=True)), simultaneous=True), t)


def root() -> sympy.Expr:
    """The positive root."""
    leading, constant = equation(sympy.pi / 4).coeff_monomial(t**2), equation(sympy.pi / 4).coeff_monomial(1)
    below = sympy.expand(1296 * leading).subs(sympy.cos(theta) ** 2, 1 - sympy.sin(theta) ** 2)
    return 36 * sympy.sqrt(-constant / sympy.expand(below))


def solves(value: sympy.Expr, angle: sympy.Expr = sympy.pi / 4) -> bool:
    """Whether t satisfies formula (10) exactly at angles with rational cosine and sine."""
    places = [(sympy.Rational(3, 5), sympy.Rational(4, 5)), (sympy.Rational(-5, 13), sympy.Rational(12, 13))]
    puts = [{sympy.cos(theta): c, sympy.sin(theta): n} for c, n in places]
    return all(sympy.simplify(equation(angle).as_expr().subs(t, value).subs(put)) == 0 for put in puts)


def with_example(sense: int) -> float:
    """How far the curve of the example file is from 36 / sqrt(1040 + sense 768 cos - 311 sin^2), at most."""
    points = solved("cone_and_ellipsoid").boundaries[0](np.linspace(0, 1, 101))
    cosine, sine = 3 * points[:, 1] / (2 * points[:, 0]), 3 * points[:, 2] / points[:, 0]
    return float(np.abs(points[:, 0] - 36 / np.sqrt(1040 + sense * 768 * cosine - 311 * sine**2)).max())


# --- figures --------------------------------------------------------------------------------------

PIPE, CROSSING = "y^2 + z^2 - 1", "x^2 + z^2 - 1"
CLOSED = {
    QuadricKind.CYLINDER: (PIPE, "x + 3"),
    QuadricKind.CONE: ("(x + 6)^2/9 - y^2/4 - z^2", "x + 3"),
    QuadricKind.PARABOLOID: ("y^2 + z^2/2 + x + 2", "x + 3"),
    QuadricKind.ELLIPSOID: ("(x + 4)^2/4 + y^2 + z^2/2 - 1", "x + 3"),
    QuadricKind.ONE_SHEET: ("y^2 + z^2/2 - (x + 5)^2/4 - 1", "x + 3"),
    QuadricKind.TWO_SHEETS: ("(x + 6)^2/4 - y^2 - z^2/2 - 1", "x + 3"),
}
"""A quadric of each kind with a closed plane section, and the plane."""


def section(kind: QuadricKind) -> pas.Boundary:
    """The end of a quadric."""
    return pas.plane_section(*CLOSED[kind])


def branch(quadric: str, other: str, number: int) -> pas.Boundary:
    """A closed curve in which two quadrics meet, on the first."""
    return pas.quadric_intersection(quadric, other)[number].on(0)


@cache
def figure(number: str) -> pas.GeneratrixBlend:
    """The blend of a figure."""
    shape = pas.GeneratrixShape
    if number in ("4 left", "4 right"):
        wave = pas.ShapeFunction.cosine(1, 2 if number == "4 left" else 4)
        ends = pas.plane_section(PIPE, "x + 3"), pas.plane_section("x^2 + z^2 - 1/4", "y - 3")
        return pas.generatrix_blend(*ends, shape(l1=wave, l2=1 if number == "4 left" else 3))
    if number == "5":
        middle = ("cos(2*pi*s)/4", "6 + cos(2*pi*s)", "sin(2*pi*s)")
        return pas.generatrix_blend(
            pas.plane_section(PIPE, "x + 4"), pas.plane_section(PIPE, "x - 4"), shape(2, 2, middle=middle)
        )
    if number in ("6 left", "6 right"):
        circle = ("2 + 7/10*cos(2*pi*s)", "2 + 7/10*cos(2*pi*s)", "sin(2*pi*s)")
        ends = branch(PIPE, "x^2/16 + y^2/9 - 1", 0), branch(CROSSING, "x^2/16 + y^2/9 - 1", 0)
        return pas.generatrix_blend(*ends, shape(l1=3.8, l2=3.8, middle=circle if number == "6 right" else None))
    if number in ("8", "9", "10"):
        first = QuadricKind.ELLIPSOID if number == "9" else QuadricKind.CONE
        second = {
            "8": ("z^2 + y^2/2 - (x - 5)^2/4 - 1", "x - 3"),
            "9": ("x^2/2 + (y - 4)^2 + z^2 - 1", "y - 7/2"),
            "10": ("(z - 2)^2 - x^2/2 - y^2/3 - 1", "z - 9/2"),
        }[number]
        return pas.blend_quadrics(*CLOSED[first], *second)
    if number == "11":
        ends = (
            branch(CLOSED[QuadricKind.ELLIPSOID][0], "4*y^2 + 3*z^2 - 1", 0),
            branch("x^2/2 + (y - 4)^2 + z^2 - 1", "4*x^2 + 3*z^2 - 1", 1),
        )
        return pas.generatrix_blend(*ends)
    if number == "12":
        ends = (
            branch("y^2 + z^2 - x^2/4 - 1", "(x - 8)^2 - z^2/4 - 16", 0),
            branch("z^2/2 + y^2 - 1", "x - 9 - y^2/2", 0),
        )
        return pas.generatrix_blend(*ends)
    ends = pas.iso_curve(tube(), t=2), pas.iso_curve(ring(), t=0)
    return pas.generatrix_blend(*(pas.Boundary.on_parametric(end, (-pi, pi)) for end in ends))


ANGLES = (-pi, pi)
SPINE = Vector([t**2 + 8, t + 7, 2 - t])
RADIUS = t**2 * sympy.sin(theta) ** 2 + sympy.cos(theta) + 2
FIRST = Vector([0, 1, 1]) / sympy.sqrt(2)
SECOND = SPINE.diff(t).cross(FIRST) / sympy.sqrt(2 + 4 * t**2)


def tube() -> pas.ParametricSurface:
    """Formula (12) with the printed C and r, and unit vectors normal to C'."""
    triples = (tuple(str(c.subs(theta, sympy.Symbol("h"))) for c in w) for w in (SPINE, FIRST, SECOND))
    centre, first, second = triples
    return pas.tube(centre, str(RADIUS.subs(theta, sympy.Symbol("h"))), first, second, angle=True, domain=(0, 2))


def ring() -> pas.ParametricSurface:
    """A torus in front of the end t = 2 of the tube."""
    angle = sympy.Symbol("h")
    along, up = SPINE.diff(t).subs(t, 2) / sympy.sqrt(18), FIRST
    centre = SPINE.subs(t, 2) + 8 * along - 9 * up
    across = along.cross(up) * 4 * sympy.sin(angle)
    points = centre + (9 + 4 * sympy.cos(angle)) * (sympy.cos(t) * up + sympy.sin(t) * along) + across
    return pas.ParametricSurface(*map(str, points), domain=(ANGLES, ANGLES))


def turns_back(at: int = 0) -> sympy.Expr:
    """The part of the tube's derivative in t along C' at a value of t, in multiples of C'."""
    surface = SPINE + RADIUS * (FIRST * sympy.cos(theta) + SECOND * sympy.sin(theta))
    along = SPINE.diff(t).subs(t, at)
    return sympy.expand(surface.diff(t).subs(t, at).dot(along) / along.dot(along))


def radius_of_curvature(at: int) -> sympy.Expr:
    """That of C."""
    first, second = (SPINE.diff(t, n).subs(t, at) for n in (1, 2))
    return first.norm() ** 3 / first.cross(second).norm()


def holds(verdict: pas.Verdict) -> bool:
    """Whether it is proved or measured."""
    return verdict.status in (pas.Status.PROVED, pas.Status.HOLDS_MEASURED)


def judged(number: str) -> tuple[bool, bool]:
    """Whether both contacts are proved or measured, and whether the surface is regular and does not cross itself."""
    found = figure(number).certificate
    return all(map(holds, found.contacts)), holds(found.regular) and holds(found.simple)


@cache
def pipes_facing(opposed: bool) -> pas.GeneratrixBlend:
    """Two ends of a pipe, the curve of one run through the other way or not."""
    first, second = (pas.plane_section(PIPE, plane) for plane in ("x + 3", "x - 3"))
    return pas.generatrix_blend(first, second.turned(opposed, 0.0), pas.GeneratrixShape(1, 1), align=False)


def facing(opposed: bool) -> bool:
    """Whether that blend is regular and does not cross itself."""
    found = pipes_facing(opposed).certificate
    return holds(found.regular) and holds(found.simple)


def past_cylinder() -> tuple[bool, bool]:
    """Whether the blend of figure 5 keeps clear of a pipe of radius 1 around the z axis, and the one without C0."""
    blends = figure("5"), figure("5").with_shape(middle=None)
    return tuple(bool(np.hypot(*b.mesh().points[:, :2].T).min() > 1) for b in blends)


@cache
def three() -> pas.SphereBlend:
    """Three closed surfaces joined through a sphere."""
    ends = [pas.plane_section("y^2 + z^2 - 1/4", "x - 3"), pas.plane_section("x^2 + z^2 - 1/2", "y + 3")]
    return pas.blend_through_sphere([*ends, pas.plane_section("x^2 + y^2 - z^2/9", "z - 3")], (0, 0, 0), 1)


def draw(folder: Path) -> None:
    """The figures that are not among the examples."""
    pas.draw(pipes_facing(True), folder / "cheng_gao_3.png", size=SIZE)
    for number in ("4 left", "4 right", "5", "6 left", "6 right", "8", "9", "10", "11", "12", "13"):
        more = {
            "5": [pas.elliptic_cylinder(angle=True).with_domain((ANGLES, (-4, 4)))],
            "13": [tube().with_domain(((0, 1.7), ANGLES)), ring().with_domain(((0.8, 5.5), ANGLES))],
        }
        name = "cheng_gao_" + number.replace(" ", "_")
        pas.draw(
            [figure(number), *more[number]] if number in more else figure(number), folder / f"{name}.png", size=SIZE
        )


THROUGH = pas.ShapeFunction.through([(0, 1), ("1/2", 3), (1, 2)])


def is_blended(kind: QuadricKind) -> bool:
    """Whether a quadric of a kind is joined with a pipe, both contacts proved."""
    blend = pas.generatrix_blend(section(kind), pas.plane_section(PIPE, "x - 3"))
    return Quadric(CLOSED[kind][0], "q").kind is kind and all(c.proved for c in blend.certificate.contacts)


def least_radius() -> sympy.Expr:
    """The least r on a grid of [0, 2] x [0, 2 pi)."""
    places = [(sympy.Rational(i, 2), sympy.pi * j / 6) for i in range(5) for j in range(12)]
    return min(RADIUS.subs({t: p, theta: q}) for p, q in places)


# --- rows -----------------------------------------------------------------------------------------

work.agrees("formula (3)", "T_i . N_i, for all lambda and C' = N x w", 0, lambda: in_tangent_plane(crossed=True))
work.agrees(
    "formula (4)", "T_i . N_i, for all lambda and V = N x w, C' = N x q", 0, lambda: in_tangent_plane(crossed=False)
)
work.agrees("section 3.3", "C1 and C11", (0, 4 * s, 2, -4 * s * l1, 4 * s, 2 - l1),
            lambda: tuple(map(sympy.expand, first_boundary().T)))  # fmt: skip
work.agrees("section 3.3", "F(C2(s))", 0, lambda: sympy.expand(on_cubic(CUBIC)))
work.agrees("section 3.3", "N(s)", (3 * u**2, 1, 8), lambda: tuple(normal()))
work.agrees("formula (7)", "(C22 - C2) / l2, x", 24 * d * u**2, lambda: across()[0])
for number, name in ((1, "y"), (2, "z")):
    printed = sympy.expand((PRINTED_C22 - C2)[number] / l2)
    work.misprint(
        "formula (7)", f"(C22 - C2) / l2, {name} (delta = 21^(1/3) - 17^(1/3))", printed,
        lambda number=number: across()[number],
        "formula (3) with lambda = 0 makes it N x C2', orthogonal to C2'; the factor delta of C2' is missing in "
        + ("8 l2" if name == "y" else "1, in 9 delta u^4 + 1"),
        lambda value, number=number: sympy.expand(value - across()[number]) == 0,
    )  # fmt: skip
work.agrees(
    "formula (7)", "as printed: in the tangent plane; orthogonal to the curve", (True, False), tangent_but_not_crossed,
    note="so the surface (8) meets the cubic with G^1 all the same, but along another vector than formula (3) has",
)  # fmt: skip
work.agrees(
    "formula (8)",
    "P(s, t) from the printed (6) and (7)",
    tuple(map(sympy.expand, PRINTED_P)),
    lambda: tuple(bezier(PRINTED_C22)),
)
for number, name in ((1, "y"), (2, "z")):
    work.misprint(
        "formula (8)", f"P(s, t), {name}", sympy.expand(PRINTED_P[number]),
        lambda number=number: bezier(C2 + l2 * across())[number],
        "it has the error of formula (7): at t = 1 it must leave "
        "along N x C2'", lambda value, number=number: leaves_along_cross_product(number, value),
    )  # fmt: skip
work.differs(
    "section 3.3", "C1 and C2 run the same way, as figure 3 demands", True, same_way,
    lambda: "C1 runs from y = 0 to 4 and C2 from y = 4 to 0; the certificate of the blend as printed says: "
    f"{solved('helicoid_twisted').certificate.sense.status.value}, "
    f"{solved('helicoid_twisted').certificate.sense.reason.split(';')[0]}",
    lambda: {
        "the printed blend is found to be twisted": not holds(solved("helicoid_twisted").certificate.sense),
        "no claim fails with C2 turned round": not solved("helicoid").certificate.failed,
    },
    slow=True,
)  # fmt: skip
work.agrees(
    "figure 2", "with C2 turned round: claims that fail", (),
    lambda: tuple(v.claim for v in solved("helicoid").certificate.failed),
    picture=f"{PICTURES}/helicoid.png", slow=True,
)  # fmt: skip
work.agrees(
    "figure 3", "two pipes, regular and without crossings: curves the same way; opposed", (True, False),
    lambda: (facing(False), facing(True)), picture="pictures/cheng_gao_3.png", slow=True,
)  # fmt: skip
work.agrees("section 4", "degree of l(s) through three data pairs, and its values there", (2, 1, 3, 2),
            lambda: (len(THROUGH.coefficients) - 1, *(round(float(THROUGH(p)), 12) for p in (0, 0.5, 1))))  # fmt: skip
work.agrees("section 4", "l(theta) at 0 and pi, for lmin = 1, lmax = 3", (1.0, 3.0),
            lambda: tuple(round(float(pas.ShapeFunction.cosine(1, 3)(p)), 12) for p in (0, 0.5)))  # fmt: skip
for number in ("4 left", "4 right", "8", "9", "10", "11", "12", "13"):
    work.agrees(
        f"figure {number.replace(' ', ', ')}", "both contacts G^1; regular and without crossings", (True, True),
        lambda number=number: judged(number), picture=f"pictures/cheng_gao_{number.replace(' ', '_')}.png", slow=True,
    )  # fmt: skip
    if number == "4 right":
        work.agrees(
            "figure 5", "clear of the cylinder: with C0; without", (True, False), past_cylinder,
            picture="pictures/cheng_gao_5.png", slow=True,
        )  # fmt: skip
        for side, whole in (("left", False), ("right", True)):
            work.agrees(
                f"figure 6, {side}", "both contacts G^1; regular and without crossings", (True, whole),
                lambda side=side: judged(f"6 {side}"), picture=f"pictures/cheng_gao_6_{side}.png", slow=True,
            )  # fmt: skip
        work.agrees(
            "section 5.1", "kinds of closed quadrics that are blended", 6,
            lambda: sum(map(is_blended, CLOSED)), slow=True,
        )  # fmt: skip
        work.agrees("figure 7", "shape values that sliders change", 4, lambda: len(FOUR))
work.agrees(
    "section 5.1", "F1(S(t, theta))", 0, lambda: sympy.simplify(CONE.subs(dict(zip((x, y, z), ON_CONE, strict=True))))
)
work.agrees("section 5.1", "degree of formula (10) in t", 2, lambda: equation(sympy.pi / 4).degree())
work.misprint(
    "formula (11)", "t as a function of theta", PRINTED_T, root,
    "F2 of formula (10), turned by pi/4, must vanish at S(t, theta); the printed root is that of the ellipsoid "
    "turned the "
    "other way, 36 / sqrt(1040 + 768 cos - 311 sin^2) in another form", solves,
)  # fmt: skip
work.agrees("formula (11)", "it solves (10) for alpha = -pi/4", True, lambda: solves(PRINTED_T, -sympy.pi / 4))
work.agrees(
    "formula (11)", "the example file has the curve of (11); that of (10)", (True, False),
    lambda: tuple(with_example(sense) < 1e-9 for sense in (1, -1)), picture=f"{PICTURES}/cone_and_ellipsoid.png",
)  # fmt: skip
work.agrees("section 5.2", "least r(t, theta) for 0 <= t <= 2 is positive: r at (0, pi)", 1,
            least_radius)  # fmt: skip
work.differs(
    "section 5.2", "derivative in t of the surface (12) at t = 0, along C': positive for all theta", True,
    lambda: bool(min(turns_back().subs(theta, sympy.pi * j / 6) for j in range(12)) > 0),
    lambda: f"it is {turns_back()} times C', which vanishes where (2 + cos theta) sin theta = 1: C has the radius of "
    f"curvature "
    "1 there, and r is larger; the surface is blended at its other end, t = 2, where it is regular",
    lambda: {
        "it vanishes there": sympy.expand(turns_back() - 1 + (2 + sympy.cos(theta)) * sympy.sin(theta)) == 0,
        "the radius of curvature of C at t = 0 is 1": radius_of_curvature(0) == 1,
        "r exceeds it": RADIUS.subs({t: 0, theta: 0}) > radius_of_curvature(0),
        "the derivative is positive at t = 2": min(turns_back(2).subs(theta, sympy.pi * j / 6) for j in range(12)) > 0,
    },
)  # fmt: skip
work.agrees(
    "figure 14", "three surfaces through a sphere: Euler characteristic", -1,
    lambda: euler_characteristics(three().mesh(size=(48, 24)))[0], note="a sphere with three openings, welded",
    picture=f"{PICTURES}/three_pipes.png", slow=True,
)  # fmt: skip
