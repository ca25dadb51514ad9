"""Rims: the closed plane curves along which contacts meet blends, from their polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from flint import fmpq

import pas
from pas.algebra.rational import to_floats
from pas.contacts.rims import outlook, rim_of

BALL = "x^2 + y^2 + z^2 - 1"
TORUS = "(x^2 + y^2 + z^2 + 4 - 1/4)^2 - 16*(x^2 + y^2)"
"""Of radii 2 and 1/2 around z."""

CUBIC = "y^2 - x^3 + x"
"""An oval between x = -1 and 0, and a branch that goes to infinity."""

ELLIPSES = {
    "pipe": (pas.Pipe((1, 2, -2), "1/4", "2/3", (1, 0, "1/2")), ("5/3", "4/3", "-5/6"), (0.25, 0.25)),
    "cone": (pas.Cone((0, 0, 2), "1/2", "3/2", "1/4", (1, 0, 0)), (1, 0, 3), (0.5, 0.5)),
    "ball": (pas.Contact(BALL, "2*x - 1"), ("1/2", 0, 0), (0.75**0.5, 0.75**0.5)),
    "leaning": (pas.Contact("x^2 + y^2 - 1", "z - 2*x - 3"), (0, 0, 3), (1, 5**0.5)),
    "plate": (pas.Contact("z - 1", "x^2 + 4*y^2 - 1"), (0, 0, 1), (0.5, 1)),
    "slender": (pas.Contact("x^2 + 1000000000000*y^2 - 1", "z"), (0, 0, 0), (1e-6, 1)),
}


@pytest.mark.parametrize("name", ELLIPSES)
def test_ellipses_have_exact_centres_and_semiaxes(name):
    contact, center, radii = ELLIPSES[name]
    rim = contact.rim
    assert rim.center == tuple(fmpq(*pas.Polynomial(c).at((0, 0, 0)).as_integer_ratio()) for c in center)
    assert rim.radii == pytest.approx(radii, rel=1e-14)
    points = rim.points(50)
    assert points.shape == (50, 3)
    for polynomial in (contact.contact.surface, contact.contact.clip):
        slopes = np.linalg.norm(polynomial.gradient(points), axis=1)
        assert np.abs(polynomial(points) / slopes).max() < 1e-14
    longer, shorter = rim.semiaxes
    assert abs(longer @ shorter) < 1e-15 * (longer @ longer)
    assert counterclockwise(rim)
    assert rim.plane.at(rim.center) == 0


def counterclockwise(rim):
    around = rim.points(50) - np.array(to_floats(rim.center))
    return (np.cross(around, np.roll(around, -1, axis=0)) @ np.array(to_floats(rim.normal)) > 0).all()


def test_normals_point_away_from_the_blend():
    assert pas.Pipe((1, 0, 0), 1, 2).rim.normal == (1, 0, 0)
    assert pas.Pipe((1, 0, 0), 1, -2).rim.normal == (-1, 0, 0)
    assert pas.Contact("z - 1", "x^2 + y^2 - 1").rim.normal == (0, 0, -1), "into the plate, whose inside is below"


@pytest.mark.parametrize(
    ("surface", "clip", "near", "center", "radii"),
    [
        (TORUS, "y", (3, 0, 0), (2, 0, 0), (0.5, 0.5)),
        (TORUS, "y", (-1, 0, 1), (-2, 0, 0), (0.5, 0.5)),
        (TORUS, "z", (1, 0, 0), (0, 0, 0), (1.5, 1.5)),
        (TORUS, "x - 1", (1, 1, 1), (1, 1.712, 0), (0.4988, 0.5939)),
        (TORUS, "x - 9/4", None, (2.25, 0, 0), (0.433, 1.0897)),
        (CUBIC, "z", None, (-0.521, 0, 0), (0.479, 0.626)),
    ],
)
def test_curves_of_higher_degree(surface, clip, near, center, radii):
    surface, clip = pas.Polynomial(surface), pas.Polynomial(clip)
    rim = rim_of(surface, clip, near)
    assert to_floats(rim.center) == pytest.approx(center, abs=2e-3)
    assert clip.raw(*rim.center) == 0
    assert rim.radii == pytest.approx(radii, rel=1e-3)
    points = rim.points(80)
    for polynomial in (surface, clip):
        assert np.abs(polynomial(points) / np.linalg.norm(polynomial.gradient(points), axis=1)).max() < 1e-14
    assert counterclockwise(rim)
    steps = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    assert steps.max() < 1.2 * steps.min(), "evenly spread, all the way round"


@pytest.mark.parametrize(
    ("surface", "clip", "words"),
    [
        (BALL, "x - 2", "cuts the surface .* in no real point"),
        (BALL, "x - 1", "in a single point"),
        (BALL, "x^2 + y^2 - 1/2", "in a curve that is in no plane"),
        ("x^2 + y^2 - 1", "x - 1/2", "in a curve that is not closed"),
        ("x^2 + y^2 - 1", "x - 2", "in no real point"),
        ("x^2 + y^2 - z^2 - 1", "x", "in a curve that is not closed"),
        ("y - x^3", "z", "in a curve that is not closed"),
        ("x*y^2 - 1", "z", "in a curve that is not closed"),
        ("x^4 + y^4 + z + 1", "z", "in no real point"),
        (TORUS, "y", r"in 2 closed curves, around \((-?)2, 0, 0\), \((-?)2, 0, 0\); say near which point yours is"),
        (TORUS, "z - 1/2", "touches it along a closed curve"),
        (TORUS, "x - 3/2", r"a singular point at \(1.5, "),
        ("y^2 - x^2 + x^4", "z", "a singular point at"),
        ("(x^2 + y^2 + z - 1)*((x - 1)^2 + y^2 - 1)", "z", "in 2 closed curves"),
    ],
)
def test_what_has_no_rim_is_refused_in_a_sentence(surface, clip, words):
    with pytest.raises(pas.GeometryError, match=words):
        _ = pas.Contact(surface, clip).rim


def test_a_point_where_two_components_cross_is_no_point_of_a_rim():
    crossing = pas.Polynomial("(x^2 + y^2 + z - 1)*((x - 1)^2 + y^2 - 1)")
    with pytest.raises(pas.GeometryError, match=r"a singular point at \(0.5, -?0.866025, 0\)"):
        rim_of(crossing, pas.Polynomial("z"), (-1, 0, 0))


def test_a_point_says_which_of_several_curves_is_meant(tmp_path):
    contact = pas.Contact(TORUS, "y", near=(-1, 0, 0))
    assert contact == pas.Contact(TORUS, "y") and repr(contact) == repr(pas.Contact(TORUS, "y"))
    assert contact.rim.center == (-2, 0, 0)
    assert contact.rotate((0, 0, 1), 90).rim.center == (0, -2, 0)
    assert contact.translate((5, 0, 0)).rim.center == (3, 0, 0)
    path = tmp_path / "problem.toml"
    path.write_text(f'order = 1\n[[contacts]]\nsurface = "{TORUS}"\nclip = "y"\nnear = [3, 0, 0]\n')
    assert pas.read_problem(path).contacts[0].rim.center == (2, 0, 0)
    with pytest.raises(ValueError, match="near must be three numbers"):
        pas.Contact(TORUS, "y", near=(1, 2))


def test_the_outlook_from_a_centre():
    pipe = pas.Pipe((1, 0, 0), 1, 1)
    cosine, place = outlook(pipe.contact.surface, pipe.rim, (0, 0, 0))
    assert cosine == pytest.approx(0.5**0.5) and np.hypot(*place[1:]) == pytest.approx(1)
    ball = pas.Sphere(
        (1, 0, 0), 1, "-3/5", ("8/5", 0, 0)
    )  # cut at x = 1, where its cone of tangents has its tip at -1/15
    for center, seen in ((-1, False), ("-1/15", None), (0, True)):
        cosine, _ = outlook(ball.contact.surface, ball.rim, (center, 0, 0))
        assert abs(cosine) < 1e-14 if seen is None else (cosine > 0) is seen


@pytest.mark.parametrize("contact", [pas.Pipe((1, 2, 0), "1/3", 1, (0, 1, 0)), pas.Contact(BALL, "x + y - 1/2")])
def test_contacts_are_moved_exactly(contact):
    moved = contact.rotate((0, 0, 1), 90).translate((1, 2, 3))
    assert type(moved) is type(contact)
    for point in ((0, 0, 0), ("1/2", 1, "1/3"), (2, "-1/5", 1)):
        x, y, z = (pas.Polynomial(c).at((0, 0, 0)) for c in point)
        for before, after in zip(pair(contact), pair(moved), strict=True):
            assert before.at((x, y, z)) == after.at((1 - y, 2 + x, 3 + z))
    turned = contact.rotate((1, 2, 3), 77, center=(1, 1, 0))
    back = turned.rotate((1, 2, 3), -77, center=(1, 1, 0))
    assert [p.primitive() for p in pair(back)] == [p.primitive() for p in pair(contact)]
    assert turned.rim.radii == pytest.approx(contact.rim.radii, rel=1e-14)


def pair(contact):
    return contact.contact.surface, contact.contact.clip
