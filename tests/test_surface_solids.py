"""Bodies that parametric surfaces bound: closed ones, and such as flat faces close at their ends."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

import pas
from pas import solid
from pas.parametric.solids import FlatEnd, SurfaceDistance

TURN = (-pi, pi)


def vase():
    return pas.surface_of_revolution("1 + h^2/4", "h", angle=True, interval=(-1, 2))


def pipe(radius="1/4 + t/8", end=3):
    """A tube of a radius that varies, about an arc."""
    center, first = ("2*cos(t)", "2*sin(t)", "0"), ("cos(t)", "sin(t)", "0")
    return pas.tube(center, radius, first, ("0", "0", "1"), angle=True, domain=(0, end))


VOLUMES = {
    "turned round": (lambda: pas.ParametricSurface("sin(t)", "cos(t)", "h", domain=(TURN, (0, 1))), pi, 2),
    "ring": (lambda: pas.torus(2, 1, angle=True), 4 * pi**2, 0),
    "ball": (lambda: pas.ellipsoid(1, 2, "1/2", angle=True), 4 * pi / 3, 0),
    "spindle": (lambda: pas.surface_of_revolution("h*(1 - h)", "h", angle=True, interval=(0, 1)), pi / 30, 0),
    "vase": (vase, pi * (3 + 9 / 6 + 33 / 80), 2),
    "pipe": (pipe, 2 * pi * 8 / 3 * ((5 / 8) ** 3 - (1 / 4) ** 3), 2),
    "cut": (lambda: pas.ParametricSurface("cos(t)", "sin(t)", "h*(1 + cos(t)/5)", domain=(TURN, (0, 1))), pi, 2),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", VOLUMES)
def test_closed_surfaces_and_such_with_plane_ends_become_solids(name):
    make, volume, ends = VOLUMES[name]
    body = make().solid("side")
    assert body.faces == ("side", "side start", "side end")[: 1 + ends]
    size = float(np.ptp(body.box, axis=0).max())
    mesh = body.mesh(0.03 * size)
    assert mesh.is_closed and mesh.components == 1 and set(mesh.names) == set(body.faces)
    assert body.volume(0.03 * size) == pytest.approx(volume, rel=2e-3)


def test_what_is_inside_is_told_apart_at_ends_and_far_away():
    body = vase().solid()
    drawn = np.random.default_rng(0).uniform([-2.5, -2.5, -2], [2.5, 2.5, 3], (4000, 3))
    radius = np.linalg.norm(drawn[:, :2], axis=1)
    known = (radius < 1 + drawn[:, 2] ** 2 / 4) & (drawn[:, 2] > -1) & (drawn[:, 2] < 2)
    assert np.array_equal(body.contains(drawn), known)


def test_distances_and_bounds_are_those_of_the_surface():
    surface = pas.torus(2, 1, angle=True)
    distance = SurfaceDistance(surface, surface.mesh())
    points = np.random.default_rng(1).uniform(-3, 3, (500, 3)) * [1, 1, 0.4]
    exact = np.linalg.norm([np.linalg.norm(points[:, :2], axis=1) - 2, points[:, 2]], axis=0) - 1
    jets = distance.jets(points)
    near = np.abs(exact) < distance.gap
    assert near.sum() > 30 and jets[near, 0] == pytest.approx(exact[near], abs=1e-12)
    assert np.array_equal(np.sign(jets[:, 0]), np.sign(exact))
    assert np.abs(jets[:, 0] - exact).max() < distance.gap
    for radius in (0.01, 0.1, 0.5):
        inside, outside = distance.decided_within(points, np.full(len(points), radius))
        assert not (inside & (exact + radius > 1e-9)).any() and not (outside & (exact - radius <= 0)).any()
        assert (inside | outside).any()
    assert not np.any(distance.decided_within(points, np.abs(exact) + 1e-6)), "these balls meet the surface"


@pytest.mark.slow
def test_they_take_part_in_everything_that_solids_do(tmp_path):
    body = pipe().solid("pipe")
    joined = (body | solid.ball((2, 0, 0), "2/5")) - solid.cylinder((2, 0, -1), (2, 0, 1), "1/10")
    moved = joined.scale(2).translate(1, 0, 0)
    mesh = moved.mesh(0.05)
    assert mesh.is_closed and mesh.euler_characteristic == 0
    again = pas.load(moved.save(tmp_path / "a.pas.json"))
    assert np.array_equal(again.mesh(0.05).points, mesh.points)
    assert isinstance(body.tree.parts[1].function, FlatEnd)


@pytest.mark.parametrize(
    ("surface", "words"),
    [
        (
            lambda: pas.helicoid().with_domain(((0, 1), (0, 1))),
            "no closed curve at one end of its domain, and only such",
        ),
        (
            lambda: pas.ParametricSurface("cos(t)", "sin(t)", "h*(1 + cos(2*t)/5)", domain=(TURN, (0, 1))),
            r"its edge at h = 1 is in no plane \(it is off by 0\.2\)",
        ),
        (
            lambda: pas.ParametricSurface(
                "(2 + cos(h))*cos(t)", "(2 + cos(h))*sin(t)", "sin(2*h)", domain=(TURN, TURN)
            ),
            "it passes through itself, or is thinner than",
        ),
        (
            lambda: pas.surface_of_revolution("2 + cos(h)", "sin(h)", angle=True, interval=(-2, 1)),
            "it goes on beyond the plane in which it ends, where no flat face closes it",
        ),
    ],
)
def test_what_bounds_no_body_is_said(surface, words):
    with pytest.raises(pas.GeometryError, match=f"the surface bounds no body: .*{words}"):
        surface().solid()


def test_a_surface_moves_as_solids_do_and_an_open_one_names_its_body(tmp_path):
    moved = vase().rotate((1, 0, 0), 90).scale(2).translate(0, 1, 0)
    assert moved.mesh(0.1).bounding_box == pytest.approx(np.array([[-4, -3, -4], [4, 3, 4]]), abs=0.1)
    with pytest.raises(ValueError, match=r"as in shape\.solid\(\)\.write\('a\.stl'\)"):
        vase().write(tmp_path / "a.stl")
    assert pas.torus(angle=True).write(tmp_path / "a.stl", tolerance=0.2).exists()
    with pytest.raises(TypeError, match=r"make a solid of the parametric surface first, as shape\.solid"):
        solid.ball((0, 0, 0), 1) - vase()
