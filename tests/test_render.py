"""Pictures: they show the surface, and stripes that break where continuity does."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas.render import offscreen


def pixels(path):
    from PIL import Image

    return np.asarray(Image.open(path).convert("RGB")).astype(int)


@pytest.mark.parametrize("style", list(pas.Style))
def test_pictures_show_something(tmp_path, style):
    path = pas.draw(solved(EQUAL, 1).surface, tmp_path / "a.png", style=style, size=(400, 300))
    image = pixels(path)
    assert image.shape == (300, 400, 3)
    saturated = (image.max(axis=2) - image.min(axis=2) > 60).mean()
    if style is pas.Style.ZEBRA:
        assert saturated < 0.01
        dark = image[150].max(axis=1) < 60
        assert np.count_nonzero(dark[1:] & ~dark[:-1]) >= 5  # stripes across the middle row
    else:
        assert 0.04 < saturated < 0.5
        assert 0.4 < (image.min(axis=2) > 215).mean() < 0.9  # the backdrop
    # the drawing is centred and fills the height
    corner = image[0, :, :].astype(int)
    rows = np.flatnonzero(np.abs(image - image[:, :1]).max(axis=(1, 2)) > 30)
    assert rows.min() < 0.15 * 300
    assert rows.max() > 0.85 * 300
    assert np.ptp(corner, axis=0).max() < 10


def test_missing_opengl_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(offscreen, "LIBRARIES", {"libnothing.so.9": "libnothing9"})
    with pytest.raises(pas.MissingLibraryError, match="apt-get install libnothing9"):
        pas.draw(solved(EQUAL, 1).surface, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_arguments_are_checked(tmp_path):
    surface = solved(EQUAL, 1).surface
    with pytest.raises(ValueError, match=r"must end in \.png"):
        pas.draw(surface, tmp_path / "a.gif")
    with pytest.raises(TypeError, match="style"):
        pas.draw(surface, tmp_path / "a.png", style="zebra")
