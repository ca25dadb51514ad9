"""Perez-Diaz and Sendra (2003): all parametric blends; Hermite interpolation, weights, eleven inputs with times."""

from __future__ import annotations

import json
from functools import cache
from itertools import combinations, permutations
from math import factorial, prod
from pathlib import Path
from typing import Any

import sympy
from entries import Work
from flint import fmpq, fmpq_mat

import pas
from pas import RationalFunction as R
from pas.algebra.roots import in_one
from pas.parametric.data import contact_order
from pas.parametric.series import rounded_roots

work = Work(
    "Perez-Diaz and Sendra (2003)",
    "Computing all parametric solutions for blending parametric surfaces",
    "Rational surfaces are met along their curves h = 0, 1, ... with all derivatives up to k: by Hermite interpolation "
    "(algorithm 1) and by weights (algorithm 2).  Long polynomials are compared as rational functions; they are in "
    "`perez_diaz_sendra.json`.  The printed times are of a Pentium III in 2003, of the algorithms alone; ours "
    "are with the check of their contacts.",
)

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples" / "parametric"
PRINTED = json.loads((HERE / "perez_diaz_sendra.json").read_text(encoding="utf-8"))
PICTURES = "../../examples/parametric/pictures"
ORDERS = {"example 1": 2, "example 2": 2, "example 3": 1, "input I": 2}
TABLE = {
    "I": (2, 2, (5, 18), (2, 2), "0.149", "0.295"),
    "II": (2, 8, (2, 2), (2, 2), "0.488", "0.226"),
    "III": (2, 5, (2, 6), (2, 2), "0.230", "0.035"),
    "IV": (2, 4, (4, 3), (2, 3), "0.510", "0.045"),
    "V": (3, 3, (5, 2, 4), (4, 2, 2), "0.580", "0.760"),
    "VI": (3, 1, (2, 2, 3), (2, 2, 3), "0.130", "0.120"),
    "VII": (4, 2, (2, 2, 2, 2), (2, 2, 2, 1), "0.300", "0.370"),
    "VIII": (4, 1, (3, 2, 2, 1), (2, 1, 1, 1), "0.215", "0.215"),
    "IX": (5, 2, (2, 2, 3, 3, 2), (2, 2, 1, 2, 2), "0.425", "1.700"),
    "X": (5, 1, (2, 2, 2, 1, 2), (2, 2, 2, 1, 1), "0.270", "1.150"),
    "XI": (6, 3, (2, 2, 1, 1, 1, 2), (1, 1, 1, 1, 1, 1), "1.115", "4.965"),
}
"""Table 1: n, k, degrees of surfaces and of curves, seconds of both algorithms."""


@cache
def data(name: str) -> pas.BlendingData:
    """The surfaces and values of an example or an input."""
    stem = name.replace(" ", "_") + ".toml"
    folder = EXAMPLES if (EXAMPLES / stem).exists() else HERE / "inputs"
    return pas.read_parametric_problem(folder / stem).data


@cache
def hermite(name: str, k: int) -> pas.ParametricSurface:
    """The output of algorithm 1, its components worked out."""
    surface = pas.hermite_blend(data(name), k).surface
    assert surface.components
    return surface


def weights(n: int, k: int, u: tuple[str, ...]) -> tuple[R, ...]:
    """The functions f_i of theorem 7 as they are printed, with the exponent k + 1, for the values 0 .. n - 1."""
    h, found = R("h"), []
    for i in range(1, n + 1):
        low, high = range(1, i - 1), [j for j in range(max(i - 1, 1), n + 1) if j != i]
        factors = [h - (j - 1) for j in low] + [R(str(j - 1)) - h for j in high]
        above = prod((f ** (k + 1) for f in factors), start=R(u[i - 1]))
        found.append(above / (above + (R("1") - R(u[i - 1])) * (h - (i - 1)) ** (k + 1)))
    return tuple(found)


