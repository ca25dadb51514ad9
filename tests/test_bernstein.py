"""Bernstein forms: exact identities for every degree, and proofs of sign that can fail."""

from __future__ import annotations

from fractions import Fraction
from math import factorial, prod

import numpy as np
import pytest
from flint import fmpq
from halving import halving
from hypothesis import given, settings
from hypothesis import strategies as st

from pas import Polynomial, Status
from pas.algebra.evaluation import evaluate
from pas.algebra.monomials import count, exponents, homogeneous_exponents, monomial_values
from pas.algebra.rational import to_floats, to_fraction, vector
from pas.bernstein.forms import (
    LARGEST_ERROR,
    UNIT_ROUNDOFF,
    BoundedForms,
    b_form,
    gram,
    nearby_forms,
    on_simplex,
    polar_forms,
    rounded,
    rounded_form,
)
from pas.bernstein.search import Boxes, Fate, Limits, search
from pas.bernstein.signs import apart_on, prove_positive
from pas.bernstein.simplices import Simplices, bisection, edges, halved, halves, rounding_bound
from pas.certify.local_mesh import critical_parts, isolated

TETRAHEDRON = [vector(v) for v in (("1/4", "-1/3", "1/5"), ("3/2", 0, "1/3"), (1, 2, 0), ("-1/2", 1, 2))]
fractions = st.fractions(min_value=-9, max_value=9, max_denominator=12)


def dense(degree: int, seed: int) -> Polynomial:
    """A polynomial with every monomial up to a degree."""
    rng = np.random.default_rng(seed)
    return Polynomial({e: Fraction(int(rng.integers(-9, 10)), int(rng.integers(1, 8))) for e in exponents(degree)})


def own_form(raw, simplex):
    """The rounded form (1, m) of a polynomial as of its own degree."""
    return rounded_form(raw, simplex, max(int(raw.total_degree()), 0))[None]


def bernstein_value(coefficients, degree, barycentric):
    """The form's value, straight from the definition, exact."""
    total = Fraction(0)
    for index, c in zip(homogeneous_exponents(degree, len(barycentric)), coefficients, strict=True):
        weight = Fraction(factorial(degree), prod(factorial(i) for i in index))
        total += to_fraction(c) * weight * prod(b**i for b, i in zip(barycentric, index, strict=True))
    return total


@pytest.mark.parametrize("degree", range(8))
@pytest.mark.parametrize("corners", [2, 3, 4])
def test_form_is_the_polynomial(degree, corners):
    p = dense(degree, degree)
    simplex = TETRAHEDRON[:corners]
    form = b_form(on_simplex(p.raw, simplex), degree, corners - 1)
    weights = [Fraction(w, 10) for w in (1, 3, 4, 2)][:corners]
    weights[0] += 1 - sum(weights)
    point = [sum(w * to_fraction(v[i]) for w, v in zip(weights, simplex, strict=True)) for i in range(3)]
    assert bernstein_value(form, degree, weights) == p.at(point)


def test_degree_elevation_keeps_values():
    p = dense(3, 1)
    for degree in (3, 4, 6, 20):
        form = b_form(on_simplex(p.raw, TETRAHEDRON), degree, 3)
        assert bernstein_value(form, degree, [Fraction(1, 4)] * 4) == p.at(
            [sum(to_fraction(v[i]) for v in TETRAHEDRON) / 4 for i in range(3)]
        )


@pytest.mark.parametrize("degree", range(7))
@pytest.mark.parametrize("edge", range(6))
def test_halving_is_the_form_on_the_halves(degree, edge):
    p = dense(degree, 3)
    i, j = edges(4)[edge]
    form = np.array(to_floats(b_form(on_simplex(p.raw, TETRAHEDRON), degree, 3)))
    middle = tuple((a + b) / 2 for a, b in zip(TETRAHEDRON[i], TETRAHEDRON[j], strict=True))
    for own, moved in zip(bisection(degree, 4)[edge](form[None]), (j, i), strict=True):
        half = list(TETRAHEDRON)
        half[moved] = middle
        expected = to_floats(b_form(on_simplex(p.raw, half), degree, 3))
        assert own[0] == pytest.approx(expected, abs=1e-12 * (1 + np.abs(form).max()))


