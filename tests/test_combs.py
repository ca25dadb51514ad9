"""Curvature combs: the curves they stand on, the curvature along them, and how they are drawn."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas.exchange.picture_options import Picture
from pas.piecewise import PiecewiseSurface
from pas.render import piecewise as sections
from pas.render import plotting as drawing
from pas.render.piecewise import chains, combs, section_planes
from pas.render.plotting import hair_length, tips
from pas.render.scene import Comb, Layer, scene_of


def alone(polynomial, lower, upper, contacts):
    return PiecewiseSurface.from_polynomials(pas.SingleCell(lower, upper), contacts, 1, [polynomial])


def combs_of(surface, tolerance):
    return combs(surface, surface.mesh(tolerance))


ELBOW = alone(
    "(x^2 + y^2 + z^2 + 400 - 25)^2 - 1600*(x^2 + y^2)",
    (0, 0, -10),
    (30, 30, 10),
    [pas.Contact("(y - 20)^2 + z^2 - 25", "-x"), pas.Contact("(x - 20)^2 + z^2 - 25", "-y")],
)
"""A quarter of a torus between two pipes."""


def test_combs_of_an_elbow_are_those_of_its_arcs():
    """Along the section the inner arc has curvature -1/15, the outer 1/25; along the circles it is 1/5."""
    found = combs_of(ELBOW, 0.2)
    assert sorted(comb.curvatures.mean() for comb in found) == pytest.approx([-1 / 15, 1 / 25, 1 / 5, 1 / 5])
    for comb in found:
        np.testing.assert_allclose(comb.curvatures, comb.curvatures.mean(), atol=1e-9)
        x, y, z = comb.points.T
        far = np.hypot(x, y)
        np.testing.assert_allclose((far - 20) ** 2 + z**2, 25, atol=1e-6)
        outward = np.stack([x / far * (far - 20), y / far * (far - 20), z], axis=1) / 5
        np.testing.assert_allclose(comb.normals, outward, atol=1e-9)
        if abs(comb.curvatures[0]) < 0.1:
            np.testing.assert_allclose(z, 0, atol=1e-4)
            steps = np.linalg.norm(np.diff(comb.points, axis=0), axis=1)
            assert steps.max() < 1.2 * steps.min()
        else:
            np.testing.assert_allclose(np.minimum(np.abs(x), np.abs(y)), 0, atol=1e-9)
            np.testing.assert_allclose(comb.points[0], comb.points[-1], atol=1e-6)  # a closed curve


def test_axes_on_one_line_have_two_sections():
    pipe = alone("x^2 + y^2 - 4", (-3, -3, -3), (3, 3, 3), [pas.Contact("x^2 + y^2 - 4", c) for c in ("z-3", "-z-3")])
    found = combs_of(pipe, 0.05)
    straight = [comb for comb in found if np.abs(comb.curvatures).max() < 1e-12]
    assert (len(found), len(straight)) == (6, 4)
    assert all(np.allclose(comb.curvatures, 0.5) for comb in found if comb not in straight)


def test_curvature_along_a_curve_in_no_principal_direction():
    """Of a pipe of radius 2, along an ellipse, by Euler's theorem: 1/2 times the squared cosine with the circle."""
    pipe = alone("x^2 + y^2 - 4", (-3, -3, -3), (3, 3, 3), [])
    turn = np.linspace(0, 2 * np.pi, 50)
    near = np.stack([2 * np.cos(turn), 2 * np.sin(turn), 2 * np.cos(turn)], axis=1) + 0.01
    found = sections._comb(pipe, near, sections._plane(np.zeros(3), np.array([1.0, 0, -1.0])))
    x, y, z = found.points.T
    np.testing.assert_allclose(np.stack([np.hypot(x, y), z - x]), [[2] * 50, [0] * 50], atol=1e-12)
    np.testing.assert_allclose(found.curvatures, 0.5 / (1 + (y / 2) ** 2), atol=1e-12)


def test_chains_of_edges():
    found = chains(np.array([[5, 3], [1, 2], [3, 4], [2, 0], [4, 5], [7, 6]]))
    assert sorted(len(chain) for chain in found) == [2, 3, 4]
    loop = next(chain for chain in found if len(chain) == 4)
    assert loop[0] == loop[-1]
    assert set(loop) == {3, 4, 5}
    assert next(chain for chain in found if len(chain) == 3).tolist() in ([0, 2, 1], [1, 2, 0])
    crossing = chains(np.array([[0, 4], [4, 1], [2, 4], [4, 3]]))  # four curves meet
    assert sorted(len(chain) for chain in crossing) == [2, 2, 2, 2]


def test_curves_of_few_points_are_not_shown(monkeypatch):
    lengths = sorted(len(comb.points) for comb in combs_of(ELBOW, 0.2))
    monkeypatch.setattr(sections, "FEWEST", lengths[-1])
    assert [len(comb.points) for comb in combs_of(ELBOW, 0.2)] == [n for n in lengths if n == lengths[-1]]


