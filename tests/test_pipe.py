"""Pipes along lines and bends: the points that balls along the path cover, of proved pieces."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import cKDTree

import pas
from pas import solid

CASES = {
    "straight": (([(0, 0, 0), (0, 3, 4)], 1), {}),
    "widening": (([(0, 0, 0), (0, 0, 10)], [1, 2]), {}),
    "elbow": (([(0, 0, 0), (0, 0, 50), (30, 0, 50)], 5), {"bend": 12}),
    "hollow": (([(0, 0, 0), (10, 3, 50), (30, 7, 50), (60, -20, 10)], 5), {"bend": [12, 14], "wall": 1}),
    "cyclides": (([(0, 0, 0), (10, 3, 50), (30, 17, 60), (60, -20, 10)], [5, 4, 3, 6]), {"bend": [12, 9], "wall": 1}),
    "barrel": (([(0, 0, 0), (0, 0, 10), (0, 0, 20)], [1, 2, 1]), {"bend": 20}),
    "waist": (([(0, 0, 0), (0, 0, 10), (0, 0, 20)], [2, 1, 2]), {"bend": 20}),
    "bends side by side": (([(0, 0, 0), (0, 0, 10), (6, 0, 10), (6, 0, 0)], 1), {"bend": 3}),
    "sharp turn": (([(0, 0, 0), (10, 0, 0), (1, 3, 1)], "1/2"), {"bend": 1}),
}


def path_of(points, bends):
    """Points of a path of lines and arcs, worked out in doubles."""
    points = np.array(points, dtype=float)
    corners = [points[0]]
    for a, b, c, bend in zip(points, points[1:], points[2:], bends, strict=False):
        u, v = (b - a) / np.linalg.norm(b - a), (c - b) / np.linalg.norm(c - b)
        angle = np.arccos(u @ v)
        reach = bend * np.tan(angle / 2)
        center = b - reach * u + bend * (v - u * (u @ v)) / np.sin(angle)
        arm, t = b - reach * u - center, np.linspace(0, angle, 100)[:, None]
        corners += [*(center + np.cos(t) * arm + np.sin(t) * bend * u)]
    corners.append(points[-1])
    return np.concatenate([a + np.linspace(0, 1, 50)[:, None] * (b - a) for a, b in pairwise(corners)])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CASES)
def test_pipes_are_closed_and_their_joints_proved(name):
    (points, radius), options = CASES[name]
    made = solid.pipe(points, radius, **options)
    mesh = made.mesh()
    assert mesh.is_closed and mesh.components == 1 and mesh.volume > 0
    assert mesh.euler_characteristic == (0 if "wall" in options else 2)
    assert (
        all(verdict.proved for verdict in made.verdicts)
        and len(made.joints)
        == len([face for face in made.faces if "bend" in face]) * (3 if name == "bends side by side" else 4) // 2
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", ["elbow", "hollow", "bends side by side", "sharp turn"])
def test_points_of_pipes_are_those_that_balls_along_the_path_cover(name):
    (points, radius), options = CASES[name]
    made = solid.pipe(points, radius, **options)
    radius, wall = float(pas.Polynomial(radius).raw.leading_coefficient()), options.get("wall", 0)
    path = path_of(points, np.broadcast_to(options["bend"], len(points) - 2))
    space = np.random.default_rng(1).uniform(made.box[0], made.box[1], (4000, 3))
    away = cKDTree(path).query(space)[0]
    ends = np.array([points[0], points[-1]], dtype=float)
    others = np.array([points[1], points[-2]], dtype=float)
    beyond = (((space[:, None] - ends) * (others - ends)).sum(axis=2) < 0).any(axis=1) & (away < radius)
    clear = (np.abs(away - radius) > 0.02) & (np.abs(away - radius + wall) > 0.02) & ~beyond
    inside = (away < radius) & ((away > radius - wall) if wall else True)
    assert clear.sum() > 2000 and inside[clear].sum() > 50
    assert (made.contains(space)[clear] == inside[clear]).all()


def test_walls_are_even_and_radii_those_at_the_points():
    (points, radii), options = CASES["cyclides"]
    full, inside = (solid.pipe(points, [r - w for r in radii], options["bend"]) for w in (0, 1))
    hollow = solid.pipe(points, radii, **options)
    assert hollow.volume() == pytest.approx(full.volume() - inside.volume(), rel=1e-4)
    outer, inner = full.mesh(0.01), inside.mesh(0.05)
    bends = np.flatnonzero(["bend" in name for name in inner.names])
    some = inner.points[np.unique(inner.triangles[np.isin(inner.faces, bends)])]
    distance = cKDTree(outer.points).query(some)[0]
    assert distance.min() > 1 - 0.02 and np.median(distance) < 1.2


def test_a_pipe_of_one_radius_has_the_volume_of_its_path():
    made = solid.pipe([(0, 0, 0), (0, 0, 50), (30, 0, 50)], 5, bend=12, wall=1)
    assert made.volume() == pytest.approx(np.pi * (25 - 16) * (38 + 18 + 12 * np.pi / 2), rel=1e-5)
    assert made.polynomials["pipe bend 1"][0].degree == 4 and made.polynomials["pipe 2"][0].degree == 2
    assert made.faces[:3] == ("pipe 1", "pipe bend 1", "pipe 2")


def test_pipes_that_cross_themselves_are_unions():
    points = [(0, 0, 0), (0, 0, 10), (8, 0, 10), (8, 0, 5), (-5, 0, 5)]
    made = solid.pipe(points, 1, bend=2)
    assert made.sheets is None and made.proved
    mesh = made.mesh(0.05)
    assert mesh.is_closed and mesh.components == 1 and mesh.euler_characteristic == 0


@pytest.mark.slow
def test_a_handle_stands_on_a_plate_and_has_fillets():
    bar = solid.pipe([(0, 0, 0), (0, 0, 30), (80, 0, 30), (80, 0, 0)], 5, bend=12, face="handle")
    part = solid.box((-15, -12, -6), (95, 12, 0), face="plate") | bar
    part = part.fillet("plate z+", "handle 1", radius=3).fillet("plate z+", "handle 3", radius=3)
    assert part.proved and part.mesh(0.2).euler_characteristic == 0


def test_numbers_stay_short_along_a_path():
    random = np.random.default_rng(3)
    steps = np.cumsum(random.uniform(5, 9, (20, 3)) * random.choice([1, 1, 2], (20, 3)), axis=0)
    made = solid.pipe(np.round(steps, 3).tolist(), 1, bend=1.5)
    digits = max(len(n) for fs in made.polynomials.values() for f in fs for n in re.findall(r"\d+", str(f)))
    assert digits < 400
    assert np.abs(made.mesh().box - [steps.min(axis=0), steps.max(axis=0)]).max() < 1.01


WRONG = {
    "one point": (lambda: solid.pipe([(0, 0, 0)], 1), ValueError, "two points at least"),
    "a word": (lambda: solid.pipe("abc", 1), ValueError, "two points at least"),
    "no bend": (lambda: solid.pipe([(0, 0, 0), (1, 0, 0), (1, 1, 0)], "1/9"), ValueError, "bend is missing"),
    "three radii": (lambda: solid.pipe([(0, 0, 0), (1, 0, 0)], [1, 1, 1]), ValueError, "one for each point: 2, not 3"),
    "two bends": (
        lambda: solid.pipe([(0, 0, 0), (1, 0, 0), (1, 1, 0)], "1/9", bend=[1, 1]),
        ValueError,
        "one for each point but the first and last: 1, not 2",
    ),
    "a negative radius": (lambda: solid.pipe([(0, 0, 0), (1, 0, 0)], [1, -1]), ValueError, r"radius\[1\] must be pos"),
    "a thick wall": (lambda: solid.pipe([(0, 0, 0), (9, 0, 0)], [2, 1], wall=1), ValueError, "below the radius, 1"),
    "tight": (
        lambda: solid.pipe([(0, 0, 0), (10, 0, 0), (10, 10, 0)], 2, bend=2),
        pas.GeometryError,
        r"crosses itself in its bend at points\[1\]: take a larger bend or a smaller radius",
    ),
    "tight inside": (
        lambda: solid.pipe([(0, 0, 0), (10, 0, 0), (10, 10, 0)], 2, bend=1, wall=1),
        pas.GeometryError,
        "pipe crosses itself in its bend",
    ),
    "short": (
        lambda: solid.pipe([(0, 0, 0), (10, 0, 0), (10, 3, 0), (0, 3, 0)], 1, bend=2),
        pas.GeometryError,
        r"from points\[1\] to points\[2\] is shorter by 1 than its bends need",
    ),
    "short at the end": (
        lambda: solid.pipe([(0, 0, 0), (10, 0, 0), (10, 1, 0)], 1, bend=2),
        pas.GeometryError,
        r"from points\[1\] to points\[2\] is shorter by 1 than its bends need",
    ),
    "back": (
        lambda: solid.pipe([(0, 0, 0), (10, 0, 0), (5, 0, 0)], 1, bend=2),
        pas.GeometryError,
        r"turns back at points\[1\]",
    ),
    "one place": (
        lambda: solid.pipe([(0, 0, 0), (0, 0, 0)], 1),
        pas.GeometryError,
        r"points\[0\] and points\[1\] are one point",
    ),
    "swallowed": (
        lambda: solid.pipe([(0, 0, 0), (1, 0, 0)], [1, 3]),
        pas.GeometryError,
        r"changes by 2 from points\[0\] to points\[1\], which must be less than their distance, 1",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_pipe_is_told(name):
    make, error, words = WRONG[name]
    with pytest.raises(error, match=words):
        make()


@pytest.mark.sampled(5)
@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -3), (1, 0, 0), (1, 2, 3), (0.48, -0.6, 0.64)])
def test_flanges_are_plates_with_a_bore_and_holes(axis):
    made = solid.flange((1, 2, 3), axis, 10, 25, 5, bolts=6, bolt_radius=2)
    way = np.array(axis) / np.linalg.norm(axis)
    side = np.cross(way, (0.3, 0.2, 0.9)) / np.linalg.norm(np.cross(way, (0.3, 0.2, 0.9)))
    inside = made.contains([np.array((1, 2, 3)) + z * way + 11 * side for z in (-0.01, 0.01, 4.99, 5.01)])
    assert inside.tolist() == [False, True, True, False]
    mesh = made.mesh(0.01)
    assert mesh.is_closed and mesh.euler_characteristic == 2 - 2 * 7
    assert made.volume() == pytest.approx((25**2 - 10**2 - 6 * 2**2) * np.pi * 5, rel=1e-5)
    holes = {f"flange hole{number}" for number in ("", " #2", " #3", " #4", " #5", " #6")}
    assert {*mesh.names} == {"flange", "flange start", "flange end", "flange bore", *holes} == {*made.faces}
    assert solid.flange((0, 0, 0), axis, 0, 2, 1).faces == ("flange", "flange start", "flange end")


def test_bores_of_flanges_are_those_of_pipes():
    """In a direction whose length is irrational, too."""
    axis = (1, 1, 1)
    bore = solid.cylinder((-1, -1, -1), (31, 31, 31), 4, "bore")
    pipe = solid.cylinder((0, 0, 0), (30, 30, 30), 5, "pipe") - bore
    whole = pipe | solid.flange((0, 0, 0), axis, 4, 12, 3, bolts=6, bolt_radius=1)
    mesh = whole.mesh()
    assert mesh.is_closed and mesh.euler_characteristic == -12 and "bore + flange bore" in mesh.names


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"axis": (0, 0, 0)}, "axis must not be the zero vector"),
        ({"radius": 26}, "radius must be 0 or more and below outer_radius, 25, not 26"),
        ({"thickness": 0}, "thickness must be positive, not 0"),
        ({"bolts": 3}, "bolt_radius is missing: holes take their number and radius"),
        ({"bolt_radius": 1}, "bolts is missing"),
        ({"bolts": 3, "bolt_radius": "15/2"}, "bolt_radius must be below 7.5, so that holes meet neither bore"),
        ({"bolts": 60, "bolt_radius": 1}, "bolt_radius must be below 0.915879"),
        ({"bolts": 3, "bolt_radius": 1, "bolt_circle": 25}, "bolt_circle must be between 10 and 25, not 25"),
        ({"bolts": -1}, "bolts must be a whole number from 0 to 1000, not -1"),
    ],
)
def test_flanges_that_cannot_be_are_refused_in_a_sentence(given, words):
    usual = {"center": (0, 0, 0), "axis": (0, 0, 1), "radius": 10, "outer_radius": 25, "thickness": 5}
    with pytest.raises(ValueError, match=words):
        solid.flange(**{**usual, **given})


@pytest.mark.sampled(9)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("start", "end", "length"),
    [((3, 3), (5, 2), 8), ((2, 2), (4, 4), 5), ((3, 2), (3, 2), 5), ((1, 1), (10, "1/2"), 1), ((5, 2), (1, 2), 3)],
)
def test_transitions_are_proved_and_have_the_volume_of_their_sections(start, end, length, order):
    made = solid.transition(start, end, length, order, straight=1)
    assert made.proved and [v.claim[-len(f"GC^{order}") :] for v in made.verdicts] == [f"GC^{order}"] * 2
    z = (np.arange(20000) + 0.5) / 20000
    share = z * z * (3 - 2 * z) if order == 1 else z**3 * (6 * z * z - 15 * z + 10)
    axes = np.array([[float(Fraction(value)) for value in ellipse] for ellipse in (start, end)])
    squares = axes[0] ** 2 + share[:, None] * (axes[1] ** 2 - axes[0] ** 2)
    volume = np.pi * (np.sqrt(squares.prod(axis=1)).mean() * length + axes.prod(axis=1).sum())
    assert made.mesh().euler_characteristic == 2 and made.volume() == pytest.approx(volume, rel=1e-4)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"start": 3}, "start must be two half axes"),
        ({"end": (0, 1)}, r"end\[0\] must be positive, not 0"),
        ({"length": 0}, "length must be positive"),
        ({"order": 3}, "order must be a whole number from 1 to 2"),
        ({"straight": -1}, "straight must be positive"),
    ],
)
def test_transitions_that_cannot_be_are_refused_in_a_sentence(given, words):
    with pytest.raises(ValueError, match=words):
        solid.transition(**{"start": (1, 1), "end": (2, 1), "length": 1, **given})
