"""Yu, Sun and Ma (2006): single surfaces by normal forms; counts of equations, surfaces, conditions of existence."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import sympy
from entries import Work
from figures import SIZE, openings

import pas
from pas import Polynomial

work = Work(
    "Yu, Sun and Ma (2006)",
    "Groebner basis methods for algebraic blending surfaces in CAGD",
    "A surface meets another along a curve with G^1 where normal forms of it and of three minors vanish: linear "
    "equations for its coefficients.  Surfaces are compared up to a factor.",
)

ELBOW = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + y^2 - 1", "z - 2")]
THREE = [("y^2 + z^2 - 1", "x - 2"), ("z^2 + x^2 - 1", "y - 2"), ("x^2 + y^2 - 1", "z - 2")]
CROSS = [(f, f"{v} {sign} 2") for f, v in (("y^2 + z^2 - 1", "x"), ("x^2 + z^2 - 1", "y")) for sign in "-+"]
FORK = [("y^4 + 2*y^2*z^2 + 6*y^2 + 9 + z^4 - 10*z^2", "x - 2"), ("y^2 + z^2 - 2", "x + 2")]
PRINTED = {
    "4.1": Polynomial("x^3 + z^3 + z*x^2 + x*y^2 + z*y^2 + z^2*x - 4*x^2 - 4*y^2 - 4*z^2 - 4*z*x + 3*x + 3*z + 4"),
    "4.2": Polynomial(
        "-28 + z^2*y*x + 4*x + z^3*x + 4*y + 3*y*x + x*y^3 + x*y^2*z + x^2*y*z + x^3*z - 4*z*y*x - 4*z*x^2 - 4*x^3"
        " - 4*y^2*x + 4*z + 3*z*x - 4*y^3 - 4*z*y^2 - 4*z^2*y + 3*z*y - 4*z^2*x - 4*y*x^2 + y*z^3 + y*x^3 + y^3*z"
        " + 12*y^2 + 12*z^2 + 12*x^2 - 4*z^3"
    ),
    "4.3": Polynomial("x^2*z^2 + 2*x^4 + 2*y^4 - 17*x^2 - 17*y^2 - 14*z^2 + y^2*x^2 + y^2*z^2 - z^4 + 47"),
    "4.4": Polynomial(
        "1260 - 176*z^2*y^2*x + 7*x^5 + 7*x^4 + 7*x^2 - 88*y^4*x + 7*z^2*x^2 - 169*y^2*x^2 + 1188*z^2*x + 484*y^2*x"
        " - 28*z^2*x^3 - 88*z^4*x - 28*y^2*x^3 - 1124*y^2 - 1604*x - 420*z^2"
    ),
}  # fmt: skip
CONTACTS = {"4.1": ELBOW, "4.2": THREE, "4.3": CROSS, "4.4": FORK}


@cache
def system(example: str, degree: int) -> pas.NormalFormSystem:
    """The normal form equations with G^1."""
    return pas.normal_form_system(CONTACTS[example], 1, degree)


def member(example: str) -> Polynomial:
    """The printed surface, less what keeps it from having G^1 with every contact: nothing if it has."""
    printed = PRINTED[example]
    ideals = [pas.contact_ideal(contact, 1) for contact in CONTACTS[example]]
    return printed - sum((ideal.normal_form(printed) for ideal in ideals), Polynomial(0))


def bases(example: str) -> tuple[tuple[Polynomial, ...], ...]:
    """The reduced Groebner bases of surfaces and clips."""
    return tuple(tuple(sorted(pas.Ideal(*contact).groebner_basis(), key=str)) for contact in CONTACTS[example])


def given(example: str) -> tuple[tuple[Polynomial, ...], ...]:
    """The pairs themselves, which are printed as their bases."""
    return tuple(tuple(sorted(map(Polynomial, contact), key=str)) for contact in CONTACTS[example])


def lowest(example: str) -> int:
    """The lowest degree of a surface that is regular along the curves and meets all contacts."""
    cell = pas.SingleCell()
    return next(n for n in range(1, 9) if pas.solutions(CONTACTS[example], 1, n, cell).regular)


def curvature_numerator() -> sympy.Expr:
    """grad^T adj(Hess) grad, from which the Gauss curvature is V / H^2."""
    gradient, hessian = sympy.Matrix(sympy.symbols("f_x f_y f_z")), sympy.Matrix(3, 3, second)
    return sympy.expand((gradient.T * hessian.adjugate() * gradient)[0])


def second(i: int, j: int) -> sympy.Symbol:
    """A second derivative."""
    return sympy.Symbol("f_" + "".join(sorted("xyz"[i] + "xyz"[j])))


PRINTED_V = sympy.sympify(
    "f_xx*f_yy*f_z**2 + f_xx*f_zz*f_y**2 + f_yy*f_zz*f_x**2 - 2*f_x*f_y*f_xy*f_zz - 2*f_x*f_z*f_xz*f_yy"
    " - 2*f_y*f_z*f_yz*f_xx + 2*f_x*f_y*f_xz*f_yz + 2*f_x*f_z*f_xy*f_yz + 2*f_y*f_z*f_xy*f_xz"
    " - f_x**2*f_yz**2 - f_y**2*f_xz**2 - f_z**2*f_xy**2"
)


def counter_example() -> pas.CurvatureContact:
    """The surfaces z = 0 and z = y^2 along the x axis."""
    return pas.curvature_contact("z", "z - y^2", ("z", "y"))


def curved() -> pas.CurvatureContact:
    """The surfaces z = x^2 and z = x^2 + y^3 along a parabola."""
    return pas.curvature_contact("z - x^2", "z - x^2 - y^3", ("z - x^2", "y"))


RELATIONS = ("H^2/V* = H*^2/V", "H^2/V = H*^2/V*")


def same_curvature(form: str) -> bool:
    """Whether a relation of H, V, H*, V* holds for a sphere of radius 2 and a multiple of its polynomial."""
    gradient, hessian = sympy.Matrix([4, 0, 0]), 2 * sympy.eye(3)
    h, v = gradient.dot(gradient), (gradient.T * hessian.adjugate() * gradient)[0]
    hs, vs = 9 * h, 81 * v
    return bool(h**2 / vs == hs**2 / v) if form == RELATIONS[0] else bool(h**2 / v == hs**2 / vs)


def conditions(degree: int) -> str:
    """When two perpendicular cylinders of any radii and distances have a common surface of a degree."""
    symbols = r1, r2, d1, d2 = sympy.symbols("r1 r2 d1 d2", positive=True)
    contacts = [(f"y^2 + z^2 - {r1}^2", f"x - {d1}"), (f"x^2 + z^2 - {r2}^2", f"y - {d2}")]
    cases = pas.existence(contacts, 1, degree, symbols).exists
    if any(not case.conditions for case in cases):
        return "always" if len(cases) > 1 else "in general"
    return " or ".join(" and ".join(f"{sign(c)} = 0" for c in case.conditions) for case in cases) or "never"


def is_product_of_degree_4() -> bool:
    """Whether f_1 f_2 + h_1^2 h_2^2 is in both ideals for r1 = 1, r2 = 1/2, d1 = 3, d2 = 2, and regular on the curves.

    Its gradient there is f_2 times that of f_1, and f_1 times that of f_2; the least of these factors is at z = 0.
    """
    (f1, h1), (f2, h2) = contacts = [
        tuple(map(Polynomial, pair)) for pair in (("y^2 + z^2 - 1", "x - 3"), ("x^2 + z^2 - 1/4", "y - 2"))
    ]
    met = all(f1 * f2 + h1**2 * h2**2 in pas.contact_ideal(contact, 1) for contact in contacts)
    return met and f2.at((3, 0, 0)) > 0 and f1.at((0, 2, 0)) > 0


def sign(condition: sympy.Expr) -> sympy.Expr:
    """A condition with r1^2 positive."""
    return condition if condition.coeff(sympy.Symbol("r1", positive=True), 2) > 0 else -condition


BOXES = {
    "4.1": ((-3, -3, -3), (2, 3, 2)),
    "4.2": ((-3, -3, -3), (2, 2, 2)),
    "4.3": ((-2, -2, -3), (2, 2, 3)),
    "4.4": ((-2, -4, -4), (2, 4, 4)),
}
"""Where the figures' surfaces are meshed: the circles of 4.4 reach up to z = 3."""


