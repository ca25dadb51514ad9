"""Profiles: what is inside by formula and by polygon, solids extruded and revolved from them, and what is refused."""

from __future__ import annotations

import string

import numpy as np
import pytest
from flint import fmpq
from matplotlib.path import Path

from pas import solid
from pas.algebra.rational import square_root
from pas.errors import GeometryError
from pas.mesh.projection import distances
from pas.mesh.quality import Quality

RNG = np.random.default_rng


def vase() -> solid.Profile:
    curved = solid.sketch((0, 0)).line_to(1, 0).curve_to((2, 1), 1, 2).curve_to(("1/2", "5/2"), 1, 3)
    return curved.line_to(0, 3).close()


def tongue() -> solid.Profile:
    return solid.sketch((0, 0)).line_to(4, 0).arc_to(4, 1, radius="1/2").line_to(0, 1).close()


def moon() -> solid.Profile:
    return solid.sketch((1, 0)).arc_to(-1, 0, radius=1).arc_to(1, 0, radius="5/4", clockwise=True).close()


def slot() -> solid.Profile:
    """Arcs that continue what comes before them, one through a point."""
    return solid.sketch((0, 0)).line_to(3, 0).arc_to(3, 2).line_to(0, 2).arc_to(0, 0, through=(-1, 1)).close()


L_SHAPE = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]
THIRD = 1.25**2 * np.arcsin(0.8) - 0.75  # of a circle of 5/4 beyond a chord of 2
PROFILES = {
    "polygon": (lambda: solid.polygon(L_SHAPE), 6.0),
    "turned round": (lambda: solid.polygon(L_SHAPE[::-1]), 6.0),
    "rounded": (lambda: solid.rounded_rectangle(4, 3, "1/2"), 12 - (4 - np.pi) / 4),
    "with a hole": (lambda: solid.rectangle(4, 3) - solid.circle((1, 1), "1/2"), 12 - np.pi / 4),
    "tongue": (tongue, 4 + np.pi / 8),
    "moon": (moon, np.pi / 2 - THIRD),
    "slot": (slot, 6 + np.pi),
    "vase": (vase, 3 + 2 / 3 - 1 / 6),  # two thirds of the triangles of control points
    "hexagon": (lambda: solid.regular_polygon(6, 2), 6 * np.sqrt(3)),
    "apart": (lambda: solid.circle((0, 0), 1) | solid.circle((3, 0), 1).mirror((0, 1)), 2 * np.pi),
    "island": (lambda: solid.circle((0, 0), 3) - (solid.circle((0, 0), 2) - solid.circle((0, 0), 1)), 6 * np.pi),
    "moved": (lambda: solid.rectangle(4, 3).rotate(30).translate(1, 2).scale("1/2"), 3.0),
}


def area(profile: solid.Profile, tolerance: float) -> float:
    polygons = profile.polygons(tolerance)
    return sum(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2 for x, y in (p.T for p in polygons))


def inside(profile: solid.Profile, points: np.ndarray) -> np.ndarray:
    """By the parity of its polygons."""
    return np.sum([Path(np.r_[p, p[:1]]).contains_points(points) for p in profile.polygons(1e-6)], axis=0) % 2 == 1


@pytest.mark.parametrize("name", PROFILES)
def test_formula_and_polygon_have_the_same_inside(name):
    make, exact = PROFILES[name]
    profile = make()
    assert area(profile, 1e-6) == pytest.approx(exact, rel=1e-5)
    corners = np.concatenate(profile.polygons(0.1))
    points = RNG(0).uniform(corners.min(axis=0) - 0.3, corners.max(axis=0) + 0.3, (4000, 2))
    assert (profile.contains(points) == inside(profile, points)).mean() > 1 - 1e-3  # chords are off by 1e-6


@pytest.mark.parametrize("name", PROFILES)
def test_extruded(name):
    make, exact = PROFILES[name]
    shape = make().extrude("1/2")
    mesh = shape.mesh(1e-3)
    assert mesh.is_closed and mesh.deviation <= 1e-3 and {"bottom", "top"} < {*mesh.names}
    assert mesh.volume == pytest.approx(exact / 2, rel=2e-3)
    assert all(verdict.proved for verdict in shape.verdicts)
    assert len(shape.joints) == {"rounded": 8, "tongue": 2, "slot": 4, "vase": 1}.get(name, 0)
    moved = shape.rotate((1, 2, 3), 40).scale(3).mesh(3e-3)
    assert moved.is_closed and moved.volume == pytest.approx(27 * mesh.volume, rel=1e-3)


