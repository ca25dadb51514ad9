"""Each rule of a joint's verdict: a whole joint, and what breaks just that rule."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from conftest import UNEQUAL, solved

import pas
from pas import solid
from pas.solid import patch
from pas.solid.joints import Joint
from pas.solid.tree import Atom, combined, complement
from pas.verdicts import Status

PROVED, REFUTED, UNDECIDED = pas.Status.PROVED, pas.Status.REFUTED, pas.Status.UNDECIDED
BALL, FLATTER, CLIP = "x^2 + y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 1 + (z - 1/3)^2", "z - 1/3"
UPPER, LOWER = patch("A", BALL, CLIP), patch("B", FLATTER, "1/3 - z")


def verdict(shape: solid.Solid, order: int = 1, along=(BALL, CLIP), names=("A", "B")) -> pas.Verdict:
    """The verdict on one claim."""
    return shape.joined(*names, along, order).verdicts[-1]


def says(shape: solid.Solid, status: pas.Status, words: str, *args, **options) -> pas.Verdict:
    """Check a verdict's status and reason."""
    found = verdict(shape, *args, **options)
    assert found.status is status, str(found)
    assert words in found.reason
    return found


@pytest.mark.parametrize("order", [0, 1])
def test_a_whole_joint(order):
    found = says(UPPER | LOWER, PROVED, f"^{order + 1}>, exactly GC^1", order)
    assert found.claim == f"A meets B with GC^{order}"
    assert verdict(UPPER | LOWER, order, names=("B", "A")).status is PROVED
    for high in (5, 8):
        says(patch("A", BALL, CLIP) | patch("B", BALL, "1/3 - z"), PROVED, "the same surface", high)
    # what cuts out the curve need not be one of the faces
    says(UPPER | LOWER, PROVED, "contact all along the curve, exactly GC^1", order=1, along=("9*x^2 + 9*y^2 - 8", CLIP))


def test_a_claim_of_a_part_of_a_curve(tmp_path):
    """Of two caps one ends at x = 0: they go on in one another before that, and not all around."""
    shape = patch("A", BALL, CLIP, "-x") | LOWER
    walls = {("-x",): PROVED, ("-x - 1/10", "y"): PROVED, ("1/10 - x",): REFUTED, (): REFUTED, ("x - 2",): REFUTED}
    for within, status in walls.items():
        made = replace(shape, joints=(Joint("A", "B", (BALL, CLIP), 1, within),)).translate(1, 0, 0)
        (found,) = made.verdicts
        assert found.status is status, (within, str(found))
        assert found.claim.endswith(" on a part of the curve") == bool(within)
        assert pas.load(made.save(tmp_path / "a.pas.json")).joints == made.joints


@pytest.mark.sampled(2)
@pytest.mark.parametrize("wall", ["x", "-x", "y + 9/10", "1/3 - x*y", "x^2 + y/10"])
def test_a_face_missing_on_a_part_is_found(wall):
    """As in `upper` and `lower` halves of which one ends at x = 0: the joint goes on where it is not."""
    for shape, name in (
        (patch("A", BALL, CLIP, wall) | LOWER, "A"),
        (UPPER | patch("B", FLATTER, "1/3 - z", wall), "B"),
        ((UPPER - solid.implicit(wall, face="cut")) | LOWER, "A"),
    ):
        for order in (0, 1):
            found = says(shape, REFUTED, f"{name} is missing: the boundary goes on without it", order)
            assert pas.Polynomial(wall)(found.witness) < 0
            assert abs(pas.Polynomial(BALL)(found.witness)) < 1e-9


def test_arcs_of_any_length_count():
    """Of a circle of radius 1, points a distance of 10^-30 apart are cut off, or all others."""
    pipe, dome = "x^2 + y^2 - 1", "x^2 + y^2 - 1 + z^2"
    steep = "(x - 1)*10^30 + y"  # 0 at (1, 0, 0) and about 2/10^30 from there
    for wall in (steep, f"-({steep})", "1/10^60 - (x - 1)^2 - (y - 1/10^30)^2", "1 - x - 1/10^50"):
        shape = patch("A", pipe, "z") | patch("B", dome, "-z", wall)
        says(shape, REFUTED, "B is missing", along=(pipe, "z"))
    for wall in ("1 - x", "1 - x + 1/10^50", "(y - x/7)^2", "(x - 1)^2 + (y - 1/10^30)^2"):
        shape = patch("A", pipe, "z") | patch("B", dome, "-z", wall)
        says(shape, PROVED, "exactly GC^1", along=(pipe, "z"))