@cache
def surface(example: str) -> pas.PiecewiseSurface:
    """The printed surface with the pipes that it meets, positive outside these."""
    contacts = [(f, h if "-" in h else f"-({h})") for f, h in CONTACTS[example]]
    space = pas.solutions(contacts, 1, PRINTED[example].degree, pas.SingleCell(*BOXES[example]))
    return space.restricted([(PRINTED[example],)]).member([1 if example == "4.2" else -1])


def figure(example: str) -> tuple[bool, int]:
    """Whether all contacts are proved, and the openings of the sheet that meets the pipes."""
    proved = all(verdict.proved for verdict in surface(example).certify().contacts)
    return proved, openings(surface(example).mesh(0.05))


def draw(folder: Path) -> None:
    """The figures' surfaces."""
    for example in CONTACTS:
        pas.draw(surface(example), folder / f"yu_sun_ma_{example[-1]}.png", size=SIZE)


NAMES = {"4.1": "cubic", "4.2": "quartic", "4.3": "quartic", "4.4": "quintic"}
COUNTS = {"4.1": (40, 20), "4.2": (88, 35), "4.3": (106, 35)}
DIMENSIONS = {"4.1": 1, "4.2": 2}
FACTOR = "the two quartics that meet the conditions have the factor (x - 2)^2 in common, so they are singular there"
OPENINGS = {"4.1": 2, "4.2": 3, "4.3": 4, "4.4": 3}

