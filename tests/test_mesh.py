"""Meshes of blends: on the surface, within the tolerance, manifold, with exact boundaries."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved

import pas
from pas.mesh.mesh import Mesh

CASES = [(EQUAL, 1), (EQUAL, 2), (EQUAL, 3), (UNEQUAL, 1), (UNEQUAL, 2), (UNEQUAL, 3)]


def distance(surface: pas.PiecewiseSurface, points: np.ndarray) -> np.ndarray:
    """Distances from the surface, by Newton's method along the gradient (points near it)."""
    x = points.copy()
    for _ in range(6):
        jets = surface.jets(x)
        g = jets[:, 1:]
        x = x - jets[:, :1] * g / (g * g).sum(axis=1, keepdims=True)
    return np.linalg.norm(x - points, axis=1)


@pytest.mark.parametrize(("radii", "order"), CASES)
@pytest.mark.sampled(3)
def test_mesh_of_a_blend(radii, order):
    surface = solved(radii, order).surface
    mesh = surface.mesh(2e-3)
    jets = surface.jets(mesh.points)
    assert not np.isnan(jets).any()
    assert (np.abs(jets[:, 0]) / np.linalg.norm(jets[:, 1:], axis=1)).max() < 1e-9
    assert mesh.is_manifold
    assert mesh.euler_characteristic == -1
    assert mesh.point_normals == pytest.approx(
        jets[:, 1:] / np.linalg.norm(jets[:, 1:], axis=1, keepdims=True), abs=1e-9
    )
    p = mesh.points[mesh.triangles]
    facets = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    assert (facets * mesh.point_normals[mesh.triangles[:, 0]]).sum(axis=1).min() > 0.7
    assert mesh.smallest_angles.min() > 12
    assert np.percentile(mesh.smallest_angles, 1) > 25


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("radii", "order"), [(EQUAL, 2), (UNEQUAL, 1)])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_deviation_is_below_the_tolerance(radii, order, tolerance):
    """Measured at other points than the mesher's own: a dense lattice of each triangle."""
    surface = solved(radii, order).surface
    mesh = surface.mesh(tolerance)
    weights = np.array([(i, j, 7 - i - j) for i in range(8) for j in range(8 - i)]) / 7
    points = np.einsum("wk,tkx->twx", weights, mesh.points[mesh.triangles]).reshape(-1, 3)
    inside = ~np.isnan(surface(points))
    assert inside.mean() > 0.999
    assert distance(surface, points[inside]).max() < 1.1 * tolerance


@pytest.mark.parametrize(("radii", "order"), CASES[:4])
def test_boundary_is_the_contact_circles(radii, order):
    surface = solved(radii, order).surface
    mesh = surface.mesh(2e-3)
    boundary = mesh.points[mesh.boundary]
    owner = np.full(len(boundary), -1)
    for number, (contact, radius) in enumerate(zip(surface.contacts, radii, strict=True)):
        on = np.abs(contact.clip(boundary)) < 1e-12
        owner[on] = number
        assert np.abs(contact.surface(boundary[on])).max() < 1e-12
        ring = np.delete(boundary[on], number, axis=1)
        angles = np.sort(np.arctan2(ring[:, 1], ring[:, 0]))
        gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
        r = float(pas.Polynomial(radius)([0, 0, 0]))
        assert r * (1 - np.cos(gaps.max() / 2)) < 2e-3
        assert len(ring) > 12
    assert (owner >= 0).all()


def test_finer_tolerances_need_triangles_in_proportion():
    surface = solved(EQUAL, 1).surface
    counts = [len(surface.mesh(t).triangles) for t in (4e-3, 1e-3, 2.5e-4)]
    ratios = np.array(counts[1:]) / counts[:-1]
    assert (ratios > 2).all()
    assert (ratios < 6).all()


@pytest.mark.parametrize("center", [(1000, -500, 20), (10**6, -(10**6), "1/3")])
def test_meshes_move_with_the_model(center):
    items = [pas.Pipe(a, r, 1, point=center) for a, r in zip(((1, 0, 0), (0, 1, 0), (0, 0, 1)), EQUAL, strict=True)]
    surface = pas.blend(items, 1, energy=pas.ThinPlate()).surface
    mesh = surface.mesh(1e-2)
    assert mesh.is_manifold
    assert mesh.points.mean(axis=0) == pytest.approx([float(Fraction(c)) for c in center], abs=1)
    jets = surface.jets(mesh.points)
    assert not np.isnan(jets).any()
    assert np.abs(jets[:, 0]).max() < 1e-9


def test_pyvista_mesh_has_normals():
    data = solved(EQUAL, 1).surface.mesh(tolerance=1e-2).to_pyvista()
    assert data.is_all_triangles
    assert data.is_manifold is False  # it has a boundary
    assert data.point_data.active_normals.shape == (data.n_points, 3)
    assert data.n_open_edges > 0


@pytest.mark.slow
def test_surfaces_that_are_refuted_are_meshed_all_the_same():
    good = solved(UNEQUAL, 1).surface
    bubble = pas.Polynomial("(x - 1/20)^2 + y^2 + z^2 - 1/100")
    wrong = pas.PiecewiseSurface.from_polynomials(
        good.partition, good.contacts, 1, [c.polynomial * bubble for c in good.cells]
    )
    mesh = wrong.triangulate(1e-2)
    assert mesh.is_manifold
    assert mesh.euler_characteristic == -1 + 2