def test_where_neither_is_nothing_is_asked():
    half = solid.implicit("x - 1/7", face="other")
    for whole in (UPPER | LOWER, UPPER | patch("B", FLATTER, "1/3 - z", "x - 1/7")):
        says(whole | half, PROVED, "exactly GC^1")
        says(whole - half, PROVED, "exactly GC^1")
    says((UPPER | LOWER) & half, PROVED, "exactly GC^1")
    short = UPPER | patch("B", FLATTER, "1/3 - z", "x - 1/7 - 1/10^30")
    says(short | half, REFUTED, "B is missing")
    says(UPPER | LOWER | solid.ball((0, 0, 0), 2), REFUTED, "do not both reach the curve")


@pytest.mark.parametrize("order", [0, 1])
def test_opposite_sides(order):
    outside = patch("B", f"-({FLATTER})", "1/3 - z")
    says(UPPER | outside, REFUTED, "opposite sides of the two faces: its boundary has 4 pieces", order)
    turned = patch("B", f"({BALL})*(x - 1/5) + (z - 1/3)^2", "1/3 - z")
    found = says(UPPER | turned, REFUTED, "opposite sides", order)
    assert found.witness[0] < 1 / 5


def test_sharp_edges():
    """Two faces bound one sector of the solid at an edge of order 0, convex or not, or there are four of them."""
    box = solid.box((0, 0, 0), (1, 2, 3))
    edge = {"along": ("x", "y"), "names": ("box x-", "box y-"), "order": 0}
    says(box, PROVED, "exactly GC^0", **edge)
    says(box - solid.ball((0, 0, 1), "1/2"), PROVED, "exactly GC^0", **edge)
    says(box | box.translate((-1, -2, 1)), REFUTED, "opposite sides", **edge)
    says(box, REFUTED, "GC^0 there", **{**edge, "order": 1})
    says(box, REFUTED, "box x+ does not hold the curve", **{**edge, "names": ("box x+", "box y-")})
    a, b = solid.implicit("x", face="A"), solid.implicit("y - x^2", face="B")
    for shape in (a | b, a & b, a - b, b - a):
        says(shape, PROVED, "exactly GC^0", 0, along=("x", "y"))
    says((a - b) | (b - a), REFUTED, "4 pieces", 0, along=("x", "y"))


def test_cusps():
    wedge = patch("A", "y", "x") - solid.implicit("y + x^3", face="B")
    says(wedge, PROVED, "exactly GC^2", 0, along=("x", "y"))
    says(wedge, REFUTED, "in a cusp", 1, along=("x", "y"))
    around = solid.implicit("-y", face="A") | solid.implicit("y + x^3", face="B") | solid.half_space("x")
    says(around, PROVED, "exactly GC^2", 0, along=("x", "y"))
    says(around, REFUTED, "in a cusp", 2, along=("x", "y"))


def test_orders():
    for k in range(4):
        shape = patch("A", "y", "x") | patch("B", f"y - x^{k + 1}*(z^2 + 1)", "-x")
        says(shape, PROVED, f"exactly GC^{k}", k, along=("x", "y"))
        found = says(shape, REFUTED, f"they meet with GC^{k} there", k + 1, along=("x", "y"))
        assert found.witness is not None
    # where the higher order is there on one of two components only, the lower one counts
    g, h = "x^2 + y^2 + z^2 - 1", "x^2 + y^2 - 9/25"
    both = patch("A", g, h) | patch("B", f"{g} + ({h})*(z - 4/5)", "9/25 - x^2 - y^2")
    says(both, REFUTED, "GC^0 there", 1, along=(g, h))
    says(both & solid.half_space("-z"), PROVED, "exactly GC^1", 1, along=(g, h))


def test_faces_that_do_not_meet():
    says(UPPER | LOWER, REFUTED, "do not meet there: B does not hold the curve", along=(BALL, "z - 1/2"))
    apart = patch("A", BALL, "z - 2/3") | LOWER
    says(apart, REFUTED, "do not both reach the curve")
    beside = patch("A", BALL, CLIP, "x") | patch("B", FLATTER, "1/3 - z", "-x")
    says(beside, REFUTED, "go along different parts of the curve")


