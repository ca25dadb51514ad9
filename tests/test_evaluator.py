"""Values, derivatives and rays at many points: against exact arithmetic."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from functools import cache
from math import comb

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved
from flint import fmpq

import pas
from pas.algebra.evaluation import evaluate
from pas.algebra.monomials import count
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_floats
from pas.surface.crossings import exact_crossings
from pas.surface.rays import HIGHEST, LocalRays, interpolation

SPHERE = "x^2 + y^2 + z^2 - 1"
TORUS = "(x^2 + y^2 + z^2 + 15/16)^2 - 4*(x^2 + y^2)"  # radii 1 and 1/4


def box(text: str, half: int = 2) -> pas.PiecewiseSurface:
    return pas.PiecewiseSurface.from_polynomials(pas.SingleCell((-half,) * 3, (half,) * 3), (), 0, [text])


@cache
def node() -> pas.PiecewiseSurface:
    contacts = [((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")]
    return pas.node(contacts, order=1).surface


def far() -> pas.PiecewiseSurface:
    """A sphere of radius 1/3 a million away from the origin."""
    text = "(x - 1000000)^2 + (y + 7)^2 + (z - 1/3)^2 - 1/9"
    return pas.PiecewiseSurface.from_polynomials(pas.SingleCell((999999, -8, -1), (1000001, -6, 1)), (), 0, [text])


SURFACES = {
    "corner": lambda: solved(UNEQUAL, 2).surface,
    "node": node,
    "torus in a box": lambda: box(TORUS),
    "torus anywhere": lambda: Polynomial(TORUS),
    "far away": far,
}


def evaluator(name: str) -> pas.Evaluator:
    return pas.Evaluator(SURFACES[name]())


def sample(known: pas.Evaluator, number: int, seed: int = 0) -> np.ndarray:
    """Points in the region's box, or within 2 of the origin."""
    points = known.partition.points
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.full(3, -2.0), np.full(3, 2.0))
    return np.random.default_rng(seed).uniform(low, high, (number, 3))


def exact_value(polynomial: Polynomial, point: np.ndarray) -> float:
    return float(polynomial.at([Fraction(v) for v in point.tolist()]))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", SURFACES)
def test_values_and_derivatives_are_exact_to_rounding(name):
    known = evaluator(name)
    points = sample(known, 1000)
    found = (known.values(points), known.gradients(points), known.hessians(points), known.third_derivatives(points))
    pieces = known.partition.local.location.pieces(known.partition.frame.local_points(points).T, known.tolerance)
    assert np.array_equal(np.isnan(found[0]), pieces < 0) and (pieces >= 0).sum() > 200
    axes = ((), (0,), (0, 2), (1, 1), (2, 0, 1), (1, 1, 2))
    for piece, patch in enumerate(known.patches):
        world = known.partition.frame.globalise(patch)
        for along in axes:
            derivative = world
            for axis in along:
                derivative = derivative.diff(axis)
            size = max(map(abs, patch.coefficients().values())) / known.scale ** len(along)
            for row in np.flatnonzero(pieces == piece)[:50]:
                error = found[len(along)][(row, *along)] - exact_value(derivative, points[row])
                assert abs(error) < 2e-12 * (1 + 1e-3 * known.target.reach) * float(size), (along, points[row])


BITS = f"""
import hashlib, numpy as np, pas
surface = pas.PiecewiseSurface.from_polynomials(pas.SingleCell((-2,) * 3, (2,) * 3), (), 0, ["{TORUS}"])
points = np.random.default_rng(0).uniform(-2, 2, (4000, 3))
known = pas.Evaluator(surface)
print(hashlib.sha256(known.jets(points).tobytes() + known.third_derivatives(points).tobytes()).hexdigest())
"""