def algorithm_2(name: str, k: int, u: tuple[str, ...] = ()) -> tuple[R, ...]:
    """The output of algorithm 2 as it is printed; u_i = 1/2 if not given."""
    surfaces = data(name).surfaces
    f = weights(len(surfaces), k, u or ("1/2",) * len(surfaces))
    return tuple(
        sum(
            (g * s.components[axis] for g, s in zip(f[1:], surfaces[1:], strict=True)),
            f[0] * surfaces[0].components[axis],
        )
        for axis in range(3)
    )


weighted = cache(algorithm_2)


def reached(components: Any, name: str, k: int) -> tuple[int, ...]:
    """The order of contact, up to k, with each of the surfaces."""
    pairs = zip(data(name).values, data(name).surfaces, strict=True)
    return tuple(
        min(contact_order(a, b, v, k) for a, b in zip(components, s.components, strict=True)) for v, s in pairs
    )


def degree(components: Any, axis: int) -> int:
    """The greatest degree in t (0) or h (1)."""
    return max(f.degrees[axis] for f in components)


def terms(components: Any) -> int:
    """The monomials of all numerators and denominators."""
    return sum(len(p.to_dict()) for f in components for p in (f.numerator, f.denominator))


def bounds(name: str, k: int) -> tuple[int, int, int, int]:
    """The printed bounds of the degrees in t and h, of both algorithms."""
    surfaces = data(name).surfaces
    n, (alpha, beta) = len(surfaces), (max(s.degrees[axis] for s in surfaces) for axis in (0, 1))
    return alpha * n * (k + 1), n * (k + 1) - 1, n * alpha, n * ((n - 1) * (k + 1) + beta)


def vandermonde(values: tuple[int, ...], k: int, size: int) -> fmpq_mat:
    """The derivatives of order 0 .. k of the powers of h below `size` at the values."""
    rows = [
        [fmpq(factorial(p), factorial(p - j)) * fmpq(s) ** (p - j) if p >= j else fmpq(0) for p in range(size)]
        for s in values
        for j in range(k + 1)
    ]
    return fmpq_mat(rows)


def determinant(values: tuple[int, ...], k: int) -> int:
    """Of the system of lemma 3, without sign."""
    return abs(int(vandermonde(values, k, len(values) * (k + 1)).det().p))


def differences(values: tuple[int, ...], k: int, pairs: Any = combinations) -> int:
    """The product of the differences to the power (k + 1)^2, over all pairs of values."""
    return prod(abs(b - a) ** ((k + 1) ** 2) for a, b in pairs(values, 2))


def constant(n: int, k: int) -> int:
    """The printed constant of the determinant."""
    return k**n * prod((k - i) ** (2 * (n + i - 1)) for i in range(1, k))


def hermite_formula(values: tuple[int, ...], k: int) -> tuple[R, ...]:
    """The polynomials of the remark after lemma 3, one for each piece of data."""
    whole = prod((R(f"(h - ({s}))^{k + 1}") for s in values), start=R("1"))
    found = []
    for s in values:
        inverse = R(f"(h - ({s}))^{k + 1}") / whole
        for j in range(k + 1):
            parts = [
                whole
                / R(f"(h - ({s}))^{k + 1 - j - m}")
                * (inverse.diff(0, m).at(0, s) / (factorial(m) * factorial(j)))
                for m in range(k - j + 1)
            ]
            found.append(sum(parts[1:], parts[0]))
    return tuple(found)


def leibniz(first: int, low_first: bool) -> bool:
    """Whether the second derivative of a product is the sum from i = first with binomials (j over i), or (i over j)."""
    h, j = sympy.symbols("h"), 2
    a, b = 1 + h**2 + h**3, 2 - h + h**4
    parts = [
        (sympy.binomial(i, j) if low_first else sympy.binomial(j, i)) * sympy.diff(a, h, i) * sympy.diff(b, h, j - i)
        for i in range(first, j + 1)
    ]
    return sympy.expand(sum(parts) - sympy.diff(a * b, h, j)) == 0


