"""Hollow blends: inner contacts, the proof that the inner side is inside the outer one, walls as solids and meshes."""

from __future__ import annotations

from functools import cache
from itertools import product
from math import sqrt

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas import solid
from pas.certify.nesting import common_parts, nesting
from pas.contacts.cones import first_met, nappe, nappe_rays
from pas.contacts.contact import CONTACTS
from pas.contacts.parallels import inner_contact
from pas.contacts.rims import outlook
from pas.fairing.constraints import Inequalities
from pas.fairing.energies.even_wall import EvenWall, Thickness
from pas.fairing.energy import Sizes
from pas.fairing.objective import check_residuals
from pas.fairing.solver import FitSolver, coordinates
from pas.piecewise import PiecewiseSurface
from pas.pipeline.cavity import Cavity
from pas.surface.depth import Depth
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
    "plates": pas.Plate((1, 2, 2), 2, point=(1, 0, 0)),
    "openings": pas.Opening("x^2 + y^2 - 4", (1, 0, 0), "4/7"),
}
"""One of each kind."""

PARALLEL = ("pipes", "cones", "spheres", "tori", "contacts", "plates", "openings")
"""Those whose inner surface is parallel, so that the distance is the same everywhere."""


def test_every_kind_of_contacts_has_an_inner_one_and_others_a_sentence():
    assert set(CONTACTS_WITH_INNER) == set(CONTACTS)
    with pytest.raises(pas.GeometryError, match=r"contact 3: no inner surface is known for x\^3 \+ z, .*inner="):
        inner_contact(pas.Contact("x^3 + z", "y"), TENTH, 3)


def around(contact):
    """Points of the curve of an opening along x from 0."""
    rays = nappe_rays(nappe(contact.clip, np.array([1.0, 0, 0])), 200)
    return rays * first_met(contact.surface, rays)[:, None]


@pytest.mark.parametrize("table", CONTACTS_WITH_INNER)
def test_an_inner_contact_is_a_thickness_inside(table):
    contact = CONTACTS_WITH_INNER[table].contact
    inner = inner_contact(contact, TENTH)
    assert inner.clip == contact.clip
    points = around(inner) if table == "openings" else inner.rim.points(200)
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


def test_an_inner_contact_turns_with_its_contact():
    """Principal axes are rational here, with coordinates of eighteen digits."""
    contact, turn = pas.Contact("x^2/4 + y^2/9 + z^2/16 - 1", "x + y - 1"), ((1, 2, 3), "37.123456789")
    inner = inner_contact(contact, TENTH).rotate(*turn)
    assert inner_contact(contact.rotate(*turn), TENTH).surface.primitive() == inner.surface.primitive()


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
        (sphere(1, middle=("1/10", 0, 0)), Status.PROVED),  # seen from another centre
        (sphere("9/4", center=("1/100", 0, 0), middle=("1/10", "1/5", "3/10")), Status.REFUTED),
        (sphere("9/400", center=("3/2", 0, 0), middle=("3/2", 0, 0)), Status.REFUTED),
        (sphere(2, center=("1/20", 0, 0), box=SMALLER, middle=("1/3", "1/4", 0)), Status.PROVED),
        (sphere(1, box=((-3, -2, -2), (2, 2, 2)), middle=("1/10", 0, 0)), Status.PROVED),
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


CENTERS = (0, 0, 0), ("1/10", "1/5", "3/10"), ("1/5", 0, 0), ("1/3", "1/3", "1/3")
"""That of both regions, one in no special place, one in planes and one on a line through the outer centre's corners."""


