"""Styles of pictures: each is drawn, its numbers are those of known surfaces, a wrong one gets the same sentence."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import EQUAL, ROOT, solved
from test_kinds import SAMPLES, sample

import pas
from pas.cli import main
from pas.exchange.picture_options import STYLES, Picture
from pas.parametric.surface import Forms
from pas.piecewise import PiecewiseSurface
from pas.render.picture import plotted
from pas.render.piecewise import principal_curvatures
from pas.render.plotting import CONCAVE, CONVEX, FOOT, SIDE, add_comb_legend, hair_length, offscreen_pyvista, tips
from pas.render.scene import Coloring, Comb, Layer, scene_of
from pas.render.styles import LIGHTS, color_range, meeting_angles, point_areas, tunnel, unwrapped
from pas.shape import KINDS

CURVED = [name for name, kind in KINDS.items() if kind.curved]
OTHERS = [name for name in KINDS if name not in CURVED]
RNG = np.random.default_rng(3)


def alone(polynomial, lower, upper, contacts=()):
    """A surface of one polynomial in a box."""
    return PiecewiseSurface.from_polynomials(pas.SingleCell(lower, upper), list(contacts), 1, [polynomial])


def on_torus(number, big=20.0, small=5.0):
    """Points (N, 3) of a torus around the z axis, and its principal curvatures (N, 2), the larger first."""
    around, about = RNG.uniform(-np.pi, np.pi, (2, number))
    far = big + small * np.cos(about)
    points = np.stack([far * np.cos(around), far * np.sin(around), small * np.sin(about)], axis=1)
    return points, np.stack([np.full(number, 1 / small), np.cos(about) / far], axis=1)


def test_every_style_has_a_name_and_says_what_it_shows():
    for name, coloring in STYLES.items():
        assert isinstance(coloring, Coloring)
        assert coloring.name == name
        assert coloring.shows
        assert Picture(style=name).coloring is coloring
    for style in pas.Style:
        assert Picture(style=style).coloring is STYLES[style.value]


def test_the_package_names_all_of_its_styles():
    assert {style.value for style in pas.Style} == {
        name for name, c in STYLES.items() if type(c).__module__[:4] == "pas."
    }


@pytest.mark.parametrize("name", list(STYLES))
@pytest.mark.sampled(3)
def test_every_style_paints_every_layer(name):
    scene = scene_of(solved(EQUAL, 1), Picture(style=name, tolerance=0.05))
    paints, legend = STYLES[name].paint(scene)
    assert len(paints) == len(scene.layers) == 4
    assert bool(legend) or not STYLES[name].curved
    for paint, layer in zip(paints, scene.layers, strict=True):
        points, triangles, _ = layer.mesh.shading
        if paint.values is not None:
            assert paint.values.shape in ((len(points),), triangles.shape)
            assert np.isfinite(paint.values).all()


@pytest.mark.parametrize("kind", OTHERS)
@pytest.mark.parametrize("options", [{"style": "gauss"}, {"combs": True}], ids=["colours", "combs"])
@pytest.mark.sampled(6)
def test_what_has_no_curvature_says_so_before_it_is_meshed(kind, options, tmp_path, monkeypatch):
    shape = sample(kind)
    monkeypatch.setattr(type(shape), "mesh", lambda *_, **__: pytest.fail("it was meshed"))
    what = "combs" if "combs" in options else "colours"
    with pytest.raises(
        ValueError, match=f"curvature {what} exist for blends and surfaces, and this is an? {kind}; draw it in"
    ):
        shape.draw(tmp_path / "a.png", **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.sampled(3)
def test_every_kind_is_painted_in_every_style_or_says_why_not(kind):
    scenes = {}
    for name, coloring in STYLES.items():
        picture = Picture(style=name, tolerance=0.1)
        if coloring.curved and kind in OTHERS:
            with pytest.raises(ValueError, match="curvature colours exist for blends and surfaces"):
                scene_of(sample(kind), picture)
            continue
        scene = scenes.get(coloring.curved) or scene_of(sample(kind), picture)
        scenes[coloring.curved] = scene  # what it is made of depends on no more
        paints, _ = coloring.paint(scene)
        assert len(paints) == len(scene.layers) > 0
        assert (paints[0].values is None) is (name == "plain")


@pytest.mark.parametrize("kind", CURVED)
@pytest.mark.sampled(4)
def test_curvatures_are_known_where_a_kind_says_so(kind, tmp_path):
    scene = scene_of(sample(kind), Picture(style="mean", combs=True))
    first = scene.layers[0]
    principal = first.principal()
    assert principal.shape == (len(first.mesh.points), 2)
    assert np.isfinite(principal).all()
    assert (principal[:, 0] >= principal[:, 1]).all()
    assert first.combs
    for comb in first.combs:
        np.testing.assert_allclose(np.linalg.norm(comb.normals, axis=1), 1)
        near = np.linalg.norm(first.mesh.points[None] - comb.points[:, None], axis=2).argmin(axis=1)
        assert ((first.mesh.point_normals[near] * comb.normals).sum(axis=1) > 0.5).all()  # on the side of the colours
        low, high = principal[near].min() - 0.5, principal[near].max() + 0.5
        assert ((low < comb.curvatures) & (comb.curvatures < high)).all()
    assert set(SAMPLES) == set(KINDS)


@pytest.mark.parametrize("kind", ["generatrix blend", "sphere blend", "parametric surface", "rational patch"])
@pytest.mark.sampled(2)
def test_meshes_without_parameters_have_no_curvature(kind, tmp_path):
    """Those of other grids or of files: refused, and not given the curvatures of other points."""
    mesh = replace(sample(kind).mesh(0.1), parameters=None)
    with pytest.raises(ValueError, match="does not say the parameters of its points"):
        pas.draw(sample(kind), tmp_path / "a.png", mesh=mesh, style="mean")
    assert pas.draw(sample(kind), tmp_path / "a.png", mesh=mesh, combs=True, size=(80, 60)).exists()


def test_curvatures_of_a_torus_are_exact_in_the_users_units():
    torus = alone("(x^2 + y^2 + z^2 + 400 - 25)^2 - 1600*(x^2 + y^2)", (-30, -30, -30), (30, 30, 30))
    points, known = on_torus(200)
    np.testing.assert_allclose(principal_curvatures(torus, points), known, atol=1e-10)
    formula = pas.torus(20, 5, angle=True)
    places = RNG.uniform(-3, 3, (50, 2))
    forms = Forms.at(formula, places)
    far = np.linalg.norm(formula(places)[:, :2], axis=1)
    outward = formula(places) * (1 - 20 / far[:, None] * np.array([1, 1, 0]))
    found = forms.principal_for(outward)
    np.testing.assert_allclose(found, np.stack([np.full(50, 1 / 5), (far - 20) / 5 / far], axis=1), atol=1e-12)
    np.testing.assert_allclose(forms.principal_for(-outward), -found[:, ::-1])


def test_numbers_of_a_style_are_those_of_its_name():
    torus = alone("(x^2 + y^2 + z^2 + 400 - 25)^2 - 1600*(x^2 + y^2)", (-30, -30, -30), (30, 30, 30))
    for name, measure in {
        "mean": lambda k: k.mean(axis=1),
        "curvature": lambda k: k.mean(axis=1),
        "gauss": lambda k: k[:, 0] * k[:, 1],
        "max": lambda k: k.max(axis=1),
        "min": lambda k: k.min(axis=1),
    }.items():
        scene = scene_of(torus, Picture(style=name, tolerance=3))
        mesh = scene.layers[0].mesh
        far = np.linalg.norm(mesh.points[:, :2], axis=1)
        known = measure(np.stack([np.full(len(far), 1 / 5), (far - 20) / 5 / far], axis=1))
        (paint,), legend = STYLES[name].paint(scene)
        np.testing.assert_allclose(paint.values, known[mesh.shading_points], atol=1e-9)
        assert legend.lines[0] == ("in 1/length^2" if name == "gauss" else "in 1/length")
        assert legend.lines[1:] == (f"least {known.min():.3g}", f"most {known.max():.3g}")


def test_curvatures_of_blends_are_in_units_of_the_thinnest_neighbour():
    blend = pas.blend([pas.Pipe(axis, 10 * np.array(r), 30) for axis, r in PIPES], 2, energy=pas.ThinPlate())
    scene = scene_of(blend, Picture(style="max", tolerance=2))
    assert scene.layers[0].unit == pytest.approx(1 / 5)
    paints, legend = STYLES["max"].paint(scene)
    rim = scene.layers[0].mesh.boundary
    assert sorted(set(paints[0].values[rim].round(6))) == pytest.approx([5 / 7, 5 / 6, 1])
    assert legend.lines[:2] == ("1: curvature of the", "thinnest neighbour")
    assert STYLES["gauss"].paint(scene)[1].lines[:2] == ("1: curvature^2 of the", "thinnest neighbour")


def test_colours_say_where_the_sign_changes():
    """On a hyperboloid of one sheet the larger curvature is positive, the smaller one and Gauss's negative."""
    sheet = alone("x^2 + y^2 - z^2/4 - 1", (-2, -2, -1), (2, 2, 1))
    scene = scene_of(sheet, Picture(style="max", tolerance=0.1))
    found = {}
    for name in ("max", "min", "gauss", "mean"):
        (paint,), legend = STYLES[name].paint(scene)
        found[name] = legend.cmap
        assert paint.options["cmap"] == legend.cmap and tuple(paint.options["clim"]) == legend.limits
    assert found == {"max": "YlOrRd", "min": "YlOrRd_r", "gauss": "YlOrRd_r", "mean": "YlOrRd"}
    torus = alone("(x^2 + y^2 + z^2 + 400 - 25)^2 - 1600*(x^2 + y^2)", (-30, -30, -30), (30, 30, 30))
    assert STYLES["gauss"].paint(scene_of(torus, Picture(style="gauss", tolerance=3)))[1].cmap == "coolwarm"