@pytest.mark.parametrize("shape", [(1, 1), (2, 5), (4, 3), (7, 1)])
@pytest.mark.parametrize("axis", [0, 1])
def test_halves_of_boxes_are_those_of_segments(shape, axis):
    """Exact means, means in doubles and matrices agree, and with the halves of a segment along each row."""
    draw = np.random.default_rng(sum(shape) + axis)
    numbers = draw.integers(-999, 999, shape)
    exact = np.array([[fmpq(int(v), 7) for v in row] for row in numbers], dtype=object)
    found = halves(exact, axis)
    rounded_too = halves(to_floats_array(exact), axis)
    by_matrix = halved(to_floats_array(exact)[None, ..., None], axis)
    matrices = halving(shape[axis] - 1, 2, 0)
    for side in (0, 1):
        assert all(type(v) is fmpq for v in found[side].ravel())
        expected = to_floats_array(found[side])
        assert rounded_too[side] == pytest.approx(expected, abs=1e-12)
        assert by_matrix[side][0, ..., 0] == pytest.approx(expected, abs=1e-12)
        rows = np.moveaxis(to_floats_array(exact), axis, 0)
        assert np.moveaxis(matrices[side] @ rows, 0, axis) == pytest.approx(expected, abs=1e-12)


def to_floats_array(values):
    return np.vectorize(lambda v: int(v.p) / int(v.q), otypes=[float])(values)


