"""Hollow blends: inner contacts, the proof that the inner side is inside the outer one, walls as solids and meshes."""

from __future__ import annotations

from functools import cache
from itertools import product
from math import sqrt

import numpy as np
import pytest
from flint import fmpq

import pas
from pas import solid
from pas.surface.contact import CONTACTS
from pas.surface.nesting import common_parts, nesting
from pas.surface.parallels import inner_contact
from pas.surface.piecewise import PiecewiseSurface
from pas.verdicts import Status

TENTH = fmpq(1, 10)
BOX = (-2, -2, -2), (2, 2, 2)

CONTACTS_WITH_INNER = {
    "pipes": pas.Pipe((1, 2, 3), "1/2", 1),
    "cones": pas.Cone((1, 2, 2), "1/2", 1, "1/4"),
    "elliptic_pipes": pas.EllipticPipe((1, 2, 2), [(0, 1, -1), (-4, 1, 1)], 2),
    "paraboloids": pas.Paraboloid((1, 0, 0), [(0, 1, 0), (0, 0, "1/2")], 1),
    "hyperboloids": pas.Hyperboloid((1, 0, 0), [(0, 1, 0), (0, 0, "1/2")], 1, 2),
    "spheres": pas.Sphere((1, 0, 0), 1, "1/2", (1, 1, 1)),
    "ellipsoids": pas.Ellipsoid((1, 1, 0), [(2, 0, 0), (0, 1, 0), (0, 0, "1/2")], "1/3"),
    "tori": pas.Torus((0, 1, 1), (3, 1, -1), 1, (1, 2, 3)),
    "quadrics": pas.QuadricContact("x^2 + 2*y^2 - 3*z^2 + 1", "z - 1"),
    "contacts": pas.Contact("x^2 + y^2 - 1/2", "z - 1"),
}
"""One of each kind that has an inner surface."""

PARALLEL = ("pipes", "cones", "spheres", "tori", "contacts")
"""Those whose inner surface is parallel, so that the distance is the same everywhere."""


def test_every_kind_of_contacts_has_an_inner_one_or_a_sentence():
    assert set(CONTACTS_WITH_INNER) | {"openings", "plates"} == set(CONTACTS)
    with pytest.raises(pas.GeometryError, match=r"contact 3: no inner surface is known for z, .*inner="):
        inner_contact(pas.Plate((0, 0, 1), 1).contact, TENTH, 3)


@pytest.mark.parametrize("table", CONTACTS_WITH_INNER)
def test_an_inner_contact_is_a_thickness_inside(table):
    contact = CONTACTS_WITH_INNER[table].contact
    inner = inner_contact(contact, TENTH)
    assert inner.clip == contact.clip
    points = inner.rim.points(200)
    feet = points.copy()
    for _ in range(60):  # to the foot on the outer surface: first along the gradient, then at right angles to it
        slopes = contact.surface.gradient(feet)
        squares = (slopes**2).sum(axis=1)[:, None]
        away = points - feet
        along = away - slopes * (slopes * away).sum(axis=1)[:, None] / squares
        feet = feet + along / 2 - slopes * contact.surface(feet)[:, None] / squares
    distances = np.linalg.norm(points - feet, axis=1)
    assert (contact.surface(points) < 0).all()
    if table in PARALLEL:
        assert np.abs(distances - 0.1).max() < 1e-8
    else:
        assert 0.05 < distances.min() < 0.12
        assert distances.max() < 0.25


@pytest.mark.parametrize(
    "contact, radius",
    [
        (pas.Pipe((1, 0, 0), "1/10", 1), "0.1"),
        (pas.Sphere((1, 0, 0), "1/10", "1/20"), "0.1"),
        (pas.Torus((0, 0, 1), (3, 0, 0), "1/11"), "0.0909091"),
        (pas.EllipticPipe((1, 0, 0), [(0, 1, 0), (0, 0, "1/20")], 2), "0.05"),
        (pas.Cone((1, 0, 0), "1/10", 1, "1/4"), "0.1"),
    ],
    ids=str,
)
def test_a_wall_is_thinner_than_its_pipe(contact, radius):
    with pytest.raises(pas.GeometryError, match=f"contact 2 has the radius {radius}; the thickness must be below that"):
        inner_contact(contact.contact, TENTH, 2)


def sphere(radius2, center=(0, 0, 0), box=BOX, middle=(0, 0, 0)):
    """A sphere as a surface over a box: x, y, z of its centre, and its squared radius."""
    x, y, z = center
    ball = f"(x - ({x}))^2 + (y - ({y}))^2 + (z - ({z}))^2 - ({radius2})"
    return PiecewiseSurface.from_polynomials(pas.SingleCell(*box, center=middle), (), 1, [ball])


