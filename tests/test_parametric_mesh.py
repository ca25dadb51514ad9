"""Meshes of parametric surfaces: within their bounds, closed at seams and poles, with the surface's normals."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import pas
from pas.bernstein.simplices import halved
from pas.mesh.mesh import Mesh
from pas.parametric.meshing import bounded
from pas.parametric.nets import Framed, exact_net, exact_rectangle

SPHERE = "x^2 + y^2 + z^2 - 1"
TORUS = "(x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2)"
SQUARE = ((0, 1), (0, 1))
CLOSED = {
    "sphere": (pas.ellipsoid(angle=True), None, 2, 0),
    "torus": (pas.torus(2, 1, angle=True), None, 0, 0),
    "cylinder": (pas.elliptic_cylinder(angle=True), (None, (0, 1)), 0, 2),
    "cone": (pas.elliptic_cone(angle=True), (None, (0, 1)), 1, 1),
    "half a sphere": (pas.ellipsoid(), ((-1, 1), None), 1, 1),
    "paraboloid": (pas.elliptic_paraboloid(), ((-1, 1), (0, 2)), 1, 1),
    "square": (pas.plane(), SQUARE, 1, 1),
}
"""Surface, domain, Euler characteristic and number of boundary curves."""

SECTIONS = {"quadric": "x^2 + y^2 - 1", "plane": "z - 3"}, {"quadric": "x^2 + z^2 - 1", "plane": "y - 3"}


def boundary_curves(mesh: Mesh) -> int:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges, times = mesh.edges
    rim = edges[times == 1]
    names, places = np.unique(rim, return_inverse=True)
    if not len(names):
        return 0
    a, b = places.reshape(-1, 2).T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(len(names), len(names)))
    return int(connected_components(graph, directed=False)[0])


@pytest.mark.parametrize("name", CLOSED)
def test_seams_and_poles(name):
    surface, domain, characteristic, curves = CLOSED[name]
    mesh = surface.mesh(0.01, domain)
    assert mesh.is_manifold
    assert (mesh.euler_characteristic, boundary_curves(mesh)) == (characteristic, curves)
    assert mesh.certified is surface.is_exact
    assert mesh.deviation <= 0.01
    p = mesh.points[mesh.triangles]
    facets = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert (np.linalg.norm(facets, axis=1) > 1e-7).all()
    assert ((facets[:, None] * mesh.point_normals[mesh.triangles]).sum(axis=-1) > 0).all()
    assert np.allclose(np.linalg.norm(mesh.point_normals, axis=1), 1)
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.points)))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("tolerance", [0.1, 0.001, 0.01])
@pytest.mark.parametrize(("name", "equation"), [("sphere", SPHERE), ("torus", TORUS)])
def test_deviation_and_normals(name, equation, tolerance):
    surface = CLOSED[name][0]
    mesh, f = surface.mesh(tolerance), pas.Polynomial(equation)
    inside = mesh.points[mesh.triangles].mean(axis=1)
    assert (np.abs(f(inside)) / np.linalg.norm(f.gradient(inside), axis=1)).max() < tolerance
    assert np.abs(f(mesh.points)).max() < 1e-12
    gradient = f.gradient(mesh.points)
    cosines = (gradient * mesh.point_normals).sum(axis=1) / np.linalg.norm(gradient, axis=1)
    assert np.abs(np.abs(cosines) - 1).max() < 1e-9
    assert np.ptp(np.sign(cosines)) == 0


def test_twice_as_fine_is_four_times_as_near():
    counts = [len(pas.torus(2, 1, angle=True).mesh(t).triangles) for t in (4e-2, 1e-2, 2.5e-3)]
    assert all(3 < b / a < 6 for a, b in pairwise(counts))


def test_flat_and_bent_parts_get_what_they_need():
    assert len(pas.plane().mesh(1e-6, SQUARE).triangles) == 2
    strips = pas.elliptic_cylinder().mesh(1e-3, ((-1, 1), (0, 100)))
    assert len(strips.points) == 2 * (len(strips.triangles) // 2 + 1)
    assert set(strips.parameters[:, 1]) == {0.0, 100.0}


@settings(max_examples=30, deadline=None)
@given(st.lists(st.fractions(-2, 2, max_denominator=7), min_size=12, max_size=12), st.integers(0, 2))
def test_bounds_hold(numbers, kind):
    """At equal parameters triangles are no further from the surface than the certified bound."""
    a, b, c, d = (
        " + ".join(f"({n})*{m}" for n, m in zip(numbers[i::4], ("t^2", "h*t", "h^2"), strict=True)) for i in range(4)
    )
    below = ("1", "(1 + t^2 + h^2)", f"(4 + ({d})^2)")[kind]
    surface = pas.ParametricSurface(f"t + ({a})/{below}", f"h + ({b})/{below}", f"({c})/{below}", domain=SQUARE)
    places = surface.on_grid(*np.linspace(0, 1, 33)[None].repeat(2, 0)).reshape(-1, 3)
    assume(len(np.unique(places.round(9), axis=0)) == len(places))  # else vertices are one, with parameters of one
    mesh = surface.mesh(0.05)
    assert mesh.certified
    shares = np.random.default_rng(0).dirichlet((1, 1, 1), 20)
    triangles = mesh.triangles
    flat = np.einsum("sk,tkx->tsx", shares, mesh.points[triangles])
    true = surface(np.einsum("sk,tkx->tsx", shares, mesh.parameters[triangles]))
    assert np.linalg.norm(flat - true, axis=-1).max() <= mesh.deviation <= 0.05


@pytest.mark.parametrize("far", [0, 10**3, 10**6, 10**10])
def test_far_out_meshes_are_those_near_the_origin(far):
    """What is far out is meshed as finely as doubles there allow, and its vertices are where the bound says."""
    surface = pas.ParametricSurface(f"{far} + t/(1 + h^2/3)", f"{far}/7 + h", "t*(1 - h)", domain=SQUARE)
    mesh = surface.mesh(1e-3)
    assert mesh.certified and len(mesh.triangles) == 1162 and mesh.deviation <= 1e-3
    for point, place in zip(mesh.points[::50].tolist(), mesh.parameters[::50].tolist(), strict=True):
        true = surface.at(*map(Fraction, place))
        assert sum((Fraction(x) - y) ** 2 for x, y in zip(point, true, strict=True)) <= Fraction(mesh.deviation) ** 2
    framed, points = Framed.of(surface), np.random.default_rng(1).uniform(-1, 1, (50, 3))
    moved, off = framed.points_outside(points)
    for before, after in zip(points.tolist(), moved.tolist(), strict=True):
        exact = [
            Fraction(c) + Fraction(x) * 2**framed.exponent for c, x in zip(framed.center.tolist(), before, strict=True)
        ]
        away = sum((Fraction(x) - y) ** 2 for x, y in zip(after, exact, strict=True))
        assert away <= (Fraction(off) * 2**framed.exponent) ** 2
    assert off <= 1e-15 * far


@pytest.mark.parametrize(
    ("x", "last", "most"), [("t/(1 + t^2)", 10**4, 100), ("t/(1 + t^8)", 30, 300)], ids=["a circle", "a leaf"]
)
def test_weights_that_differ_by_millions_need_no_more_triangles(x, last, most):
    """What rounding may do to a cell is measured by the weights of that cell."""
    below = x.split("/")[1]
    mesh = pas.ParametricSurface(x, "h", f"t^2/{below}", domain=((0, last), (0, 1))).mesh(1e-2)
    assert mesh.certified and len(mesh.triangles) <= most


def test_places_that_coincide_are_one_vertex():
    """A strip turns back on itself: at t = 1/2 and t = 3/4 it is the same line, and nothing is left between them."""
    surface = pas.ParametricSurface("t - 4/5*t^2", "h", "0", domain=SQUARE)
    mesh = surface.mesh(0.05)
    assert set(mesh.points[:, 0].round(9)) == {0.0, 0.2, 0.3} and mesh.certified
    true = surface.on_grid(np.linspace(0, 1, 65), np.array([0.0]))[:, 0, 0]
    assert true.max() == pytest.approx(0.3125, abs=1e-4)
    assert true.max() - mesh.points[:, 0].max() <= mesh.deviation <= 0.05


def test_bounds_are_not_far_off():
    """The bound of a cell is at most a small multiple of what is measured."""
    surface = pas.torus(2, 1).with_domain(((0, "1/8"), (0, "1/8")))
    net = exact_net(surface, exact_rectangle(surface)).rounded()
    bound, _ = bounded(net).bounds_and_axes
    grid = surface.on_grid(*np.linspace(0, 1 / 8, 33)[None].repeat(2, 0))
    share = np.linspace(0, 1, 33)
    hats = np.stack([1 - share, share])
    bilinear = np.einsum("ia,jb,ijx->abx", hats, hats, grid[::32, ::32])
    assert (
        np.linalg.norm(grid - bilinear, axis=-1).max() <= bound[0] < 5 * np.linalg.norm(grid - bilinear, axis=-1).max()
    )


def test_nets_are_the_surface():
    surface = pas.torus(2, 1).with_domain(((-1, 2), ("1/4", 1)))
    net = exact_net(surface, exact_rectangle(surface))
    m, n = (size - 1 for size in net.weights.shape)
    u, v = Fraction(2, 7), Fraction(3, 5)

    def value(table):
        return sum(
            Fraction(str(table[i][j])) * math.comb(m, i) * math.comb(n, j)
            * u**i * (1 - u) ** (m - i) * v**j * (1 - v) ** (n - j)
            for i in range(m + 1) for j in range(n + 1)
        )  # fmt: skip

    point = tuple(value(net.table[..., axis]) / value(net.weights) for axis in range(3))
    assert point == surface.at(-1 + 3 * u, Fraction(1, 4) + Fraction(3, 4) * v)
    left, right = halved(net.rounded().table, 0)
    assert np.array_equal(left[:, -1], right[:, 0])


@pytest.mark.parametrize(
    ("surface", "domain", "error", "words"),
    [
        (pas.ellipsoid(), None, ValueError, r"domain of t is infinite .* domain=\(\(-1, 1\), None\)"),
        (pas.plane(), ((0, 1), None), ValueError, "domain of h is infinite"),
        (pas.plane(), ((0, None), (0, 1)), ValueError, r"domain of t is infinite \(0 to inf\)"),
        (pas.ellipsoid(), ((0, 1), (0, 2)), ValueError, "interval .* of h is not within"),
        (pas.ParametricSurface("1/(t - h)", "t", "h"), SQUARE, pas.GeometryError, "has a pole, .* near t = "),
        (pas.ParametricSurface("t*h/(t^2 + h^2)", "t", "h"), ((-1, 2), (-1, 2)), pas.GeometryError, "near t = .*e-"),
        (  # of size 1, but so far out that doubles are further apart than the tolerance
            pas.ParametricSurface("10^14 + t", "h", "(t^2 - h^2)/(1 + t^2 + h^2)"),
            SQUARE,
            pas.MeshError,
            "finer than doubles resolve",
        ),
        pytest.param(
            pas.ParametricSurface("1/sin(t)", "t", "h"), ((-1, 2), (0, 1)), pas.GeometryError, "has a pole",
            marks=pytest.mark.slow,
        ),
        (pas.ParametricSurface("1", "2", "0*t"), SQUARE, pas.GeometryError, "single point"),
    ],
)  # fmt: skip
def test_what_cannot_be_meshed(surface, domain, error, words):
    with pytest.raises(error, match=words):
        surface.mesh(0.01, domain)


@pytest.mark.parametrize("tolerance", [0, -1, math.inf, math.nan, "fine", True])
def test_tolerances_are_checked(tolerance):
    wrong = TypeError if isinstance(tolerance, bool) else ValueError
    with pytest.raises(wrong, match="tolerance must be a positive number"):
        pas.plane().mesh(tolerance, SQUARE)


def test_a_blend_is_meshed_within_the_default_tolerance():
    first = pas.ParametricSurface("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1")
    second = pas.ParametricSurface("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1")
    mesh = pas.hermite_blend(pas.BlendingData([first, second]), 1).mesh(domain=((-1, 1), None))
    assert mesh.certified
    assert mesh.deviation <= 4e-3
    low, high = (mesh.points[mesh.parameters[:, 1] == h] for h in (0, 1))
    assert np.allclose(np.linalg.norm(low[:, :2], axis=1), 1)
    assert np.allclose(np.linalg.norm(high[:, :2], axis=1), 2)


def test_a_double_cone_has_normals_at_its_apex():
    mesh = pas.elliptic_cone().mesh(0.01, ((-1, 1), (-1, 1)))
    assert np.allclose(np.linalg.norm(mesh.point_normals, axis=1), 1)
    assert (np.linalg.norm(mesh.points, axis=1) == 0).sum() == 1


def test_a_deadline_stops_it():
    with pytest.raises(pas.LimitError), pas.limit(seconds=0.2):
        pas.torus(2, 1, angle=True).mesh(1e-6)


TRADED = {
    "a cone over a parabola": pas.ParametricSurface(
        "(1 - t^2)/(1 + t^2)*(h + 1)", "2*t/(1 + t^2)*(h + 1)", "3*h", domain=((-1, 1), (0, 1))
    ),
    "paraboloid": pas.ParametricSurface("t", "h", "t^2 + h^2", domain=((-1, 1), (-1, 1))),
    "torus": pas.torus(2, 1, angle=True),
    "saddle": pas.ParametricSurface("t", "h", "t^3 - 3*t*h^2", domain=((-1, 1), (-1, 1))),
}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", TRADED)
def test_good_angles_or_few_triangles(name):
    surface = TRADED[name]
    angles, usual, count = (surface.mesh(2e-3, quality=q) for q in ("angles", "balanced", "count"))
    assert len(count.triangles) < 0.96 * len(usual.triangles)
    assert angles.smallest_angles.min() >= usual.smallest_angles.min()
    for mesh in (angles, count):
        assert mesh.is_manifold
        assert mesh.euler_characteristic == usual.euler_characteristic
        assert mesh.deviation <= 2e-3
        assert mesh.certified is surface.is_exact
    if name == "a cone over a parabola":  # cells along straight lines are long
        assert usual.smallest_angles.min() < 6
        assert angles.smallest_angles.min() > 30


def test_the_bound_holds_where_thirds_are_cut_first():
    surface = TRADED["paraboloid"]
    mesh = surface.mesh(1e-2, quality="count")
    assert mesh.proved
    shares = np.random.default_rng(0).dirichlet([1, 1, 1], 20)
    corners, parameters = mesh.points[mesh.triangles], mesh.parameters[mesh.triangles]
    at, there = (np.einsum("kc,tcx->tkx", shares, values) for values in (corners, parameters))
    assert np.linalg.norm(surface(there.reshape(-1, 2)) - at.reshape(-1, 3), axis=1).max() <= mesh.deviation
    assert np.abs(surface(mesh.parameters) - mesh.points).max() < 1e-12


def test_a_mesh_of_a_size_has_no_quality():
    ends = [pas.boundary_from(table) for table in SECTIONS]
    blend = pas.generatrix_blend(*ends)
    with pytest.raises(ValueError, match="of a mesh with a given size no quality can be chosen"):
        blend.mesh(size=(20, 20), quality="angles")
    assert blend.mesh(0.1, quality="count").deviation is not None