def test_values_are_the_same_bits_on_every_machine():
    found = set()
    for machine in ("Haswell", "Prescott"):
        environment = {**os.environ, "OPENBLAS_CORETYPE": machine}
        done = subprocess.run([sys.executable, "-c", BITS], env=environment, capture_output=True, text=True, check=True)
        found.add(done.stdout)
    assert len(found) == 1


def test_many_polynomials_are_those_of_few():
    rng = np.random.default_rng(1)
    table, points = rng.normal(size=(count(6), 9)), rng.uniform(-1, 1, (5, 7, 3))
    together, alone = evaluate(points, table), [evaluate(points, table[:, [i]])[..., 0] for i in range(9)]
    assert together.shape == (5, 7, 9)
    assert np.allclose(together, np.stack(alone, axis=-1), rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    "partition",
    [
        pas.SixTetrahedra(),
        pas.AlfeldSplit(),
        pas.WorseyFarinSplit(),
        pas.KuhnCube(),
        pas.SingleCell((0, 0, 0), (1, 2, 3)),
        pas.Partition([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)]),
    ],
    ids=lambda p: p.name,
)
def test_planes_find_the_pieces_that_barycentric_coordinates_do(partition):
    assert_located(partition)


def test_the_pieces_of_a_node_are_found():
    assert_located(node().partition)


def assert_located(partition: pas.Partition) -> None:
    local = partition.local
    low, high = local.points.min(axis=0), local.points.max(axis=0)
    points = np.random.default_rng(0).uniform(low - 0.1, high + 0.1, (20000, 3))
    depth = local.barycentric(points).min(axis=1)
    cells, deepest = depth.argmax(axis=0), np.sort(depth, axis=0)
    expected = np.where(deepest[-1] < 0, -1, local.piece_of[cells])
    clear = np.abs(deepest[-1]) > 1e-9
    if len(depth) > 1:
        clear &= np.abs(deepest[-2]) > 1e-9
    found = local.location.pieces(points.T, 1e-12)
    assert np.array_equal(found[clear], expected[clear])
    assert (expected[clear] >= 0).any() and (expected[clear] < 0).any()


def test_points_on_the_ray_of_many_planes_are_in_a_piece_that_has_it():
    """There rounding makes signs that no piece has; the first piece is on the other side."""
    top, bottom = (fmpq(1, 3), fmpq(1, 7), fmpq(1)), (fmpq(0), fmpq(0), fmpq(-1))
    ring = [(1, 0, 0), (fmpq(1, 3), 1, 0), (-1, fmpq(2, 3), 0), (fmpq(-2, 3), -1, 0), (fmpq(1, 2), -1, 0)]
    cells = [(0, end, 3 + i, 3 + (i + 1) % 5) for end in (1, 2) for i in range(5)]
    partition = pas.Partition([(0, 0, 0), bottom, top, *ring], cells, (0, 0, 0)).local
    ray = np.array(to_floats(partition.vertices[2]))
    points = np.linspace(0, 1, 501)[1:, None] * ray
    found = partition.location.pieces(np.ascontiguousarray(points.T), 1e-12)
    assert set(found.tolist()) <= set(range(5, 10))
    table = partition.location._planes[1]
    assert (table < 0).any()


def test_points_on_faces_and_the_centre_are_inside():
    surface = solved(UNEQUAL, 2).surface
    corners = surface.partition.points
    faces = np.array([corners[list(triangle)].mean(axis=0) for triangle, _, _ in surface.partition.inner_triangles])
    known = pas.Evaluator(surface)
    assert np.isfinite(known.values(np.concatenate([corners, faces, np.zeros((1, 3))]))).all()


def test_outside_is_as_asked_for():
    known = evaluator("corner")
    assert np.isnan(known.values([9, 9, 9])) and known.values([9, 9, 9], outside=-1.0) == -1
    assert np.isnan(known.hessians([[9, 9, 9]])).all()
    assert np.isinf(known.jets([[9, 9, 9]], outside=np.inf)).all()


