"""Fillets along edges that go on smoothly in one another: at feet, floors, tops and rims of upright solids."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from flint import fmpq
from scipy.integrate import quad
from test_step import measures, read_solids

import pas
from pas import solid
from pas.cli import main
from pas.errors import GeometryError
from pas.solid.fillets import Filling
from pas.solid.profile_rounds import filleted, pieces_along


def plate(height: int = 0) -> solid.Solid:
    return solid.box((-20, -20, -10), (60, 50, height), face="plate")


def rectangle(face: str = "boss") -> solid.Profile:
    return solid.rounded_rectangle(40, 30, 5, face=face)


def slot() -> solid.Profile:
    outline = solid.sketch((0, -4)).line_to(20, -4, face="slot 1").arc_to(20, 4, radius=4, face="slot 2")
    return outline.line_to(0, 4, face="slot 3").arc_to(0, -4, radius=4, face="slot 4").close()


def waisted() -> solid.Profile:
    """Two arcs of more than half a turn with two that bow in between them, all of radius 5."""
    right = solid.sketch((3, 4)).arc_to(-3, 4, radius=5, clockwise=True, face="waist 1")
    left = right.arc_to(-3, -4, radius=5, large=True, face="waist 2")
    return (
        left.arc_to(3, -4, radius=5, clockwise=True, face="waist 3")
        .arc_to(3, 4, radius=5, large=True, face="waist 4")
        .close()
    )


TURN, WIDE, NARROW = 2 * np.pi, 2 * (np.pi - np.arctan2(4, 3)), np.pi - 2 * np.arctan2(4, 3)
PROFILES = {
    "rectangle": (rectangle, 40 * 30 - 25 * (4 - np.pi), 100, [(5, TURN, 1)]),
    "slot": (slot, 160 + 16 * np.pi, 40, [(4, TURN, 1)]),
    "waisted": (waisted, None, 0, [(5, 2 * WIDE, 1), (5, 2 * NARROW, -1)]),
}
"""Profiles with their areas, the length of their straight edges, and radius, angle and bow of their arcs."""


@cache
def area_of(name: str) -> float:
    make, known, *_ = PROFILES[name]
    return known or make().extrude(1).volume(1e-4)


def depth(t: float, order: int) -> float:
    """How high a fillet of radius 1 is at a distance from the wall, by its section 2 s t = (1 - s - t)^(order + 1)."""
    if order == 2:
        return 1 - t - max(root.real for root in np.roots([1, 0, 2 * t, 2 * t * (t - 1)]) if abs(root.imag) < 1e-9)
    return 1 - np.sqrt(1 - (1 - t) ** 2) if order else 1 - t


def swept(name: str, radius: float, order: int, outwards: int) -> float:
    """The volume between a fillet beside a profile's wall, outside or inside of it, and plane and wall, by Pappus."""
    _, _, straight, arcs = PROFILES[name]
    found = straight * quad(lambda t: depth(t, order), 0, 1)[0] * radius**2
    for size, angle, bow in arcs:
        far = quad(lambda t, side=bow * outwards, size=size: (size + side * radius * t) * depth(t, order), 0, 1)[0]
        found += angle * far * radius**2
    return found


CASES = {
    "feet": lambda outline: (plate() | outline().extrude(8), "plate z+", 8, 1, 1),
    "floors": lambda outline: (plate() - outline().extrude(7).translate(0, 0, -6), "bottom", -6, 1, -1),
    "tops": lambda outline: (plate() | outline().extrude(8), "top", 8, -1, -1),
    "rims": lambda outline: (plate() - outline().extrude(7).translate(0, 0, -6), "plate z+", -6, -1, 1),
}
SOME = [("rectangle", 1), ("rectangle", 2), ("slot", 1), ("waisted", 2), ("rectangle", 0)]


@pytest.mark.sampled(20)
@pytest.mark.parametrize(("profile", "order"), SOME)
@pytest.mark.parametrize("case", CASES)
def test_fillets_go_along_all_edges_of_a_chain(case, profile, order):
    trimesh = pytest.importorskip("trimesh")
    make = PROFILES[profile][0]
    plain, end, height, sign, outwards = CASES[case](make)
    names, radius = (end, {"rectangle": "boss", "slot": "slot 2", "waisted": "waist"}[profile]), Fraction(3, 2)
    made = plain.fillet(*names, radius, order) if order else plain.chamfer(*names, radius)
    assert made.proved
    for tolerance in (None, 3e-2):
        mesh = made.mesh(tolerance)
        assert mesh.is_closed and mesh.euler_characteristic == 2
        assert trimesh.Trimesh(mesh.points, mesh.triangles, process=False).is_watertight
    expected = 80 * 70 * 10 + area_of(profile) * height + sign * swept(profile, 1.5, order, outwards)
    assert made.volume() == pytest.approx(expected, rel=3e-6)
    across = [joint for joint in made.joints if joint.first == joint.second]
    assert len(across) == len({edge.name for edge in make().loop.edges})