def starts_with_first_curve(first: int) -> bool:
    """Whether the prototype, with the sum of A_i Q_i from i = first, is Q_1 at s_0: each A_i is 1 at its own value."""
    row = [pas.hermite_basis((0, 1, 3), 1)[i][0].at(0, 0) for i in range(3)]
    return row[0] + sum(row[first - 1 :]) == 1


def poles(name: str, k: int, own: bool) -> tuple[float, ...]:
    """The real poles of the printed weights between the outermost values, or each in its own interval of prop. 3."""
    n, found = len(data(name).surfaces), []
    for i, f in enumerate(weights(n, k, ("1/2",) * n), 1):
        low, high = (max(i - 2, 0), max(i - 1, 1)) if own else (0, n - 1)
        found += rounded_roots(in_one(f.denominator, 1), fmpq(low), fmpq(high))
    return tuple(found)


def same(components: Any, printed: list[str]) -> tuple[bool, ...]:
    """Component by component, whether rational functions are the printed ones."""
    return tuple(c == R(p) for c, p in zip(components, printed, strict=True))


def quotients(name: str, factor: str = "1") -> tuple[R, ...]:
    """The printed D_i / D of an example, the third one times a factor."""
    given = PRINTED[name]
    found = [R(given[f"D{i}"]) / R(given["D"]) for i in (1, 2, 3)]
    return (*found[:2], found[2] * R(factor))


LINE = "-785*t^4*h^4-1923*t^4*h^5+2803*h^6*t^4-43922*t^2*h^7+39686*t^2*h^8-2965*t^4*h^7+12950*h^10*t^2"
BALANCE = ("1/2", "3/4", "2/3")
SPHERES = ("x^2 + y^2 + (z - 1)^2 - 1", "x^2 + y^2 - 4", "x^2 + y^2 + (z + 1)^2 - 1")


def lies_on(polynomial: str, i: int) -> bool:
    """Whether surface i of example 3 lies on a quadric."""
    return bool(data("example 3").surfaces[i].implicit_residual(polynomial).is_zero)


def without_line(line: str) -> bool:
    """Whether D3 of example 3 without a line is the numerator over D / (t^2 + 1)."""
    (third,) = (R(PRINTED["example 3"]["D3"]) - R("h - 1") * R(line or "0"),)
    return weighted("example 3", 1, BALANCE)[2] == third * R("t^2 + 1") / R(PRINTED["example 3"]["D"])


def derivative(name: str, i: int, j: int) -> tuple[R, ...]:
    """The j-th derivative in h of surface i (from 0) along its curve."""
    return tuple(data(name).coefficients(i, j)[j])


def functions(*texts: str) -> tuple[R, ...]:
    """Rational functions of t and h."""
    return tuple(map(R, texts))


def draw(folder: Path) -> None:
    """All pictures stand with the examples."""


def figure_1() -> tuple[int, ...]:
    """Orders of contact of a blend of a cylinder, a cone and a sphere, cut by parallel planes."""
    x, y = "(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)"
    surfaces = [(f"2*({x})", f"2*({y})", "h - 4"), (f"(h + 1)/2*({x})", f"(h + 1)/2*({y})", "h - 1")]
    ball = "2*(h - 2)/(1 + (h - 2)^2)", "(1 - (h - 2)^2)/(1 + (h - 2)^2)"
    surfaces.append((f"({ball[1]})*({x})", f"({ball[1]})*({y})", f"4 + ({ball[0]})"))
    made = pas.BlendingData([pas.ParametricSurface(*s) for s in surfaces])
    components = pas.hermite_blend(made, 1).surface.components
    pairs = zip(made.values, made.surfaces, strict=True)
    return tuple(
        min(contact_order(a, b, v, 1) for a, b in zip(components, s.components, strict=True)) for v, s in pairs
    )


# --- lemma 3, theorems, bounds --------------------------------------------------------------------

