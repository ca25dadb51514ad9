"""A short walk through the studio in a browser: open, drag, see the verdicts, export; the rest of it is slow."""

from __future__ import annotations

import pytest
from test_studio_page import BROWSER, FINAL, Page, browser, context, page, studio

import pas

__all__ = ["Page", "browser", "context", "page", "studio"]

pytestmark = pytest.mark.skipif(BROWSER is None, reason="there is no browser")


def test_a_walk(page, tmp_path):
    assert page.proved and page.problem["name"] == "pipes"
    slider = page.page.locator("#c-problem-tension-s")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    page.page.mouse.move(box["x"] + box["width"] * 0.49, box["y"] + box["height"] / 2)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + box["width"] * 0.62, box["y"] + box["height"] / 2, steps=3)
    assert page.tells_one_state()
    page.page.mouse.up()
    page.until(FINAL)
    assert float(page.problem["tension"]) > 6 and page.proved and page.trouble == []
    with page.page.expect_download() as download:
        page.page.click("text=Export")
    download.value.save_as(tmp_path / "pipes.pas.json")
    kept = pas.load(tmp_path / "pipes.pas.json")
    assert kept.certificate.proved and kept.wishes.energy is not None
    page.page.click("text=Undo")
    page.until(FINAL)
    assert page.proved and page.page.locator(".lamps .proved").count() == len(kept.certificate.verdicts)