@pytest.mark.slow
def test_the_largest_has_spheres_at_arcs_of_its_radius():
    pocket = plate() - rectangle().extrude(8).translate(0, 0, -7)
    with pytest.raises(GeometryError, match=r"'boss 2' is bent more than a ball of this radius.*; one of radius 5 is"):
        pocket.fillet("bottom", "boss", 6)
    made = pocket.fillet("bottom", "boss", 5)
    assert made.proved and made.description.count("sphere") == 1
    assert made.volume() == pytest.approx(56000 - 7 * area_of("rectangle") + swept("rectangle", 5, 1, -1), rel=3e-6)
    assert pocket.largest_fillet("bottom", "boss") == 5


@pytest.mark.slow
def test_nearly_as_large_as_an_arc_it_is_a_part_of_a_torus_that_meets_itself():
    made = (plate() | rectangle().extrude(8)).fillet("top", "boss", "9/2")
    points = np.random.default_rng(0).random((50_000, 3)) * (40, 30, 8)
    kept = area_of("rectangle") * 8 - swept("rectangle", 4.5, 1, -1)
    assert made.proved and made.contains(points).mean() * 9600 == pytest.approx(kept, abs=50)
    assert made.volume() == pytest.approx(56000 + kept, rel=3e-6)


@pytest.mark.slow
def test_edges_that_turn_by_more_than_half_a_turn_are_cut_by_one_plane_at_each_end():
    made = (plate() | waisted().extrude(8)).fillet("plate z+", "waist 2", 1)
    x, y = np.array([(-10.5, 0), (-6, 5.5), (-6, -5.5), (10.5, 0), (0, 2.7)]).T
    assert made.contains(np.stack([np.append(x, 15), np.append(y, 0), np.full(6, 0.1)], axis=1)).tolist() == 5 * [
        True
    ] + [False]
    parts = [joint for joint in made.joints if joint.second == "waist 2"]
    assert made.proved and len([joint for joint in parts if joint.first == "fillet"]) == 2


@pytest.mark.slow
def test_the_top_of_an_other_prism_is_not_taken_for_it():
    """Two have faces of one name, of which both meet the upper one's side."""
    step, upper = solid.rounded_rectangle(60, 50, 8, (-10, -10), "step").extrude(3), rectangle().extrude(8)
    with pytest.raises(GeometryError, match="'top' has its edge on several polynomials: give faces names of their own"):
        (plate() | step | upper).fillet("top", "boss", 2)
    made = (plate() | step | upper.renamed({"top": "lid"})).fillet("lid", "boss", 2).fillet("top", "step", 1)
    volume = 56000 + 3 * (3000 - 64 * (4 - np.pi)) + 5 * area_of("rectangle") - swept("rectangle", 2, 1, -1)
    far = quad(lambda t: (8 - t) * depth(t, 1), 0, 1)[0]
    assert made.proved and made.mesh().is_closed
    assert made.volume() == pytest.approx(volume - 156 * (1 - np.pi / 4) - 2 * np.pi * far, rel=3e-6)
    body, other = rectangle().extrude(8).sheets, solid.rounded_rectangle(20, 10, 3, face="boss").extrude(8).sheets
    pieces = pieces_along(body.loops[0], "top", pas.Polynomial("z - 8"), fmpq(2), 1)
    assert filleted(body, pieces, False) is not None and filleted(other, pieces, False) is None
    assert filleted(body, pieces, True) is None  # these are inside of it
    amid = pieces_along(body.loops[0], "end", pas.Polynomial("z - 5"), fmpq(2), 1)
    assert filleted(body, amid, False) is None  # where it does not end
    for plane, fits in (
        ("z - 1", True),
        ("z", True),
        ("z - 8", False),
        ("7 - z", True),
        ("5/2 - z", True),
        ("1 - z", False),
    ):
        around = pieces_along(body.loops[0], "foot", pas.Polynomial(plane), fmpq(2), 1, 1)
        assert (filleted(body, around, True) is not None) == fits


