"""Every kind of contact: its polynomials, its rim, its table in problem files, its moves and its sentences."""

from __future__ import annotations

import json
from inspect import isclass

import numpy as np
import pytest

import pas
from pas.algebra.rational import rational
from pas.contacts.contact import CONTACTS, Contact, as_contact

ACROSS = [(0, "1/2", 0), (0, 0, "1/3")]
"""Semi-axes across x."""

SAMPLES = {
    "pipes": {"axis": (1, 0, 0), "radius": "1/3", "clip": 1},
    "cones": {"axis": (1, 0, 0), "radius": "1/3", "clip": 1, "slope": "1/10"},
    "elliptic_pipes": {"axis": (1, 0, 0), "semiaxes": ACROSS, "clip": 1},
    "paraboloids": {"axis": (1, 0, 0), "semiaxes": ACROSS, "clip": 2, "point": (-1, 0, 0)},
    "hyperboloids": {"axis": (1, 0, 0), "semiaxes": ACROSS, "conjugate": 3, "clip": 1},
    "spheres": {"axis": (2, 0, 0), "radius": 1, "clip": "-1/4", "point": ("3/2", 0, 0)},
    "ellipsoids": {"axis": (1, 1, 0), "semiaxes": [(2, 0, 0), *ACROSS], "clip": "-1/2", "point": (2, 0, 0)},
    "tori": {"axis": (0, 0, 1), "arm": (0, 2, 0), "radius": "1/2", "point": (1, -2, 0)},
    "plates": {"axis": (-1, 0, 0), "radius": "1/2", "point": (1, 0, 0)},
    "openings": {"surface": "x - 1", "axis": (1, 0, 0), "slope": "1/2"},
    "quadrics": {"quadric": "x*y + 9*z^2 + y^2 - 1/9", "clip": "x - y - 1"},
    "contacts": {"surface": "y^2 + z^2 - 1/9", "clip": "x - 1"},
}

SIDES = {
    "pipes": [("inside", (5, "1/4", 0)), ("outside", (0, "1/2", 0)), ("blend", (0, 0, 9)), ("beyond", (2, 0, 0))],
    "cones": [("inside", (2, "2/5", 0)), ("outside", (0, "2/5", 0)), ("blend", (0, 0, 9)), ("beyond", (2, 0, 0))],
    "elliptic_pipes": [("inside", (5, "2/5", 0)), ("outside", (0, 0, "2/5")), ("blend", (0, 0, 9))],
    "paraboloids": [
        ("inside", (0, "1/4", 0)),
        ("outside", (0, 0, "1/3")),
        ("outside", (-2, 0, 0)),
        ("blend", (0, 0, 9)),
    ],
    "hyperboloids": [
        ("inside", (3, "3/5", 0)),
        ("outside", (0, "3/5", 0)),
        ("blend", (0, 0, 9)),
        ("beyond", (2, 0, 0)),
    ],
    "spheres": [("inside", ("3/2", 0, 0)), ("outside", (0, 0, 0)), ("blend", (0, 0, 0)), ("beyond", ("3/2", 0, 0))],
    "ellipsoids": [("inside", (3, 0, 0)), ("outside", (2, 1, 0)), ("blend", (0, 0, 0)), ("beyond", (2, 0, 0))],
    "tori": [("inside", (1, "1/3", 0)), ("outside", (1, -2, 0)), ("blend", (2, 0, 0)), ("beyond", (0, 0, 0))],
    "plates": [("inside", (2, 9, 9)), ("outside", (0, 0, 0)), ("blend", (0, "1/3", 0)), ("beyond", (0, 0, 1))],
    "openings": [("inside", (0, 3, 0)), ("outside", (2, 0, 0)), ("blend", (1, "1/3", 0)), ("beyond", (1, 1, 0))],
    "quadrics": [("inside", ("1/2", 0, 0)), ("outside", (0, 0, 1)), ("blend", (0, 0, 0)), ("beyond", (2, 0, 0))],
    "contacts": [("inside", (0, 0, 0)), ("outside", (0, 1, 0)), ("blend", (0, 0, 0)), ("beyond", (2, 0, 0))],
}
"""Points of which it is known whether they are inside the surface, and whether on the blend's side of the clip."""

