"""The studio, measured in a browser without a window: slider to picture, what the server takes of it, and accuracy.

    python benchmarks/studio.py [--moves N] [--degrees N ...]

Times are of one run; on a machine that is shared they say little, and the share of the server is CPU time.
"""

from __future__ import annotations

import argparse
import base64
import re
import shutil
import subprocess
import sys
from os import getloadavg
from pathlib import Path
from time import perf_counter, sleep

import numpy as np

import pas
from pas.studio import GALLERY
from pas.studio.server import PAGE

SOFTWARE = ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--no-sandbox"]
AXES, RADII = ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ("1/3", "1/4", "2/5")
PIPES = [{"axis": list(a), "radius": r, "clip": 1} for a, r in zip(AXES, RADII, strict=True)]
CASES = ((1, 4), (2, 5), (2, 6), (3, 7), (3, 8))
"""Orders and degrees of the corner."""

VIEWS = ((0.62, -0.62, 0.48), (1, 1, 1), (1, 0, 0.001), (1, 0, -1), (1, 2, 0.05), (-0.3, 0.8, 0.1))
FINAL = "!!(globalThis.studio && studio.state.final?.seq === studio.state.seq)"
MOVES = """async ([n, path, middle]) => { const s = studio.state, v = studio.view, out = [];
  for (let i = 0; i < n; i++) { const began = performance.now();
    studio.act.move(path, (middle * (1 + 0.4 * Math.sin(i * 0.1))).toFixed(4));
  do await new Promise(requestAnimationFrame); while (s.shown < s.seq || v.drawn < s.came);
  out.push([v.drawn - began, s.came - began, v.spent, s.spent]); } return out; }"""
"""It waits from frame to frame: a page that looks without a pause takes a core from those that it waits for."""

RESTS = """async (n) => { const s = studio.state, out = [], wait = () => new Promise((r) => setTimeout(r, 2));
  for (let i = 0; i < n; i++) {
    const began = performance.now(), before = s.judged;
    studio.act.move(["problem", "tension"], (5 + 0.3 * i).toFixed(2));
    while (s.judged === before) await wait();
    const lit = performance.now(); studio.act.commit();
    while (s.final?.seq !== s.seq) await wait();
    out.push([lit - began, performance.now() - lit]); } return out; }"""
RELEASES = """async (n) => { const s = studio.state, v = studio.view, out = [];
  for (let i = 0; i < n; i++) {
    studio.act.move(["problem", "tension"], (6.1 + 0.3 * i).toFixed(2));
    do await new Promise(requestAnimationFrame); while (s.shown < s.seq || v.drawn < s.came);
    const began = performance.now(); studio.act.commit();
    while (s.final?.seq !== s.seq) await new Promise((r) => setTimeout(r, 2));
    out.push(performance.now() - began); } return out; }"""
PROBE = """([towards, w, h]) => { const n = Math.hypot(...towards), v = studio.view;
  v.camera.towards = towards.map((x) => x / n);
  const a = new Uint8Array(v.caster.probe(v.camera, v.look, w, h).buffer); let s = "";
  for (let i = 0; i < a.length; i += 32768) s += String.fromCharCode(...a.subarray(i, i + 32768));
  return [btoa(s), v.camera.frame(w / h), studio.state.scene.origin, studio.state.scene.scale]; }"""


def final(page) -> None:
    """Wait until what is seen is final."""
    for _ in range(1200):
        if page.evaluate(FINAL):
            return
        sleep(0.05)
    raise RuntimeError(f"nothing came: {page.inner_text('.message')}")


def opened(page, order: int, degree: int) -> None:
    """Show a corner of a degree."""
    problem = {"order": order, "degree": degree, "pipes": PIPES}
    page.evaluate("(problem) => studio.openDocument({ kind: 'problem', problem })", problem)
    final(page)
    sleep(1)


