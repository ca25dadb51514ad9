"""Opens the studio in a browser without a window, uses it, and takes the pictures of README.md.

    python examples/studio/screenshots.py

Needs `pas[studio]`, playwright, and Chromium.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import sleep
from typing import Any

PICTURES = Path(__file__).parent / "pictures"
SOFTWARE = ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--no-sandbox"]
FINAL = "!!(globalThis.studio && studio.state.final?.seq === studio.state.seq)"
SMOOTH = "studio.view.still.hidden === false && studio.view.still.dataset.fine === 'true'"
PATIENCE, LOOK = 60.0, 0.05
"""Seconds to wait for a shape, and between looks."""


def until(page: Any, text: str) -> None:
    """Wait until something holds in the page."""
    for _ in range(int(PATIENCE / LOOK)):
        if page.evaluate(text):
            return
        sleep(LOOK)
    raise RuntimeError(f"the page says {page.inner_text('.message')!r}")


def start(page: Any, name: str) -> None:
    """Take a starting point from the gallery."""
    page.select_option("header select", name)
    until(page, FINAL)


def corner(page: Any) -> None:
    """The first view, in zebra stripes, with a point to drag."""
    page.click(".bar >> text=Zebra")
    page.click("text=Add point")
    until(page, FINAL)
    page.evaluate("document.querySelector('aside').scrollTop = 0")


def curvature(page: Any) -> None:
    """Gauss curvature of a node, cut open, in the dark."""
    page.emulate_media(color_scheme="dark")
    start(page, "Three pipes askew")
    page.click(".bar >> text=Gauss curvature")
    page.click(".bar >> text=Section")


def pieces(page: Any) -> None:
    """A node of six pipes with its cells, and where the surface passes from piece to piece."""
    page.click(".bar >> text=Section")
    page.click(".bar >> text=Mean curvature")
    page.click(".bar >> text=Cells")
    start(page, "Six-way node")


def refuted(page: Any) -> None:
    """What a surface looks like that is refuted: the place is marked, and a repair offered."""
    page.emulate_media(color_scheme="light")
    page.click(".bar >> text=Cells")
    page.click(".bar >> text=Shaded")
    start(page, "Corner of three pipes")
    page.evaluate(
        """studio.openDocument({ ...studio.state.doc, problem: { ...studio.state.doc.problem, order: 1, degree: 4,
        prove: false, guard: false, energy: { kind: "thin-plate" },
        points: { near: [["0.8", "0.8", "0.8"]], near_weight: "100000" } } }, true)"""
    )
    until(page, FINAL)
    page.evaluate("studio.view.aim([1, 0.3, 0.4])")


def combs(page: Any) -> None:
    """Curvature combs on an elbow, and the diagram of one curve."""
    start(page, "Elbow")
    page.click(".bar >> text=Combs")
    until(page, "studio.state.combs !== null")
    page.evaluate("document.querySelector('.diagram').scrollIntoView({ block: 'center' })")


def handles(page: Any) -> None:
    """A blend of a single cell with a handle in the picture, and its members' coefficients."""
    page.click(".bar >> text=Combs")
    start(page, "Elbow of one quartic")
    page.evaluate("studio.view.aim([-0.4, -1, 0.5])")
    page.click("text=Add handle")
    until(page, "studio.state.doc.problem.points?.handles?.length === 1")
    until(page, FINAL)
    page.focus(".mark.handle")
    for _ in range(6):
        page.keyboard.press("ArrowUp")
    until(page, f"!studio.state.before && {FINAL}")
    page.evaluate("document.querySelector('#c-problem-points-coefficients-0').scrollIntoView()")


def plate(page: Any) -> None:
    """A pipe out of a plate: the neighbour's clip is a cone, which ends both surfaces."""
    start(page, "Pipe out of a plate")
    page.click(".bar >> text=Zebra")
    page.evaluate("document.querySelector('aside').scrollTop = 0")


STEPS: dict[str, Callable[[Any], None]] = {
    "corner": corner,
    "curvature": curvature,
    "pieces": pieces,
    "refuted": refuted,
    "combs": combs,
    "handles": handles,
    "plate": plate,
}


def main(folder: Path = PICTURES, size: tuple[int, int] = (1150, 720)) -> list[Path]:
    """Take all pictures; returns their paths."""
    from playwright.sync_api import sync_playwright

    command = [sys.executable, "-m", "pas", "studio", "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    found = re.search(r"http\S+", server.stdout.readline())
    assert found is not None
    taken = []
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE)
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            page.goto(found[0])
            until(page, FINAL)
            for name, step in STEPS.items():
                step(page)
                until(page, SMOOTH)
                sleep(LOOK)
                taken.append(folder / f"{name}.png")
                page.screenshot(path=taken[-1])
            browser.close()
    finally:
        server.terminate()
        server.wait(20)
    return taken


if __name__ == "__main__":
    main()
