"""Hollow blends out of plates and other openings: both sides end on one cone."""

from functools import cache

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas.algebra.rational import rational, to_floats
from pas.certify.nesting import nesting
from pas.certify.thickness import thicker_than
from pas.contacts.cones import apex
from pas.contacts.parallels import inner_contact
from pas.layouts.opened import open_region
from pas.pipeline.cavity import EVEN, Cavity
from pas.pipeline.feet import Tee
from pas.surface.depth import Depth
from pas.verdicts import Status

X, Z = (1, 0, 0), (0, 0, 1)
EIGHTH = rational("1/8", "thickness")
CASES = {
    "upright": [pas.Plate(Z, 2), pas.Pipe(Z, 1, "auto")],
    "foot": [pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)],
    "leaning": [pas.Plate(Z, 2), pas.Pipe((1, 0, 3), 1, "auto")],
    "cone": [pas.Plate(Z, 2), pas.Cone(Z, 1, 2, "1/4")],
    "nozzle": [pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)],
    "boss": [pas.Opening("x^2 + y^2 + z^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)],
    "off centre": [
        pas.Opening("x^2 + y^2 + z^2 - 4", X, "1/2", ("1/4", "1/4", 0)),
        pas.Pipe(X, "1/3", 3, (0, "1/4", 0)),
    ],
    "on a cone": [pas.Opening("x^2 + y^2 - (4 - z)^2/4", X, "1/2"), pas.Pipe(X, "1/4", 4)],
    "on a paraboloid": [pas.Opening("z - 2 + x^2 + y^2", Z, "1/2"), pas.Pipe(Z, "1/4", 3)],
    "pipe first": [pas.Pipe(X, "1/2", 3), pas.Opening("x^2 + y^2 - 4", X, "4/7")],
    "on a run": Tee.of(pas.Pipe(Z, 1, "auto"), pas.Pipe(X, "1/2", "auto")).contacts,
}


@cache
def made(name, order=1):
    kept = {("foot", 1): "hollow_foot", ("nozzle", 1): "hollow_nozzle", ("on a run", 1): "hollow_run"}.get(
        (name, order)
    )
    return read(kept) if kept else pas.blend(CASES[name], order).hollow(EIGHTH)


def opening_of(blend):
    """The number of the contact that the region is open at."""
    (number,) = (i for i, join in enumerate(blend.surface.joins) if join.opening)
    return number


@pytest.mark.sampled(20)
@pytest.mark.parametrize(
    "name, order",
    [
        *((name, 1) for name in CASES if name != "foot"),  # whose limits were others
        ("upright", 2),
        ("boss", 2),
        pytest.param("nozzle", 2, marks=pytest.mark.slow),
    ],
)
def test_hollow_openings_are_proved(name, order):
    hollow = made(name, order)
    assert hollow.certificate.proved
    assert [v.claim for v in hollow.certificate.verdicts][-3:] == ["inside", "end 1", "end 2"]
    assert not any(part.fairness.beyond(part.limits) for part in (hollow.outer, hollow.inner))
    shares = Cavity(hollow.outer, hollow.inner.surface.contacts, hollow.thickness).evenness.shares
    shares = shares(Depth(hollow.inner.surface).samples)
    assert EVEN[0] < shares.min() and shares.max() < EVEN[1]
    number = opening_of(hollow.outer)
    inner, outer = (part.surface.contacts[number] for part in (hollow.inner, hollow.outer))
    assert apex(inner.clip) == apex(outer.clip) == hollow.outer.surface.partition.center
    center = np.array(to_floats(hollow.outer.surface.partition.center))
    rays = hollow.outer.surface.joins[number].rays
    near, far = (part.surface.intersect_rays(center, 0.9 * rays + 0.1 * rays.mean(axis=0)) for part in both(hollow))
    assert (near < far).all()


def both(hollow):
    return hollow.inner, hollow.outer


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["foot", "nozzle", "pipe first"])
def test_a_wall_ends_in_rings_on_the_cone(name):
    hollow = made(name)
    mesh, number = hollow.mesh(2e-2), opening_of(hollow.outer)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    ring = mesh.names.index(f"end {number + 1}")
    clip = hollow.outer.surface.contacts[number].clip
    points = mesh.points[np.unique(mesh.triangles[mesh.faces == ring])]
    assert np.abs(clip(points)).max() < 1e-9
    corners = mesh.points[mesh.triangles[mesh.faces == ring]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    slopes = clip.gradient(corners.mean(axis=1))
    assert ((across * slopes).sum(axis=1) > 0).all()  # seen from outside
    assert ((mesh.normals[mesh.faces == ring] * slopes[:, None]).sum(axis=2) > 0).all()
    assert 0.1 < mesh.volume / hollow.outer.mesh(2e-2).area < 0.16


@pytest.mark.parametrize("name", ["foot", pytest.param("nozzle", marks=pytest.mark.slow)])
def test_the_solid_is_the_wall_and_its_neighbours_walls(name):
    hollow = made(name)
    wall = hollow.solid("1/2")
    assert wall.proved
    mesh = wall.mesh(2e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert not any("back" in title for title in mesh.names if title.startswith("inside"))
    points = np.random.default_rng(1).uniform(*wall.box, (20000, 3))
    inside = wall.contains(points)
    number = opening_of(hollow.outer)
    outer, inner = (part.surface.contacts[number] for part in (hollow.outer, hollow.inner))
    ahead = points - np.array(to_floats(hollow.outer.surface.partition.center))
    ahead = ahead @ hollow.outer.surface.joins[number].nappe[0]
    beside = inside & (outer.clip(points) > 0) & (ahead > 0)
    beside &= hollow.outer.surface.contacts[1 - number].clip(points) < 0
    assert beside.sum() > 100
    assert (outer.surface(points[beside]) <= 0).all() and (inner.surface(points[beside]) >= 0).all()
    short = hollow.solid(0)
    body, cavity = (part.surface.contains(points) for part in (hollow.outer, hollow.inner))
    above = (ahead > np.median(ahead[body])) & (outer.clip(points) < 0)  # only there is the outer side in use
    assert (body & ~cavity & above).sum() > 100
    assert np.array_equal(short.contains(points)[above], (body & ~cavity)[above])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", ["foot", "upright"])  # on one cone, as files of older versions have it, and on two
def test_a_hollow_opening_is_kept_in_files(tmp_path, name):
    assert (made(name).inner.surface.contacts[0].clip == made(name).outer.surface.contacts[0].clip) == (name == "foot")
    again = pas.load(made(name).save(tmp_path / "hollow.pas.json"))
    assert again.certificate.proved and again.thickness == EIGHTH


@pytest.mark.slow
def test_the_wall_of_a_foot_is_proved_to_be_even():
    wall = made("on a run")
    assert wall.thicker_than(EIGHTH * rational("22/25")).proved
    assert wall.wall.largest < 1.2 / 8 and "; even, 0.9" in str(wall)


@pytest.mark.parametrize("length, inside", [(None, True), ("1/16", False), (0, False)])
def test_solids_of_walls_end_inside_or_around_the_inner_cone(length, inside):
    wall = made("nozzle" if inside else "on a run").solid(length)
    assert wall.sheets is not None and ("inside of neighbour 1" in wall.faces) == inside
    mesh = wall.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    middles = mesh.points[mesh.triangles].mean(axis=1)
    outwards = np.cross(*(mesh.points[mesh.triangles[:, k]] - mesh.points[mesh.triangles[:, 0]] for k in (1, 2)))
    assert wall.contains(middles - 0.01 * outwards / np.linalg.norm(outwards, axis=1)[:, None]).mean() > 0.99


@pytest.mark.slow
def test_the_solid_of_a_hollow_plate_is_the_same_everywhere():
    volumes = []
    for z in (0, 2):
        foot = pas.blend([pas.Plate(Z, 2, point=(0, 0, z)), pas.Pipe(Z, 1, 2 + z)], 1)
        wall = foot.hollow(EIGHTH).solid("1/2")
        assert wall.sheets is not None
        volumes.append(wall.mesh(1e-2).volume)
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-6)


def test_walls_that_are_too_thick():
    outer = made("foot").outer
    with pytest.raises(
        pas.GeometryError, match=r"contact 1 opens along a cone from \(0, 0, -1\), .*the thickness, 1, "
    ):
        outer.hollow(1)
    with pytest.raises(pas.GeometryError, match="contact 2 has the radius 1; the thickness must be below that, not 2"):
        pas.blend([pas.Plate(Z, 8), pas.Pipe(Z, 1, "auto")], 1).hollow(2)


def test_walls_of_cones_are_as_thick_as_asked():
    outer = CASES["on a cone"][0].contact
    inner = inner_contact(outer, EIGHTH)
    across = np.array([2.0, 0, 1]) / 5**0.5  # at right angles to the cone above the x axis
    foot = np.array([2.0, 0, 0])
    assert outer.surface(foot) == 0
    assert abs(inner.surface(foot - across / 8)) < 1e-9


def of(hollow, surface, clip):
    """The inner side with another contact at its opening, the rest as it is."""
    inner = hollow.inner.surface
    contacts = [pas.Contact(surface, clip), inner.contacts[1]]
    return pas.PiecewiseSurface(inner.partition, contacts, 0, inner.patches, inner.degree)


def test_ends_on_other_cones_and_contacts_that_cross():
    hollow = made("foot")
    outer, clip = hollow.outer.surface, hollow.outer.surface.contacts[0].clip
    for narrow in ("x^2 + y^2 - 3*(z + 1)^2", "x^2 + 2*y^2 - 5*(z + 1)^2"):
        end = nesting(of(hollow, "z + 1/8", narrow), outer)[1]
        assert end.status is Status.REFUTED and "is not around that of the outer one" in end.reason
    inside, end, _ = nesting(of(hollow, "z + 1/8", "x^2 + y^2 - 5*(z + 9/8)^2"), outer)
    assert not inside.proved and not end.proved
    crossing = nesting(of(hollow, "z + x/4", clip), outer)[1]
    assert not crossing.proved
    reverse = nesting(outer, hollow.inner.surface)
    assert reverse[0].status is Status.REFUTED and not reverse[1].proved


def bumped(bump, wide=5):
    """What is less than z < -1/8 inside of the cone of "foot", and more between this and a wider one."""
    contacts = [pas.Contact("z + 1/8", f"x^2 + y^2 - {wide}*(z + 1)^2"), made("foot").inner.surface.contacts[1]]
    polynomial = pas.Polynomial("z + 1/8") - pas.Polynomial(bump) * made("foot").outer.surface.contacts[0].clip
    return pas.PiecewiseSurface.from_polynomials(open_region(contacts), contacts, 0, [polynomial])


@pytest.mark.parametrize("bump, status", [(0, Status.PROVED), ("1/16", Status.PROVED), ("1/4", Status.REFUTED)])
def test_between_two_cones_the_inner_side_is_inside_the_plate(bump, status):
    inside, end, _ = nesting(bumped(bump), made("foot").outer.surface)
    assert inside.proved and end.status is status
    assert status is Status.PROVED or "between the cones the inner surface is not inside" in end.reason


def test_between_two_cones_the_plate_counts_for_the_thickness():
    """There the inner side comes as near as 0.03 to the plate, and as 0.1 to what is inside of the outer cone."""
    inner, outer = bumped("1/40", 8), made("foot").outer.surface
    assert thicker_than(inner, outer, fmpq(3, 40)).status is Status.REFUTED
    assert thicker_than(inner, outer, fmpq(1, 100)).proved


def test_the_other_nappe_of_the_cone_is_another_place():
    outer = made("foot").outer.surface
    below = pas.blend([pas.Plate((0, 0, -1), 2, point=(0, 0, -2)), pas.Pipe((0, 0, -1), 1, 3)], 1).surface
    assert outer.partition.center == below.partition.center
    assert outer.contacts[0].clip == below.contacts[0].clip
    inside, end, _ = nesting(below, outer)
    assert inside.status is Status.UNDECIDED
    assert end.status is Status.REFUTED and "cones from one point" in end.reason


def test_given_inner_contacts_end_where_the_outer_ones_do():
    outer = made("foot").outer
    clips = [contact.clip for contact in outer.surface.contacts]
    with pytest.raises(pas.GeometryError, match=r"inner\[0\] must have the clip of contact 1, x\^2 \+ y\^2 - 4"):
        outer.hollow(inner=[("z + 1/8", "x^2 + y^2 - 3"), ("x^2 + y^2 - 49/64", clips[1])])