work.agrees("section 3", "V, so that V/H^2 is the Gauss curvature", PRINTED_V, curvature_numerator)
work.misprint(
    "theorem 3.3, "
    "proof", "what follows from condition 3", RELATIONS[0], lambda: next(filter(same_curvature, RELATIONS)),
    "a sphere of radius 2 and three times its polynomial are the same surface, of the same curvature; the relation "
    "must "
    "hold for them", same_curvature,
)  # fmt: skip
work.differs(
    "theorem 3.3", "conditions 1 to 3 give G^2", True, lambda: counter_example().gc2 or not counter_example().holds,
    lambda: "z = 0 and z = y^2 meet the conditions along the x axis and have no G^2 there "
    f"(normal form {counter_example().membership} modulo <z, y^3>): equal Gauss curvature is enough only where the "
    f"normal "
    "curvature along the curve is not 0",
    lambda: {
        "they meet the conditions": counter_example().holds,
        "they have no G^2": not counter_example().gc2 and counter_example().membership != 0,
        "the normal curvature along the curve is 0": sympy.diff(sympy.Symbol("y") ** 2, "x", 2) == 0,
        "where it is not 0, z = x^2 and z = x^2 + y^3 meet them and have G^2": curved().holds and curved().gc2,
    },
)  # fmt: skip
for example in CONTACTS:
    section, degree = f"example {example}", PRINTED[example].degree
    work.agrees(
        section, "Groebner bases of <f_i, h_i>", given(example), lambda example=example: bases(example),
        note="each pair is its own reduced basis" if example == "4.1" else "",
    )  # fmt: skip
    if example == "4.2":
        work.misprint(
            section, "degree of the surface", 2, lambda: lowest("4.2"),
            "a surface of that degree must exist, and the printed polynomial have it",
            lambda n: system("4.2", n).dimension > 0 and PRINTED["4.2"].degree == n,
        )  # fmt: skip
    else:
        work.agrees(section, f"lowest degree (a {NAMES[example]})", degree, lambda example=example: lowest(example),
                    note=FACTOR if example == "4.4" else "")  # fmt: skip
    if example in COUNTS:
        work.agrees(
            section, "linear equations, unknowns", COUNTS[example],
            lambda e=example, n=degree: (system(e, n).distinct, system(e, n).unknowns),
            note="the coefficients of the four normal forms over all pairs that are different and not zero"
            if example == "4.1" else "",
        )  # fmt: skip
    if example in DIMENSIONS:
        what = "families of solutions" if example == "4.2" else "solutions up to a factor (unique)"
        work.agrees(section, what, DIMENSIONS[example], lambda e=example, n=degree: system(e, n).dimension)
    if example == "4.4":
        work.agrees(
            section, "f_1 is two cylinders", Polynomial(FORK[0][0]),
            lambda: Polynomial("(y^2 + (z - 2)^2 - 1)*(y^2 + (z + 2)^2 - 1)"),
        )  # fmt: skip
        work.agrees(
            section, "g is symmetric about the planes xy and xz", True,
            lambda: all(b % 2 == c % 2 == 0 for _, b, c in PRINTED["4.4"].coefficients()),
        )  # fmt: skip
    work.agrees(section, f"g, of degree {degree}", PRINTED[example], lambda example=example: member(example))
    work.agrees(
        f"figure {example[-1]}", "all contacts have G^1; openings", (True, OPENINGS[example]),
        lambda example=example: figure(example), picture=f"pictures/yu_sun_ma_{example[-1]}.png", slow=True,
        note="in the box of +-4 there is one more sheet, which meets none of the pipes" if example == "4.4" else "",
    )  # fmt: skip
work.agrees("remark 2", "condition for a cubic", "d1**2 - d2**2 + r1**2 - r2**2 = 0", lambda: conditions(3))
work.differs(
    "remark 2", "condition for a blending surface of any degree", "d1**2 - d2**2 + r1**2 - r2**2 = 0",
    lambda: conditions(4),
    lambda: f"the condition is that of degree 3; of degree 4 there are surfaces {conditions(4)}, such as "
    "f_1 f_2 + h_1^2 h_2^2; of degree 2 there are none",
    lambda: {
        "of degree 2 there are none": conditions(2) == "never",
        "f_1 f_2 + h_1^2 h_2^2 has G^1 with both where the printed condition does not hold": is_product_of_degree_4(),
    },
)  # fmt: skip