def test_random_polygons_by_their_formula():
    """Stars with many reflex corners, some with collinear ones."""
    rng = RNG(1)
    for n in (5, 8, 13, 30):
        angles = 2 * np.pi * (np.arange(n) + rng.uniform(0, 0.9, n)) / n
        corners = (rng.uniform(0.2, 1, n)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)).round(2)
        profile = solid.polygon(corners.tolist())
        points = rng.uniform(-1.1, 1.1, (3000, 2))
        assert (profile.contains(points) == Path(np.r_[corners, corners[:1]]).contains_points(points)).all()
    comb = solid.polygon(
        [(0, 0), (1, 0), (2, 0), (2, 2), ("3/2", 2), ("3/2", 1), (1, 1), ("1/2", 1), ("1/2", 2), (0, 2)]
    )
    assert comb.contains([[1, 0.5], [0.2, 1.5], [1, 1.5], [1.8, 1.9], [2.1, 0.5], [1, -0.1]]).tolist() == [
        True, True, False, True, False, False,
    ]  # fmt: skip


REVOLVED = {
    "cylinder": (lambda: solid.rectangle(1, 2), np.pi * 2),
    "ring": (lambda: solid.circle((3, 0), 1), 6 * np.pi**2),
    "ball": (lambda: solid.sketch((0, -1)).arc_to(0, 1, radius=1).close(), 4 / 3 * np.pi),
    "cone": (lambda: solid.polygon([(0, 0), (1, 0), (0, 2)]), 2 / 3 * np.pi),
    "washer": (lambda: solid.rectangle(1, "1/2", (1, 0)), 3 * np.pi / 2),
    "vase": (vase, None),  # parabolas, of which one bows in
    "apple": (lambda: solid.sketch((0, -1)).line_to("1/2", -1).arc_to("1/2", 1, radius=1).line_to(0, 1).close(), None),
    "lemon": (lambda: solid.sketch((0, -1)).arc_to(0, 1, radius="5/4").close(), None),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("degrees", [360, 90, 250])
@pytest.mark.parametrize("name", REVOLVED)
def test_revolved(name, degrees):
    make, exact = REVOLVED[name]
    profile = make()
    shape = profile.revolve(degrees)
    mesh = shape.mesh(2e-3)
    assert mesh.is_closed and mesh.deviation <= 2e-3
    assert ({"start", "end"} <= {*mesh.names}) == (degrees < 360)
    assert all(verdict.proved for verdict in shape.verdicts)
    if exact is not None:
        assert mesh.volume == pytest.approx(exact * degrees / 360, rel=4e-3)
    rng = RNG(2)
    r, z = rng.uniform(
        (0, mesh.points[:, 2].min() - 0.1), (mesh.points[:, 0].max() + 0.1, mesh.points[:, 2].max() + 0.1), (2000, 2)
    ).T
    turn = rng.uniform(0, 2 * np.pi, 2000)
    found = shape.contains(np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1))
    expected = profile.contains(np.stack([r, z], axis=1)) & (turn < np.radians(degrees))
    assert (found == expected).mean() > 0.999


def test_tapered_sides_lean_and_stay_smooth():
    shape = (solid.rounded_rectangle(40, 30, 5) - solid.circle((10, 10), 3)).extrude(5, taper=2)
    mesh = shape.mesh(1e-2)
    by = 5 * np.tan(np.radians(2))
    top = (40 - 2 * by) * (30 - 2 * by) - (4 - np.pi) * (5 - by) ** 2 - np.pi * (3 + by) ** 2
    plane = mesh.points[mesh.triangles[mesh.faces == mesh.names.index("top")]]
    assert mesh.is_closed and len(shape.verdicts) == 8 and all(verdict.proved for verdict in shape.verdicts)
    areas = np.linalg.norm(np.cross(plane[:, 1] - plane[:, 0], plane[:, 2] - plane[:, 0]), axis=1) / 2
    assert areas.sum() == pytest.approx(top, rel=1e-4)
    assert shape.sheets.mesh(1e-2, Quality.BALANCED) is not None
    points = RNG(3).uniform((0, 0, 0), (40, 30, 5), (4000, 3))
    lean = points[:, 2] * np.tan(np.radians(2))
    off = np.abs(points[:, :2] - (20, 15)) - (15, 10)  # from the rectangle of the corners' centres
    side = np.linalg.norm(np.maximum(off, 0), axis=1) + np.minimum(off.max(axis=1), 0) - 5
    hole = 3 - np.linalg.norm(points[:, :2] - (10, 10), axis=1)
    assert (shape.contains(points) == (np.maximum(side, hole) + lean <= 0)).all()
    wider = solid.polygon(L_SHAPE).extrude(1, taper=-10).mesh()
    assert wider.bounding_box[1, 0] == pytest.approx(4 + np.tan(np.radians(10)))