work.agrees("figure 1", "cylinder, cone and sphere cut by parallel planes: orders of contact", (1, 1, 1), figure_1,
            note="printed without numbers; those here are chosen")  # fmt: skip
work.misprint(
    "lemma 3", "constant of the determinant for n = 3, k = 4", constant(3, 4),
    lambda: determinant((0, 1, 3), 4) // differences((0, 1, 3), 4),
    "times the product of the differences to the power (k+1)^2 it must be the determinant, here of s = (0, 1, 3); the "
    "exponent 2(n + i - 1) must be n (i + 1)", lambda c: c * differences((0, 1, 3), 4) == determinant((0, 1, 3), 4),
)  # fmt: skip
work.misprint(
    "lemma 3", "determinant for k = 1, s = (0, 2), with the printed product over all i != r",
    constant(2, 1) * differences((0, 2), 1, permutations), lambda: determinant((0, 2), 1),
    "that product has each pair twice; it must be over i < r", lambda d: d == determinant((0, 2), 1),
)  # fmt: skip
work.agrees(
    "remark to lemma 3", "formula for A(h), with s = (0, 1, 3), k = 2", hermite_formula((0, 1, 3), 2),
    lambda: tuple(f for row in pas.hermite_basis((0, 1, 3), 2) for f in row),
)  # fmt: skip
work.misprint(
    "remark to lemma 3", "polynomials of degree (k+1) n with the same data are unique", True,
    lambda: vandermonde((0, 1, 3), 2, 10).rank() == 10,
    "for n = 3, k = 2 the system has 10 unknowns and must have the rank 10; 'with the assumption' must be 'except'",
    lambda unique: unique == (vandermonde((0, 1, 3), 2, 10).rank() == 10),
)  # fmt: skip
work.misprint(
    "lemma 1, proof", "Leibniz's formula", "sum from 1, (i over j)",
    lambda: next(
        f"sum from {i}, ({'i over j' if low else 'j over i'})"
        for i in (1, 0) for low in (True, False) if leibniz(i, low)
    ),
    "it must give the second derivative of a product of two polynomials",
    lambda text: leibniz(int(text[9]), "(i" in text),
)  # fmt: skip
work.misprint(
    "section 5", "the sum of A_i Q_i in the prototype T begins with i =", 1,
    lambda: next(filter(starts_with_first_curve, (1, 2, 3))),
    "at h = s_0 the prototype must be Q_1, not twice it (corollary 1 has 2)", starts_with_first_curve,
)  # fmt: skip
work.agrees(
    "remark to theorem 7", "for n = 2, u_2 = 1 - u_1: f_1 + f_2", R("1"),
    lambda: sum(weights(2, 2, ("1/3", "2/3"))[1:], weights(2, 2, ("1/3", "2/3"))[0]),
)  # fmt: skip
work.agrees(
    "proposition 3", "poles of f_i between s_(i-2) and s_(i-1), inputs V to XI", (),
    lambda: tuple(p for name in list(TABLE)[4:] for p in poles(f"input {name}", TABLE[name][1], True)),
)  # fmt: skip
for name in ("VII", "IX"):
    work.differs(
        "theorem 7", f"exponent of weights without poles between the outer curves, input {name}", TABLE[name][1] + 1,
        lambda name=name: pas.weighted_blend(data(f"input {name}"), TABLE[name][1]).weights.exponent,
        lambda name=name: "with the printed k + 1 the surface has poles, at h = "
        + ", ".join(f"{p:.4f}" for p in sorted(set(poles(f"input {name}", TABLE[name][1], False))))
        + "; with an even exponent from k + 1 on, all denominators are positive, and pas takes that",
        lambda name=name: {
            "there are such poles": bool(poles(f"input {name}", TABLE[name][1], False)),
            "the next exponent is even": TABLE[name][1] % 2 == 0,
            "there are no poles with it": not poles(f"input {name}", TABLE[name][1] + 1, False),
        },
    )  # fmt: skip