def test_a_contact_in_parts_is_one_neighbour():
    turn = np.linspace(0, 2 * np.pi, 40)
    circle = np.stack([np.cos(turn), np.sin(turn), np.zeros(40)], axis=1)
    left, right = circle[:19], circle[20:39]
    other = circle + [9, 0, 0]
    parts = sections._neighbours([left, other, right], 0.1)
    assert [[len(curve) for curve in part] for part in parts] == [[40], [19, 19]]
    assert np.abs(sections._middle([left, right])).max() < 0.05
    np.testing.assert_allclose(sections._middle([np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0]])]), [1.5, 0, 0])


def test_planes_of_axes():
    x, y, z = np.eye(3)
    ((place, normal),) = section_planes([(2 * x, x), (3 * y, y)])
    assert abs(normal @ z) == pytest.approx(1)
    assert place @ z == pytest.approx(0)
    assert len(section_planes([(2 * x, x), (3 * y, y), (-2 * x, x), (-3 * y, y)])) == 1  # four in one plane
    ((place, normal),) = section_planes([(2 * x + z, x), (2 * x + 5 * z, x)])  # parallel, apart
    assert abs(normal @ y) == pytest.approx(1)
    planes = section_planes([(2 * x, x), (-2 * x, -x)])
    assert len(planes) == 2
    assert len(section_planes([(2 * x, x), (-2 * x, -x), (5 * x, x)])) == 2
    assert all(abs(normal @ x) < 1e-12 for _, normal in planes)
    assert len(section_planes([(2 * x, x), (2 * y, y), (2 * z, z)])) == 3


def test_combs_of_a_corner_agree_with_its_measures():
    """In the planes of symmetry sections bend as the surface does; their signs are those that fairness finds."""
    blend = solved(EQUAL, 2)
    found = combs(blend.surface, blend.surface.mesh(0.02))
    pipe = float(Fraction(EQUAL[0]))
    circles = [comb for comb in found if np.allclose(comb.points[0], comb.points[-1], atol=1e-6)]
    assert len(circles) == 3
    for comb in circles:
        np.testing.assert_allclose(comb.curvatures, 1 / pipe, rtol=1e-6)
        axis = int(np.ptp(comb.points, axis=0).argmin())
        across = np.delete(comb.points, axis, axis=1)
        np.testing.assert_allclose(np.linalg.norm(across, axis=1), pipe, rtol=1e-9)
    sections = [comb for comb in found if not any(comb is c for c in circles)]
    assert len(sections) >= 6
    for comb in sections:
        values, slopes = blend.surface(comb.points), blend.surface.gradient(comb.points)
        known = np.isfinite(values)
        assert known.mean() > 0.9
        assert np.abs(values[known] / np.linalg.norm(slopes[known], axis=1)).max() < 1e-12
        assert np.abs(comb.points).min(axis=1).max() < 1e-5  # in a plane of coordinates
        chord = np.diff(comb.points, axis=0)
        length = np.linalg.norm(chord, axis=1)
        turn = np.cross(chord[:-1], chord[1:])
        size = np.linalg.norm(turn, axis=1) / length[:-1] / length[1:] / (length[:-1] + length[1:]) * 2
        inner = slice(1, -1)
        gap = np.abs(np.abs(comb.curvatures[inner]) - size)
        assert np.median(gap) < 0.05 * np.abs(comb.curvatures).max()  # symmetry: the curve bends in the plane alone


def test_combs_are_found_far_from_the_origin():
    near, far = (solved_at(shift) for shift in (0, 1000))
    for a, b in zip(combs_of(near, 0.02), combs_of(far, 0.02), strict=True):
        assert a.curvatures.max() == pytest.approx(b.curvatures.max(), rel=1e-6)


def solved_at(shift):
    pipes = [pas.Pipe(axis, "1/3", 1, (shift, shift, shift)) for axis in np.eye(3, dtype=int).tolist()]
    return pas.blend(pipes, 1, energy=pas.ThinPlate()).surface


def straight_comb(curvatures):
    count = len(curvatures)
    points = np.stack([np.linspace(0, 1, count), np.zeros(count), np.zeros(count)], axis=1)
    return Comb(points, np.tile([0.0, 0.0, 1.0], (count, 1)), np.array(curvatures, dtype=float))


def layer_with(*combs):
    return Layer(pas.solid.box((0, 0, -1), (1, 1, 0)).mesh(), "#ffffff", combs=combs)


def test_hairs_stand_outside_and_have_sensible_lengths():
    usual = straight_comb([1, -1] * 50)
    layer = layer_with(usual)
    factor = hair_length([layer])
    assert factor == pytest.approx(0.16)
    assert tips(layer, factor)[:, 2] == pytest.approx(0.16)  # concave ones, too
    spiked = layer_with(straight_comb([1] * 99 + [50]))
    assert 50 * hair_length([spiked]) == pytest.approx(0.4)
    assert hair_length([layer_with(straight_comb([0, 0, 0]))]) == 0
    assert hair_length([layer_with()]) == 0
    assert hair_length([layer, layer_with(straight_comb([2] * 9))]) < factor  # one length for all