def test_a_chain_that_ends_at_corners_and_goes_over_an_edge():
    """Half a slot beside the plate's side: its foot ends there."""
    half = (
        solid.sketch((-20, 0))
        .line_to(0, 0, face="d 1")
        .arc_to(0, 10, radius=5, face="d 2")
        .line_to(-20, 10, face="d 3")
    )
    made = (plate() | half.close("d 4").extrude(6)).fillet("plate z+", "d 2", 1)
    mesh = made.mesh()
    assert made.proved and mesh.is_closed and mesh.points[:, 0].min() == pytest.approx(-20)
    expected = 56000 + 6 * (200 + 12.5 * np.pi) + 40 * (1 - np.pi / 4)
    expected += np.pi * quad(lambda t: (5 + t) * depth(t, 1), 0, 1)[0]
    assert made.volume() == pytest.approx(expected, rel=1e-5)


def on_plate(part: solid.Profile, height: int, number: int = 1) -> solid.Solid:
    """A boss that is so high on a rounded plate, 5 thick, and goes 1 into it."""
    return part.extrude(height + 1).translate(0, 0, 4).renamed({"top": f"lid {number}", "bottom": f"foot {number}"})


def rounded_plate() -> solid.Solid:
    return solid.rounded_rectangle(40, 30, 5, face="plate").extrude(5)


def pillar() -> solid.Profile:
    return solid.rounded_rectangle(20, 10, 2, (10, 10), face="boss")


ON_PLATE = 5 * (1200 - 25 * (4 - np.pi)) + 12 * (200 - 4 * (4 - np.pi))


def foot(straight: float, arc: float, radius: float, order: int = 1, outwards: int = 1) -> float:
    """The volume of a fillet around straight edges and arcs that make one whole turn, or of a round: see `swept`."""
    section = quad(lambda t: depth(t, order), 0, 1)[0]
    turned = quad(lambda t: (arc + outwards * radius * t) * depth(t, order), 0, 1)[0]
    return radius**2 * (straight * section + TURN * turned)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("radius", "order"), [(3, 1), ("1/10", 1), ("19/2", 1), ("1/2", 2), ("11/2", 2)])
def test_feet_on_plates_over_profiles_are_as_large_as_the_plate_is(radius, order):
    """Such plates and bosses are meshed from rows along their edges, where lattices took minutes, or ended."""
    made = (rounded_plate() | on_plate(pillar(), 12)).fillet("top", "boss", radius, order)
    mesh = made.mesh()
    assert made.proved and made.sheets is not None and mesh.is_closed and mesh.euler_characteristic == 2
    assert made.volume() == pytest.approx(ON_PLATE + foot(44, 2, float(Fraction(radius)), order), rel=3e-6)


@pytest.mark.slow
def test_feet_go_with_holes_and_maps(tmp_path):
    """Around a tube on a plate, turned and scaled, and in it; drilled, saved and read."""
    outer, inner = solid.rounded_rectangle(20, 14, 4, (4, 8)), solid.rounded_rectangle(14, 8, 3, (7, 11), "bore")
    part, drill = rounded_plate() | on_plate(outer - inner, 8), solid.cylinder((33, 15, -1), (33, 15, 9), 1)
    part, drill = (one.rotate((2, 1, 2), 50).scale(2) for one in (part, drill))
    made = part.fillet("top", "bore", 4).fillet("top", "side", 6, 2) - drill
    expected = 5 * (1200 - 25 * (4 - np.pi) - np.pi) + 8 * (280 - 112 - 7 * (4 - np.pi)) + foot(36, 4, 3, 2)
    bores = 20 * quad(lambda t: depth(t, 1), 0, 1)[0] + TURN * quad(lambda t: (3 - 2 * t) * depth(t, 1), 0, 1)[0]
    pas.save(made, tmp_path / "part.pas.json")
    assert made.proved and made.sheets is not None and made.mesh().euler_characteristic == 0
    assert made.volume() == pytest.approx(8 * (expected + 4 * bores), rel=3e-6)
    assert len(pas.load(tmp_path / "part.pas.json").mesh().triangles) == len(made.mesh().triangles)


