"""Pictures: they show the surface, and stripes that break where continuity does."""

from __future__ import annotations

from unittest.mock import MagicMock

import numpy as np
import pytest
from conftest import EQUAL, ROOT, solved

import pas
from pas import solid
from pas.cli import main
from pas.exchange.picture_options import STYLES, VIEWS, Picture, Style
from pas.parametric.surface import Forms
from pas.render import drawing, plotting
from pas.render.parametric import ALONG, BLEND_TINT, COLORS, TINTS
from pas.render.scene import BLEND_COLOR, scene_of


def pixels(path):
    from PIL import Image

    return np.asarray(Image.open(path).convert("RGB")).astype(int)


@pytest.mark.parametrize("style", list(pas.Style))
@pytest.mark.sampled(3)
def test_pictures_show_something(tmp_path, style):
    path = pas.draw(solved(EQUAL, 1).surface, tmp_path / "a.png", style=style, size=(400, 300), tolerance=5e-3)
    image = pixels(path)
    assert image.shape == (300, 400, 3)
    saturated = (image.max(axis=2) - image.min(axis=2) > 60).mean()
    if style is pas.Style.ZEBRA:
        assert saturated < 0.01
        assert starts(image[150].max(axis=1) < 60) >= 5  # stripes across the middle row
    elif style is pas.Style.HIGHLIGHTS:
        assert max(starts(row.min(axis=1) > 190) for row in image) >= 5  # bright lines across some row
    else:
        assert (0.02 if STYLES[style.value].curved else 0.04) < saturated < 0.5
        assert 0.4 < (image.min(axis=2) > 215).mean() < 0.9  # the backdrop
    corner = image[0, :, :].astype(int)
    assert np.ptp(corner, axis=0).max() < 10
    # the drawing is centred and fills the height, or the width that a legend leaves
    drawn = np.abs(image - image[:, :1]).max(axis=2) > 30
    rows, columns = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    if STYLES[style.value].curved:
        assert columns.max() > 0.8 * 400
        assert rows.min() < 0.2 * 300
    else:
        assert rows.min() < 0.15 * 300
        assert rows.max() > 0.85 * 300


def starts(there):
    """How often a row of truth values becomes true."""
    return np.count_nonzero(there[1:] & ~there[:-1])