def along(known: pas.Evaluator, origin: list[float], direction: list[float]) -> list[tuple[float, int]]:
    found = known.rays([origin], [direction])
    assert np.allclose(found.points, np.array(origin) + found.parameters[:, None] * np.array(direction))
    return list(zip(found.parameters.tolist(), found.sides.tolist(), strict=True))


@pytest.mark.parametrize("name", ["corner", "node", "torus in a box", "torus anywhere"])
def test_all_crossings_are_found_in_order(name):
    known = evaluator(name)
    ends = sample(known, 300, 1)
    origins, directions = 3 * sample(known, 300, 2)[::-1], np.empty((300, 3))
    directions[:] = ends - origins
    found = known.rays(origins, directions)
    assert found.number == 300 and found.counts.sum() == len(found.rays) > 100
    assert np.array_equal(found.first, known.first(origins, directions), equal_nan=True)
    for ray in range(0, 300, 3):
        expected = exact_crossings(known.target, origins[ray], directions[ray])
        assert np.allclose(found.along(ray), [t for t, _ in expected], rtol=1e-11, atol=1e-11)
        assert found.sides[found.rays == ray].tolist() == [side for _, side in expected]


@pytest.mark.parametrize("depth", [1e-3, 1e-7, 1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("surface", [SPHERE, box(SPHERE)], ids=["anywhere", "in a box"])
def test_rays_that_nearly_touch(surface, depth):
    known = pas.Evaluator(surface)
    half = float(1 - Fraction(1 - depth) ** 2) ** 0.5
    (first, into), (second, out) = along(known, [-1.5, 1 - depth, 0], [1, 0, 0])
    assert (into, out) == (-1, 1) and first < second
    assert abs(second - first - 2 * half) < 1e-15 + 1e-6 * half
    assert along(known, [-1.5, 1 + depth, 0], [1, 0, 0]) == []


@pytest.mark.parametrize("name", ["corner", "torus in a box"])
def test_rays_that_are_tangent_to_rounding(name):
    known, rng = evaluator(name), np.random.default_rng(3)
    inwards = sample(known, 60, 4)
    points = known.rays(3 * inwards, -inwards).points[:20]
    ways = np.cross(known.gradients(points), rng.normal(size=points.shape))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    origins = points - 4 * ways
    found = known.rays(origins, ways)
    assert len(points) == 20
    for ray in range(20):
        expected = exact_crossings(known.target, origins[ray], ways[ray])
        assert len(found.along(ray)) == len(expected)
        assert np.allclose(found.along(ray), [t for t, _ in expected], rtol=0, atol=1e-9)


def test_rays_that_touch_start_on_or_lie_in_the_surface():
    ball = pas.Evaluator(box(SPHERE))
    assert along(ball, [-1.5, 1, 0], [1, 0, 0]) == [(1.5, 0)]
    assert along(ball, [1, 0, 0], [-1, 0, 0]) == [(0, -1), (2, 1)]
    assert along(ball, [1, 0, 0], [1, 0, 0]) == [(0, 1)]
    assert along(ball, [1, 0, 0], [0, 1, 0]) == [(0, 1)]  # tangent, where it starts: outside from there on
    assert along(ball, [0, 0, 0], [0, 0, 2]) == [(0.5, 1)]
    cylinder = pas.Evaluator(box("x^2 + y^2 - 1"))
    assert along(cylinder, [1, 0, -9], [0, 0, 1]) == [(7, 0)]
    assert along(pas.Evaluator("x^2 + y^2 - 1"), [1, 0, -9], [0, 0, 1]) == [(0, 0)]
    assert along(pas.Evaluator("(x - 1)^2 * (x - 2)^3"), [0, 0, 0], [1, 0, 0]) == [(1, 0), (2, 1)]
    assert along(pas.Evaluator("7"), [0, 0, 0], [1, 0, 0]) == []


@pytest.mark.parametrize("name", ["corner", "torus anywhere"])
def test_scaling_directions_by_a_power_of_two_changes_no_crossing(name):
    known = evaluator(name)
    origins, ends = 3 * sample(known, 300, 1), sample(known, 300, 2)
    directions = ends - origins
    found, first = known.rays(origins, directions), known.first(origins, directions)
    assert len(found.rays) > 80
    for power in (-1000, -300, -60, -53, -1, 1, 53, 300, 1000):
        same = known.rays(origins, np.ldexp(directions, power))
        assert np.array_equal(same.rays, found.rays) and np.array_equal(same.sides, found.sides), power
        assert np.array_equal(same.points, found.points)
        assert np.array_equal(same.parameters, np.ldexp(found.parameters, -power))
        longer = known.first(origins, np.ldexp(directions, power))
        assert np.array_equal(longer, np.ldexp(first, -power), equal_nan=True)


@pytest.mark.parametrize("power", [-1074, -1022, -500, 500, 1023])
def test_parameters_beyond_doubles_are_infinite_or_zero(power):
    for surface in (SPHERE, box(SPHERE)):
        found = pas.Evaluator(surface).rays([[-1.5, 0, 0]], [[2.0**power, 0, 0]])
        assert found.sides.tolist() == [-1, 1]
        assert np.allclose(found.points, [[-1, 0, 0], [1, 0, 0]], rtol=0, atol=1e-15)
        with np.errstate(over="ignore"):
            expected = np.ldexp([0.5, 2.5], -power)
        assert np.array_equal(np.isinf(found.parameters), np.isinf(expected))
        assert found.parameters == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("power", [10, 20, 30, 40, 45, 46, 52, 60, 200, pytest.param(1000, marks=pytest.mark.slow)])
def test_rays_from_far_away(power):
    far = 2.0**power
    for surface in (SPHERE, box(SPHERE)):
        known = pas.Evaluator(surface)
        for height, expected in ((0.5, [-1, 1]), (1.0, [0]), (1 + 2.0**-52, []), (1.75, [])):
            assert known.rays([[-far, height, 0]], [[1, 0, 0]]).sides.tolist() == expected
            assert known.rays([[far, height, 0]], [[1, 0, 0]]).sides.tolist() == []
    inside = known.rays([[-far, -far, 0.5]], [[2, 2, 0]])
    assert inside.parameters == pytest.approx([far / 2, far / 2], rel=max(2 / far, 1e-15))
    assert known.rays([[-far, -far + max(8.0, far / 2**40), 0.5]], [[2, 2, 0]]).sides.tolist() == []


@pytest.mark.parametrize("far", [2.0**2, 2.0**12, 2.0**20, 2.0**27])
def test_rays_from_afar_that_meet_the_rim_or_touch_within_rounding(far):
    rng = np.random.default_rng(int(far))
    turns, ways = rng.uniform(0, 7, 60), rng.normal(size=(60, 3))
    ways[:, 2] = -np.abs(ways[:, 2])  # from above
    rim = np.stack([np.cos(turns), np.sin(turns), np.full(60, 2.0)], axis=1)
    touched = np.stack([np.cos(turns), np.sin(turns), rng.uniform(-1, 1, 60)], axis=1)
    flat = np.cross(touched * [1, 1, 0], ways)
    tube = pas.Evaluator(box("x^2 + y^2 - 1"))
    numbers = set()
    for ends, along_ray in ((rim, ways), (touched, flat)):
        origins = ends - far * along_ray
        found = tube.rays(origins, along_ray)
        for ray in range(60):
            expected = [side for _, side in exact_crossings(tube.target, origins[ray], along_ray[ray])]
            assert found.sides[found.rays == ray].tolist() == expected
            numbers.add(len(expected))
    assert {0, 1, 2} <= numbers


def test_the_region_is_closed_and_has_no_tolerance():
    tube, below, above = pas.Evaluator(box("x^2 + y^2 - 1")), 2 - 2.0**-52, 2 + 2.0**-51
    for height, expected in ((below, [-1, 1]), (2.0, [-1, 1]), (above, [])):
        assert [side for _, side in along(tube, [-1.5, 0, height], [1, 0, 0])] == expected
    assert along(pas.Evaluator(box("x - 2")), [0, 0, 0], [1, 0.5, 0.25]) == [(2, 1)]
    assert along(pas.Evaluator(box("x - 2 - 1/1000000000000000")), [0, 0, 0], [1, 0.5, 0.25]) == []
    edge = pas.Evaluator(box("x + y - 4"))  # which is 0 in an edge of the box
    assert along(edge, [3, 1, 0], [-1, 1, 0]) == [(1, 0)]
    assert along(edge, [3, 0.75, 0], [-1, 1, 0]) == []


@pytest.mark.parametrize("surface", [SPHERE, box(SPHERE)], ids=["anywhere", "in a box"])
def test_rays_from_points_beside_the_surface_cross_it_or_not_as_they_are(surface):
    known = pas.Evaluator(surface)
    assert along(known, [1 + 2.0**-52, 0, 0], [1, 0, 0]) == []
    assert along(known, [1 - 2.0**-53, 0, 0], [1, 0, 0]) == [(2.0**-53, 1)]
    assert along(known, [1 + 2.0**-52, 0, 0], [-1, 0, 0]) == [(2.0**-52, -1), (2 + 2.0**-52, 1)]


def test_rays_on_polynomials_whose_coefficients_lose_digits():
    known = pas.Evaluator(box(f"(3*x^2 + 2*y^2 - 1)/1{'0' * 320}"))
    edge = 3**-0.5
    for x, expected in ((edge * (1 - 1e-6), [-1, 1]), (edge * (1 + 1e-6), [])):
        assert known.rays([[x, -1.5, 0.125]], [[0, 1, 0]]).sides.tolist() == expected


@pytest.mark.parametrize("number", [1, 100])
def test_all_crossings_of_a_surface_of_many_sheets_are_found(number):
    """There are nine, where there is room for four a ray at first."""
    sheets = pas.Evaluator(box("*".join(f"(3*x - {k} - y/8)" for k in range(-4, 5))))
    heights = np.linspace(-1, 1, number)
    origins = np.stack([np.full(number, -2.5), heights, heights / 3 + 0.15], axis=1)
    found = sheets.rays(origins, [[1, 0, 0]])
    assert found.counts.tolist() == [9] * number
    assert found.parameters.reshape(number, 9) == pytest.approx(2.5 + (np.arange(-4, 5) + heights[:, None] / 8) / 3)
    assert (found.sides.reshape(number, 9) == [(-1) ** k for k in range(9)]).all()
    assert sheets.first(origins, [[1, 0, 0]]) == pytest.approx(found.first, rel=1e-12)
    local = LocalRays.of(sheets.target, origins, np.tile([1.0, 0, 0], (number, 1)))
    assert not sheets.target.in_doubles(local)[1].any()


@pytest.mark.parametrize("degree", [1, 6, 14, 15, 16, 22, HIGHEST, HIGHEST + 1])
@pytest.mark.parametrize("bounded", [False, True])
@pytest.mark.sampled(5)
def test_rays_of_high_degree_and_in_all_of_space(degree, bounded):
    """Products of planes, whose crossings are known; doubles decide them, but for those above the highest degree."""
    if bounded and degree > 16:
        pytest.skip("surfaces on partitions end at degree 16")
    sheets = " * ".join(f"(x - {k}/{degree + 1} - y/16 + z/32)" for k in range(degree))
    known = pas.Evaluator(box(sheets) if bounded else sheets)
    rng = np.random.default_rng(degree)
    origins = np.stack([np.full(9, -1.5), *rng.uniform(-1, 1, (2, 9))], axis=1)
    directions = np.stack([np.full(9, 2.0), *rng.uniform(-0.1, 0.1, (2, 9))], axis=1)
    found = known.rays(origins, directions)
    slant = np.array([1, -1 / 16, 1 / 32])
    places = (np.arange(degree) / (degree + 1) - (origins @ slant)[:, None]) / (directions @ slant)[:, None]
    assert found.counts.tolist() == [degree] * 9
    assert found.parameters.reshape(9, degree) == pytest.approx(places, rel=1e-12)
    assert (found.sides.reshape(9, degree)[:, ::-1] == [(-1) ** k for k in range(degree)]).all()
    assert known.first(origins, directions) == pytest.approx(found.first, rel=1e-12)
    decided = ~known.target.in_doubles(LocalRays.of(known.target, origins, directions))[1]
    assert decided.all() or degree > 6
    assert not decided.any() or degree <= HIGHEST


@pytest.mark.parametrize("gap", ["1/10^18", "1/10^20", "1/10^24"])
@pytest.mark.parametrize("factor", ["1", "(3 + x + y)", "(7 + y - z)"])
def test_a_function_that_rises_within_rounding_only_may_have_several_zeros(factor, gap):
    """In the middle of the way it goes down again, by less than the rounding of forms."""
    known = pas.Evaluator(f"((x - 1)^3 - {gap}*(x - 1))*{factor}")
    origins = np.column_stack([np.full(20, -1.0), np.random.default_rng(0).uniform(-1, 1, (20, 2))])
    found = known.rays(origins, [[1, 0, 0]])
    for ray in range(20):
        assert found.sides[found.rays == ray].tolist()[:3] == [1, -1, 1]


def test_crossings_far_away_are_right_to_rounding():
    """The Bernstein form on an endless stretch has the second one to two digits only."""
    known = pas.Evaluator("10*x^2*z + 69/100*z^3 - 100000000000000*x - 6800000")
    origin, way = np.array([-0.25, -2.25, 0.015625]), np.array([2.0**-12, -(2.0**-10), 2.0**-10])
    assert not known.target.in_doubles(LocalRays.of(known.target, origin[None], way[None]))[1].any()
    expected = exact_crossings(known.target, origin, way)
    assert len(expected) == 2 and expected[1][0] > 1e9
    assert np.array(along(known, origin, way)) == pytest.approx(np.array(expected), rel=1e-12)


@pytest.mark.parametrize("name", ["corner", "torus in a box", "torus anywhere"])
def test_doubles_and_exact_arithmetic_find_the_same_crossings(name):
    known, points = evaluator(name), sample(evaluator(name), 100)
    local = LocalRays.of(known.target, 3 * points, -points)
    (rays, lengths, sides), undecided = known.target.in_doubles(local)
    assert undecided.sum() <= 3
    for ray in np.flatnonzero(~undecided).tolist():
        expected = exact_crossings(known.target, 3 * points[ray], -points[ray], fmpq(2) ** -int(local.exponents[ray]))
        assert sides[rays == ray].tolist() == [side for _, side in expected]
        assert lengths[rays == ray] == pytest.approx([t for t, _ in expected], rel=1e-12)


def test_stretches_in_the_surface_count_once():
    tube = pas.Evaluator(box("x^2 + y^2 - 1"))
    assert along(tube, [1, 0, -9], [0, 0, 1]) == [(7, 0)]
    assert along(tube, [1, 0, 0], [0, 0, -0.5]) == [(0, 0)]


def test_a_face_that_cells_do_not_agree_on_is_the_first_ones():
    torn = pas.PiecewiseSurface.from_polynomials(pas.SixTetrahedra(), (), 0, [f"{SPHERE} + {i}/16" for i in range(6)])
    for direction in ([1, 1, 1], [1, 1, 0], [1, 0, 0]):
        assert [side for _, side in along(pas.Evaluator(torn), [0, 0, 0], direction)] in ([1], [])
    assert len(along(pas.Evaluator(torn), [0, 0, 0], [1, 1, 1])) == 1


@pytest.mark.sampled(4)
@pytest.mark.parametrize("degree", [*range(17), 24, HIGHEST])
def test_forms_are_interpolated_as_well_as_their_bounds_say(degree):
    nodes, to_bernstein, growth = interpolation(degree, False)
    places, weighted, same = interpolation(degree, True)
    assert growth == same and places == pytest.approx(nodes / (1 - nodes), rel=1e-15)
    assert weighted == pytest.approx(to_bernstein * (1 - nodes) ** degree, rel=1e-13)
    exact = [Fraction(s) for s in nodes.tolist()]
    basis = [[comb(degree, j) * (1 - s) ** (degree - j) * s**j for j in range(degree + 1)] for s in exact]
    norm = Fraction(growth) / 2
    for row, entries in enumerate(to_bernstein.tolist()):
        for column in range(degree + 1):
            error = sum(Fraction(e) * b[column] for e, b in zip(entries, basis, strict=True)) - (row == column)
            assert abs(error) <= norm / 2**53


def test_constants_outweigh_other_terms_where_they_are_said_to():
    known = pas.Evaluator(box("x^2 + y^2 + z^2 - 1/100"))
    reach = known.target.clear * known.scale
    assert (reach > 1e-3).all() and (reach < 0.1 / 3**0.5).all()
    assert (pas.Evaluator(box("x + y")).target.clear == 0).all()


def test_rays_in_the_faces_of_cells():
    surface = solved(EQUAL, 1).surface
    known = pas.Evaluator(surface)
    for direction in ([1, 1, 1], [1, 1, 0], [-1, 0, 0], [1, -1, 0], [0, 1, -1]):
        found = along(known, [0, 0, 0], direction)
        expected = exact_crossings(known.target, np.zeros(3), np.array(direction, dtype=float))
        assert [side for _, side in found] == [side for _, side in expected]
        assert np.allclose([t for t, _ in found], [t for t, _ in expected], rtol=1e-12)


def test_rays_broadcast():
    known = pas.Evaluator(SPHERE)
    first = known.first([[0, 0, 0], [0, 0, 3], [0, 0, -3]], [0, 0, 1])
    assert np.allclose(first, [1, np.nan, 2], equal_nan=True)
    assert known.first(np.zeros(3), np.eye(3)[None]).shape == (1, 3)
    with pytest.raises(ValueError, match="ray must be a number from 0 to 2, not 3"):
        known.rays(np.zeros(3), np.eye(3)).along(3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda e: e.values([[0, 0]]), r"points must have shape \(\.\.\., 3\), not \(1, 2\)"),
        (lambda e: e.values(3.0), r"points must have shape"),
        (lambda e: e.gradients(np.empty((0, 3))), r"points must hold at least one"),
        (lambda e: e.hessians([[0, 0, 0], [0, np.nan, 0]]), r"points\[1\] must be finite, not nan"),
        (lambda e: e.third_derivatives([0, 0, np.inf]), r"points must be finite, not inf"),
        (lambda e: e.jets("here"), r"points must be numbers of shape"),
        (lambda e: e.rays([[0, 0, 0]], [[0, 0, 0]]), r"directions\[0\] must not be of length zero"),
        (lambda e: e.rays([[0, 0, np.nan]], [[0, 0, 1]]), r"origins\[0\] must be finite"),
        (
            lambda e: e.rays(np.zeros((2, 3)), np.ones((4, 3))),
            r"must broadcast to one shape, not \(2, 3\) and \(4, 3\)",
        ),
        (lambda e: e.first(np.zeros((0, 3)), [1, 0, 0]), r"origins must hold at least one"),
    ],
)
def test_bad_input_is_refused_in_a_sentence(call, message):
    with pytest.raises(ValueError, match=message):
        call(pas.Evaluator(SPHERE))


def test_what_has_no_polynomials_is_refused():
    with pytest.raises(TypeError, match="surface must be a piecewise surface or a polynomial"):
        pas.Evaluator(object())