WRONG = {
    "pipes": [({"radius": 0}, ValueError, "radius must be positive")],
    "cones": [({"axis": (0, 0, 0)}, ValueError, "axis must not be the zero vector")],
    "elliptic_pipes": [
        ({"semiaxes": [(0, 1, 0)]}, ValueError, "semiaxes must be 2 vectors across one another"),
        ({"semiaxes": [(0, 1, 0), (0, 1, 1)]}, ValueError, "semiaxes must be perpendicular to one another"),
        ({"semiaxes": [(1, 1, 0), (0, 0, 1)]}, ValueError, r"semiaxes\[0\] must be perpendicular to \(1, 0, 0\)"),
        ({"semiaxes": [(0, 0, 0), (0, 0, 1)]}, ValueError, r"semiaxes\[0\] must not be the zero vector"),
        ({"semiaxes": "wide"}, ValueError, "semiaxes must be 2 vectors"),
    ],
    "paraboloids": [({"clip": 0}, ValueError, "clip must not be 0, where a paraboloid has its vertex")],
    "hyperboloids": [({"conjugate": -1}, ValueError, "conjugate must be positive, not -1")],
    "spheres": [
        ({"clip": 1}, pas.GeometryError, "the clip .* cuts the surface .* in no real point"),
        ({"clip": "1/2"}, pas.GeometryError, "in a single point"),
        ({"radius": "-1"}, ValueError, "radius must be positive"),
    ],
    "ellipsoids": [
        ({"clip": 9}, pas.GeometryError, "in no real point"),
        ({"semiaxes": ACROSS}, ValueError, "semiaxes must be 3 vectors"),
    ],
    "tori": [
        ({"arm": (0, 1, 1)}, ValueError, r"arm must be perpendicular to the axis \(0, 0, 1\), and \(0, 1, 1\) is not"),
        ({"arm": (0, 0, 0)}, ValueError, "arm must not be the zero vector"),
        ({"radius": 2}, pas.GeometryError, "a torus of radius 2 needs a longer arm"),
    ],
    "plates": [
        ({"semiaxes": [(0, 1, 0), (0, 0, 2)]}, ValueError, "radius or semiaxes must be given, and not both"),
        ({"radius": None}, ValueError, "radius or semiaxes must be given"),
        ({"radius": 0}, ValueError, "radius must be positive"),
    ],
    "openings": [
        ({"point": (2, 0, 0)}, pas.GeometryError, r"the point \(2, 0, 0\) must be inside the surface"),
        ({"slope": 0}, ValueError, "slope must be positive"),
        ({"axis": (0, 0, 0)}, ValueError, "axis must not be the zero vector"),
        ({"surface": "x +"}, ValueError, "surface"),
    ],
    "quadrics": [
        ({"quadric": "x^3 - 1"}, ValueError, "quadric must be of degree 2, and x.3 - 1 is of degree 3"),
        ({"quadric": [[1, 0], [0, 1]]}, ValueError, "quadric must be a polynomial or a symmetric matrix of 4 rows"),
        ({"quadric": np.triu(np.ones((4, 4))).tolist()}, ValueError, r"quadric\[1\]\[0\] is not quadric\[0\]\[1\]"),
        ({"quadric": "x^2 +"}, ValueError, "quadric"),
        ({"clip": 3}, ValueError, "clip of a contact"),
    ],
    "contacts": [({"surface": 0}, ValueError, "surface of a contact")],
}

every_kind = pytest.mark.parametrize("table", CONTACTS)


def sample(table):
    return CONTACTS[table](**SAMPLES[table])


def pair(kind):
    return kind.contact.surface, kind.contact.clip


