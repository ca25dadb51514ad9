"""Patches of parametric surfaces: Bezier ones identical with them, B-splines within their bounds, and both as STEP."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_step import ocp, read_back  # noqa: F401

import pas
from pas.parametric.nets import product

SQUARE = ((0, 1), (0, 1))
FIRST = pas.ParametricSurface("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1")
SECOND = pas.ParametricSurface("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1")
BLEND = pas.hermite_blend(pas.BlendingData([FIRST, SECOND]), 2)
EXACT = {
    "torus": (pas.torus(2, 1), ((0, 1), ("1/3", 1)), 1),
    "torus beyond half a turn": (pas.torus(2, 1), ((-3, 3), (-1, "7/2")), 6),
    "sphere": (pas.ellipsoid(2, 3, "1/2"), (("-1/2", "1/2"), None), 2),
    "plane": (pas.plane((1, 2, 3), (1, "1/3", 0), (0, 1, 1)), ((-5, "1/7"), (0, 1)), 1),
    "paraboloid": (pas.elliptic_paraboloid(), ((0, "1/2"), (0, 2)), 1),
    "hyperboloid": (pas.one_sheet_hyperboloid(1, 2, 3), ((-1, 1), (-1, 1)), 2),
    "negative denominator": (pas.ParametricSurface("t/(t + h - 3)", "h", "t*h"), SQUARE, 1),
    "blend": (BLEND.surface, (("-1/2", "1/2"), None), 1),
}
"""Surface, rectangle and number of patches."""


@pytest.mark.parametrize("name", EXACT)
def test_bezier_patches_are_the_surface(name):
    surface, domain, number = EXACT[name]
    patches = pas.bezier_patches(surface, domain)
    assert len(patches) == number
    area = 0.0
    for patch in patches:
        assert all(
            a == b for a, b in zip(patch.surface(surface.parameters).components, surface.components, strict=True)
        )
        (a, b), (c, d) = patch.domain
        area += (b - a) * (d - c)
        t, h = np.meshgrid(np.linspace(a, b, 7), np.linspace(c, d, 5), indexing="ij")
        inside = surface.with_domain(None)
        assert np.allclose(patch(t, h), inside(np.stack([t, h], axis=-1)), rtol=1e-12, atol=1e-12)
        assert (patch.weights > 0).all()
        assert all(isinstance(x, Fraction) for x in (*patch.control_points.ravel(), *patch.exact.weights.ravel()))
        corner = patch.exact.rectangle[:, 0]
        assert tuple(patch.control_points[0, 0]) == surface.with_domain(None).at(*corner)
    whole = [Fraction(str(b)) - Fraction(str(a)) for a, b in (domain[0], domain[1] or surface.domain[1])]
    assert area == pytest.approx(float(whole[0] * whole[1]))


def test_one_patch_or_the_reason_why_not():
    surface = pas.torus(2, 1)
    patch = pas.bezier_patch(surface, SQUARE)
    assert patch.degrees == (2, 2)
    assert patch.is_bezier
    assert [k.tolist() for k in patch.knots] == [[0, 0, 0, 1, 1, 1]] * 2
    assert patch.control_points[2, 2].tolist() == list(surface.at(1, 1))
    with pytest.raises(pas.GeometryError, match=r"weight .* not positive \(0\); bezier_patches splits"):
        pas.bezier_patch(surface, ((-1, 1), (0, 1)))


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pas.bezier_patch(pas.helicoid(), SQUARE), ValueError, "needs an exact surface"),
        (lambda: pas.bezier_patch(pas.torus(2, 1)), ValueError, "domain of t is infinite"),
        (lambda: pas.bezier_patches(pas.ParametricSurface("1/(t - h)", "t", "h"), SQUARE),
         pas.GeometryError, "pole or base point near t"),
        (lambda: pas.bezier_patches(pas.ParametricSurface("1/(3*t^2 + h^2 - 1/5)", "t", "h"), SQUARE),
         pas.GeometryError, "pole or base point near t = "),
        (lambda: pas.fit_patch(pas.torus(2, 1), 1e-3), ValueError, "domain of t is infinite"),
        (lambda: pas.fit_patch(pas.plane(), 0, SQUARE), ValueError, "tolerance must be a positive number"),
        (lambda: pas.fit_patch(pas.ParametricSurface("1/(t - 1/2)", "t", "h"), 1e-3, SQUARE),
         pas.GeometryError, "finite"),
        (lambda: pas.fit_patch(pas.ParametricSurface("sqrt(t)", "t", "h"), 1e-6, SQUARE),
         pas.GeometryError, "512 spans"),
        (lambda: pas.RationalPatch(np.zeros((3, 2, 3)), np.ones((3, 2)), ([0, 0, 1, 2, 2], [0, 0, 1, 1, 1])),
         ValueError, "in v it is 2"),
        (lambda: pas.RationalPatch(np.zeros((3, 2, 3)), np.ones((3, 2)), ([0, 0, 3, 2, 2], [0, 0, 1, 1])),
         ValueError, "knots of u must not fall"),
    ],
)  # fmt: skip
def test_what_cannot_be_converted(make, error, words):
    with pytest.raises(error, match=words):
        make()


FITS = {
    "torus": (pas.torus(2, 1), ((-1, 1), (-1, 1))),
    "turned torus": (pas.torus(2, 1, angle=True), None),
    "helicoid": (pas.helicoid(), ((0, 6), (-1, 1))),
    "blend": (BLEND.surface, ((-1, 1), None)),
    "callable": (pas.ParametricSurface(lambda t, h: t, lambda t, h: h, lambda t, h: np.exp(-t * t - h)), SQUARE),
}


@pytest.mark.parametrize("name", FITS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_fits_are_within_their_bounds(name, tolerance):
    surface, domain = FITS[name]
    patch = pas.fit_patch(surface, tolerance, domain)
    assert patch.certified is surface.is_exact
    assert patch.deviation <= tolerance
    assert patch.degrees == (3, 3)
    low, high = np.array(patch.domain).T
    points = low + (high - low) * np.random.default_rng(1).random((3000, 2))
    off = np.linalg.norm(patch(points[:, 0], points[:, 1]) - surface(points), axis=1).max()
    assert off <= (1 if patch.certified else 1.05) * patch.deviation + 1e-14
    if patch.certified and patch.deviation > 1e-12:
        assert off > patch.deviation / 20


def test_a_fit_is_a_surface_with_derivatives():
    surface, domain = FITS["turned torus"]
    fitted = pas.fit_patch(surface, 1e-6, domain).surface()
    assert not fitted.is_exact
    points = np.random.default_rng(2).uniform(-3, 3, (200, 2))
    for orders, slack in (((1, 0), 1e-4), ((0, 1), 1e-4), ((1, 1), 1e-3), ((2, 0), 1e-1)):
        assert np.allclose(fitted.derivative(points, *orders), surface.derivative(points, *orders), atol=slack)
    assert fitted.mesh(1e-2).euler_characteristic == 0


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 4), st.integers(1, 4), st.integers(1, 3), st.integers(1, 3), st.integers(0, 1000))
def test_products_of_nets(m, n, k, p, seed):
    def value(net, u, v):
        flat = np.zeros((*net.shape[:2], 3))
        flat[..., 2] = net
        patch = pas.RationalPatch(flat, np.ones(net.shape))
        return patch(u, v)[2]

    random = np.random.default_rng(seed)
    a, b, (u, v) = random.random((m + 1, n + 1)), random.random((k + 1, p + 1)), random.random(2)
    both = product(a[None, ..., None], b[None, ..., None])[0, ..., 0]
    assert both.shape == (m + k + 1, n + p + 1)
    assert value(both, u, v) == pytest.approx(value(a, u, v) * value(b, u, v))


def test_what_step_does_not_take(tmp_path):
    with pytest.raises(ValueError, match=r"patches\[1\]: the surface is not exact; write fit_patch"):
        pas.write_step([pas.torus(2, 1).with_domain(SQUARE), pas.helicoid()], tmp_path / "a.step")
    with pytest.raises(ValueError, match="domain of t is infinite"):
        pas.write_step(BLEND, tmp_path / "a.step")
    steep = pas.ParametricSurface("t^26", "t", "h", domain=SQUARE)
    with pytest.raises(ValueError, match=r"patches\[0\] has the degrees \(26, 1\)"):
        pas.write_step(steep, tmp_path / "a.step")
    assert not list(tmp_path.iterdir())


def test_blends_and_fits_come_back_from_step(ocp, tmp_path):  # noqa: F811
    blend = pas.ParametricBlend(BLEND.data, 2, BLEND.surface.with_domain((("-1/2", "1/2"), (0, 1))))
    fit = pas.fit_patch(pas.torus(2, 1, angle=True), 1e-3, ((0, 1), (0, 2)))
    pieces = pas.bezier_patches(pas.torus(2, 1), ((-2, 2), (0, 1)))
    _, faces, valid = read_back(pas.write_step([blend, fit, *pieces], tmp_path / "a.step"))
    expected = [pas.bezier_patch(blend.surface), fit, *pieces]
    assert valid
    assert len(faces) == len(expected)
    for patch, (points, weights) in zip(expected, faces, strict=True):
        assert np.array_equal(points, patch.points)
        np.testing.assert_allclose(weights / weights[0, 0], patch.weights / patch.weights[0, 0], rtol=1e-13)