PIPES = (((1, 0, 0), 0.5), ((0, 1, 0), 0.6), ((0, 0, 1), 0.7))


def test_ranges_of_colours_leave_out_what_is_extreme():
    areas = np.ones(1000)
    values = np.linspace(-1, 2, 1000)
    low, high = color_range(np.concatenate([values, [1e6]]), np.ones(1001))
    assert -low == high == pytest.approx(1.94, abs=0.01)
    assert color_range(values + 1.5, areas) == pytest.approx((0.56, 3.44), abs=0.01)
    assert color_range(-values - 1.5, areas) == pytest.approx((-3.44, -0.56), abs=0.01)
    assert color_range(np.where(values > 1.99, values, np.nan), areas)[0] > 1.9
    few = np.concatenate([np.full(50, -0.005), np.linspace(0, 1, 950)])  # below 0 by less than counts
    assert color_range(few, areas) == pytest.approx((0, 0.98), abs=0.01)
    assert color_range(-few, areas) == pytest.approx((-0.98, 0), abs=0.01)
    weighted = np.where(values > 1.9, 1e-6, 1.0)  # a small place does not count
    assert color_range(values, weighted)[1] < 1.9
    constant = color_range(np.full(1000, 0.5) + 1e-9 * values, areas)
    assert constant == pytest.approx((0.495, 0.505))
    assert color_range(np.zeros(9), np.ones(9)) == color_range(np.full(9, np.nan), np.ones(9)) == (-1, 1)