SMALLER = (-1, "-6/5", "-3/2"), ("8/5", 1, "7/5")


@pytest.mark.parametrize(
    "inner, status",
    [
        (sphere(1), Status.PROVED),
        (sphere(1, box=SMALLER), Status.PROVED),
        (sphere("16/9", center=("1/10", 0, 0)), Status.PROVED),
        (sphere("9/4", center=("1/100", 0, 0)), Status.REFUTED),  # pokes out by a hundredth
        (sphere("9/400", center=("3/2", 0, 0)), Status.REFUTED),  # a bubble across the outer surface
        (sphere(1, box=((-3, -2, -2), (2, 2, 2))), Status.PROVED),
        (sphere(1, middle=("1/10", 0, 0)), Status.UNDECIDED),
        (sphere("9/4", center=(0, 0, 0)), Status.UNDECIDED),  # the same sphere
        (sphere(2, center=("1/20", 0, 0)), Status.PROVED),  # within 0.04
    ],
)
def test_spheres_in_a_sphere(inner, status):
    (verdict,) = nesting(inner, sphere("9/4"))
    assert verdict.status is status, verdict
    assert verdict.claim == "inside"
    if status is Status.REFUTED:
        x, y, z = verdict.witness
        assert sphere("9/4")((x, y, z)) >= -1e-9
        assert inner((x, y, z)) <= 1e-9


def test_a_bubble_of_the_outer_function_within_the_inner_body_is_found():
    # outer < 0 in a ball but for a small bubble around a point deep in the inner body, where its sign turns
    holed = "(x^2 + y^2 + z^2 - 9/4)*((x - 3/10)^2 + (y - 1/5)^2 + (z - 1/9)^2 - 1/900)"
    outer = PiecewiseSurface.from_polynomials(pas.SingleCell(*BOX, center=(0, 0, 0)), (), 1, [holed])
    (verdict,) = nesting(sphere(1), outer)
    assert verdict.status is Status.REFUTED
    assert np.linalg.norm(np.subtract(verdict.witness, (0.3, 0.2, 1 / 9))) <= 1 / 30


def test_outside_the_outer_region_nothing_is_inside():
    wide = sphere(1, box=((-3, -3, -3), (3, 3, 3)))
    narrow = sphere(4, box=(("-1/2", -3, -3), (3, 3, 3)))  # larger, but cut off by its region
    (verdict,) = nesting(wide, narrow)
    assert verdict.status is Status.REFUTED
    assert verdict.witness[0] < -0.5
    assert "not in the region of the outer one" in verdict.reason


@pytest.mark.parametrize("boxes", [(BOX, BOX), (SMALLER, BOX), (BOX, SMALLER)])
def test_common_parts_fill_the_inner_region(boxes):
    inner, outer = (pas.SingleCell(*box, center=(0, 0, 0)) for box in boxes)
    parts = common_parts(inner, outer)
    corners = np.array([[[float(x.p) / float(x.q) for x in v] for v in part.corners[1:]] for part in parts])
    sides = np.ptp(inner.points, axis=0)
    assert np.linalg.det(corners).sum() / 6 == pytest.approx(np.prod(sides))
    assert (np.linalg.det(corners) > 0).all()


ELBOW = [((1, 0, 0), 1), ((0, 1, 0), 1)]


@cache
def made(name, order):
    nodes = {
        "elbow": ELBOW,
        "T": [((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 1, 0), "3/4")],
        "corner": [((1, 0, 0), 1), ((0, 1, 0), "3/4"), ((0, 0, 1), "1/2")],
        "five": [((3, 1, -1), 1), ((-2, 1, 1), "3/4"), ((-1, -3, 0), "3/4"), ((0, 1, -4), "1/2"), ((1, 1, 5), 1)],
    }
    return pas.node(nodes[name], order).hollow("1/10")


@pytest.mark.parametrize(
    "name, order",
    [
        ("elbow", 1),
        ("corner", 2),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in product(("T", "five"), (1, 2))),
        pytest.param("elbow", 2, marks=pytest.mark.slow),
        pytest.param("corner", 1, marks=pytest.mark.slow),
    ],
)
def test_nodes_are_hollow(name, order):
    hollow = made(name, order)
    contacts = len(hollow.outer.surface.contacts)
    assert hollow.certificate.proved
    claims = [v.claim for v in hollow.certificate.verdicts]
    assert claims[-contacts - 1 :] == ["inside", *(f"end {i + 1}" for i in range(contacts))]
    for inner, outer in zip(hollow.inner.surface.contacts, hollow.outer.surface.contacts, strict=True):
        assert inner.rim.radii[0] == pytest.approx(outer.rim.radii[0] - 0.1)
        assert inner.rim.center == outer.rim.center
    rays = np.random.default_rng(0).normal(size=(2000, 3))
    near, far = (part.surface.intersect_rays((0, 0, 0), rays) for part in (hollow.inner, hollow.outer))
    both = np.isfinite(near) & np.isfinite(far)
    assert both.sum() > 500
    assert (near[both] < far[both]).all()
    assert not nesting(hollow.outer.surface, hollow.inner.surface)[0].proved  # not the other way round
    assert 0 < hollow.wall.distance < 0.1 + 4 * hollow.wall.within