def accuracy(page, order: int, degree: int) -> None:
    """Every pixel of six views against rays in double precision."""
    contacts = [pas.Pipe(**p) for p in PIPES]
    surface = pas.blend(contacts, order, degree).surface
    rays = pas.Evaluator(surface)
    w, h, holes, extras, far, bent = 400, 300, 0, 0, [], []
    for view in VIEWS:
        text, f, origin, scale = page.evaluate(PROBE, [list(view), w, h])
        found = np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 4)
        x, y = ((np.arange(n) + 0.5) / n * 2 - 1 for n in (w, h))
        ahead, side, up, eye = (np.array(f[name]) for name in ("ahead", "side", "up", "eye"))
        ways = (ahead + f["across"] * x[None, :, None] * side + f["tan"] * y[:, None, None] * up).reshape(-1, 3)
        exact = rays.first(np.array(origin) + scale * eye, scale * ways)
        hit, there = found[:, 3] >= 0, np.isfinite(exact)
        hidden = (found[:, 3] < 0) & (found[:, 3] > -1e5) & (found[:, 0] < exact)
        both = hit & there
        holes, extras = holes + int((there & ~hidden & ~hit).sum()), extras + int((hit & ~there).sum())
        far.append(np.abs(found[:, 0] - exact)[both] * np.linalg.norm(ways[both], axis=1))
        true = surface.curvatures(np.array(origin) + scale * (eye + exact[both, None] * ways[both])) * [scale, scale**2]
        bent.append(np.abs(true - found[both, 1:3]) / np.percentile(np.abs(true), 98, axis=0))
    d, k = np.concatenate(far), np.concatenate(bent).ravel()
    print(
        f"degree {degree}: {len(d)} pixels, {holes} holes, {extras} extras; distance: median {np.median(d):.1e}, "
        f"99.9% {np.quantile(d, 0.999):.1e}, largest {d.max():.1e} ({(d > 1e-3).sum()} above 1e-3); curvatures over "
        f"their range: 99.9% {np.quantile(k, 0.999):.1e}, largest {k.max():.1e} ({(k > 1e-3).sum()} above 1e-3)",
        flush=True,
    )


def speed(page, degree: int, moves: int) -> None:
    """From a moved slider to the picture, at 400 x 300 and 800 x 600."""
    for width, height in ((400, 300), (800, 600)):
        page.set_viewport_size({"width": width + 350, "height": height})
        page.evaluate("studio.view.now()")
        sleep(0.5)
        rows = np.array(page.evaluate(MOVES, [moves, ["problem", "tension"], 4.6]))[2:]
        total, came, drawn, spent = rows.T
        print(
            f"load {getloadavg()[0]:.1f}; degree {degree}, {width} x {height}: slider to picture median "
            f"{np.median(total):.0f} ms, 99% {np.quantile(total, 0.99):.0f}, "
            f"least {total.min():.0f}; until it came {np.median(came):.0f}, of which "
            f"the step {np.median(spent):.0f}; drawn in {np.median(drawn):.0f}",
            flush=True,
        )
        page.evaluate("studio.act.commit()")
        final(page)
    lamps, whole = np.median(page.evaluate(RESTS, 6), axis=0) / 1000
    released = np.median(page.evaluate(RELEASES, 6)) / 1000
    print(
        f"degree {degree}: lamps of what is seen {lamps:.2f} s after a move; let go then, the fair shape with proofs "
        f"{whole:.2f} s after that; let go at once, after {released:.2f} s",
        flush=True,
    )


def generatrix(page, moves: int) -> None:
    """The same for a shape value of a blend by a generatrix, which the page draws by itself."""
    page.evaluate("(document) => studio.openDocument(document)", GALLERY["Round an obstacle"])
    final(page)
    sleep(1)
    rows = np.array(page.evaluate(MOVES, [moves, ["problem", "shape", "l1"], 2]))[2:]
    median, most = np.quantile(rows[:, 0], [0.5, 0.99])
    print(
        f"load {getloadavg()[0]:.1f}; generatrix, 800 x 600: slider to picture median {median:.0f} ms, 99% {most:.0f}"
    )


def main() -> None:
    """Measure all of it."""
    from playwright.sync_api import sync_playwright

    reader = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    reader.add_argument("--moves", type=int, default=200)
    reader.add_argument("--degrees", type=int, nargs="*", default=[degree for _, degree in CASES])
    options = reader.parse_args()
    sizes = {path.name: path.stat().st_size for path in sorted(PAGE.iterdir())}
    print(f"the page: {sum(sizes.values())} bytes in {len(sizes)} files; load {getloadavg()[0]:.1f}")
    command = [sys.executable, "-m", "pas", "studio", "--no-browser"]
    began = perf_counter()
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parent.parent)
    address = re.search(r"http\S+", server.stdout.readline())[0]
    told = perf_counter() - began
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE)
            page = browser.new_page(viewport={"width": 750, "height": 300})
            asked = perf_counter()
            page.goto(address)
            page.wait_for_selector(".overall.proved")
            done = perf_counter()
            print(
                f"the address after {told:.1f} s; a proved picture {done - asked:.1f} s after it is opened, "
                f"{done - began:.1f} s after the start, of which the browser's own {asked - began - told:.1f} s"
            )
            for order, degree in (case for case in CASES if case[1] in options.degrees):
                opened(page, order, degree)
                accuracy(page, order, degree)
                if degree in (5, 6, 7):
                    speed(page, degree, options.moves)
            generatrix(page, options.moves)
            browser.close()
    finally:
        server.terminate()
        server.wait(20)


if __name__ == "__main__":
    main()
