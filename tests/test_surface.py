"""Surfaces: values, rays, Bernstein forms, and the continuity that is felt on the seams."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved

import pas

CASES = [(EQUAL, 1), (UNEQUAL, 1), (EQUAL, 2), (UNEQUAL, 2), (EQUAL, 3)]


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def curvatures(p: pas.Polynomial, x: np.ndarray) -> np.ndarray:
    """Principal curvatures (N, 2) of p = 0, from the shape operator in the tangent plane."""
    g, h = p.gradient(x), p.hessian(x)
    n = unit(g)
    project = np.eye(3) - n[:, :, None] * n[:, None, :]
    shape = project @ h @ project / np.linalg.norm(g, axis=1)[:, None, None]
    values = np.linalg.eigvalsh(shape)
    drop = np.abs(values).argmin(axis=1)
    return np.sort(np.array([np.delete(v, d) for v, d in zip(values, drop, strict=True)]), axis=1)


def seam(surface: pas.PiecewiseSurface, number: int) -> tuple[np.ndarray, pas.Polynomial, pas.Polynomial]:
    """Points of the surface in an interior face, and the two polynomials that meet there."""
    face = surface.partition.interior_faces[number]
    corners = surface.partition.points[list(face.vertices)]
    weights = np.random.default_rng(number).dirichlet(np.ones(3), 60)
    centre = np.array([float(c) for c in pas.Polynomial(0).gradient(np.zeros(3))])
    directions = weights @ corners - centre
    t = surface.intersect_rays(centre, directions)
    points = (t[:, None] * directions)[~np.isnan(t)]
    return points, surface.cells[face.first].polynomial, surface.cells[face.second].polynomial


@pytest.mark.parametrize(("radii", "order"), CASES)
def test_normals_and_curvatures_agree_across_contacts(radii, order):
    surface = solved(radii, order).surface
    mesh = surface.mesh(5e-3)
    boundary = mesh.points[mesh.boundary]
    for number, contact in enumerate(surface.contacts):
        x = boundary[np.abs(contact.clip(boundary)) < 1e-12]
        patch = surface.cells[2 * number].polynomial
        assert len(x) > 10
        assert np.abs(unit(patch.gradient(x)) - unit(contact.surface.gradient(x))).max() < 1e-6
        gap = np.abs(curvatures(patch, x) - curvatures(contact.surface, x)).max()
        assert gap < 1e-4 if order >= 2 else gap > 1e-3


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("radii", "order"), CASES)
def test_normals_and_curvatures_agree_across_faces(radii, order):
    surface = solved(radii, order).surface
    gaps = []
    for number in range(6):
        x, first, second = seam(surface, number)
        assert len(x) > 10
        assert np.abs(unit(first.gradient(x)) - unit(second.gradient(x))).max() < 1e-6
        gaps.append(np.abs(curvatures(first, x) - curvatures(second, x)).max())
    assert max(gaps) < 1e-4 if order >= 2 else max(gaps) > 1e-3


def test_curvatures_are_those_of_the_shape_operator():
    surface = solved(UNEQUAL, 2).surface
    mesh = surface.mesh(2e-2)
    inner = np.setdiff1d(np.arange(len(mesh.points)), mesh.boundary)[::7]
    x = mesh.points[inner]
    owner = surface.partition.locate(x)
    mean, gauss = surface.curvatures(x).T
    for number, cell in enumerate(surface.cells):
        k = curvatures(cell.polynomial, x[owner == number])
        assert mean[owner == number] == pytest.approx(k.mean(axis=1), abs=1e-8)
        assert gauss[owner == number] == pytest.approx(k.prod(axis=1), abs=1e-8)


def test_values_are_those_of_the_cells_polynomials():
    surface = solved(UNEQUAL, 2).surface
    rng = np.random.default_rng(2)
    corners = surface.partition.points[np.array(surface.partition.cells)]
    for number, cell in enumerate(surface.cells):
        x = rng.dirichlet(np.ones(4), 30) @ corners[number]
        assert surface(x) == pytest.approx(cell.polynomial(x), abs=1e-9)
        assert surface.gradient(x) == pytest.approx(cell.polynomial.gradient(x), abs=1e-8)
        assert surface.hessian(x) == pytest.approx(cell.polynomial.hessian(x), abs=1e-7)
    assert np.isnan(surface([[2.0, 0, 0]])).all()
    assert not surface.contains([2.0, 0, 0])
    assert surface.contains(np.zeros((2, 4, 3))).shape == (2, 4)
    with pytest.raises(ValueError, match="shape"):
        surface([1.0, 2.0])


def test_b_coefficients_are_exact():
    surface = solved(EQUAL, 1).surface
    for cell in surface.cells:
        b = cell.b_coefficients
        assert len(b) == 20
        assert b[3, 0, 0, 0] == cell.polynomial.at(cell.vertices[0])
        assert b[0, 0, 0, 3] == cell.polynomial.at(cell.vertices[3])
        middle = [sum(v[i] for v in cell.vertices) / 4 for i in range(3)]
        weights = {3: 1, 2: 3, 1: 6}
        total = sum(c * weights[max(e)] for e, c in b.items()) / Fraction(64)
        assert total == cell.polynomial.at(middle)


@pytest.mark.parametrize(("radii", "order"), [(EQUAL, 1), (UNEQUAL, 2)])
def test_rays_hit_where_the_function_vanishes(radii, order):
    surface = solved(radii, order).surface
    rng = np.random.default_rng(4)
    origins = rng.normal(size=(400, 3)) * 2
    directions = rng.uniform(-0.6, 0.6, (400, 3)) - origins
    t = surface.intersect_rays(origins, directions)
    hit = ~np.isnan(t)
    assert 50 < hit.sum() < 400
    points = origins + t[:, None] * directions
    jets = surface.jets(points[hit])
    assert np.abs(jets[:, 0]).max() < 1e-11
    # nothing before the hit: dense samples along each ray keep one sign
    shares = np.linspace(0, 1, 400, endpoint=False)[1:]
    ends = np.where(hit, t, 3.0)
    samples = surface(origins[:, None] + (shares * ends[:, None])[..., None] * directions[:, None])
    signs = np.where(np.isnan(samples), 0, np.sign(samples))
    changes = (signs[:, 1:] * signs[:, :-1]) < 0
    assert not changes.any()


def test_rays_broadcast_and_respect_scale():
    surface = solved(EQUAL, 1).surface
    t = surface.intersect_rays([0, 0, 0], [[-1, 0, 0], [-2, 0, 0], [1, 0, 0]])
    assert t.shape == (3,)
    assert t[0] == pytest.approx(2 * t[1])
    assert np.isnan(t[2])
    assert np.isnan(surface.intersect_rays([5, 5, 5], [1, 0, 0]))