def test_a_wall_is_closed_by_rings():
    hollow = made("corner", 2)
    mesh = hollow.mesh(0.05)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, -2)
    assert mesh.names == ("blend", "inside of blend", "end 1", "end 2", "end 3")
    assert mesh.face_areas["end 1"] == pytest.approx(np.pi * (1 - 0.81), rel=0.1)
    assert 0 < mesh.volume < hollow.outer.mesh(0.05).area * 0.1


def test_a_solid_of_several_parts_less_another_is_bounded():
    pipes = [solid.patch(f"pipe {x}", "y^2 + z^2 - 1", f"x - {x}", f"{x + 1} - x") for x in (0, 2)]
    whole = solid.union(pipes)
    assert np.allclose((whole - solid.ball((0, 0, 0), "1/2")).box, whole.box, atol=0.2)


def test_a_hollow_node_is_a_solid():
    hollow = made("elbow", 1)
    wall = hollow.solid(names=("front", "side"))
    assert {"blend", "inside of blend", "front", "inside of front", "front end"} <= set(wall.faces)
    assert wall.proved
    short = hollow.solid(0)
    points = np.random.default_rng(1).uniform(-1.5, 1.9, (4000, 3))
    inside, cavity = hollow.outer.surface.contains(points), hollow.inner.surface.contains(points)
    assert np.array_equal(short.contains(points), inside & ~cavity)
    assert 0 < (inside & ~cavity).mean() < inside.mean()
    far = np.array([[2.2, 0.95, 0], [2.2, 0, 0], [2.2, 1.05, 0]])
    assert wall.contains(far).tolist() == [True, False, False]


def test_inner_contacts_may_be_given():
    outer = made("elbow", 1).outer
    pipes = [pas.Pipe(axis, "1/2", "63/32") for axis, _ in ELBOW]
    hollow = outer.hollow(inner=pipes)
    assert hollow.thickness is None
    assert hollow.certificate.proved


def test_an_inner_side_that_pokes_out_is_not_proved():
    outer = made("elbow", 1).outer
    clip = outer.surface.contacts
    moved = [("(y - 1/4)^2 + z^2 - 49/64", clip[0].clip), ("(x - 1/4)^2 + z^2 - 49/64", clip[1].clip)]
    with pytest.raises(pas.NotProvedError, match=r"the wall is not proved: .*inner contacts farther inside") as caught:
        outer.hollow(inner=moved)
    assert isinstance(caught.value.blend, pas.HollowBlend)
    assert outer.hollow(inner=moved, prove=False).certificate.refuted
    other = pas.node([(axis, "1/2", 3) for axis, _ in ELBOW], 1, degree="lowest")
    ends = nesting(other.surface, outer.surface)[1:]
    assert [end.status for end in ends] == [Status.REFUTED] * 2
    assert "different planes" in ends[0].reason


@pytest.mark.parametrize(
    "arguments, error, words",
    [
        ({"thickness": 0}, ValueError, "thickness must be positive, not 0"),
        ({"thickness": "-1/3"}, ValueError, "thickness must be positive, not -1/3"),
        ({"thickness": 1}, pas.GeometryError, "contact 1 has the radius 1; the thickness must be below that, not 1"),
        ({}, ValueError, "thickness or inner must be given, and not both"),
        ({"thickness": 1, "inner": []}, ValueError, "thickness or inner must be given, and not both"),
        ({"inner": [("x^2 - 1", "y")]}, ValueError, "inner must be 2 contacts"),
        ({"inner": [("x^2 - 1", "y"), 3]}, TypeError, r"inner\[1\] must be a Pipe"),
        ({"thickness": "thin"}, ValueError, "thickness"),
    ],
)
def test_bad_input(arguments, error, words):
    with pytest.raises(error, match=words):
        made("elbow", 1).outer.hollow(**arguments)


def test_irrational_radii_are_rounded():
    contact = pas.Contact("x^2 + y^2 - 2", "z - 1")
    (radius, _) = inner_contact(contact, TENTH).rim.radii
    assert radius == pytest.approx(sqrt(2) - 0.1, abs=1e-9)