def test_every_kind_has_its_samples_and_a_public_name():
    assert set(SAMPLES) == set(SIDES) == set(WRONG) == set(CONTACTS)
    public = {thing for name in pas.__all__ if isclass(thing := getattr(pas, name))}
    assert set(CONTACTS.values()) <= public


@every_kind
def test_polynomials_are_negative_inside_and_clips_on_the_blends_side(table):
    contact = sample(table).contact
    for where, point in SIDES[table]:
        value = (contact.surface if where in ("inside", "outside") else contact.clip).at(point)
        assert (value < 0) is (where in ("inside", "blend")) and value != 0, (where, point)


@every_kind
def test_rims_are_on_both_polynomials(table):
    kind = sample(table)
    rim = kind.rim
    points = rim.points(64)
    for polynomial in (kind.contact.surface, kind.contact.clip):
        assert np.abs(polynomial(points) / np.linalg.norm(polynomial.gradient(points), axis=1)).max() < 1e-14
    flat = kind.contact.clip if kind.contact.clip.degree == 1 else kind.contact.surface
    assert rim.plane.primitive() == flat.primitive()
    for where, point in SIDES[table] if flat is kind.contact.clip else []:
        if where in ("blend", "beyond"):
            assert (rim.plane.at(point) < 0) is (where == "blend"), "the normal points away from the blend"


@every_kind
def test_contacts_are_moved_as_what_they_are(table):
    kind = sample(table)
    moved = kind.rotate((0, 0, 1), 90, center=(1, 0, 0)).translate((0, 0, 5))
    assert type(moved) is type(kind)
    for where, point in SIDES[table]:
        x, y, z = (rational(c) for c in point)
        for before, after in zip(pair(kind), pair(moved), strict=True):
            assert before.at((x, y, z)) == after.at((1 - y, x - 1, z + 5)), where
    leaning = kind.rotate((1, 2, 3), 40)
    assert leaning.rim.radii == pytest.approx(kind.rim.radii, rel=1e-12)


@every_kind
def test_every_kind_is_read_from_its_table(table, tmp_path):
    text = "\n".join(f"{key} = {json.dumps(value)}" for key, value in SAMPLES[table].items())
    path = tmp_path / "problem.toml"
    path.write_text(f"order = 1\n[[{table}]]\n{text}\n")
    (found,) = pas.read_problem(path).contacts
    assert found == sample(table)
    assert hash(found) == hash(sample(table))
    assert as_contact(found) == found.contact
    path.write_text(f"order = 1\n[[{table}]]\n{text}\nnothing = 1\n")
    with pytest.raises(pas.ProblemFileError, match="nothing"):
        pas.read_problem(path)


@pytest.mark.parametrize(("table", "changes", "error", "words"), [(t, *case) for t, cs in WRONG.items() for case in cs])
def test_wrong_values_get_a_sentence(table, changes, error, words):
    with pytest.raises(error, match=words):
        CONTACTS[table](**SAMPLES[table] | changes)


def test_files_name_the_entry_at_fault(tmp_path):
    path = tmp_path / "problem.toml"
    path.write_text('order = 1\n[[tori]]\naxis = [0, 0, 1]\narm = [0, 1, 1]\nradius = "1/2"\n')
    with pytest.raises(pas.ProblemFileError, match=r"line 4.*torus 1: arm must be perpendicular"):
        pas.read_problem(path)
    path.write_text("order = 1\n[[elliptic_pipes]]\naxis = [0, 0, 1]\nsemiaxes = 3\nclip = 1\n")
    with pytest.raises(pas.ProblemFileError, match=r"line 4.*elliptic pipe 1: semiaxes must be 2 vectors"):
        pas.read_problem(path)