@pytest.mark.slow
def test_feet_of_two_bosses_and_rounds_of_their_tops():
    """On one plate, one after the other; a foot that would meet the other boss, or pass the edge, is told."""
    bosses = [on_plate(solid.rounded_rectangle(8, 10, 2, (5, 10), "p"), 9)]
    bosses.append(on_plate(solid.rounded_rectangle(8, 10, 3, (24, 10), "q"), 9, 2))
    plain = rounded_plate() | bosses[0] | bosses[1]
    made = plain.fillet("top", "p", 4).fillet("lid 1", "p", 1).fillet("top", "q", 3, 2)
    expected = 5 * (1200 - 25 * (4 - np.pi)) + 9 * (160 - 13 * (4 - np.pi))
    expected += foot(20, 2, 4) - foot(20, 2, 1, 1, -1) + foot(12, 3, 3, 2)
    assert made.proved and made.sheets is not None
    assert made.volume() == pytest.approx(expected, rel=3e-6)
    meets, passes = "fillet 2 meets top with GC^1 on a part of the curve: the regions", "'top' does not go on so far"
    for whole, name, told in ((plain.fillet("top", "p", "9/2"), "q", meets), (plain, "p", passes)):
        assert told in Filling.of(whole, ("top", name), 1, ()).made(fmpq(7))


TABLES = """
[[solid]]
name = "base"
kind = "box"
lower = [-20, -20, -10]
upper = [60, 50, 0]
face = "plate"

[[solid]]
name = "boss"
kind = "rounded_rectangle"
width = 40
height = 30
radius = 5
face = "boss"
then = [{ kind = "extrude", height = 8 }]

[[solid]]
name = "part"
kind = "union"
of = ["base", "boss"]
then = [{ kind = "fillet", first = "plate z+", second = "boss", radius = 2 }]
"""


@pytest.mark.slow
def test_parts_go_on_and_files_have_them(tmp_path):
    """Moved, drilled, saved and read, written as STEP with exact faces, and made from a file of tables."""
    made = (plate() | rectangle().extrude(8)).fillet("plate z+", "boss", 2)
    part = (made - solid.cylinder((20, 15, -20), (20, 15, 20), 4, face="hole")).rotate((1, 2, 3), 40)
    assert part.proved and part.mesh().euler_characteristic == 0
    pas.save(part, tmp_path / "part.pas.json")
    assert pas.load(tmp_path / "part.pas.json").polynomials == part.polynomials
    (tmp_path / "part.toml").write_text(TABLES)
    assert main(["build", str(tmp_path / "part.toml"), "-o", str(tmp_path / "built.pas.json")]) == 0
    assert pas.load(tmp_path / "built.pas.json").polynomials == made.polynomials


@pytest.mark.slow
def test_step_has_planes_cylinders_and_tori(tmp_path):
    pytest.importorskip("OCP")
    part = (plate() | rectangle().extrude(8)).fillet("plate z+", "boss 3", 2)
    part.write(tmp_path / "part.step")
    solids, kinds = read_solids(tmp_path / "part.step")
    assert kinds == {"CylindricalSurface": 8, "Plane": 11, "ToroidalSurface": 4} and len(solids) == 1
    expected = 56000 + 8 * area_of("rectangle") + swept("rectangle", 2, 1, 1)
    assert measures(solids[0])[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_smooth_unions_go_along_chains():
    made = solid.smooth_union(plate(), rectangle().extrude(8).translate(0, 0, -2), 1)
    assert made.proved and made.faces[-1] == "fillet"
    expected = 56000 + 6 * area_of("rectangle") + swept("rectangle", 1, 1, 1)
    assert made.volume() == pytest.approx(expected, rel=3e-6)


REFUSED = {
    "'sidee'; is 'side 6' meant?": lambda: sharp().fillet("plate z+", "sidee", 1),
    "does not go on smoothly from that of 'plate z+' and 'side 4': give the name of one face": lambda: sharp().fillet(
        "plate z+", "side", 1
    ),
    "the face 'bottom' has its edge on several polynomials: give faces names of their own": lambda: twins(),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("order", "taper"), [(3, 0), (1, 5)])
def test_where_sections_differ_is_told(order, taper):
    whole = plate() | rectangle().extrude(8, taper)
    told = Filling.of(whole, ("plate z+", "boss 1"), order, ()).made(fmpq(1))
    for words in ("near (", "where 'boss 1' goes on smoothly in 'boss", "it does of order 0 to 2 along a plane with"):
        assert words in told


def sharp() -> solid.Solid:
    return solid.box((-20, -20, -10), (20, 20, 0), face="plate") | solid.regular_polygon(6, 8).extrude(5)


def twins() -> solid.Solid:
    outer, inner = (
        solid.rounded_rectangle(80, 60, 8).extrude(12),
        solid.rounded_rectangle(40, 30, 5, (20, 15)).extrude(8),
    )
    return (outer - inner.translate(0, 0, 4)).fillet("bottom", "side 1", 2)


@pytest.mark.parametrize("sentence", REFUSED)
def test_refused(sentence):
    with pytest.raises(GeometryError) as caught:
        REFUSED[sentence]()
    assert sentence in str(caught.value) and "\n" not in str(caught.value)