def test_curves_that_are_none():
    for clip in ("z - 2", "z - 1"):
        shape = patch("A", BALL, clip) | patch("B", f"{BALL} + ({clip})^2", f"-({clip})")
        says(shape, REFUTED, "no real points, or isolated ones only", along=(BALL, clip))
    pipe = patch("A", "y^2 + z^2 - 1", "y - 1") | patch("B", "y^2 + z^2 - 1", "1 - y")
    says(pipe, UNDECIDED, "touch all along", 0, along=("y^2 + z^2 - 1", "y - 1"))
    says(UPPER | LOWER, REFUTED, "no real points", along=("x", "x - 1"))
    for along in (("x*y", "x*z"), ("0", "x"), ("x", "x")):
        with pytest.raises(ValueError, match="share a surface"):
            Joint("A", "B", along, 1)


def test_components_on_which_they_do_not_meet_are_no_part():
    pipe = "x^2 + y^2 - 1/4"
    a = patch("A", BALL, pipe)
    b = f"{BALL} + ({pipe})^2"
    says(a | patch("B", b, "1/4 - x^2 - y^2", "z"), PROVED, "exactly GC^1", along=(BALL, pipe))
    says(a | patch("B", b, "1/4 - x^2 - y^2", "z", "x"), REFUTED, "B is missing", along=(BALL, pipe))
    for off, status in (("1/10^30", PROVED), ("0", REFUTED), ("-1/10^30", REFUTED)):
        loop = f"(x - 1/2)^2 + y^2 - 1/4 + ({off})"  # in two parts, in one that crosses itself, in one
        shape = patch("A", BALL, loop) | patch("B", f"{BALL} + ({loop})^2", f"-({loop})", "z")
        says(shape, status, "", along=(BALL, loop))


def test_curves_without_end():
    line = {"along": ("y", "x")}
    a, b = patch("A", "y", "x"), patch("B", "y + x^2", "-x")
    says(a | b, PROVED, "exactly GC^1", **line)
    says(a | patch("B", "y + x^2", "-x", "10^9 - z"), REFUTED, "B is missing", **line)
    says(a | patch("B", "y + x^2", "-x", "z + 10^9"), REFUTED, "B is missing", **line)
    hyperbola = {"along": ("x*y - 1", "z")}
    a, b = patch("A", "x*y - 1", "z"), ("x*y - 1 + z^2", "-z")
    says(a | patch("B", *b, "x"), PROVED, "exactly GC^1", **hyperbola)
    says(a | patch("B", *b, "x - 1/10^9"), REFUTED, "B is missing", **hyperbola)


CONE = "x^2 + y^2 - z^2"


def test_singular_points():
    a, b = patch("A", CONE, "x - y"), patch("B", CONE, "y - x")
    line = {"along": (CONE, "x - y")}
    found = says(a | b, UNDECIDED, "singular at a point", **line)
    assert found.witness == (0, 0, 0)
    away = patch("A", CONE, "x - y", "z - 1/10^9") | patch("B", CONE, "y - x", "z - 1/10^9")
    says(away, PROVED, "the same surface", **line)
    says(a | b | solid.ball((0, 0, 0), "1/1000000000"), PROVED, "the same surface", **line)
    says((a | b) - solid.ball((0, 0, 0), "1/1000000000"), PROVED, "the same surface", **line)
    smooth = f"{CONE} + x - y"  # regular there
    says(patch("A", smooth, "x - y") | patch("B", CONE, "y - x"), UNDECIDED, "B is singular", 0, **line)
    says(patch("A", CONE, "x - y") | patch("B", smooth, "y - x"), UNDECIDED, "A is singular", 0, **line)


def test_faces_that_are_singular_all_along():
    a, b = patch("A", "y^2 - x^3"), patch("B", "y", "-x")
    says(a | b, UNDECIDED, "A is singular all along the curve", 0, along=("x", "y"))
    says(a | b | solid.half_space("x - 1"), REFUTED, "do not both reach", 0, along=("x", "y"))
    beside = patch("A", "y^2 - x^3", "x - 5")  # that has a part of the face, elsewhere
    says(beside | patch("A", "y", "x") | b, PROVED, "the same surface", 8, along=("x", "y"))


def test_functions_that_are_no_polynomials():
    """Tubes far from the curve do not matter, near it they may; `Nearby` looks at boxes."""
    whole = UPPER | LOWER
    far = solid.tube(("cos(t)/2", "sin(t)/2", "0"), "1/8", (0, 2))
    says(whole | far, PROVED, "exactly GC^1")
    says(whole - far, PROVED, "exactly GC^1")
    across = solid.tube(("t", "0", "1/3"), "1/8", (0, 2))
    for shape in (whole | across, whole - across):
        found = says(shape, UNDECIDED, "tube may cross the curve, and is no polynomial")
        assert abs(found.witness[0] - 0.93) < 0.1
        assert abs(found.witness[1]) < 0.4
    half = UPPER | patch("B", FLATTER, "1/3 - z", "x")
    says(half | far, REFUTED, "B is missing")
    says(half | across, REFUTED, "B is missing")
    says(far, UNDECIDED, "tube is no polynomial", 0, along=(BALL, CLIP), names=("tube", "tube start"))


