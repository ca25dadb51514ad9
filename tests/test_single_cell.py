"""Single-surface blends: placement, spaces by different methods, trivial members, proofs."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import pas

COAXIAL = [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "x + 1")]
ELBOW = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
THREE = [*ELBOW, ("x^2 + y^2 - 1", "z - 2")]
SPHERES = [("(x + 2)^2 + y^2 + z^2 - 4", "x + 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")]
SKEW = [("y^2 + z^2 - 1", "x - 2"), ("(x - 1/3)^2 + 2*z^2 - 1", "y - 3"), ("(x + y)^2 + (y - 1)^2/2 - 3/4", "z + 5/2")]
CURVED = [("y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 5"), ("x^2 + y^2 - 1/4", "z - 3 - x^2")]
BOX = ((-2, -2, -2), (2, 2, 2))
METHODS = ("linear", "normal-form", "intersection", "syzygy")


def test_the_box():
    cell = pas.SingleCell((0, 0, 0), (1, 2, "3"))
    assert len(cell.cells) == 12
    assert cell.pieces == (tuple(range(12)),)
    assert cell.interior_faces == ()
    volumes = np.abs(np.linalg.det(np.diff(cell.points[np.array(cell.cells)], axis=1))) / 6
    assert volumes.sum() == pytest.approx(6)
    assert sorted(np.unique(cell.piece_of)) == [0]
    off_centre = pas.SingleCell((0, 0, 0), (1, 1, 1), center=("1/4", "1/2", "3/4"))
    assert off_centre.locate(np.array([[0.1, 0.2, 0.3], [1.1, 0, 0]])).tolist()[1] == -1


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: pas.SingleCell((0, 0, 0)), "both lower and upper"),
        (lambda: pas.SingleCell((0, 0, 0), (1, 0, 1)), "below the upper one"),
        (lambda: pas.SingleCell((0, 0, 0), (1, 1, 1), (2, 0, 0)), "inside its box"),
        (lambda: pas.Partition([(0, 0, 0)], [(0, 1, 2, 3)]), "four different vertex numbers"),
        (
            lambda: pas.Partition([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)], pieces=[]),
            "hold each of the 1 cells once",
        ),
    ],
)
def test_bad_cells(make, words):
    with pytest.raises((ValueError, pas.GeometryError), match=words):
        make()


@pytest.mark.parametrize("contacts", [COAXIAL, ELBOW, THREE, SPHERES, SKEW, CURVED])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.sampled(6)
def test_all_methods_give_the_same_space(contacts, order):
    for degree in range(2, 6):
        linear, *others = (pas.solutions(contacts, order, degree, pas.SingleCell(), method=m) for m in METHODS)
        for other in others:
            assert linear.equals(other)


def test_the_same_space_is_not_just_the_same_dimension():
    a = pas.solutions(COAXIAL, 1, 3, pas.SingleCell())
    b = pas.solutions([("y^2 + z^2 - 1", "x - 2"), COAXIAL[1]], 1, 3, pas.SingleCell())
    assert a.dimension == b.dimension == 2
    assert not a.equals(b)
    assert not a.equals(pas.solutions(COAXIAL, 1, 4, pas.SingleCell()))


def test_the_region_does_not_change_the_space():
    inside = pas.solutions(ELBOW, 1, 4, pas.SingleCell((-2, -2, -2), (2, 2, 3)))
    everywhere = pas.solutions(ELBOW, 1, 4, pas.SingleCell())
    assert inside.equals(everywhere)
    assert [m[0] for m in inside.basis] == [m[0] for m in everywhere.basis]


def test_lowest_degrees_and_what_was_tried():
    assert pas.solutions(COAXIAL, 1, partition=pas.SingleCell()).degrees_tried == {1: 0, 2: 0, 3: 2}
    space = pas.solutions(THREE, 1, partition=pas.SingleCell(), highest_degree=3)
    assert (space.dimension, space.degree, space.degrees_tried) == (0, 3, {1: 0, 2: 0, 3: 0})
    assert space.basis == ()
    assert not space.regular


def test_regular_members_come_later_where_the_first_are_singular():
    """Six unit pipes: the first quartic is a square, every quintic a multiple of it."""
    six = [(f"{a}^2 + {b}^2 - 1", f"{c} {sign} 2") for a, b, c in ("yzx", "xzy", "xyz") for sign in "+-"]
    first = pas.solutions(six, 1, partition=pas.SingleCell())
    assert (first.degree, first.dimension, first.regular) == (4, 1, False)
    assert first.basis[0][0] == pas.Polynomial("(x^2 + y^2 + z^2 - 5)^2")
    assert any("singular along contact 6" in text for text in first.trivial_part.remarks())
    quintics = pas.solutions(six, 1, 5, pas.SingleCell())
    assert quintics.trivial_part.common_factor == pas.Polynomial("(x^2 + y^2 + z^2 - 5)^2")
    regular = pas.solutions(six, 1, partition=pas.SingleCell(), regular=True)
    assert (regular.degree, regular.regular) == (6, True)
    with pytest.raises(pas.NoSolutionError, match="no usable surface of degree 4"):
        pas.blend(six, 1, 4, pas.SingleCell(*BOX))


def test_trivial_part_of_the_three_cylinders():
    trivial = pas.solutions(THREE, 1, 4, pas.SingleCell()).trivial_part
    for part in trivial.singular:
        assert [m[0] for m in part.basis] == [pas.Polynomial("(x^2 + y^2 + z^2 - 5)^2")]
    assert trivial.products.dimension == 0
    assert trivial.same_everywhere is None
    assert trivial.common_factor == 1


def test_trivial_part_of_the_elbow():
    generic = pas.solutions([ELBOW[0], ("x^2 + z^2 - 1", "y - 3")], 1, 4, pas.SingleCell())
    products = ["(y^2+z^2-1)*(x^2+z^2-1)", "(y^2+z^2-1)*(y-3)^2", "(x^2+z^2-1)*(x-2)^2", "(x-2)^2*(y-3)^2"]
    assert generic.equals(generic.restricted([(p,) for p in products]))
    assert generic.trivial_part.products.dimension == 4
    assert "all members are sums of products" in str(generic.trivial_part)
    special = pas.solutions(ELBOW, 1, 4, pas.SingleCell())
    assert (special.dimension, special.trivial_part.products.dimension) == (7, 4)


def test_trivial_part_of_a_corner():
    pipes = [pas.Pipe(axis, "1/3", 1) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    space = pas.solutions(pipes, 1, 4)
    single = pas.solutions(pipes, 1, 4, pas.SingleCell())
    trivial = space.trivial_part
    assert trivial.same_everywhere.dimension == single.dimension == 2
    assert all((m[0],) * 6 in space for m in single.basis)
    assert trivial.products is None


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("contacts", "box", "order"), [
    (ELBOW, BOX, 1),
    (COAXIAL, ((-1, -3, -3), (1, 3, 3)), 1),
    (COAXIAL, ((-1, -3, -3), (1, 3, 3)), 2),
    (THREE, BOX, 1),
    (SPHERES, ((-2, -3, -3), (1, 3, 3)), 2),
])  # fmt: skip
def test_single_surface_blends_are_proved(contacts, box, order, tmp_path):
    blend = pas.blend(contacts, order, partition=pas.SingleCell(*box))
    assert blend.certificate.proved
    assert len(blend.certificate.verdicts) == len(contacts) + 2
    mesh = blend.surface.mesh(0.05)
    assert len(mesh.boundary) > 0
    # a sphere with one hole for each contact
    assert mesh.euler_characteristic == 2 - len(contacts)
    again = pas.load(blend.save(tmp_path / "single.pas.json"))
    assert again.surface.polynomials == blend.surface.polynomials
    assert again.surface.certify().proved


def test_verdicts_without_a_region_are_undecided():
    space = pas.solutions(COAXIAL, 1, 3, pas.SingleCell())
    surface = space.member([1, 1])
    verdicts = surface.certify().verdicts
    assert all(v.status is pas.Status.UNDECIDED for v in verdicts)
    assert "exactly" in verdicts[0].reason
    assert surface([[0, 1, 1]]) == pytest.approx(float(surface.polynomials[0].at((0, 1, 1))))
    wrong = pas.PiecewiseSurface.from_polynomials(space.partition, space.contacts, 1, ["x"])
    assert wrong.certify().verdicts[0].status is pas.Status.REFUTED
    with pytest.raises(pas.MeshError, match="no region"):
        surface.mesh()
    with pytest.raises(ValueError, match="needs a region"):
        space.fit()


@pytest.mark.parametrize(
    ("contacts", "error", "words"),
    [
        ([("0", "x")], ValueError, "polynomial that is not constant"),
        ([("x^2 + y^2 - 1", "3")], ValueError, "clip of a contact must be a polynomial that is not constant"),
        ([("(x - 1)*y", "x - 1")], ValueError, "common factor x - 1"),
        ([("x^2 + y^2 + 1", "z")], pas.GeometryError, "contact 1: .* no real curve"),
        ([COAXIAL[0], ("x^2 + y^2", "z")], pas.GeometryError, "contact 2: .* no real curve"),
        ([("y^2 + z^2 - 1", "y - 1")], pas.GeometryError, "contact 1: .* touches"),
        ([("x", "x - 1")], pas.GeometryError, "contact 1: .* no common point"),
        ([("x^2 + y^2 - 1", "z"), ("x^2 + z^2 - 1", "y")], pas.GeometryError, "contacts 1 and 2 meet in 2 points"),
        ([COAXIAL[0], COAXIAL[0]], pas.GeometryError, "contacts 1 and 2 have a whole curve in common"),
        ([("x^2 + w", "z")], ValueError, "variable 'w' is not one of x, y, z"),
        ([("x/y", "z")], ValueError, "divides by a polynomial"),
        ([("sin(x)", "z")], ValueError, "variable .sin. is not one of x, y, z"),
        ([], ValueError, "at least one contact"),
    ],
)
def test_bad_contacts_are_one_sentence(contacts, error, words):
    with pytest.raises(error, match=words):
        pas.solutions(contacts, 1, partition=pas.SingleCell())


def test_symbols_where_numbers_are_needed():
    import sympy

    x, y, z, r = sympy.symbols("x y z r")
    with pytest.raises(ValueError, match=r"r is not one of them; .* pas\.existence"):
        pas.solutions([(y**2 + z**2 - r**2, x - 1)], 1, partition=pas.SingleCell())


def test_wrong_arguments():
    with pytest.raises(ValueError, match="method must be one of linear, syzygy for several cells, not 'intersection'"):
        pas.solutions([pas.Pipe(a, "1/3", 1) for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], 1, method="intersection")
    with pytest.raises(ValueError, match="method must be one of linear, normal-form, intersection, syzygy"):
        pas.solutions(COAXIAL, 1, partition=pas.SingleCell(), method="magic")
    with pytest.raises(ValueError, match="highest_degree must be a whole number from 1 to 12"):
        pas.solutions(COAXIAL, 1, partition=pas.SingleCell(), highest_degree=40)
    with pytest.raises(pas.GeometryError, match=r"partition=pas\.SingleCell"):
        pas.solutions(COAXIAL, 1, partition="six tetrahedra")


def test_limits_stop_a_search_in_words():
    with pytest.raises(pas.LimitError, match=r"gave up after 1e-06 s while .*; allow more seconds"):
        pas.solutions(THREE, 1, partition=pas.SingleCell(), seconds=1e-6)
    assert pas.solutions(THREE, 1, partition=pas.SingleCell()).dimension == 2


def test_numerators_of_a_hundred_digits():
    big = Fraction(10**100 + 267, 10**99 + 9)
    contacts = [(f"y^2 + z^2 - {big}", "x - 1"), ("y^2 + z^2 - 4", f"x + {big}")]
    for method in METHODS:
        assert pas.solutions(contacts, 1, 3, pas.SingleCell(), method=method).dimension == 2


def test_clips_inside_the_region_are_examined_there():
    with pytest.raises(pas.GeometryError, match="not closed inside its face"):
        pas.solutions(COAXIAL, 1, partition=pas.SingleCell((-1, -1, -1), (1, 1, 1)))
    wide = pas.SingleCell((-3, -3, -3), (3, 3, 3))
    space = pas.solutions(COAXIAL, 1, 3, wide)
    first, second, _, enclosed = space.member([1, 0]).certify().verdicts
    assert first.proved
    assert "closed inside the region" in first.reason
    assert second.status is pas.Status.REFUTED  # 4 x y^2 + 4 x z^2 + .. has the pipe inside out at x = -1
    assert "alpha" in second.reason
    assert np.hypot(*second.witness[1:]) == pytest.approx(2)
    assert enclosed.status is pas.Status.UNDECIDED
    with pytest.raises(ValueError, match="no side of the region lies in the clip plane of contact 1"):
        space.fit()