def test_what_is_cut_afterwards_is_meshed_by_inequalities():
    plate = solid.rounded_rectangle(4, 3, "1/2").extrude("1/2")
    cut = plate - solid.cylinder((2, "3/2", -1), (2, "3/2", 2), "3/4")
    mesh = cut.mesh(5e-3)
    assert mesh.is_closed and mesh.volume == pytest.approx((12 - (4 - np.pi) / 4 - np.pi * 9 / 16) / 2, rel=3e-3)


def test_parts_that_cross_are_one_set():
    cross = solid.rectangle(3, 1, (0, 1)) | solid.rectangle(1, 3, (1, 0), face="bar")
    assert cross.boundary is None
    assert cross.extrude(1).mesh().volume == pytest.approx(5)
    both = solid.rectangle(3, 1, (0, 1)) & solid.rectangle(1, 3, (1, 0), face="bar")
    assert both.extrude(1).mesh().volume == pytest.approx(1)
    less = solid.rectangle(3, 1, (0, 1)) - solid.rectangle(1, 3, (1, 0), face="bar")
    made = [p.operands(lambda part: part.extrude(1)).steps[-1].operation for p in (cross, both, less)]
    assert made == ["Add", "Intersect", "Subtract"]


CROSSING = {
    # the circle crosses the line of the top again where that goes on in an arc
    "circle and line": (
        lambda: (
            (solid.rectangle(6, 5, (-3, 3)) | solid.circle((1, 3), 3))
            - solid.circle((0, 1), 1)
            - solid.rounded_rectangle(6, 5, 1, corner=(-2, -4))
        ),
        2,
    ),
    "teeth and text": (
        lambda: (
            solid.polygon([(20, -4), (27, -2), (27, 2), (20, 4)]).circular_pattern(3)
            | solid.circle((0, 0), 21) - solid.text("12", 6, corner=(-4, 12))
        ),
        -2,
    ),
    "one circle twice": (lambda: solid.circle((0, 0), 2) | solid.circle((0, 0), 2) | solid.rectangle(3, 1), 2),
    "rings": (
        lambda: (
            (solid.circle((0, 0), 3) - solid.circle((0, 0), 2)) | (solid.circle((0, 0), 2) - solid.circle((0, 0), 1))
        ),
        0,
    ),
}
"""Profiles whose loops cross or overlap, and the Euler characteristic of what is extruded."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", CROSSING)
def test_profiles_that_cross_are_meshed_from_their_parts(name):
    make, euler = CROSSING[name]
    profile = make()
    assert profile.boundary is None
    body = profile.extrude(2)
    mesh = body.mesh(1e-2)
    low, high = mesh.points.min(axis=0)[:2], mesh.points.max(axis=0)[:2]
    u, v = np.meshgrid(*((np.arange(700) + 0.5) / 700,) * 2)
    points = low + np.stack([u, v], axis=-1) * (high - low)
    assert mesh.is_closed and mesh.euler_characteristic == euler
    assert mesh.volume == pytest.approx(2 * profile.contains(points).mean() * np.prod(high - low), rel=4e-3)


def test_turned_profiles_that_cross_are_meshed_from_their_parts():
    ring = (solid.rectangle(10, 4, (2, 0)) - solid.circle((6, 4), 3)).revolve()
    mesh = ring.mesh(3e-2)
    assert mesh.is_closed and mesh.euler_characteristic == 0
    assert mesh.volume == pytest.approx(np.pi * (144 - 4) * 4 - np.pi * 9 / 2 * 12 * np.pi, rel=2e-3)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("letter", ["o", "R", "g", "8", "i", "%"])
def test_letters_are_exact(letter):
    profile = solid.text(letter, 10)
    body = profile.extrude(2)
    mesh = body.mesh(1e-2)
    assert mesh.is_closed and mesh.volume == pytest.approx(2 * area(profile, 1e-6), rel=5e-3)
    found = body.face_mesh(1e-2).mesh
    off = [distances(body.field, found.points[corners], found.labels) for corners in found.triangles.T]
    assert np.max(off) < 1e-12  # each triangle is on the function of its face, which shares its name with others
    corners = np.concatenate(profile.polygons(0.1))
    points = RNG(0).uniform(corners.min(axis=0), corners.max(axis=0), (2000, 2))
    assert (profile.contains(points) == inside(profile, points)).mean() > 0.999


@pytest.mark.slow
@pytest.mark.parametrize("font", ["DejaVu Sans", "DejaVu Serif", "cmr10"])
def test_alphabets(font):
    for letter in string.ascii_letters + string.digits:
        assert solid.text(letter, 10, font=font).extrude(2).mesh().is_closed


def test_words_go_to_the_right():
    word, letter = solid.text("pas pas", 10), solid.text("pas", 10)
    assert area(word, 1e-3) == pytest.approx(2 * area(letter, 1e-3))
    assert word.extrude(1).mesh().is_closed


REFUSED = {
    "crossing": (lambda: solid.polygon([(0, 0), (2, 2), (2, 0), (0, 2)]), "crosses or touches itself near (1, 1)"),
    "crossing arcs": (
        lambda: (
            solid.sketch((0, 0))
            .line_to(2, 0)
            .arc_to(2, 4, radius="5/2", clockwise=True)
            .line_to(0, 4)
            .line_to("3/2", 2)
            .close()
        ),
        "crosses or touches itself near",
    ),
    "touching": (
        lambda: solid.polygon([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)]),
        "crosses or touches itself near (1, 0)",
    ),
    "cusp": (
        lambda: solid.sketch((0, 0)).line_to(2, 0).arc_to(1, 1, radius=1, clockwise=True).close(),
        "turns back on itself at (2, 0): edges 'side 1' and 'side 2' leave it in one direction; let "
        "them meet at an angle",
    ),
    "cusp of arcs": (
        lambda: solid.sketch().arc_to(0, 4, radius=2).line_to(0, 2).arc_to(0, 0, radius=1, clockwise=True).close(),
        "crosses or touches itself near (0.0",
    ),
    "cusp from both sides": (
        lambda: (
            solid.sketch().arc_to(2, 2, radius=2).line_to(-3, 2).line_to(-3, -2).line_to(2, -2).arc_to(0, 0, radius=2)
        ).close(),
        "turns back on itself at (0, 0)",
    ),
    "turning back": (lambda: solid.polygon([(0, 0), (2, 0), (1, 0), (1, 1)]), "turns back on itself at (2, 0)"),
    "in line": (lambda: solid.polygon([(0, 0), (1, 0), (2, 0)]), "nothing inside"),
    "two corners": (lambda: solid.polygon([(0, 0), (1, 0)]), "at least three corners, not 2"),
    "twice": (lambda: solid.polygon([(0, 0), (1, 0), (1, 0), (0, 1)]), "corners 2 and 3 of the polygon are one point"),
    "no length": (lambda: solid.sketch().line_to(0, 0), "has no length"),
    "small radius": (lambda: solid.sketch().arc_to(2, 0, radius="1/2"), "radius must be at least 1, half the distance"),
    "straight arc": (lambda: solid.sketch().line_to(1, 0).arc_to(2, 0), "would be straight"),
    "first arc": (lambda: solid.sketch().arc_to(2, 0), "without a radius"),
    "three in line": (lambda: solid.sketch().arc_to(2, 0, through=(1, 0)), "are in line"),
    "wide radius": (lambda: solid.rounded_rectangle(4, 3, 2), "radius must be at most 3/2"),
    "no height": (lambda: solid.rectangle(1, 1).extrude(0), "height must be positive, not 0"),
    "steep": (lambda: solid.rectangle(1, 1).extrude(1, taper=90), "taper must be between"),
    "used up": (
        lambda: solid.rounded_rectangle(4, 3, "1/2").extrude(5, taper=10),
        "its radius, 1/2, is used up at height 2.8",
    ),
    "no top": (lambda: solid.rectangle(4, 1).extrude(5, taper=10), "does not reach the top"),
    "arc with a corner": (lambda: moon().extrude(1, taper=2), "meet with an angle"),
    "parabola": (lambda: vase().extrude(1, taper=2), "no arc of a circle"),
    "beyond the axis": (lambda: solid.circle((0, 0), 1).revolve(), "passes the axis"),
    "no turn": (lambda: solid.rectangle(1, 1).revolve(0), "degrees must be above 0"),
    "blank": (lambda: solid.text("  ", 10), "is blank"),
    "no letter": (lambda: solid.text("a\u4e2d", 10), "has no letter '\u4e2d', which is number 2 of the text"),
    "two dimensions": (lambda: solid.circle((0, 0, 0), 1), "center must be two numbers, not 3"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    make, sentence = REFUSED[name]
    with pytest.raises((GeometryError, ValueError)) as caught:
        make()
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


def test_fonts_and_types_that_are_none():
    with pytest.raises(FileNotFoundError, match="no font 'DejaVu Sanz' is installed; is 'DejaVu Sans' meant"):
        solid.text("a", 1, font="DejaVu Sanz")
    with pytest.raises(FileNotFoundError, match=r"no font file none\.ttf"):
        solid.text("a", 1, font="none.ttf")
    with pytest.raises(AttributeError, match="no 'write'; it is flat: extrude or revolve it first"):
        solid.circle((0, 0), 1).write("disc.stl")
    with pytest.raises(TypeError, match="take two profiles"):
        _ = solid.circle((0, 0), 1) | solid.ball((0, 0, 0), 1)


@pytest.mark.parametrize("offset", [10**3, 10**6])
def test_far_from_the_origin(offset):
    profile = solid.rounded_rectangle(4, 3, "1/2") - solid.circle((1, 1), "1/4")
    shape = profile.translate(offset, -offset).extrude(1)
    mesh = shape.sheets.mesh(1e-2, Quality.BALANCED)
    assert mesh is not None and mesh.is_closed
    assert mesh.translate(-offset, offset, 0).volume == pytest.approx(12 - (4 - np.pi) / 4 - np.pi / 16, rel=1e-2)


def test_roots_are_near_at_any_size():
    for value in (fmpq(2), fmpq(2, 10**40), fmpq(10**41), fmpq(3, 7)):
        root = square_root(value)
        assert 0 <= 1 - root * root / value < fmpq(1, 2**58)
    assert square_root(fmpq(9, 4)) == fmpq(3, 2)


def test_what_dips_below_the_axis_is_refused():
    dip = solid.sketch(("1/10", 0)).line_to(2, 0).line_to(2, 2).line_to("1/10", 2)
    assert dip.arc_to("1/10", 0, through=("1/1000", 1)).close().revolve().mesh(1e-2).is_closed
    with pytest.raises(GeometryError, match="passes the axis"):
        dip.arc_to("1/10", 0, through=("-1/1000000", 1)).close().revolve()


def test_volume_and_area_of_what_is_swept():
    """They are measured on its mesh, in a box that this shows."""
    shape = solid.rounded_rectangle(4, 3, "1/2").extrude(2).rotate((1, 1, 0), 30).scale(2)
    assert shape.volume() == pytest.approx(16 * (12 - (4 - np.pi) / 4), rel=1e-4)
    assert shape.area() == pytest.approx(4 * (2 * (12 - (4 - np.pi) / 4) + 2 * (10 + np.pi)), rel=1e-4)
    assert solid.circle((3, 0), 1).revolve().volume() == pytest.approx(6 * np.pi**2, rel=1e-3)


@pytest.mark.parametrize("depth", [1, 3])
def test_notches_between_sides_in_one_line_are_cut(depth):
    """Both sides are one plane, which the arc crosses in two lines: its chord's wall says where one of them is."""
    top = solid.sketch().line_to(10, 0).line_to(10, 4).line_to(7, 4)
    body = top.arc_to(3, 4, through=(5, 4 - depth)).line_to(0, 4).close().extrude(3)
    cut = body - solid.cylinder((1, 1, -1), (1, 1, 4), "1/2")
    assert cut.mesh(0.02).is_closed
    assert cut.volume(0.02) == pytest.approx(body.volume(0.02) - 0.75 * np.pi, rel=2e-4)