def test_missing_opengl_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(plotting, "LIBRARIES", {"libnothing.so.9": "libnothing9"})
    with pytest.raises(pas.MissingLibraryError, match="apt-get install libnothing9"):
        pas.draw(solved(EQUAL, 1).surface, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_arguments_are_checked(tmp_path):
    surface = solved(EQUAL, 1).surface
    with pytest.raises(ValueError, match=r"the suffix must be one of .png, .gif"):
        pas.draw(surface, tmp_path / "a.jpg")
    with pytest.raises(TypeError, match="style"):
        pas.draw(surface, tmp_path / "a.png", style=3)


RING = pas.ParametricSurface("cos(t)", "sin(t)", "h - 1")
WIDE = pas.ParametricSurface("2*cos(t)", "2*sin(t)", "h + 1")
BLEND = pas.hermite_blend(pas.BlendingData([RING, WIDE]), 1)
TURN = ((-np.pi, np.pi), None)


def near(image, color):
    """The share of pixels of a hue, in light or shadow."""
    target = np.array([int(color[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    scaled = image / np.maximum(image.max(axis=2, keepdims=True), 1)
    return (np.abs(scaled - target / target.max()).max(axis=2) < 0.12).mean()


@pytest.mark.sampled(6)
@pytest.mark.parametrize("style", list(pas.Style))
def test_parametric_blends_are_drawn_with_their_surfaces(tmp_path, style):
    image = pixels(pas.draw(BLEND, tmp_path / "a.png", style=style, size=(400, 300), domain=TURN))
    rows = np.flatnonzero(np.abs(image - image[:, :1]).max(axis=(1, 2)) > 30)
    assert rows.min() < 0.2 * 300
    assert rows.max() > 0.8 * 300
    if STYLES[style.value].curved:
        assert all(near(image, color) < 0.03 for color in COLORS[:2])  # the neighbours are faint
        assert near(image, BLEND_COLOR) < 0.05
    elif style is pas.Style.ZEBRA:
        assert (image.max(axis=2) < 40).mean() > 0.05
        assert near(image, BLEND_TINT) > 0.02
        assert near(image, TINTS[1]) > 0.01
    else:
        for color in COLORS[:2]:
            assert near(image, color) > 0.006
        assert near(image, COLORS[2]) < 0.002
        assert near(image, BLEND_COLOR) > 0.05


def test_stripes_run_on_across_contacts_and_break_without():
    """Normals of the blend and of the surface beyond are those of one smooth surface along the curve."""
    for order, smooth in ((0, False), (1, True)):
        blend = pas.hermite_blend(BLEND.data, order)
        layers = scene_of(blend, Picture(style=Style.ZEBRA, domain=TURN)).layers
        beyond = layers[1].mesh
        t = np.linspace(*TURN[0], ALONG)
        own, there = blend.surface(np.stack([t, 0 * t], axis=1)), beyond.points.reshape(ALONG, -1, 3)[:, 0]
        assert np.abs(own - there).max() < 1e-9
        normals = blend.surface.normals(np.stack([t, 0 * t], axis=1))
        gaps = np.abs(normals - beyond.point_normals.reshape(ALONG, -1, 3)[:, 0])
        assert bool(gaps.max() < 1e-9) is smooth


def test_surfaces_beyond_end_where_they_are_singular():
    """The normal of one of the two surfaces vanishes on its curve, where its strip stays."""
    blend = pas.read_problem(ROOT / "examples/parametric/example_1.toml").solve()
    first, *beyond = scene_of(blend, Picture()).layers
    assert len(beyond) == 2
    for layer in beyond:
        assert np.ptp(layer.mesh.points, axis=0).max() < 1.5 * np.ptp(first.mesh.points, axis=0).max()


def mean_curvatures(surface, parameters):
    return Forms.at(surface, parameters).principal.mean(axis=1)


def test_mean_curvature_of_known_surfaces():
    points = np.random.default_rng(1).uniform(-1, 1, (20, 2))
    sphere = pas.ellipsoid(2, 2, 2, angle=True)
    assert np.allclose(np.abs(mean_curvatures(sphere, points)), 0.5)
    assert np.allclose(mean_curvatures(pas.helicoid(3), points), 0)
    assert np.allclose(np.abs(mean_curvatures(pas.elliptic_cylinder(4, 4), points)), 0.125)
    assert np.isnan(mean_curvatures(pas.elliptic_cone(), np.array([[0.5, 0.0]]))).all()


def test_several_surfaces_are_drawn_and_others_refused(tmp_path):
    shapes = [pas.torus(2, 1, angle=True), pas.ellipsoid(angle=True)]
    image = pixels(pas.draw(shapes, tmp_path / "a.png", size=(400, 300), view=(0, -1, 2)))
    assert all(near(image, color) > 0.01 for color in COLORS[:2])
    with pytest.raises(ValueError, match="domain of t is infinite"):
        pas.draw(pas.plane(), tmp_path / "b.png")
    with pytest.raises(ValueError, match="at least one surface"):
        pas.draw([], tmp_path / "b.png")
    with pytest.raises(TypeError, match="what to draw must be a mesh, a solid, an assembly, a surface or a blend"):
        pas.draw("torus", tmp_path / "b.png")
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]


PLATE = solid.box((0, 0, 0), (40, 30, 6), face="plate") - solid.cylinder((10, 10, -1), (10, 10, 7), 4, face="hole")
MESH = PLATE.mesh()
SMALL = {"mesh": MESH, "size": (200, 150)}


def plate(path, **options):
    return pixels(pas.draw(PLATE, path / "a.png", **SMALL | options))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("view", list(VIEWS))
def test_named_views_look_from_where_they_say(tmp_path, view):
    """The face that is turned to the camera is seen, and the one on the other side is not."""
    names = {"front": "y-", "back": "y+", "left": "x-", "right": "x+", "top": "z+", "bottom": "z-", "iso": "z+"}
    image = plate(tmp_path, view=view, parallel=True, colors={f"plate {names[view]}": "red", "*": "blue"})
    opposite = names[view].translate(str.maketrans("+-", "-+"))
    assert near(image, "#ff0000") > 0.05
    assert near(plate(tmp_path, view=view, colors={f"plate {opposite}": "red", "*": "blue"}), "#ff0000") == 0


@pytest.mark.parametrize(("view", "sides"), [("front", (40, 6)), ("right", (30, 6)), ("top", (40, 30))])
def test_parallel_projection_keeps_proportions(tmp_path, view, sides):
    image = plate(tmp_path, view=view, parallel=True)
    there = np.abs(image - image[:, :1]).max(axis=2) > 40
    wide, high = there.any(axis=0).sum(), there.any(axis=1).sum()
    assert wide / high == pytest.approx(sides[0] / sides[1], rel=0.06)


def test_no_side_is_dark(tmp_path):
    """From below and from behind a face has at least two thirds of the brightness that it has from above."""
    for view in ("bottom", "back", "left", (-1, -1, -1), (1, 1, -0.6), (0.3, -1, -0.4)):
        image = plate(tmp_path, view=view, colors="white", occlusion=False)
        low = np.percentile(image.max(axis=2), 3)  # but for edges
        assert low > 0.6 * 255


def test_transparent_pictures_have_no_background(tmp_path):
    from PIL import Image

    for transparent in (False, True):
        path = pas.draw(PLATE, tmp_path / "a.png", view="top", transparent=transparent, **SMALL)
        alpha = np.asarray(Image.open(path).convert("RGBA"))[..., 3]
        assert alpha[75, 100] == 255
        assert alpha[0, 0] == (0 if transparent else 255)


def test_edges_are_drawn_whole(tmp_path):
    """Around the hole there is a dark pixel in every direction."""
    image = plate(tmp_path, view="top", parallel=True, size=(400, 300))
    per_unit = (np.abs(image - image[:, :1]).max(axis=2) > 40).any(axis=0).sum() / 40
    angles = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    around = np.arange(-3, 4)[:, None] + 4 * per_unit
    x = np.rint(200 + (10 - 20) * per_unit + around * np.cos(angles)).astype(int)
    y = np.rint(150 - (10 - 15) * per_unit - around * np.sin(angles)).astype(int)
    assert (image[y, x].max(axis=2).min(axis=0) < 225).all()


def test_cuts_are_closed_and_keep_colours(tmp_path):
    colors = {"hole": "red", "*": "blue"}
    assert near(plate(tmp_path, view="front", colors=colors), "#ff0000") == 0
    image = plate(tmp_path, view="front", colors=colors, cut=(0, -2, 1))
    assert near(image, "#ff0000") > 5 / 30_000
    assert near(image, BLEND_COLOR) > 0.05  # the section, of faces of several colours
    block = plate(tmp_path, view="left", cut="left", colors="#0000ff", parallel=True)
    assert near(block, BLEND_COLOR) == 0 and near(block, "#0000ff") > 0.1  # all of it is section


class Words:
    """A plotter that keeps the words, and forgets the rest."""

    def __init__(self):
        self.words = []

    def add_point_labels(self, places, words, **style):
        self.words += words

    def __getattr__(self, name):
        return lambda *_, **__: MagicMock()


@pytest.mark.parametrize(
    ("towards", "words"), [((1, -1, 1), ["40", "30", "6"]), ((0, 0, 1), ["40", "30"]), ((1, 0, 0), ["30", "6"])]
)
def test_dimensions_are_those_of_the_box(towards, words):
    plotter = Words()
    room = plotting.add_dimensions(plotter, MESH.points, np.array(towards) / np.linalg.norm(towards), 1200)
    assert plotter.words == words
    ends = room[: 2 * len(words)]
    assert np.linalg.norm(ends[::2] - ends[1::2], axis=1) == pytest.approx(list(map(float, words)))
    assert not ((ends >= MESH.box[0]) & (ends <= MESH.box[1])).all(axis=1).any()


def test_labels_name_what_is_seen():
    layers = scene_of(PLATE, Picture(), MESH).layers
    for towards, plane, words in (
        ((0, 0, 1), None, {"plate z+"}),
        ((0, -1, 0), None, {"plate y-"}),
        ((0, 0, 1), (np.array([0, 0, 1.0]), np.array([0, 0, 3.0])), set()),  # the section has no name
        ((0, -1, 0), (np.array([0, -1.0, 0]), np.array([0, 10.0, 0])), {"hole"}),
    ):
        plotter = Words()
        plotting.add_labels(plotter, layers, np.zeros((1, 3)), plane, np.array(towards, dtype=float), 1200)
        assert set(plotter.words) == words
    parts = scene_of(solid.assembly(shell=PLATE, pin=solid.ball((20, 15, 3), 1)), Picture()).layers
    plotter = Words()
    plotting.add_labels(plotter, parts, np.zeros((2, 3)), None, np.array([0.0, 0.0, 1.0]), 1200)
    assert plotter.words == ["shell"]  # in which the other is hidden
    parts = scene_of(solid.assembly(low=PLATE, high=solid.ball((21, 15, 9), 7)), Picture()).layers
    plotter = Words()
    plotting.add_labels(plotter, parts, np.zeros((2, 3)), None, np.array([0.0, 0.0, 1.0]), 1200)
    assert plotter.words == ["low", "high"]  # beside what hides the middle of it


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"view": "frnot"}, "there is no view 'frnot'; is 'front' meant?"),
        ({"view": "xyz"}, "there is no view 'xyz'; there are front, back, left, right, top, bottom, iso"),
        ({"cut": "botom"}, "there is no cut 'botom'; is 'bottom' meant?"),
        ({"view": "0,0,0"}, "view must not be the zero vector"),
        ({"size": "big"}, "size must be width and height in pixels, as in 1200x900, not 'big'"),
        ({"size": "800x0"}, r"size\[1\] must be .*not 0"),
        ({"size": "800xa"}, r"size\[1\] must be .*not 'a'"),
        ({"colors": "gren"}, "'gren' is no colour; is 'green' meant?"),
        ({"colors": {"plate": "#12"}}, "'#12' is no colour, which is a CSS name or #rrggbb"),
        ({"colors": {"plate z": "red"}}, "there is no part or face 'plate z'; is 'plate z-' meant?"),
        ({"colors": "red", "style": "zebra"}, "colors are those of the style plain; the style zebra has its own"),
        ({"parallel": 1}, "parallel must be True or False, not 1"),
    ],
    ids=str,
)
def test_wrong_options_get_a_sentence(tmp_path, options, sentence):
    with pytest.raises((ValueError, TypeError), match=f"^{sentence}"):
        pas.draw(PLATE, tmp_path / "a.png", **{"mesh": MESH, "size": (40, 30), **options})
    assert not list(tmp_path.iterdir())


