"""Pictures: they show the surface, and stripes that break where continuity does."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas.exchange.picture_options import STYLES, Picture, Style
from pas.parametric.curves import Forms
from pas.render import plotting
from pas.render.parametric import BLEND_TINT, COLORS, TINTS
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
    with pytest.raises(ValueError, match=r"the suffix must be .png"):
        pas.draw(surface, tmp_path / "a.gif")
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


@pytest.mark.parametrize("style", list(pas.Style))
@pytest.mark.sampled(2)
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
        (inner, outer), found = (layers[0].mesh, layers[1].mesh), []
        for mesh in (inner, outer):
            on = mesh.parameters[:, 1] == 0
            found.append(dict(zip(mesh.parameters[on, 0].round(9), mesh.point_normals[on], strict=True)))
        common = sorted(set(found[0]) & set(found[1]))
        assert len(common) > 10
        gaps = [np.abs(found[0][t] - found[1][t]).max() for t in common]
        assert bool(max(gaps) < 1e-9) is smooth


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