def test_areas_of_points_sum_to_that_of_the_mesh():
    mesh = solved(EQUAL, 1).mesh(0.05)
    assert point_areas(mesh).sum() == pytest.approx(mesh.area)


def test_highlight_lines_are_where_normals_meet_lights():
    """Beier and Chen's distance from the light line at the angle found is zero, and the light is outside."""
    points, normals = RNG.normal(size=(300, 3)), RNG.normal(size=(300, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    axes, center, radius = tunnel(points, np.eye(3))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    angles = meeting_angles(points, normals, axes, center, radius)
    lights = center + radius * (np.cos(angles)[:, None] * axes[0] + np.sin(angles)[:, None] * axes[1])
    across = np.cross(axes[2], normals)
    across /= np.linalg.norm(across, axis=1)[:, None]
    np.testing.assert_allclose((across * (lights - points)).sum(axis=1), 0, atol=1e-9)
    inward = np.cross(across, axes[2])
    assert (np.abs((inward * (lights - points)).sum(axis=1)) > 0).all()
    assert ((lights - points - ((lights - points) @ axes[2])[:, None] * axes[2]) * normals).sum(axis=1).min() > 0


def test_no_triangle_of_highlights_spans_the_jump_of_angles():
    angles = RNG.uniform(-np.pi, np.pi, (500, 3))
    found = unwrapped(angles)
    assert np.allclose(np.mod(found - angles, 2 * np.pi) % (2 * np.pi - 1e-12), 0, atol=1e-9)
    close = np.pi + RNG.uniform(-0.4, 0.4, (500, 3))
    wrapped = np.mod(close + np.pi, 2 * np.pi) - np.pi
    assert np.ptp(unwrapped(wrapped), axis=1).max() < 0.8
    assert LIGHTS % 2 == 0  # so that the bands over three half turns are whole


def test_stripes_turn_with_the_frame():
    normals, turn = RNG.normal(size=(50, 3)), np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    values = []
    for frame in (np.eye(3), turn):
        layer = SimpleNamespace(mesh=SimpleNamespace(shading=(None, None, normals @ frame)), tint="white")
        values.append(STYLES["zebra"].paint(SimpleNamespace(frame=frame, layers=[layer]))[0][0].values)
    np.testing.assert_allclose(values[0], values[1], atol=1e-12)
    assert np.ptp(values[0]) > 0.5


def test_highlights_are_as_many_as_lights_and_the_same_after_a_turn():
    scene = scene_of(solved(EQUAL, 1), Picture(style="highlights", tolerance=0.005))
    for paint in STYLES["highlights"].paint(scene)[0]:
        low, high = paint.options["clim"]
        assert low <= paint.values.min() < paint.values.max() <= high
        assert (np.ptp(paint.values, axis=1) > np.pi).mean() < 5e-3  # but for a few where the lines meet
        angles = np.linspace(-np.pi, np.pi, 10_000, endpoint=False) + 1e-5
        first, second = (paint.options["cmap"]((a - low) / (high - low)) for a in (angles, angles + 2 * np.pi))
        here = angles < 0  # after that another turn would be beyond the colours
        np.testing.assert_array_equal(first[here], second[here])
        bright = (first[:, :3] == 1).all(axis=1)
        assert (bright & ~np.roll(bright, 1)).sum() == LIGHTS


@pytest.mark.parametrize("options", [{"style": "mean"}, {"combs": True}, {"style": "min", "combs": True}], ids=str)
@pytest.mark.parametrize(
    ("view", "size"), [(None, (400, 300)), ((-1, 1, -0.4), (400, 300)), ((0, 0, 1), (400, 300)), (None, (300, 400))]
)
@pytest.mark.sampled(3)
def test_legends_have_room_of_their_own(options, view, size):
    picture = Picture(**options, view=view, size=size, tolerance=0.05)
    scene = scene_of(solved(EQUAL, 1), picture)
    plotter = plotted(offscreen_pyvista(), scene, picture, off_screen=True)
    plotter.render()
    places = []
    for layer in scene.layers:
        for point in np.concatenate([layer.mesh.points[::7], tips(layer, hair_length(scene.layers))]):
            plotter.renderer.SetWorldPoint(*point, 1)
            plotter.renderer.WorldToView()
            places.append(plotter.renderer.GetViewPoint()[:2])
    plotter.close()
    across, up = ((1 + np.array(places)) / 2).T
    assert 0 < across.min() < across.max() < 1 - (SIDE if "style" in options else 0)
    assert (FOOT if "combs" in options else 0) < up.min() < up.max() < 1
    assert max(np.ptp(across), np.ptp(up)) > 0.5  # and it is not small


class Words:
    """A plotter that keeps what is written in it, with its colour."""

    def __init__(self):
        self.written = {}

    def add_text(self, text, position, viewport, color):
        self.written[text] = color
        return SimpleNamespace(GetTextProperty=lambda: SimpleNamespace(SetFontSize=lambda size: None))


@pytest.mark.parametrize(("unit", "longest"), [(None, "4 in 1/length"), (2.0, "2 of the thinnest neighbour")])
def test_the_line_below_combs_names_the_longest_and_the_colours(unit, longest):
    combs = [Comb(np.zeros((2, 3)), np.zeros((2, 3)), np.array(bent)) for bent in ([1.0, -4.0], [3.0, 2.0])]
    plotter = Words()
    add_comb_legend(plotter, [Layer(None, "#ffffff", combs=combs, unit=unit)], 1200)
    colors = {text: color for text, color in plotter.written.items() if text in ("convex", "concave")}
    assert colors == {"convex": CONVEX, "concave": CONCAVE}
    assert f"hairs: normal curvature; the longest: {longest}" in plotter.written


SENTENCE = "there is no style of pictures 'meen'; is 'mean' meant?"


def test_a_wrong_style_gets_the_same_sentence_everywhere(tmp_path, capsys):
    with pytest.raises(ValueError, match="style") as wrong:
        solved(EQUAL, 1).draw(tmp_path / "a.png", style="meen")
    assert str(wrong.value) == SENTENCE
    project = str(solved(EQUAL, 1).save(tmp_path / "a.pas.json"))
    for words in (["--style", "meen"], ["--curvature", "meen"], ["--curvature=meen"]):
        assert main(["render", project, "-o", str(tmp_path / "a.png"), *words]) == 2
        assert capsys.readouterr().err == f"pas: {SENTENCE}\n"
    problem = tmp_path / "a.toml"
    problem.write_text((ROOT / "examples/corners/equal_gc1.toml").read_text() + '\n[picture]\nstyle = "meen"\n')
    with pytest.raises(pas.ProblemFileError, match=r"line \d+: there is no style") as wrong:
        pas.read_problem(problem)
    assert str(wrong.value).endswith(SENTENCE)
    assert main(["render", project, "-o", str(tmp_path / "a.png"), "--curvature", "zebra"]) == 2
    assert "--curvature shows mean, gauss, max or min, not zebra" in capsys.readouterr().err
    for options in ({"style": None}, {"combs": 1}):
        with pytest.raises(TypeError, match=next(iter(options))):
            pas.draw(solved(EQUAL, 1), tmp_path / "a.png", **options)


def test_a_problem_file_says_how_it_is_drawn(tmp_path, capsys):
    text = "degree = 3\n" + (ROOT / "examples/corners/equal_gc1.toml").read_text()
    problem = tmp_path / "a.toml"
    problem.write_text(text + '\n[picture]\nstyle = "max"\ncombs = true\nsize = [80, 60]\n')
    found = pas.read_problem(problem)
    assert (found.picture.name, found.picture.combs) == ("max", True)
    assert main(["blend", str(problem), "-o", str(tmp_path / "out"), "--tolerance", "0.05"]) == 0
    assert (tmp_path / "out" / "equal_gc1.png").exists() or (tmp_path / "out" / "a.png").exists()
    problem.write_text(text + "\n[picture]\ncombs = 1\n")
    with pytest.raises(pas.ProblemFileError, match="combs must be true or false, not 1"):
        pas.read_problem(problem)