def test_the_command_line_has_the_same_options(tmp_path, capsys):
    project = str(PLATE.save(tmp_path / "a.pas.json"))
    plate = pas.load(project)
    words = ["--size", "80x60", "--view", "iso", "--parallel", "--transparent", "--colors", "plate*=red,hole=#00ff00"]
    for more, options in (([], {}), (["--cut"], {"cut": True}), (["--cut", "top"], {"cut": "top"})):
        assert main(["render", project, "-o", str(tmp_path / "b.png"), *words, *more]) == 0
        colors = {"plate*": "red", "hole": "#00ff00"}
        options |= {"size": (80, 60), "view": "iso", "parallel": True, "transparent": True, "colors": colors}
        pas.draw(plate, tmp_path / "c.png", **options)
        assert (tmp_path / "b.png").read_bytes() == (tmp_path / "c.png").read_bytes()
    assert main(["render", project, "-o", str(tmp_path / "d.png"), "--view", "lft"]) == 2
    assert capsys.readouterr().err.endswith("there is no view 'lft'; is 'left' meant?\n")


def test_a_turntable_turns_once_before_a_camera_that_stays(tmp_path, monkeypatch):
    from PIL import Image

    monkeypatch.setattr(drawing, "TURNTABLE", 8)
    post = solid.box((-1, -2, -3), (1, 2, 3))
    path = pas.draw(post, tmp_path / "a.gif", size=(80, 60), parallel=True)
    with Image.open(path) as frames:
        assert frames.n_frames == 8
        wide, high = [], []
        for number in range(8):
            frames.seek(number)
            image = np.asarray(frames.convert("RGB")).astype(int)
            there = np.abs(image - image[:, :1]).max(axis=2) > 40
            wide.append(int(there.any(axis=0).sum()))
            high.append(int(there.any(axis=1).sum()))
    assert wide[:4] == pytest.approx(wide[4:], abs=1)
    assert max(wide) / min(wide) > 1.2
    assert max(high) < 1.3 * min(high)