def test_kinds_agree_with_one_another():
    """Where two kinds say the same, so do their polynomials."""
    circle = [(0, "1/3", 0), (0, 0, "1/3")]
    round_pipe = pas.EllipticPipe((1, 0, 0), circle, 1).contact
    assert round_pipe.surface / 9 == pas.Pipe((1, 0, 0), "1/3", 1).contact.surface
    ball = pas.Ellipsoid((1, 2, 0), [(2, 0, 0), (0, 2, 0), (0, 0, 2)], "1/2", (1, 1, 1)).contact
    assert ball.surface * 4 == pas.Sphere((1, 2, 0), 2, "1/2", (1, 1, 1)).contact.surface
    matrix = [[0, "1/2", 0, 0], ["1/2", 1, 0, 0], [0, 0, 9, 0], [0, 0, 0, "-1/9"]]
    assert pas.QuadricContact(matrix, "x - y - 1") == sample("quadrics")
    assert pas.Paraboloid((1, 0, 0), circle, 2).rim.radii == pytest.approx((1 / 3, 1 / 3))
    assert pas.Hyperboloid((1, 0, 0), circle, 3, 3).rim.radii == pytest.approx((2**0.5 / 3, 2**0.5 / 3))
    square = pas.Plate((0, 0, 2), 1).contact
    assert square.clip == pas.Plate((0, 0, 2), semiaxes=[(1, 0, 0), (0, 1, 0)]).contact.clip
    bent = pas.Torus((0, 0, 1), (2, 0, 0), "1/2")
    assert bent.rim.center == (2, 0, 0) and bent.rim.radii == pytest.approx((0.5, 0.5), rel=1e-14)


def test_sentences_say_what_they_are():
    assert str(sample("spheres")) == "sphere of radius 1 around (3/2, 0, 0), clipped at -1/4 along (2, 0, 0)"
    assert str(sample("plates")) == "plate with the normal (-1, 0, 0) and a circle of radius 1/2 around (1, 0, 0)"
    for table in CONTACTS:
        text = str(sample(table))
        assert "fmpq" not in text and len(text) < 200


def test_a_corner_of_an_elliptic_pipe_and_round_ones():
    pipes = [
        pas.EllipticPipe((1, 0, 0), ACROSS, "3/2"),
        pas.Pipe((0, 1, 0), "1/3", "3/2"),
        pas.Pipe((0, 0, 1), "1/3", "3/2"),
    ]
    blend = pas.blend(pipes, 1, 5, energy=pas.ThinPlate())
    assert blend.certificate.proved


def test_a_pipe_on_a_plate_is_met_by_one_polynomial():
    """All quartics of a plate and a pipe, and what is proved of one: it meets both exactly."""
    plate, pipe = pas.Plate((0, 0, 1), 2), pas.Pipe((0, 0, 1), 1, 2)
    region = pas.SingleCell((-3, -3, -1), (3, 3, 2))
    space = pas.solutions([plate, pipe], 1, 4, region)
    assert space.dimension > 0 and space.regular
    for member in space.basis:
        assert pas.contact_ideal(plate, 1).contains(member[0])
        assert pas.contact_ideal(pipe, 1).contains(member[0])
    bell = pas.Polynomial("9*z - 9*z^2/4 - (x^2 + y^2 - 4)^2")
    surface = pas.PiecewiseSurface(region, [plate.contact, pipe.contact], 1, [region.frame.localise(bell)])
    certificate = surface.certificate
    assert [verdict.status for verdict in certificate.contacts] == [pas.Status.PROVED] * 2
    assert certificate.enclosed.status is pas.Status.UNDECIDED, "as the docstring of plates says"
    wrong = pas.Polynomial("9*z - 9*z^2/4 - 2*(x^2 + y^2 - 4)")
    surface = pas.PiecewiseSurface(region, [plate.contact, pipe.contact], 1, [region.frame.localise(wrong)])
    assert surface.certificate.contacts[0].status is pas.Status.REFUTED


def test_contacts_are_contacts():
    pair = Contact("x^2 + y^2 - 1", "z - 1")
    assert pair.contact is pair and as_contact(pair) is pair