def test_bodies_of_blends_in_pieces():
    """The inside of a piecewise surface is read cell by cell; a neighbour of which a part is missing is found."""
    blend = solved(UNEQUAL, 1)
    contact = blend.surface.contacts[0]
    along = (contact.surface, contact.clip)
    body = blend.solid("1/2", ["x", "y", "z"])
    says(body, PROVED, "exactly GC^1", along=along, names=("blend", "x"))
    says(body, REFUTED, "GC^1 there", 2, along=along, names=("blend", "x"))
    notch = solid.half_space("y - 3*z + 9/10").tree
    for name, words in (("x", "x is missing"), ("blend", "blend is missing")):
        parts = [combined(False, part, complement(notch)) if _has(part, name) else part for part in body.tree.parts]
        says(solid.Solid(combined(True, *parts)), REFUTED, words, along=along, names=("blend", "x"))


def _has(tree, name: str) -> bool:
    return any(isinstance(part, Atom) and part.face == name for part in tree.parts)


def test_one_name_for_both():
    both = patch("A", BALL, CLIP) | patch("A", FLATTER, "1/3 - z")
    says(both, PROVED, "exactly GC^1", names=("A", "A"))
    half = patch("A", BALL, CLIP) | patch("A", FLATTER, "1/3 - z", "x")
    says(half, REFUTED, "A is missing", names=("A", "A"))


def test_other_surfaces_through_the_curve():
    """They count where they are on the boundary, and only there."""
    inner = patch("C", f"2*({FLATTER}) + (z - 1/3)^2")  # inside both, touching them along the curve
    says(UPPER | LOWER | inner, PROVED, "exactly GC^1")
    outer = patch("C", f"2*({FLATTER}) - 3*(z - 1/3)^2")
    says(UPPER | LOWER | outer, REFUTED, "do not both reach the curve")
    wall = f"({FLATTER})*(x - 1/2)"  # a factor of a wall is one of the faces
    says(UPPER | patch("B", FLATTER, "1/3 - z", f"-({wall})*(x - 1/2)"), PROVED, "exactly GC^1")
    says(UPPER | patch("B", FLATTER, "1/3 - z", wall), REFUTED, "B is missing")


def test_touching_surfaces_that_change_their_order():
    """B goes on beyond the curve: under A that is no matter, and where it comes out over A, that ends before."""
    over, under = (REFUTED, "do not both reach"), (PROVED, "exactly GC^1")
    for b, found in (
        ("z^2 + 5", under),
        ("(z + 5)^2", under),
        ("-z^2 - 5", over),
        ("z + 5", (REFUTED, "A is missing")),
    ):
        says(patch("A", "y", "x") | patch("B", f"y + x^2*({b})", "1 - x"), *found, along=("y", "x"))


def test_powers_of_a_surface_are_no_face():
    full = solid.implicit("-y^2", face="A") & solid.half_space("y", "C")
    says(full, REFUTED, "do not both reach", 0, along=("x", "y"), names=("A", "C"))
    says(full & solid.half_space("x", "B"), PROVED, "exactly GC^0", 0, along=("x", "y"), names=("B", "C"))


def test_places_are_on_the_curve():
    shape = UPPER | patch("B", FLATTER, "1/3 - z", "x - 9/10")
    found = says(shape, REFUTED, "B is missing")
    assert found.witness[2] == pytest.approx(1 / 3)
    assert Fraction(found.witness[0]) < Fraction(9, 10)


@pytest.mark.parametrize("height", [10, 10**8])
def test_what_hides_a_face_is_seen_wherever_it_is(height):
    """Of a verdict on the solid before nothing is carried on: boxes end where doubles are too coarse for them."""
    tube = solid.implicit("x^2 + y^2 - 1", f"{height} - z", f"z - {height - 5}", face="tube")
    dome = solid.implicit(f"x^2 + y^2 + (z - {height})^2 - 1", f"z - {height}", face="dome")
    whole = (tube | dome).joined("tube", "dome", (f"z - {height}", "x^2 + y^2 - 1"), 1)
    assert whole.proved
    (verdict,) = (whole | solid.box((0, -2, height - 3), (2, 2, height))).verdicts
    assert verdict.status is Status.REFUTED and "tube is missing" in verdict.reason