@pytest.mark.parametrize("center", CENTERS)
@pytest.mark.parametrize("boxes", [(BOX, BOX), (SMALLER, BOX), (BOX, SMALLER)])
def test_common_parts_fill_the_inner_region(boxes, center):
    inner, outer = pas.SingleCell(*boxes[0], center=center), pas.SingleCell(*boxes[1], center=(0, 0, 0))
    parts = common_parts(inner, outer)
    corners = np.array([[[float(x.p) / float(x.q) for x in v] for v in part.corners] for part in parts])
    volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    sides = np.ptp(inner.points, axis=0)
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(np.prod(sides))
    cones = np.linalg.inv(np.array([outer.points[list(face.vertices)] for face in outer.outer_faces]))
    within = ((corners[:, None] @ cones).min(axis=(2, 3)) > -1e-9).argmax(axis=1)
    for part, points, cone in zip(parts, corners, within, strict=True):
        face = outer.outer_faces[cone]
        assert (points @ cones[cone]).min() > -1e-9  # in one cone from the outer centre
        assert part.beyond in (face.plane, None)


ELBOW = [((1, 0, 0), 1), ((0, 1, 0), 1)]


@pytest.mark.parametrize("number", [0, 255, 256, -1])
def test_a_bubble_is_found_in_every_part(number):
    middle = "1/3", "1/4", 0
    parts = common_parts(pas.SingleCell(*SMALLER, center=middle), pas.SingleCell(*BOX, center=(0, 0, 0)))
    assert len(parts) > 256
    center = [sum(axis, fmpq(0)) / 4 for axis in zip(*parts[number].corners, strict=True)]
    (verdict, *_) = nesting(sphere("1/100000", center, SMALLER, middle), sphere("1/10000"))
    assert verdict.status is Status.REFUTED
    assert np.allclose(verdict.witness, [float(x.p) / float(x.q) for x in center], atol=0.01)


SHARP = ((1, 0, 0), 1), ((4, 7, 0), 1)
"""Two pipes at 60 degrees."""


@cache
def made(name, order):
    nodes = {
        "elbow": ELBOW,
        "sharp": SHARP,
        "unequal": [((1, 0, 0), 1), ((4, 7, 0), "1/2")],
        "cross": [((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 1, 0), 1), ((0, -1, 0), 1)],
        "T": [((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 1, 0), "3/4")],
        "corner": [((1, 0, 0), 1), ((0, 1, 0), "3/4"), ((0, 0, 1), "1/2")],
        "five": [((3, 1, -1), 1), ((-2, 1, 1), "3/4"), ((-1, -3, 0), "3/4"), ((0, 1, -4), "1/2"), ((1, 1, 5), 1)],
    }
    if (name, order) == ("elbow", 1):
        return read("hollow_elbow")
    return pas.node(nodes[name], order).hollow("1/10")


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name, order",
    [
        ("elbow", 1),
        ("unequal", 1),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in product(("T", "five", "cross"), (1, 2))),
        *(pytest.param(name, 2, marks=pytest.mark.slow) for name in ("elbow", "sharp", "unequal")),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in (("corner", 1), ("corner", 2), ("sharp", 1))),
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
    center = [float(c.p) / float(c.q) for c in hollow.inner.surface.partition.center]
    near, far = (part.surface.intersect_rays(center, rays) for part in (hollow.inner, hollow.outer))
    both = np.isfinite(near) & np.isfinite(far)
    assert both.sum() > 500
    assert (near[both] < far[both]).all()
    assert not nesting(hollow.outer.surface, hollow.inner.surface)[0].proved  # not the other way round
    assert 0.05 - 4 * hollow.wall.within < hollow.wall.distance < 0.1 + 4 * hollow.wall.within
    # every point of either side is between half and twice the thickness from the other one
    meshes = [part.mesh(0.01).to_pyvista() for part in (hollow.outer, hollow.inner)]
    for one, other in (meshes, meshes[::-1]):
        distances = np.abs(one.compute_implicit_distance(other)["implicit_distance"])
        assert 0.05 < distances.min() < distances.max() < 0.2


