"""Solids of blends that are meshed from their surfaces' meshes, tubes and flat ends, beside their lattices' meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas import solid
from pas.mesh.quality import Quality
from pas.pipeline.blend import struts
from pas.solid.operands import Operands
from pas.solid.sheets import SheetBody
from pas.solid.strips import Sections

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SKEW = (0.292372, 0.956305, 0)


def both(*axes):
    return [way for axis in axes for way in (axis, tuple(-c for c in axis))]


NODES = {
    "T": ([*((way, 1) for way in both(X)), (Y, "4/5")], 1),
    "T of a thin branch": ([*((way, 1) for way in both(X)), (Y, "1/2")], 1),
    "cross": ([(way, 1) for way in both(X, Y)], 1),
    "six-way": ([(way, 1) for way in both(X, Y, Z)], 1),
    "tetrahedral": ([((1, 1, 1), 1), ((1, -1, -1), 1), ((-1, 1, -1), 1), ((-1, -1, 1), 1)], 1),
    "bicycle": ([*((way, "17.45") for way in both(X)), (SKEW, "14.3")], 1),
    "cone": ([pas.Pipe(X, 1, 2), pas.Pipe(Y, 1, 2), pas.Cone(Z, 1, 2, slope="-1/8")], 1),
    "axes that miss": ([pas.Pipe(X, "1/3", 1, (0, "1/2", 0)), pas.Pipe(Z, "1/3", 1)], 1),
    "plate": ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 1),
    "nozzle": ([pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1),
    "ball": ([pas.Contact("x^2 + y^2 + (z + 2)^2 - 4", "-z - 3/2"), pas.Pipe(Z, "1/2", 1)], 1),
    "paraboloid": ([pas.Contact("3*x^2 + 3*y^2 + z - 4", "z - 1"), pas.Pipe(X, "1/2", 2)], 1),
}
"""Contacts or struts, and the order."""

SOLVED = {"T": lambda: read("tee"), "plate": lambda: read("hollow_foot").outer}
"""Those that are read from files."""

OPEN = ("plate", "nozzle")
QUICK = ("T", "plate")
CASES, HOLLOW = (
    [pytest.param(name, marks=() if name in quick else pytest.mark.slow) for name in NODES]
    for quick in (QUICK, ["plate"])
)


@pytest.fixture(scope="module")
def blends():
    made = {}

    def of(name):
        if name not in made:
            items, order = NODES[name]
            contacts = items if hasattr(items[0], "contact") else struts(items, order)
            made[name] = SOLVED[name]() if name in SOLVED else pas.blend(contacts, order)
        return made[name]

    return of


def radius(blend):
    """That of the widest neighbour on which no region opens."""
    joins = zip(blend.surface.contacts, blend.surface.joins, strict=True)
    return max(contact.rim.radii[0] for contact, join in joins if not join.opening)


def reach(blend):
    """How far neighbours go on: but a default length around openings."""
    return None if any(join.opening for join in blend.surface.joins) else int(np.ceil(radius(blend)))


def is_sound(mesh, body, tolerance, euler):
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, euler)
    assert mesh.deviation <= tolerance and {*mesh.names} <= {*body.faces}
    corners = mesh.points[mesh.triangles]
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((turned[:, None] * mesh.normals).sum(axis=2) > 0).all()
    for face in mesh.names:  # each face lies on its own polynomials
        rows = mesh.faces == mesh.names.index(face)
        if "blend" not in face:
            points = corners[rows].reshape(-1, 3)
            away = [
                np.abs(polynomial(points)) / np.linalg.norm(polynomial.gradient(points), axis=-1)
                for polynomial in body.polynomials[face]
            ]
            assert np.min(away, axis=0).max() < 1e-9 * np.ptp(points)
    return mesh


@pytest.mark.parametrize("name", CASES)
def test_nodes_are_bounded_by_their_sheets(name, blends):
    blend = blends(name)
    r, size = radius(blend), len(blend.surface.contacts)
    body = blend.solid(reach(blend))
    assert body.sheets is not None
    for share in (1e-2, 4e-3):
        mesh = is_sound(body.mesh(share * r), body, share * r, 2)
    assert mesh.names == body.faces and len(mesh.names) == 1 + 2 * size + (name in OPEN)
    within = 2 / 3 * mesh.deviation * mesh.area  # chords are two thirds of the greatest distance off
    assert mesh.volume == pytest.approx(body.volume(1e-2 * r), abs=within)
    assert mesh.area == pytest.approx(body.area(1e-2 * r), rel=2e-3)


@pytest.mark.parametrize("name", HOLLOW)
def test_hollow_nodes_are_bounded_by_their_sheets(name, blends):
    blend = blends(name)
    r, size = radius(blend), len(blend.surface.contacts)
    thickness = "17/8" if r > 10 else "1/24" if r < 1 / 2 else "1/16"
    wall = read("hollow_foot") if name == "plate" else blend.hollow(thickness)
    body = wall.solid(reach(blend))
    assert body.sheets is not None
    mesh = is_sound(body.mesh(1e-2 * r), body, 1e-2 * r, 2 * (2 - size))
    assert len(mesh.names) == 2 * (1 + size) + size
    assert {f"inside of neighbour {size}", "inside of blend", f"neighbour {size} end"} <= {*mesh.names}
    assert body.volume(1e-2 * r) == pytest.approx(body.mesh(4e-3 * r).volume, rel=2e-2)


@pytest.mark.parametrize("name, lengths", [("plate", ("1/2", 1)), ("T", (1, 2, "1/2")), ("cone", 1)])
@pytest.mark.sampled(3)
def test_the_lattice_says_the_same(name, lengths, blends):
    body = blends(name).solid(lengths)
    lattice = replace(body, sheets=None)
    assert lattice.volume(1e-2) == pytest.approx(body.volume(1e-2), rel=1e-3)
    assert lattice.area(1e-2) == pytest.approx(body.area(1e-2), rel=1e-3)
    assert {*lattice.mesh(1e-2).names} == {*body.mesh(1e-2).names}


def test_each_neighbour_has_its_length(blends):
    blend = blends("T")
    planes = [contact.rim.plane for contact in blend.surface.contacts]
    body = blend.solid([1, 0, "5/2"])
    mesh = is_sound(body.mesh(3e-2), body, 3e-2, 2)
    heights = [plane(mesh.points) / np.linalg.norm(plane.gradient(np.zeros(3))) for plane in planes]
    assert [h.max() for h in heights] == pytest.approx([1, 0, 2.5], abs=1e-9)
    assert "neighbour 2" not in mesh.names and "neighbour 2 end" in mesh.names
    wall = read("hollow_elbow").solid([0, "5/2"])
    assert is_sound(wall.mesh(3e-2), wall, 3e-2, 0).volume < mesh.volume
    assert len(body.joints) == 2 and body.proved and wall.proved
    with pytest.raises(ValueError, match="one number, or 3, one for each neighbour, not 2"):
        blend.solid([1, 2])


def test_moved_bodies_keep_their_sheets(blends):
    body = blends("cone").solid(1)
    volume, kept = body.mesh(1e-2).volume, body.rotate(Z, 30).translate((1, 2, 3))
    for moved, times in ((kept, 1), (kept.mirror((1, 2, 0)), 1), (body.scale(2), 8), (body.scale((1, 2, 3)), 6)):
        mesh = is_sound(moved.mesh(2e-2), moved, 2e-2, 2)
        assert mesh.volume == pytest.approx(times * volume, rel=1e-2)


def test_qualities(blends):
    body = blends("T").solid(3)
    meshes = {quality: body.mesh(2e-2, quality=quality) for quality in ("angles", "balanced", "count")}
    for mesh in meshes.values():
        assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
        assert mesh.deviation <= 2e-2
    assert len(meshes["count"].triangles) <= len(meshes["balanced"].triangles) < len(meshes["angles"].triangles)
    assert np.median(meshes["angles"].smallest_angles) > 30


def test_set_operations_go_by_exact_faces(blends):
    body = blends("T").solid(2)
    bore = solid.cylinder((0, 0, 0), (0, 6, 0), "1/2", "bore")
    flange = solid.cylinder((0, "11/4", 0), (0, 3, 0), 2, "flange")
    made = (body | flange) - bore
    assert isinstance(made.sheets, Operands)
    mesh = made.mesh(5e-2)
    assert mesh.is_closed and {"bore", "flange", "blend", "neighbour 1"} <= {*mesh.names}
    assert body.cap("y - 5/2", "cut").sheets is None


GOOD = [
    *("x^2 + y^2 - 1", "x^2 + (y - 1/2)^2 - 1", "x^2 + 2*y^2 - (z + 1)^2/9", "x^2 + y^2 - (z - 5)^2/9"),
    *("x^2 + y^2 - z - 1", "x^2 + (y + z/3)^2 + (z - 2)^2 - 5", "x^2 + y^2 - (z + 3)^2 + 4"),
]
WRONG = {
    "the centre is outside": "x^2 + (y - 2)^2 - 1",
    "the centre is in the other nappe": "x^2 + y^2 - (z - 1)^2",
    "the centre is the apex": "x^2 + y^2 - z^2",
    "it has two nappes up to the cap": "x^2 + y^2 - (z - 5/2)^2",
    "it ends at the cap": "x^2 + y^2 + (z - 2)^2 - 1",
    "it is not there at the clip": "x^2 + y^2 - z + 5/2",
    "it is not convex": "x^2 + y^2 - 1 - (z + 5)^2/16",
    "sections are hyperbolas": "x^2 - y^2 - 1",
    "sections are parabolas": "x^2 - y - 1",
    "it is all of space": "-x^2 - y^2 - 1",
    "it is a plane": "x - 1",
    "it is of degree 4": "x^4 + y^4 - 1",
}


@pytest.mark.parametrize("surface", GOOD)
def test_sections_between_planes_are_on_their_quadric(surface):
    """Row by row, with the ellipse that has the points of the first one."""
    surface, plane, cap = map(pas.Polynomial, (surface, "z - 2", "z - 3"))
    rows = Sections.of(surface, plane, cap, (fmpq(0),) * 3)
    rim = pas.Contact(surface, plane).rim.points()
    for share in (0, 0.3, 1):
        points = rows(rim, share)
        assert np.abs(surface(points)).max() < 1e-12 and np.abs(points[:, 2] - 2 - share).max() < 1e-12
    assert np.abs(rows(rim, 0) - rim).max() < 1e-12


@pytest.mark.parametrize("case", WRONG)
def test_what_is_no_convex_quadric_around_the_centre_has_no_sections(case):
    plane, cap = pas.Polynomial("z - 2"), pas.Polynomial("z - 3")
    assert Sections.of(pas.Polynomial(WRONG[case]), plane, cap, (fmpq(0),) * 3) is None


def test_bodies_have_sheets_where_each_rule_holds(blends):
    """A wall's inner strips must be inside the outer ones, and all of them above the wall's floor."""
    body = blends("cone").hollow("1/8").solid(1).sheets
    outer, inner = body.sides
    assert SheetBody.of([outer, inner]) is not None and SheetBody.of([inner, outer]) is None
    chain = outer.chains[0]
    for floor, found in (("-1", True), ("x - 5/2", False)):
        floored = replace(chain, floor=pas.Polynomial(floor))
        assert (SheetBody.of([replace(outer, chains=(floored, *outer.chains[1:]))]) is not None) == found
    assert SheetBody.of([outer, replace(inner, name="neighbour 1 end")]) is None
    for number in range(3):  # an end is left over
        side = replace(outer, chains=outer.chains[:number] + outer.chains[number + 1 :])
        assert side.mesh(1e-2, Quality.BALANCED) is None


@pytest.mark.slow
def test_a_node_with_a_torus_has_a_lattice():
    contacts = [pas.Torus(Z, (2, 0, 0), "1/2", (-2, 2, 0)), pas.Cone((1, -1, 0), "1/2", 2, slope="1/8")]
    surface = pas.blend([*contacts, pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8")], 1)
    assert surface.solid("1/2").sheets is None


@pytest.mark.slow
def test_two_pipes_and_a_wider_cone_as_wall_moved_and_cut():
    contacts = [pas.Pipe(Y, "1/2", 2), pas.Pipe((1, -1, 0), "1/2", 2), pas.Cone(Z, "1/2", 2, slope="1/8")]
    wall = pas.blend(contacts, 1).hollow("1/16").solid(1)
    moved = wall.rotate((1, 2, 2), 40).translate((3, 0, 0))
    is_sound(moved.mesh(1e-2), moved, 1e-2, -2)
    cut = wall - solid.box((-4, -4, -4), (0, 4, 4), "cut")
    assert np.abs(cut.box).max() < 4
    mesh = cut.mesh(2e-2)
    assert mesh.is_closed and {"cut x+", "blend", "inside of blend"} <= {*mesh.names}