def test_concave_hairs_do_not_cross_where_they_can_be_short():
    hollow, sharp = (hair_length([layer_with(straight_comb([-bent] * 9))]) for bent in (8, 100))
    assert 8 * hollow == pytest.approx(0.1)  # of the radius
    assert 100 * sharp == pytest.approx(0.4 * 0.16)


class Drawn:
    """A plotter that keeps what it is given: points, colour and width."""

    def __init__(self):
        self.parts = []

    def add_mesh(self, data, color, line_width, lighting):
        self.parts.append((np.asarray(data.points), np.asarray(data.lines), color, line_width))


def test_hairs_are_coloured_by_sign_and_stand_on_the_curve():
    comb = straight_comb([2, 1, -1, -3])
    layer, shift, plotter = layer_with(comb), np.array([0.0, 5.0, 0.0]), Drawn()
    drawing.add_combs(plotter, layer, 0.1, shift)
    base = comb.points + shift + [0, 0, 0.002]  # on the outside: normals are along z
    assert [color for _, _, color, _ in plotter.parts] == [
        drawing.NEARBY, drawing.CONVEX, drawing.CONVEX, drawing.CONCAVE, drawing.CONCAVE
    ]  # fmt: skip
    np.testing.assert_allclose(plotter.parts[0][0], base, atol=1e-7)
    for (hairs, lines, _, width), (envelope, _, _, wider), run in zip(
        plotter.parts[1::2], plotter.parts[2::2], (slice(0, 2), slice(2, 4)), strict=True
    ):
        ends = base[run] + 0.1 * np.abs(comb.curvatures[run, None]) * [0, 0, 1]
        np.testing.assert_allclose(hairs.reshape(-1, 2, 3), np.stack([base[run], ends], axis=1), atol=1e-7)
        assert lines.tolist() == [2, 0, 1, 2, 2, 3]
        np.testing.assert_allclose(envelope[:2] if run.start == 0 else envelope[1:], ends, atol=1e-7)
        assert len(envelope) == 3 and width < wider


def test_the_envelope_comes_down_where_the_sign_changes():
    plotter = Drawn()
    drawing.add_combs(plotter, layer_with(straight_comb([3, 1, -3, -1])), 0.1, np.zeros(3))
    convex, concave = (plotter.parts[number][0] - [0, 0, 0.002] for number in (2, 4))  # the curve is lifted
    np.testing.assert_allclose(convex, [[0, 0, 0.3], [1 / 3, 0, 0.1], [5 / 12, 0, 0]], atol=1e-7)
    np.testing.assert_allclose(concave, [[5 / 12, 0, 0], [2 / 3, 0, 0.3], [1, 0, 0.1]], atol=1e-7)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "options", [{}, {"style": "min"}, {"style": "zebra"}, {"cut": True}, {"four_views": True}], ids=str
)
def test_combs_are_seen_in_every_picture(tmp_path, options):
    from PIL import Image

    path = solved(EQUAL, 1).draw(tmp_path / "a.png", combs=True, size=(600, 450), tolerance=0.02, **options)
    image = np.asarray(Image.open(path).convert("RGB")).astype(int)[: int(450 * 0.9)]
    plain = solved(EQUAL, 1).draw(tmp_path / "b.png", size=(600, 450), tolerance=0.02, **options)
    before = np.asarray(Image.open(plain).convert("RGB")).astype(int)[: int(450 * 0.9)]
    red, blue = ((lambda i, a=a: i[..., a] - np.delete(i, a, axis=2).max(axis=2)) for a in (0, 2))
    assert (red(image) > 60).sum() > 300
    if options.get("style") != "min":
        assert (blue(image) > 40).sum() > (blue(before) > 40).sum() + 30


@pytest.mark.slow
def test_the_command_line_draws_combs(tmp_path):
    from pas.cli import main

    project = str(solved(EQUAL, 1).save(tmp_path / "a.pas.json"))
    asked = (["--combs"], ["--curvature", project], ["--curvature", "gauss", "--combs"])
    for number, words in enumerate(asked):
        given = words if project in words else [project, *words]
        assert main(["render", *given, "-o", str(tmp_path / f"{number}.png"), "--tolerance", "0.05"]) == 0
    pictures = [(tmp_path / f"{number}.png").read_bytes() for number in range(len(asked))]
    assert len(set(pictures)) == len(asked)
    solved(EQUAL, 1).draw(tmp_path / "b.png", style="mean", tolerance=0.05)
    assert (tmp_path / "b.png").read_bytes() == pictures[1]


def test_known_parts_of_parametric_combs():
    torus = pas.torus(2, 1, angle=True)
    layer = scene_of(torus, Picture(combs=True)).layers[0]
    small = [comb for comb in layer.combs if np.allclose(comb.curvatures, 1)]
    assert len(small) == 3  # meridians; the others are circles about the axis
    assert len(layer.combs) == 6
    ball = pas.ellipsoid(2, 2, 2, angle=True)
    for comb in scene_of(ball, Picture(combs=True)).layers[0].combs:
        assert np.allclose(np.abs(comb.curvatures), 0.5)
        assert len(comb.points) > 50
