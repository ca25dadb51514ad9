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
    backdrop = (image.min(axis=2) > 215).mean()
    assert 0.3 < backdrop < 0.9
    saturated = (image.max(axis=2) - image.min(axis=2) > 60).mean()
    if style is pas.Style.ZEBRA:
        assert saturated < 0.01
        dark, bright = (image.max(axis=2) < 60).mean(), (image.min(axis=2) > 150).mean() - backdrop
        assert dark > 0.04
        assert bright >= -0.01
    else:
        assert saturated > 0.04


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