@pytest.mark.parametrize("degree", range(6))
def test_gram_is_the_integral(degree):
    # the integral of x^a y^b z^c over the unit simplex is a! b! c! / (a+b+c+3)!
    unit = [vector(v) for v in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    p, q = dense(degree, 5), dense(degree, 6)
    exact = sum(
        c * Fraction(prod(factorial(int(i)) for i in e), factorial(sum(e) + 3))
        for e, c in (p * q).coefficients().items()
    )
    weights = gram(degree, 3)
    a, b = (b_form(on_simplex(r.raw, unit), degree, 3) for r in (p, q))
    total = sum((x * weights[i, j] * y for i, x in enumerate(a) for j, y in enumerate(b)), fmpq(0))
    assert to_fraction(total) / 6 == exact


def test_monomials_are_graded_and_evaluated():
    assert exponents(2)[: count(1)] == exponents(1)
    points = np.random.default_rng(0).uniform(-2, 2, (50, 3))
    values = monomial_values(points, 5)
    for row, e in zip(values, exponents(5), strict=True):
        assert row == pytest.approx(np.prod(points ** np.array(e), axis=1))
    assert evaluate(points, np.eye(count(3))).shape == (50, count(3))


@settings(max_examples=30, deadline=None)
@given(st.lists(fractions, min_size=10, max_size=10))
def test_rounding_keeps_signs_and_errs_by_half_an_ulp(values):
    exact = [fmpq(v.numerator, v.denominator) for v in values]
    result = rounded(exact)
    largest = max(abs(v) for v in values)
    for v, r in zip(values, result, strict=True):
        assert largest == 0 or abs(Fraction(float(r)) - v / largest) <= Fraction(1, 2**53)


@pytest.mark.parametrize("size", ["1e-400", "1", "1e400"])
def test_rounding_scales_coefficients_of_any_size(size):
    values = [Fraction(size) * Fraction(c) for c in (3, -1, "1e-10", 0)]
    result = rounded([fmpq(v.numerator, v.denominator) for v in values])
    assert result.tolist() == [1.0, -1 / 3, result[2], 0.0]
    assert 0 < result[2] < 1e-9


def signs(p: str | None, *zeros: str | None):
    """Branch and bound on one tetrahedron: for p > 0 where the others vanish, or for no common zero of theirs."""
    if p is None:
        return apart_on([CUBE], [Polynomial(text).raw for text in zeros])
    value, *known = (own_form(Polynomial(text).raw, CUBE) for text in (p, *filter(None, zeros)))
    return prove_positive(value, np.array([[to_floats(v) for v in CUBE]]), known)


CUBE = [vector(v) for v in ((-2, -2, -2), (6, -2, -2), (-2, 6, -2), (-2, -2, 6))]


@pytest.mark.parametrize("corners", [2, 3, 4])
@pytest.mark.parametrize("degree", [0, 1, 4, 7])
def test_forms_in_doubles_are_as_near_as_they_say(degree, corners):
    """Each its own polynomial on its own simplex; hardly worse than the rounding of single steps."""
    polynomials = [dense(degree, seed) / 10**seed for seed in range(5)]
    simplices = [[vector([c * (i + 1) for c in v]) for v in TETRAHEDRON[:corners]] for i in range(5)]
    forms, error = nearby_forms([p.raw for p in polynomials], simplices, degree)
    assert UNIT_ROUNDOFF <= error < 1e-11
    for p, simplex, form in zip(polynomials, simplices, forms, strict=True):
        exact = b_form(on_simplex(p.raw, simplex), degree, corners - 1)
        largest = max(map(abs, exact))
        off = [abs(to_fraction(v / largest) - Fraction(f)) for v, f in zip(exact, form.tolist(), strict=True)]
        assert max(off) <= error and np.abs(form).max() == pytest.approx(1)


@pytest.mark.parametrize("size", [1, Fraction(1, 10**320), 10**400, Fraction(1, 10**205)])
def test_forms_that_cancel_or_leave_the_range_of_doubles_are_rounded(size):
    near = [vector([1 + c / 10**6 for c in v]) for v in TETRAHEDRON]
    for p in (Polynomial("(x - 1)^4 + (y - 1)^4") * size, Polynomial("x + y + 1") * size, Polynomial(0)):
        degree = max(p.degree, 0)
        forms, error = nearby_forms([p.raw], [near], degree)
        exact = rounded_form(p.raw, near, degree)
        assert np.abs(forms - exact).max() <= error < LARGEST_ERROR + UNIT_ROUNDOFF
    cancelled = Polynomial("(x - 1)^4 + (y - 1)^4").raw
    assert np.array_equal(nearby_forms([cancelled], [near], 4)[0], rounded_form(cancelled, near, 4)[None])
    tiny, cubic = [vector([c / 10**107 for c in v]) for v in TETRAHEDRON], Polynomial("x^3 + 2*x*y^2").raw
    assert np.array_equal(nearby_forms([cubic], [tiny], 3)[0], rounded_form(cubic, tiny, 3)[None])


def test_corners_that_moved_by_rounding_count():
    """As halving rounds them: here by a thousand roundings of the largest coordinate, away from 0."""
    corners = np.array([[[0.0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]]])
    p, moved = Polynomial("x + 3*x*y"), 1000
    exact = polar_forms([p], corners, 2)[0]
    forms, error = polar_forms([p], corners + moved * UNIT_ROUNDOFF * 8, 2, moved, 8.0)
    assert 0 < np.abs(forms - exact).max() <= error[0] < 1e-9


@pytest.mark.parametrize("off", [(0, 0), (2.0, 0), (0, 2.0)])
def test_sums_and_products_of_forms_are_as_near_as_they_say(off):
    """Of forms that are exact, or off by as much as they may be."""
    polynomials = [dense(degree, seed) * 5040 for seed, degree in enumerate((3, 2))]
    corners = [vector(v) for v in ((0, 0, 0), (3, 0, 1), (1, 2, 0), (0, 1, 4))]
    exact = [b_form(on_simplex(p.raw, corners), p.degree, 3) for p in polynomials]
    given = [np.array([to_floats([c * 24 for c in form])]) for form in exact]
    assert all(float(v) == v for form in given for v in form[0])
    p, q = (
        BoundedForms(form + error * (-1.0) ** np.arange(form.size), degree, np.array([error]))
        for form, error, degree in zip(given, off, (3, 2), strict=True)
    )
    for found, wanted in (
        (p * q, polynomials[0] * polynomials[1] * 24**2),
        (q * p, polynomials[0] * polynomials[1] * 24**2),
        (p + q, (polynomials[0] + polynomials[1]) * 24),
        (p - q * 3.0, (polynomials[0] - polynomials[1] * 3) * 24),
        (q.raised(5), polynomials[1] * 24),
    ):
        form = b_form(on_simplex(wanted.raw, corners), found.degree, 3)
        apart = [abs(to_fraction(v) - Fraction(f)) for v, f in zip(form, found.values[0].tolist(), strict=True)]
        assert max(apart) <= found.error[0] and (any(off) or found.error[0] < 1e-10 * found.size[0])
    error = (p * q * 1e-300).scaled()[1]
    assert error >= 1 and np.abs((p * q).scaled()[0]).max() == 1


def test_values_that_became_small_are_worked_out_anew():
    """x^2 + 1e-20 is positive on [0, 1] and x^2 - 1e-20 is not, which halving alone does not tell."""
    segment = [vector((0, 0, 0)), vector((1, 0, 0))]
    above, below = (Polynomial(f"x^2 {sign} 1/10^20").raw for sign in "+-")

    def proof(raws, error=UNIT_ROUNDOFF, depth=40):
        def anew(corners, source):
            parts = [[vector(v) for v in part] for part in corners.tolist()]
            forms = [rounded_form(raws[s], part, 2) for s, part in zip(source.tolist(), parts, strict=True)]
            return np.array(forms), error

        value = np.concatenate([own_form(raw, segment) for raw in raws])
        corners = np.array([[to_floats(v) for v in segment]] * len(raws))
        limits = Limits(depth=depth)
        return tuple(prove_positive(value, corners, limits=limits, anew=a).status for a in (None, anew))

    assert proof([above]) == (Status.UNDECIDED, Status.PROVED)
    assert proof([above, below]) == (Status.UNDECIDED, Status.REFUTED)
    assert proof([above], depth=20)[1] is Status.PROVED
    assert proof([above], 1e-3, 20)[1] is Status.UNDECIDED


def test_an_error_before_the_halvings_counts():
    """x + 1/10 on a segment is positive, and cannot be told from what is not where forms may be off by 1/10."""
    form, corners = own_form(Polynomial("x + 1/10").raw, SEGMENT), np.array([[to_floats(v) for v in SEGMENT]])
    assert prove_positive(form, corners).status is Status.PROVED
    assert prove_positive(form, corners, limits=Limits(depth=8), error=0.1).status is Status.UNDECIDED


@pytest.mark.parametrize(
    ("value", "zero", "status"),
    [
        ("1", None, Status.PROVED),
        ("x^2 + y^2 + z^2 + 1/1000", None, Status.PROVED),
        ("(x-y)^4 + (y-z+1/7)^2 + (z - 1/3)^2 + 1/10000", None, Status.PROVED),
        ("x^2 + y^2 + z^2 - 1/1000", None, Status.REFUTED),
        ("x", None, Status.REFUTED),
        ("(x - 1/3)^2 + (y - 1/3)^2", None, Status.UNDECIDED),
        ("x^2 + y^2 + z^2", "x^2 + y^2 + z^2 - 1", Status.PROVED),
        ("z + 1001/1000", "x^2 + y^2 + z^2 - 1", Status.PROVED),
        ("z + 49/50", "x^2 + y^2 + z^2 - 1", Status.REFUTED),
        ("-1", "x^2 + y^2 + z^2 + 1/100", Status.PROVED),
        ("0", "x - 1", Status.UNDECIDED),
        ("3/2 - x", "x^3 - 1", Status.PROVED),
        ("1/2 - x", "x^3 - 1", Status.REFUTED),
    ],
)
def test_verdicts(value, zero, status):
    result = signs(value, zero)
    assert result.status is status
    if status is Status.REFUTED:
        point = [Fraction(c) for c in result.witness.tolist()]
        assert Polynomial(value).at(point) < 0
        if zero is not None:
            assert abs(Polynomial(zero).at(point)) < 1e-14
    else:
        assert result.witness is None
    if status is Status.UNDECIDED:
        assert len(result.undecided)


@pytest.mark.parametrize(
    ("value", "zeros", "status"),
    [
        ("z + 1/2", ("x^2 + y^2 + z^2 - 1", "z - 1/2"), Status.PROVED),
        ("x + 9/10", ("x^2 + y^2 + z^2 - 1", "z - 1/2"), Status.PROVED),  # not so where one of them vanishes
        ("x + 4/5", ("x^2 + y^2 + z^2 - 1", "z - 1/2"), Status.UNDECIDED),  # wrong, but signs do not tell
        (None, ("x^2 + y^2 + z^2 - 1", "z - 11/10"), Status.PROVED),
        (None, ("x^2 + y^2 + z^2 - 1", "z - 1/2"), Status.UNDECIDED),
        (None, ("x^2 + y^2 + z^2 - 1", "x - y", "z - 1/2"), Status.UNDECIDED),
        (None, ("x^2 + y^2 + z^2 - 1", "x - y", "z - x - 2"), Status.PROVED),
        (None, ("x + 3",), Status.PROVED),
        (None, ("x + 1",), Status.REFUTED),
    ],
)
def test_common_zeros(value, zeros, status):
    assert signs(value, *zeros).status is status


def test_nothing_is_claimed_of_no_simplices():
    for result in (prove_positive(np.array([]), np.array([])), apart_on((), ())):
        assert (result.status, result.examined) == (Status.PROVED, 0)


def test_rounding_is_accounted_for():
    # a margin below the error bound must not pass as a proof, nor one of the other sign as refuted
    for sign in (1, -1):
        value = np.full((1, 4), sign * 2.0**-53)
        result = prove_positive(value, np.eye(4)[None, :, :3], limits=Limits(depth=3))
        assert result.status is Status.UNDECIDED


SEGMENT = [vector(v) for v in ((0, 0, 0), (1, 0, 0))]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("degree", [2, 4, 8])
def test_a_double_root_is_neither_proved_nor_refuted(degree):
    """(x - p)^2 times a positive factor: rounding alone makes its coefficients positive in half of the cases."""
    x = Polynomial("x")
    for p in range(3, 60, 4):
        f = (x - Fraction(p, 61)) ** 2
        for i in range(degree // 2 - 1):
            f = f * ((x - Fraction(7 * i + p, 50)) ** 2 + Fraction(1, 9))
        form = rounded(b_form(on_simplex(f.raw, SEGMENT), degree, 1))
        assert prove_positive(form[None], np.eye(3)[None, :2]).status is Status.UNDECIDED


@pytest.mark.parametrize(("degree", "vertices"), [(5, 2), (12, 2), (8, 3), (12, 4)])
def test_rounding_errors_stay_within_their_bound(degree, vertices):
    """Constants are what halving should leave alone; rounding makes some of them drift, the same way each time.

    Without the growth with the number of halvings the bound would be wrong.
    """
    rng = np.random.default_rng(3)
    constants = 1 - rng.integers(0, 2**20, (1000, 1)) * 2.0**-53
    forms = np.repeat(constants, len(homogeneous_exponents(degree, vertices)), axis=1)
    errors = []
    for halvings in range(1, 49):
        forms = forms @ halving(degree, vertices, halvings % len(edges(vertices)))[halvings % 2].T
        errors.append(np.abs(forms - constants).max())
        assert errors[-1] <= rounding_bound(degree, halvings) / 2
    if (degree, vertices) == (12, 2):
        assert max(errors) > rounding_bound(degree, 0)


@pytest.mark.parametrize(
    ("value", "zero"),
    [
        (-1, "-(x - 1/3)^2"),  # touches 0 from below inside,
        (-1, "-x^2"),  # at a corner,
        (-1, "(2*x - 1)^2"),  # from above at a point that halving reaches
        (0, "x - 1/3"),
        ("x - 1/3", "(x - 1/3)^2"),
    ],
)
def test_a_zero_that_may_be_there_is_not_passed_over(value, zero):
    """Where `zero` vanishes without changing its sign: the value is not positive there."""
    forms = [rounded(b_form(on_simplex(Polynomial(p).raw, SEGMENT), 2, 1))[None] for p in (value, zero)]
    assert prove_positive(forms[0], np.eye(3)[None, :2], forms[1]).status is Status.UNDECIDED


def one_simplex(value, zero, below=False):
    """The claim on one tetrahedron with these B-coefficients, before it is halved."""
    forms, corners, limits = (np.array([value]), np.array([zero])), np.eye(4)[None, :, :3], Limits(depth=0)
    return prove_positive(forms[0], corners, forms[1], limits, below=below)


def test_a_multiple_of_what_vanishes_may_be_added():
    zero = np.array([1.0, -0.5, 0.25, -0.125])
    for times in (0.7, -0.9):
        assert one_simplex(0.05 + times * zero, zero).status is Status.PROVED
        assert one_simplex(-0.05 + times * zero, zero).status is Status.REFUTED
    assert one_simplex([0.5, 0.5, -0.1, 0.5], [1.0, -1.0, 0.0, 0.5]).status is Status.UNDECIDED  # nothing to add there
    assert one_simplex([-0.5, -0.5, 0.5, 0.5], [1.0, -1.0, 0.5, 0.5]).status is Status.UNDECIDED  # t > 1/2 and < -1/2


def test_only_a_positive_multiple_of_what_is_not_positive_may_be_added():
    inside = np.array([1.0, -1.0, 0.5, -0.5])
    assert one_simplex(0.1 - 0.5 * inside, inside, below=True).status is Status.PROVED
    assert one_simplex(0.1 + 0.5 * inside, inside, below=True).status is not Status.PROVED  # wrong where it is -1


def test_none_of_several_is_positive():
    """Beside one that settles a simplex another does not count, and all are negative where a claim is refuted."""
    corners, limits = np.eye(4)[None, :, :3], Limits(depth=0)
    value, low, high = (np.array([c]) for c in ([-0.5, 0.5, 0.5, 0.5], [-1.0] * 4, [0.25] * 4))
    for inside, status in (
        ([low, high], "proved"),
        ([high, low], "proved"),
        ([low, low], "refuted"),
        ([low], "refuted"),
    ):
        assert prove_positive(value, corners, inside, limits, below=True).status.value == status
    there = np.array([[0.5, -0.5, 0.5, 0.5]])
    assert prove_positive(value, corners, [low, there], limits, below=True).status is Status.UNDECIDED
    found = prove_positive(low, corners, [low, np.array([[0.5, 0.5, -0.5, 0.5]])], limits, below=True)
    assert found.status is Status.REFUTED and found.witness.tolist() == [0, 0, 1]


@pytest.mark.parametrize("times", [0.5, -0.25, -1.0])
def test_rounding_of_multiples_is_accounted_for(times):
    zero = np.array([0.5, -0.5, 0.25, -0.125])
    for margin, status in ((2.0**-52, Status.UNDECIDED), (2.0**-51, Status.UNDECIDED), (2.0**-48, Status.PROVED)):
        assert one_simplex(margin + times * zero, zero).status is status


def test_what_the_limits_leave_open_is_not_proved():
    """x^2 + 1/1000 is positive, which takes some halvings."""
    form = rounded(b_form(on_simplex(Polynomial("(x - 1/3)^2 + 1/1000").raw, SEGMENT), 2, 1))[None]
    corners = np.eye(3)[None, :2]
    assert prove_positive(form, corners).status is Status.PROVED
    for limits in (Limits(depth=0), Limits(depth=2), Limits(cells=0)):
        result = prove_positive(form, corners, limits=limits)
        assert result.status is Status.UNDECIDED
        assert len(result.undecided) == len(result.sources) > 0


@pytest.mark.parametrize("cell", range(5))
def test_every_simplex_counts(cell):
    """One of five is negative, or open: the verdict is about it, and its number is told."""
    corners = np.array([np.eye(3)[:2] + i for i in range(5)])
    for bad, status in ((-1.0, Status.REFUTED), (0.0, Status.UNDECIDED)):
        value = np.ones((5, 3))
        value[cell] = bad
        result = prove_positive(value, corners, limits=Limits(depth=2))
        assert result.status is status
        assert set(result.sources) == {cell}
        if result.witness is not None:
            assert np.abs(result.witness - corners[cell].mean(axis=0)).max() <= 0.5


def test_cells_that_wait_stay_open():
    """One of eight waits while the others are split, and in the end nothing else is open."""
    whole = Boxes.of(np.array([[0.0, 0, 0], [1, 1, 1]]))

    def judge(cells, depth):
        fates = np.full(len(cells), Fate.SETTLED if depth == 3 else Fate.SPLIT)
        fates[(cells.centers < 0.3).all(axis=1) & (cells.halves[:, 0] == 0.25)] = Fate.WAIT
        return fates.astype(np.intp)

    found = search(whole, judge, Boxes.eighths, Limits(), "testing")
    assert found.status is Status.UNDECIDED
    assert found.open.centers.tolist() == [[0.25] * 3]
    assert found.examined == 1 + 8 + 7 * 8 + 7 * 64


def test_the_bound_is_that_of_the_highest_degree():
    forms = [np.full((1, size), 0.5) for size in (3, 21, 6)]
    cells = Simplices.of(forms, np.eye(3)[None]).halved().halved()
    assert cells.degrees == (1, 5, 2)
    assert cells.bound == rounding_bound(5, 2) > rounding_bound(1, 2)


def test_critical_parts_are_free_of_what_must_not_be_in_them():
    """Parts are cut until they are free, and told how far the function is from 0 for certain."""
    bowl, middle = "(x - 1/3)^2 + (y - 1/4)^2 + (z - 1/5)^2 + 1/10", np.array([1 / 3, 1 / 4, 1 / 5])
    tetrahedron = [vector(v) for v in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    form = own_form(Polynomial(bowl).raw, tetrahedron)
    corners = np.array([[to_floats(v) for v in tetrahedron]])
    parts = critical_parts(isolated(form, corners), lambda _, some: np.ptp(some, axis=1).max(axis=1) < 0.05)
    assert not len(parts.open) and (parts.kept.table > 0).all()
    assert (np.ptp(parts.kept.corners, axis=1) < 0.05).all()
    low, high = parts.kept.corners.min(axis=1), parts.kept.corners.max(axis=1)
    assert ((low <= middle) & (middle <= high)).all(axis=1).any()
    told = []
    critical_parts(isolated(np.full((1, 10), -0.5), corners, 1e-4), lambda least, some: told.append(least) or least > 0)
    assert len(told) == 1 and 0.49 < told[0][0] <= 0.5 - 1e-4


@pytest.mark.parametrize("root", ["1/3", "2/3", "1/1000", "999/1000"])
def test_every_half_counts(root):
    """A value that is negative next to one point only: each child of each halving is looked at."""
    f = Polynomial(f"(x - {root})^2 - 1/10^10")
    form = rounded(b_form(on_simplex(f.raw, SEGMENT), 2, 1))[None]
    result = prove_positive(form, np.array([[[0.0, 0, 0], [1, 0, 0]]]))
    assert result.status is Status.REFUTED
    assert f.at([Fraction(c) for c in result.witness.tolist()]) < 0