work.agrees(
    "section 5", "algorithm 1: degrees in t and h below the bounds, all inputs", True,
    lambda: all(
        degree(hermite(f"input {n}", row[1]).components, axis) <= bounds(f"input {n}", row[1])[axis]
        for n, row in TABLE.items() for axis in (0, 1)
    ),
)  # fmt: skip
work.agrees(
    "section 5", "algorithm 2: degrees in t and h below the bounds, all inputs", True,
    lambda: all(
        degree(weighted(f"input {n}", row[1]), axis) <= bounds(f"input {n}", row[1])[2 + axis]
        for n, row in TABLE.items() for axis in (0, 1)
    ),
)  # fmt: skip

# --- tables 1 and 2 -------------------------------------------------------------------------------

for name, (n, k, surfaces, curves, first, second) in TABLE.items():
    full = f"input {name}"
    work.agrees(
        f"table 1, {name}", "n; D_p; D_c", (n, surfaces, curves),
        lambda full=full: (len(data(full).surfaces), tuple(data(full).degrees), tuple(data(full).curve_degrees)),
    )  # fmt: skip
    work.agrees(
        f"table 1, {name}", "algorithm 1: orders of contact", (k,) * n,
        lambda full=full, k=k: reached(pas.hermite_blend(data(full), k).surface.components, full, k),
        printed_seconds=first,
    )  # fmt: skip
    if name in ("V", "XI"):
        work.differs(
            f"table 1, {name}", "algorithm 2: orders of contact", (k,) * n,
            lambda full=full, k=k: reached(algorithm_2(full, k), full, k),
            lambda full=full: "a surface that is not met at h = 0 has a pole there, which takes one order from its "
            "weight's zero: theorem 7 needs that each surface is regular at every s_i, and is false as it is printed ("
            + refusal(full) + ")",
            lambda full=full: {
                "a surface that is not met at h = 0 has a pole there": [s for _, s in undefined(full)] == [0],
                "no other input has such poles": not any(
                    undefined(f"input {other}") for other in TABLE if other not in ("V", "XI")
                ),
            },
            printed_seconds=second,
        )  # fmt: skip
    else:
        work.agrees(
            f"table 1, {name}", "algorithm 2: orders of contact", (k,) * n,
            lambda full=full, k=k: reached(algorithm_2(full, k), full, k), printed_seconds=second,
        )  # fmt: skip


def refusal(name: str) -> str:
    """What pas says where algorithm 2 has no solution."""
    try:
        pas.weighted_blend(data(name), TABLE[name.split()[1]][1])
    except pas.GeometryError as error:
        return str(error).split(";")[0]
    return ""


def undefined(name: str) -> tuple[tuple[int, int], ...]:
    """The surfaces that have a pole for all t where another one is met, by number, with h there."""
    return tuple(
        (i, s)
        for i, surface in enumerate(data(name).surfaces)
        for s in data(name).values
        if s != data(name).values[i] and any(f.denominator.subs({"h": fmpq(s)}) == 0 for f in surface.components)
    )


def bounds_of(name: str) -> tuple[int, int, int, int]:
    """The printed bounds for an input of table 1."""
    return bounds(f"input {name}", TABLE[name][1])


def below(name: str) -> bool:
    """Whether a degree is less than its bound, with one of the algorithms."""
    one, two = hermite(f"input {name}", TABLE[name][1]).components, weighted(f"input {name}", TABLE[name][1])
    return any(degree(c, axis) < bounds_of(name)[2 * n + axis] for n, c in enumerate((one, two)) for axis in (0, 1))


def better(what: str) -> tuple[str, ...]:
    """The inputs for which the algorithm that table 2 prefers is worse."""
    found = []
    for name, row in TABLE.items():
        one, two = hermite(f"input {name}", row[1]).components, weighted(f"input {name}", row[1])
        measure = {"t": lambda c: degree(c, 0), "h": lambda c: degree(c, 1), "density": terms}[what]
        good, bad = (two, one) if what == "t" else (one, two)
        found += [name] if measure(good) > measure(bad) else []
    return tuple(found)