@pytest.mark.parametrize("name, order", [("elbow", 1), pytest.param("corner", 2, marks=pytest.mark.slow)])
def test_a_wall_is_closed_by_rings(name, order):
    hollow = made(name, order)
    mesh, ends = hollow.mesh(0.05), len(hollow.outer.surface.contacts)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2 * (2 - ends))
    assert mesh.names == ("blend", "inside of blend", *(f"end {i + 1}" for i in range(ends)))
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


@pytest.mark.slow
def test_an_inner_side_around_a_sharp_bend_has_a_centre_further_in():
    hollow = made("sharp", 1)
    outer, inner = (part.surface.partition.center for part in (hollow.outer, hollow.inner))
    assert outer != inner
    depth = Depth(hollow.outer.surface)
    (before, after), _ = depth(np.array([[float(x.p) / float(x.q) for x in place] for place in (outer, inner)]))
    assert before < 0.1 < after
    (verdict, *_) = nesting(made("elbow", 1).inner.surface, hollow.outer.surface)
    assert verdict.status is Status.REFUTED  # its other arm points elsewhere
    wall = hollow.mesh(0.05)
    assert (wall.is_closed, wall.components, wall.euler_characteristic) == (True, 1, 0)
    points = np.random.default_rng(1).uniform((-1, -1.5, -1.1), (3, 3, 1.1), (4000, 3))
    inside, cavity = hollow.outer.surface.contains(points), hollow.inner.surface.contains(points)
    assert (cavity <= inside).all()
    assert np.array_equal(hollow.solid(0).contains(points), inside & ~cavity)


@pytest.mark.slow
@pytest.mark.parametrize("thickness, order", [("1/16", 1), ("1/2", 1)])
def test_walls_around_sharp_bends_may_be_thin_and_thick(thickness, order):
    hollow = made("sharp", order).outer.hollow(thickness)
    assert hollow.certificate.proved
    shares = Cavity(hollow.outer, hollow.inner.surface.contacts, hollow.thickness).evenness.shares
    assert shares(Depth(hollow.inner.surface).samples).min() > 0.5


@pytest.mark.slow
def test_a_centre_further_in_sees_all_contacts():
    outer = pas.node([((1, 0, 0), 1), ((0, 1, 0), "1/4")], 1)
    hollow = outer.hollow("1/8")
    assert hollow.certificate.proved and hollow.inner.surface.partition.center != outer.surface.partition.center
    cavity = Cavity(outer, hollow.inner.surface.contacts, hollow.thickness)
    center = cavity._moved(cavity.evenness, outer.surface.partition.center)
    assert min(outlook(contact.surface, contact.rim, center)[0] for contact in cavity.contacts) > 0


def seen(inner):
    """What the fit sees of an inner blend."""
    solver = FitSolver(inner.space.prepared, pas.Wishes(energy=inner.plate, limits=inner.limits))
    member = coordinates(inner.space.prepared, inner.surface)
    return solver.iterate(member, Inequalities.none(len(member))).value


def test_an_inner_blend_is_kept_without_what_made_its_wall_even(tmp_path):
    hollow = made("elbow", 1)
    inner = hollow.inner
    assert inner.wishes.energy == hollow.outer.wishes.energy == pas.CurvatureVariation()
    assert inner.energy == pytest.approx(seen(inner).energy, rel=0.02)
    again = pas.load(hollow.save(tmp_path / "hollow.pas.json"))
    assert again.inner.energy == inner.energy
    assert again.certificate.proved


def bend(order=1):
    return made("elbow", order).outer


def test_depths_are_distances_along_normals():
    outer = bend()
    depth = Depth(outer.surface)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(depth.samples), 300, replace=False)
    feet = depth.samples[chosen]
    on, normals = depth(feet)
    assert np.abs(on).max() < 1e-9
    for far in (-0.1, 0.1, 0.3):
        found, across = depth(feet - far * normals)
        assert np.abs(found - far).max() < 1e-7
        assert np.abs(across - normals).max() < 1e-6
    points = feet - 0.2 * normals + rng.normal(scale=0.02, size=feet.shape)
    found, across = depth(points)
    values = outer.surface(points + found[:, None] * across)
    assert np.isfinite(values).sum() > 200 and np.nanmax(np.abs(values)) < 1e-12  # others lie beyond the clips
    step = rng.normal(scale=1e-6, size=3)
    change = depth(points + step)[0] - depth(points - step)[0]
    assert np.abs(change + 2 * across @ step).max() < 1e-10