@pytest.mark.parametrize("tolerance", [0, -1, float("nan"), float("inf")])
def test_bad_tolerances(tolerance):
    with pytest.raises(ValueError, match="tolerance must be a positive number"):
        solved(EQUAL, 1).surface.mesh(tolerance)


def test_tolerances_that_need_too_many_triangles_are_refused():
    with pytest.raises(pas.MeshError, match="needs more than 20000 triangles"):
        solved(EQUAL, 1).surface.mesh(1e-5, max_triangles=20_000)
    thousand = [pas.Pipe(a, "1000/3", 1000) for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    large = pas.blend(thousand, 1, energy=pas.ThinPlate()).surface
    words = r"the tolerance 0\.01 needs more than 20000 triangles; 0\.[1-9]\d is reached with"
    with pytest.raises(pas.MeshError, match=words):
        large.mesh(0.01, max_triangles=20_000)  # in the model's units, whatever those inside are


def test_no_surface_is_said():
    good = solved(EQUAL, 1).surface
    empty = pas.PiecewiseSurface.from_polynomials(good.partition, good.contacts, 1, [pas.Polynomial("x^2 + 1")] * 6)
    with pytest.raises(pas.MeshError, match="does not change sign"):
        empty.triangulate(1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("degree", [5, 6])
def test_a_long_thin_arm_beside_the_centre(degree):
    """Some rays from the centre leave through its end without having met the surface, and meet it at distances that
    are very different on both sides of its axis."""
    arms = [
        pas.Pipe(axis=(2, 1, -1), radius="1/4", clip=2, point=(0, "1/10", 0)),
        pas.Cone(axis=(1, -1, 2), radius="1/3", slope="-1/5", clip="auto"),
    ]
    mesh = pas.blend(arms, 2, degree=degree).mesh(tolerance=2e-2)
    assert mesh.certificate.holds
    assert np.percentile(mesh.smallest_angles, 1) > 28


@pytest.mark.parametrize(
    ("order", "given"),
    [
        (2, [((0, 2, 0), "1/5", "auto", (0, "1/12", "1/16")), ((-1, -1, -2), "1/5", "3/2", ("1/8", "1/16", "-1/10"))]),
        pytest.param(
            1,
            [
                ((2, -1, 1), "1/5", "3/2", (0, "1/8", "-1/10")),
                ((0, 1, 2), "1/4", "auto", ("-1/12", "1/8", "1/6")),
                ((0, -2, -1), "1/3", "3/2", ("-1/8", "-1/8", 0)),
            ],
            marks=pytest.mark.slow,
        ),
    ],
)
@pytest.mark.slow
def test_arms_that_pass_the_centre_by(order, given):
    """First triangles across such an arm were split to points on its other side, and folded."""
    mesh = pas.blend([pas.Pipe(a, r, clip=c, point=p) for a, r, c, p in given], order).mesh(2e-2)
    assert mesh.certificate.holds
    assert mesh.smallest_angles.min() > 15


@pytest.mark.slow
def test_a_surface_that_is_too_sharp_for_a_mesh_is_said_to_be():
    given = (((0, 1, 0), "1/2", "3/2"), ((-4, 7, 0), "1/2", 1))
    cones = [pas.Cone(axis=a, radius=r, slope="1/8", clip=c) for a, r, c in given]
    surface = pas.blend(cones, 1, "lowest", energy=pas.ThinPlate()).surface
    words = (
        r"no good mesh .* near \(0\.2\d+, -0\.2\d+, .*\) it is 5\d(\.\d)? times as sharp as its neighbours"
        r".*clip=\"auto\""
    )
    with pytest.raises(pas.MeshError, match=words):
        surface.mesh(1e-2)


def test_manifold_check_can_fail():
    bow_tie = Mesh.smooth(np.zeros((5, 3)), np.array([[0, 1, 2], [0, 3, 4]]), np.zeros((5, 3)))
    assert not bow_tie.is_manifold
    book = Mesh.smooth(np.zeros((5, 3)), np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]]), np.zeros((5, 3)))
    assert not book.is_manifold


def test_a_surface_that_is_singular_along_a_curve_is_meshed():
    """The heart: its gradient vanishes where it crosses z = 0, and its normals turn at once at both cusps."""
    text, half = "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", 1.5
    mesh = pas.Polynomial(text).surface(("-3/2",) * 3, ("3/2",) * 3).mesh(3e-3)
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2
    assert mesh.components == 1
    steps = (np.arange(120) + 0.5) / 120 * 2 * half - half
    x, y, z = np.meshgrid(steps, steps, steps, sparse=True)
    inside = (x**2 + 9 / 4 * y**2 + z**2 - 1) ** 3 - x**2 * z**3 - 9 / 80 * y**2 * z**3 < 0
    assert mesh.volume == pytest.approx(inside.mean() * (2 * half) ** 3, rel=0.01)
    assert not mesh.certificate.proved  # that its topology is right is not claimed