for what, text, winner in (("t", "degree in t", 2), ("h", "degree in h", 1), ("density", "number of terms", 1)):
    work.differs(
        "table "
        "2", f"inputs for which algorithm {winner} is not the better one, {text}", (), lambda what=what: better(what),
        lambda what=what: f"the table compares bounds, which need not be reached; it holds for "
        f"{11 - len(better(what))} of "
        "the 11 inputs",
        lambda what=what: {
            "the bounds are as the table says, for all inputs": what == "density" or all(
                (2 * (what == "h") - 1) * (b[2 + (what == "h")] - b[what == "h"]) > 0 for b in map(bounds_of, TABLE)
            ),
            "one of the two is below its bounds there": all(map(below, better(what))),
        },
    )  # fmt: skip

# --- examples -------------------------------------------------------------------------------------

ONE, TWO, THREE, FOUR = "example 1", "example 2", "example 3", "input I"
work.agrees(ONE, "Q_1", functions("-5", "-t", "2/3*t^2 + 4/3"), lambda: data(ONE).curve(0))
work.agrees(ONE, "Q_2", functions("3/5*t^2 + 3/5*t + 15/4", "0", "t + 1/2"), lambda: data(ONE).curve(1))
work.agrees(ONE, "derivative of P_1 at h = 0", functions("2/3*t^2", "0", "0"), lambda: derivative(ONE, 0, 1))
work.misprint(
    ONE, "derivative of P_2 at h = 1, x", R("3/5*t^3 + 3/10*t^2 + 18/15*t - 3/20*(4*t^2 + 4*t + 25)*t"),
    lambda: derivative(ONE, 1, 1)[0],
    "at t = 1 it must be the derivative of P_2(1, h) there, -9/20; with 18/5 t in place of 18/15 t it is",
    lambda f: f.at(1, 0) == data(ONE).surfaces[1].x.diff(0, 1).at(1, 1),
)  # fmt: skip
work.agrees(
    ONE, "derivative of P_2 at h = 1, y and z", functions("t + 1/2", "1/2*t^2 - 1/4*(2*t + 1)*t"),
    lambda: derivative(ONE, 1, 1)[1:],
)  # fmt: skip
work.agrees(ONE, "there are polynomial solutions", True, lambda: bool(pas.has_polynomial_solution(data(ONE), 1)))
work.differs(
    ONE, "order k for which T is the output of algorithm 1", 1,
    lambda: next(k for k in range(5) if all(same(hermite(ONE, k).components, PRINTED[ONE]["T"]))),
    lambda: f"the printed T has degree {degree(functions(*PRINTED[ONE]['T']), 1)} in h and contact of order "
    f"{min(reached(functions(*PRINTED[ONE]['T']), ONE, 5))} with both surfaces, while the text says G^1, for which "
    f"degree 3 "
    "is enough",
    lambda: {
        "the printed T has degree 5 in h, as k = 2 needs": degree(functions(*PRINTED[ONE]["T"]), 1) == 2 * 3 - 1,
        "it has contact of order 2 with both": reached(functions(*PRINTED[ONE]["T"]), ONE, 5) == (2, 2),
        "degree 3 is enough for G^1": degree(hermite(ONE, 1).components, 1) == 3
        and reached(hermite(ONE, 1).components, ONE, 1) == (1, 1),
    },
)  # fmt: skip
work.agrees("figure 2", "T meets both surfaces with order", 2, lambda: min(reached(hermite(ONE, 2).components, ONE, 4)),
            picture=f"{PICTURES}/example_1.png")  # fmt: skip