def test_depths_go_on_beyond_clips():
    contact = made("elbow", 1).outer.surface.contacts[0]
    middle, radius = np.array([float(x.p) / float(x.q) for x in contact.rim.center]), contact.rim.radii[0]
    angles = np.linspace(0, 6, 50)
    beyond = middle + np.stack([np.full(50, 0.1), 0.8 * np.cos(angles), 0.8 * np.sin(angles)], axis=1)
    assert np.abs(Depth(bend().surface)(beyond)[0] - (radius - 0.8)).max() < 1e-9


def test_an_uneven_wall_has_slopes():
    places, values = np.array([(2.0, 0, 0), (0, 2.0, 0), (0, 0, 2.0)]), np.array([0.1, 0.2, 0.4])
    wanted = Thickness(places, values)
    points = np.random.default_rng(0).uniform(-1, 1, (200, 3))
    found, gradients = wanted(points)
    assert (found > 0.1).all() and (found < 0.4).all()
    assert wanted(places + 1e-7)[0] == pytest.approx(values)
    step = np.array([1e-6, -2e-6, 3e-6])
    assert wanted(points + step)[0] - wanted(points - step)[0] == pytest.approx(2 * gradients @ step, abs=1e-11)
    energy = EvenWall(Depth(bend().surface), wanted)
    inner = made("elbow", 1).inner
    points = seen(inner).sampled.points
    check_residuals(energy, points, Sizes(0.9, 2.0))
    with pytest.raises(ValueError, match="disagree"):
        check_residuals(Upwards(energy.depth, wanted), points, Sizes(0.9, 2.0))


class Upwards(EvenWall):
    """With slopes of the wrong sign."""

    def slopes(self, points, sizes):
        return -super().slopes(points, sizes)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "pipes, order",
    [
        ([((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 0, 1), 1)], 1),
        ([((1, 0, 0), 1), ((0, 1, 0), "4/5")], 2),
    ],
)
def test_walls_are_even_where_limits_of_fairness_leave_room(pipes, order):
    wall = pas.node(pipes, order).hollow("1/8")
    shares = 8 * Depth(wall.outer.surface)(Depth(wall.inner.surface).samples)[0]
    assert 0.88 < shares.min() < shares.max() < 1.2
    assert wall.certificate.proved and not wall.inner.surface.fairness().beyond(wall.inner.limits)


@pytest.mark.slow
def test_walls_of_unlike_ends_go_over_into_one_another():
    """Inner contacts may be given."""
    outer = bend()
    pipes = [pas.Pipe(axis, radius, "63/32") for (axis, _), radius in zip(ELBOW, ("9/10", "7/10"), strict=True)]
    hollow = outer.hollow(inner=pipes)
    assert hollow.thickness is None
    assert hollow.certificate.proved
    inner = hollow.inner.surface
    shares = Cavity(outer, inner.contacts, None).evenness.shares(Depth(inner).samples)
    assert 0.7 < shares.min() < shares.max() < 1.4


def test_an_inner_side_that_pokes_out_is_not_proved():
    outer = made("elbow", 1).outer
    clip = outer.surface.contacts
    moved = [("(y - 1/4)^2 + z^2 - 49/64", clip[0].clip), ("(x - 1/4)^2 + z^2 - 49/64", clip[1].clip)]
    with pytest.raises(pas.NotProvedError, match=r"the wall is not proved: .*inner contacts farther inside") as caught:
        outer.hollow(inner=moved)
    assert isinstance(caught.value.blend, pas.HollowBlend) and caught.value.blend.certificate.refuted
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