work.agrees(
    ONE, "f(0), f(1), f'(0), f'(1) of f = 1 - 3 h^2 + 2 h^3", (1, 0, 0, 0),
    lambda: tuple(f.at(0, h) for f in (R("1 - 3*h^2 + 2*h^3"), R("1 - 3*h^2 + 2*h^3").diff(0, 1)) for h in (0, 1)),
)  # fmt: skip
work.agrees(
    ONE, "algorithm 2 with it: D_i / C_i",
    tuple(R(PRINTED[ONE][f"D{i}"]) / R(PRINTED[ONE][f"C{i}"]) for i in (1, 2, 3)),
    lambda: tuple(
        R("1 - 3*h^2 + 2*h^3") * a + R("3*h^2 - 2*h^3") * b
        for a, b in zip(*(s.components for s in data(ONE).surfaces), strict=True)
    ),
)  # fmt: skip
for name, k, text in (
    (ONE, 1, "h^2*(h - 1)^2"),
    (TWO, 2, "h^3*(h - 1)^3"),
    (THREE, 1, "h^2*(h - 1)^2*(h - 2)^2"),
    (FOUR, 2, "h^3*(h - 1)^3"),
):
    work.agrees(
        "example 4" if name == FOUR else name, "multiplier of all solutions", R(text),
        lambda name=name, k=k: pas.hermite_blend(data(name), k).all_solutions().multiplier,
    )  # fmt: skip

work.agrees(TWO, "Q_1", functions("(t^2 - 1)/(t^2 + 1)", "2", "2*t/(t^2 + 1)"), lambda: data(TWO).curve(0))
work.agrees(TWO, "Q_2", functions("(t^2 - 1)/(t^2 + 1)", "2*t/(t^2 + 1)", "2"), lambda: data(TWO).curve(1))
work.agrees(
    TWO,
    "derivative of P_1 at h = 0",
    functions("0", "-3*(5*t^2 + 5 - 6*t)/(4*(t^2 + 1))", "0"),
    lambda: derivative(TWO, 0, 1),
)
work.agrees(
    TWO, "derivative of P_2 at h = 1", functions("0", "0", "4*(-t + t^2 + 1)/(t^2 + 1)"), lambda: derivative(TWO, 1, 1)
)
work.agrees(TWO, "second derivatives", (R("0"),) * 6, lambda: derivative(TWO, 0, 2) + derivative(TWO, 1, 2))
work.agrees(
    TWO, "f(h) for u = 1/2", R("(1 - h)^3/((1 - h)^3 + h^3)"), lambda: weights(2, 2, ("1/2", "1/2"))[0]
)  # fmt: skip
work.misprint(
    TWO, "T of algorithm 1, x", R(PRINTED[TWO]["T"][0]), lambda: hermite(TWO, 2).x,
    "at h = 0 it must be the first component of Q_1", lambda f: f == data(TWO).curve(0)[0],
)  # fmt: skip
work.agrees(TWO, "T of algorithm 1, y and z", functions(*PRINTED[TWO]["T"][1:]), lambda: hermite(TWO, 2).components[1:])
work.agrees(TWO, "algorithm 2, x and z", functions(*PRINTED[TWO]["by weights"][::2]), lambda: weighted(TWO, 2)[::2])
work.misprint(
    TWO, "algorithm 2, y", R(PRINTED[TWO]["by weights"][1]), lambda: weighted(TWO, 2)[1],
    "at h = 0 it must be 2, the second component of Q_1; the second of the two printed fractions lacks the factor 4 "
    "of its "
    "denominator", lambda f: contact_order(f, R("2"), fmpq(0), 0) == 0,
)  # fmt: skip
for side, stem, components in (
    ("left", "", lambda: hermite(TWO, 2).components),
    ("right", "_weights", lambda: weighted(TWO, 2)),
):
    work.agrees(
        f"figure 3, {side}", "orders of contact", (2, 2), lambda components=components: reached(components(), TWO, 2),
        picture=f"{PICTURES}/example_2{stem}.png",
    )  # fmt: skip

for i, text in enumerate(SPHERES[:2]):
    work.agrees(THREE, f"P_{i + 1} lies on {text}", True, lambda text=text, i=i: lies_on(text, i))
work.misprint(
    THREE, "V_3", SPHERES[2], lambda: next(s for d in range(1, 5) if lies_on(s := f"x^2 + y^2 + (z + {d})^2 - 1", 2)),
    "the printed P_3 must lie on it", lambda text: lies_on(text, 2),
)  # fmt: skip
CIRCLE = ("(t^2 - 1)/(t^2 + 1)", "2*t/(t^2 + 1)")
for i, curve in enumerate(((*CIRCLE, "1"), ("2*(t^2 - 1)/(t^2 + 1)", "4*t/(t^2 + 1)", "0"), (*CIRCLE, "-2"))):
    work.agrees(THREE, f"Q_{i + 1}", functions(*curve), lambda i=i: data(THREE).curve(i))
work.agrees(
    THREE, "derivatives at the three curves, z", functions("2/(t^2 + 1)", "1", "2/(t^2 + 1)"),
    lambda: tuple(derivative(THREE, i, 1)[2] for i in range(3)),
)  # fmt: skip
work.agrees(THREE, "T of algorithm 1", functions(*PRINTED[THREE]["T"]), lambda: hermite(THREE, 1).components)
work.agrees("figure 4", "orders of contact", (1, 1, 1), lambda: reached(hermite(THREE, 1).components, THREE, 1),
            picture=f"{PICTURES}/example_3.png")  # fmt: skip
work.agrees(
    THREE, "f_1, f_2, f_3", functions(
        "1/2*(1 - h)^2*(2 - h)^2/(1/2*(1 - h)^2*(2 - h)^2 + (1 - 1/2)*h^2)",
        "3/4*h^2*(2 - h)^2/(3/4*h^2*(2 - h)^2 + (1 - 3/4)*(h - 1)^2)",
        "2/3*(1 - h)^2*h^2/(2/3*(1 - h)^2*h^2 + (1 - 2/3)*(h - 2)^2)",
    ), lambda: weights(3, 1, BALANCE),
)  # fmt: skip
work.agrees(THREE, "algorithm 2, D_1 / D and D_2 / D", quotients(THREE)[:2], lambda: weighted(THREE, 1, BALANCE)[:2])
work.misprint(
    THREE, "line in D_3 that does not belong there", "", lambda: LINE,
    "without it D_3 must be the numerator over D / (t^2 + 1); its seven monomials are there a second "
    "time", without_line,
)  # fmt: skip
for name, where, u in ((THREE, THREE, BALANCE), (FOUR, "example 4", ())):
    line = LINE if name == THREE else "0"
    fraction = lambda d, name=name, line=line: (R(PRINTED[name]["D3"]) - R("h - 1") * R(line)) / R(d)  # noqa: E731
    work.misprint(
        where, "denominator of the third component, D over", "1",
        lambda name=name, u=u, fraction=fraction: next(
            d for d in ("1", "t^2 + 1") if weighted(name, ORDERS[name], u)[2] == fraction(PRINTED[name]["D"]) * R(d)
        ),
        "D_3 / D must be the third component of the sum of f_i P_i, which has no factor t^2 + 1 in its denominator",
        lambda d, name=name, u=u, fraction=fraction: (
            weighted(name, ORDERS[name], u)[2] == fraction(PRINTED[name]["D"]) * R(d)
        ),
    )  # fmt: skip
work.agrees("example 4", "input I, P_2", functions(*PRINTED[FOUR]["P2"]), lambda: data(FOUR).surfaces[1].components)
work.agrees("example 4", "T of algorithm 1", functions(*PRINTED[FOUR]["T"]), lambda: hermite(FOUR, 2).components)
work.agrees("figure 5", "orders of contact", (2, 2), lambda: reached(hermite(FOUR, 2).components, FOUR, 2),
            picture=f"{PICTURES}/input_I.png")  # fmt: skip
work.agrees("example 4", "algorithm 2, D_1 / D and D_2 / D", quotients(FOUR)[:2], lambda: weighted(FOUR, 2)[:2])
