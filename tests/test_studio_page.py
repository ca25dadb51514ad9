"""The studio in a browser: what is drawn, dragged, proved, undone and saved, and what happens where something fails."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from test_studio import MESHLESS, children

import pas
from pas import network
from pas.studio import GALLERY
from pas.studio.documents import problem_of
from pas.studio.scene import coefficients

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next(filter(None, map(shutil.which, BROWSERS)), None)
SOFTWARE = ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--no-sandbox"]
"""The OpenGL of the system, which is software on machines without a graphics card."""

pytestmark = [
    pytest.mark.slow,  # `test_studio_walk.py` is run always
    pytest.mark.skipif(BROWSER is None, reason=f"there is no browser: none of {', '.join(BROWSERS)}"),
]

PROBLEM = """order = 1
degree = 4

[[pipes]]
axis = [1, 0, 0]
radius = "1/3"
clip = 1

[[pipes]]
axis = [0, 1, 0]
radius = "1/4"
clip = 1

[[pipes]]
axis = [0, 0, 1]
radius = "2/5"
clip = 1
"""

FINAL = "studio.state.final?.seq === studio.state.seq"
SEEN = "studio.state.shown === studio.state.seq"


class Page:
    """A page of the studio, polled: its content policy lets nothing be evaluated from texts later."""

    def __init__(self, context, address):
        self.page = context.new_page()
        self.trouble, self.asked = [], []
        self.page.on("pageerror", lambda error: self.trouble.append(str(error)))
        self.page.on("console", lambda line: self.trouble.append(line.text) if line.type == "error" else None)
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(address)

    def until(self, text, seconds=60):
        for _ in range(int(seconds / 0.03)):
            if self.page.evaluate(f"!!(globalThis.studio && ({text}))"):
                return
            time.sleep(0.03)
        raise AssertionError(f"not within {seconds} s: {text}; the page says {self.page.inner_text('.message')!r}")

    def ask(self, text):
        return self.page.evaluate(text)

    @property
    def problem(self):
        return self.ask("studio.state.doc.problem")

    @property
    def proved(self):
        return self.page.inner_text(".overall") == "✓ all proved"

    def tells_one_state(self):
        """Whether no verdict of an older shape stands beside the word that the present one is being checked."""
        said, lamps = self.ask(
            "[document.querySelector('.overall').textContent, document.querySelectorAll('.lamps .proved').length]"
        )
        return (said == "checking") == (lamps == 0)


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=BROWSER, args=SOFTWARE)
        yield found
        found.close()


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    """The file that is open, the address of the page, and the server's process."""
    file = tmp_path_factory.mktemp("studio") / "pipes.toml"
    file.write_text(PROBLEM)
    process = subprocess.Popen(
        [sys.executable, "-m", "pas", "studio", "--no-browser", str(file)], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    address = re.search(r"http\S+", process.stdout.readline())[0]
    yield file, address, process
    process.kill()
    process.wait()


@pytest.fixture(scope="module")
def context(browser):
    made = browser.new_context(viewport={"width": 860, "height": 480}, accept_downloads=True)
    made.grant_permissions(["clipboard-read", "clipboard-write"])
    return made


@pytest.fixture(scope="module")
def page(context, studio):
    made = Page(context, studio[1])
    made.until(FINAL)
    return made


COLORED = """(() => { studio.view.now(); const c = studio.view.live, g = studio.view.caster.gl;
  const a = new Uint8Array(4 * c.width * c.height); let orange = 0, gray = 0;
  g.readPixels(0, 0, c.width, c.height, g.RGBA, g.UNSIGNED_BYTE, a);
  for (let i = 0; i < a.length; i += 4) if (a[i + 3]) { if (a[i] > 2 * a[i + 2]) orange++; else gray++; }
  return [orange / a.length * 4, gray / a.length * 4]; })()"""
"""The shares of the picture that the surface and its neighbours take."""


def test_the_page_shows_a_proved_surface_and_asks_nobody_else(page, studio):
    assert page.proved and page.problem["name"] == "pipes"
    own = studio[1].partition("#")[0]
    assert all(url.startswith((own, "data:")) for url in page.asked) and "token" not in page.page.url
    assert page.trouble == []
    page.until("!studio.view.still.hidden")
    picture = page.ask(COLORED)
    assert 0.04 < picture[0] < 0.4 and 0.02 < picture[1] < 0.4


OPENED = "(document) => studio.openDocument(document)"
EXTENT = """(() => { const v = studio.view; v.now(); const c = v.live, g = v.caster.gl, w = c.width, h = c.height;
  const a = new Uint8Array(4 * w * h), x = [], y = []; g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, a);
  for (let i = 0; i < w * h; i++) if (a[4 * i + 3]) { x.push((i % w) / w); y.push(Math.floor(i / w) / h); }
  const ends = (l) => [l.reduce((p, q) => Math.min(p, q)), l.reduce((p, q) => Math.max(p, q))];
  return [ends(x), ends(y)]; })()"""
"""From where to where the picture is not empty, over its width and height."""


def test_a_shape_off_the_origin_is_in_the_middle_and_is_so_when_it_comes_back(page):
    before = page.problem
    away = {"kind": "problem", "problem": GALLERY["Elbow of one quartic"]["problem"] | {"name": "away"}}
    page.page.evaluate(OPENED, away)
    page.until(FINAL)
    for _ in range(2):
        for low, high in page.ask(EXTENT):
            assert low > 0.01 and high < 0.99 and abs(low + high - 1) < 0.16
        page.page.click("text=Undo")
        page.until(FINAL)
        assert page.problem == before and page.ask("studio.view.camera.target") == page.ask("studio.state.scene.middle")
        page.page.click("text=Redo")
        page.until(FINAL)
    page.page.evaluate("studio.view.pan(0.1, 0)")
    page.ask("studio.act.move(['problem', 'tension'], '6', true); studio.act.commit()")
    page.until(FINAL)
    assert page.ask("studio.view.camera.target") != page.ask("studio.state.scene.middle")  # as it was turned to
    page.page.evaluate(OPENED, {"kind": "problem", "problem": before})
    page.until(FINAL)


STARTS = "[aria-label='Starting points']"


def test_a_starting_point_is_named_as_long_as_it_is_seen(browser):
    command = [sys.executable, "-m", "pas", "studio", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as process:
        try:
            page = Page(browser, re.search(r"http\S+", process.stdout.readline())[0])
            page.until(FINAL)
            first, other = next(iter(GALLERY)), "Elbow of one quartic"
            assert page.page.input_value(STARTS) == first
            page.page.select_option(STARTS, other)
            page.until(FINAL)
            assert page.problem == GALLERY[other]["problem"] and page.page.input_value(STARTS) == other
            page.ask("studio.act.move(['problem', 'tension'], '6', true); studio.act.commit()")
            page.until(FINAL)
            assert page.page.input_value(STARTS) == ""
            page.page.select_option(STARTS, other)
            page.until(FINAL)
            assert page.problem == GALLERY[other]["problem"]
            for name in ("", other, first):
                page.page.click("text=Undo")
                page.until(FINAL)
                assert page.page.input_value(STARTS) == name
            assert page.trouble == []
            page.page.close()
        finally:
            process.terminate()


VIEWS = ((0.62, -0.62, 0.48), (1, 0, 0.001), (1, 2, 0.05))
PROBE = """([towards, w, h]) => { const n = Math.hypot(...towards), v = studio.view;
  v.camera.towards = towards.map((x) => x / n);
  const a = new Uint8Array(v.caster.probe(v.camera, v.look, w, h).buffer); let s = "";
  for (let i = 0; i < a.length; i += 32768) s += String.fromCharCode(...a.subarray(i, i + 32768));
  return [btoa(s), v.camera.frame(w / h), studio.state.scene.origin, studio.state.scene.scale]; }"""


def compared(page, surface, view, width, height):
    """Holes, extras, and the errors of distances over the size and of curvatures over their range, of all pixels."""
    text, frame, origin, scale = page.page.evaluate(PROBE, [list(view), width, height])
    found = np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 4)
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * frame["across"]
    y = ((np.arange(height) + 0.5) / height * 2 - 1) * frame["tan"]
    ahead, side, up, eye = (np.array(frame[name]) for name in ("ahead", "side", "up", "eye"))
    ways = (ahead + x[None, :, None] * side + y[:, None, None] * up).reshape(-1, 3)
    exact = pas.Evaluator(surface).first(np.array(origin) + scale * eye, scale * ways)
    hit, there = found[:, 3] >= 0, np.isfinite(exact)
    hidden = (found[:, 3] < 0) & (found[:, 3] > -1e5) & (found[:, 0] < exact)
    both = hit & there
    far = np.abs(found[:, 0] - exact)[both] * np.linalg.norm(ways[both], axis=1)
    true = surface.curvatures(np.array(origin) + scale * (eye + exact[both, None] * ways[both])) * [scale, scale**2]
    bent = np.abs(true - found[both, 1:3]) / np.percentile(np.abs(true), 98, axis=0)
    return int((there & ~hidden & ~hit).sum()), int((hit & ~there).sum()), far, bent


def test_every_pixel_is_where_the_ray_meets_the_surface(page):
    surface = pas.blend(
        [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1), pas.Pipe((0, 0, 1), "2/5", 1)], 1, 4
    ).surface
    for view in VIEWS:
        holes, extras, far, bent = compared(page, surface, view, 240, 180)
        assert (holes, extras) == (0, 0) and len(far) > 2000
        assert np.median(far) < 1e-6 and far.max() < 1e-3
        assert (bent > 1e-3).sum() <= 6  # on faces, where curvature jumps at GC^1, either piece may be taken


MORE_VIEWS = (*VIEWS, (1, 1, 1), (1, 0, -1), (-0.3, 0.8, 0.1), (0.2, -0.9, 0.35), (-1, -1, -0.4), (0.7, 0.1, -0.7))
PIPES = [
    {"axis": list(a), "radius": r, "clip": 1} for a, r in (((1, 0, 0), "1/3"), ((0, 1, 0), "1/4"), ((0, 0, 1), "2/5"))
]
NODE = [{"axis": list(a), "radius": "1/3", "clip": "auto"} for a in ((1, 0, 0), (-1, 2, 0), (0, -1, 3), (-1, -1, -2))]


@pytest.mark.parametrize(("order", "degree", "pipes"), [(2, 6, PIPES), (3, 8, PIPES), (1, 5, NODE)])
def test_rays_that_graze_and_walls_between_cells_are_seen_as_exactly(page, order, degree, pipes):
    before = page.problem
    page.page.evaluate(OPEN, {"order": order, "degree": degree, "pipes": pipes})
    page.until(FINAL, 60)
    surface = pas.blend([pas.Pipe(**pipe) for pipe in pipes], order, degree).surface
    for view in MORE_VIEWS:
        holes, extras, far, _ = compared(page, surface, view, 400, 300)
        assert (holes, extras) == (0, 0) and len(far) > 4000
        assert np.median(far) < 1e-6 and far.max() < 1e-3, view
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


BALL = "x^2 + y^2 + z^2 - 4"
CURVED = {
    "order": 1,
    "degree": 4,
    "prove": False,
    "guard": False,
    "contacts": [{"surface": "y^2 + z^2 - 1", "clip": BALL}, {"surface": "x^2 + z^2 - 1/2", "clip": BALL}],
    "partition": {"kind": "single cell", "lower": [-2, -2, -2], "upper": [2, 2, 2]},
    "normalize": {"kind": "value-at", "point": [0, 0, 0], "value": -1},
}
"""Two pipes that end at a sphere."""


def zeros_on_rays(polynomial, eye, ways, degree):
    """All zeros of a polynomial on rays (N, 3), complex ones as inf: (N, degree)."""
    nodes = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    middle = -ways @ eye / (ways * ways).sum(axis=1)  # next to the origin
    places = middle[:, None] + 3 * nodes
    values = polynomial(eye + places[..., None] * ways[:, None])
    powers = np.linalg.solve(np.vander(nodes), values.T).T
    companion = np.zeros((len(ways), degree, degree))
    companion[:, 0] = -powers[:, 1:] / powers[:, :1]
    companion[:, 1:, :-1] = np.eye(degree - 1)
    found = np.linalg.eigvals(companion)
    return np.where(np.abs(found.imag) < 1e-9, middle[:, None] + 3 * found.real, np.inf)


def test_curved_clips_end_the_blend_and_its_neighbours(page):
    before = page.problem
    page.page.evaluate(OPEN, CURVED)
    page.until(FINAL)
    assert "undecided" in page.page.inner_text(".overall") and page.page.locator(".message.bad").count() == 0
    assert page.page.locator("#c-problem-contacts-0-clip-s").count() == 0  # a formula is no number
    blend = problem_of({"name": "curved", **CURVED}).solve()
    width, height = 160, 120
    for view in VIEWS:
        text, frame, origin, scale = page.page.evaluate(PROBE, [list(view), width, height])
        found = np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 4)
        x = ((np.arange(width) + 0.5) / width * 2 - 1) * frame["across"]
        y = ((np.arange(height) + 0.5) / height * 2 - 1) * frame["tan"]
        ahead, side, up, eye = (np.array(frame[name]) for name in ("ahead", "side", "up", "eye"))
        ways = scale * (ahead + x[None, :, None] * side + y[:, None, None] * up).reshape(-1, 3)
        eye = np.array(origin) + scale * eye
        nearest = np.full((3, len(ways)), np.inf)
        pieces = [
            (blend.surface.polynomials[0], 4, 1, 2.0),
            *((c.surface, 2, -1, 2.88) for c in blend.surface.contacts),
        ]
        for row, (polynomial, degree, sign, half) in zip(nearest, pieces, strict=True):
            zeros = zeros_on_rays(polynomial, eye, ways, degree)
            there = eye + np.where(np.isfinite(zeros), zeros, 0.0)[..., None] * ways[:, None]
            kept = (sign * ((there**2).sum(axis=-1) - 4) < 0) & (np.abs(there) < half).all(axis=-1)
            row[:] = np.where(kept & np.isfinite(zeros), zeros, np.inf).min(axis=1)
        which, first = nearest.argmin(axis=0), nearest.min(axis=0)
        hit = found[:, 3] > -1e5
        assert (hit != np.isfinite(first)).sum() <= 3  # on rims, to within rounding
        both = hit & np.isfinite(first)
        assert both.sum() > 2000 and (np.where(found[:, 3] >= 0, 0, 1) != (which > 0))[both].sum() <= 3
        far = np.abs(found[:, 0] - first)[both]
        assert np.median(far) < 2e-6 and (far > 1e-3).sum() <= 3
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


def test_a_slider_is_dragged_by_mouse_and_by_keys_and_undone(page):
    before = page.problem
    slider = page.page.locator("#c-problem-tension-s")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    page.page.mouse.move(box["x"] + box["width"] * 0.49, box["y"] + box["height"] / 2)
    page.page.mouse.down()
    for share in (0.55, 0.6, 0.62):
        page.page.mouse.move(box["x"] + box["width"] * share, box["y"] + box["height"] / 2)
    assert page.tells_one_state()
    page.page.mouse.up()
    page.until(FINAL)
    moved = page.problem["tension"]
    assert float(moved) > 6 and page.proved
    assert page.page.input_value("#c-problem-tension") == moved
    for value in ("9", moved):
        page.ask(f"studio.act.move(['problem', 'tension'], '{value}')")
    page.ask("studio.act.commit()")  # back where it began: no step to undo, but final again
    page.until(FINAL)
    assert page.proved
    slider.focus()
    page.page.keyboard.press("ArrowRight")
    page.until(FINAL)
    assert float(page.problem["tension"]) > float(moved)
    page.page.keyboard.press("Control+z")
    page.page.keyboard.press("Control+z")
    page.until(FINAL)
    assert page.problem == before and page.proved
    page.page.click("text=Redo")
    page.until(FINAL)
    assert page.problem["tension"] == moved and json.dumps(moved) in page.page.inner_text("pre")
    page.page.click("text=Undo")
    page.until(FINAL)


def test_fields_take_fractions_and_refuse_what_is_no_number(page):
    before = page.problem
    field = page.page.locator("#c-problem-pipes-0-radius")
    field.fill("1/0")
    field.press("Enter")
    assert "1/0 is no number" in page.page.inner_text(".message") and field.get_attribute("aria-invalid") == "true"
    assert page.problem == before and page.proved
    field.fill("20")
    field.press("Enter")
    page.until("/^no surface for this state/.test(document.querySelector('.overall').textContent)")
    assert "leave room" in page.page.inner_text(".message") and page.page.locator(".lamps li").count() == 0
    page.page.click("text=Undo")
    page.until(FINAL)
    assert page.problem == before and page.proved
    field.fill("3/10")
    field.press("Enter")
    page.until(FINAL)
    assert page.problem["pipes"][0]["radius"] == "3/10" and page.proved
    page.page.click("text=Undo")
    page.until(FINAL)


def test_a_point_is_added_dragged_in_the_picture_and_removed(page):
    page.page.evaluate(OBLIQUE)
    page.page.click("text=Add point")
    page.until(FINAL)
    (first,) = page.problem["points"]["near"]
    mark = page.page.locator(".mark.near circle").bounding_box()
    x, y = mark["x"] + mark["width"] / 2, mark["y"] + mark["height"] / 2
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    page.page.mouse.move(x + 8, y + 6, steps=3)
    page.until(SEEN)
    page.page.mouse.up()
    page.until(FINAL)
    (second,) = page.problem["points"]["near"]
    assert first != second and np.abs(np.array(first, float) - np.array(second, float)).max() < 0.2
    page.page.focus(".mark.near")
    page.page.keyboard.press("ArrowUp")
    page.until(f"studio.state.past.length && {FINAL} && !studio.state.before")
    assert page.problem["points"]["near"] != [second]
    page.page.click("[aria-label='remove the point near 1']")
    page.until(FINAL)
    assert page.problem["points"]["near"] == [] and page.page.locator(".mark").count() == 0


class Fingers:
    """Touches of a page, as its browser would tell of them."""

    def __init__(self, page):
        self.page, self.session = page, page.page.context.new_cdp_session(page.page)

    def tell(self, kind, *places):
        points = [{"x": float(x), "y": float(y), "id": i} for i, (x, y) in enumerate(places)]
        self.session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    def go(self, *ways, lift=True):
        """Fingers that go from one place to another at the same time."""
        starts, ends = (np.array(side, dtype=float) for side in zip(*ways, strict=True))
        self.tell("touchStart", *starts)
        for share in np.linspace(0, 1, 11):
            self.tell("touchMove", *(starts + share * (ends - starts)))
            self.page.page.wait_for_timeout(10)
        if lift:
            self.tell("touchEnd")

    @property
    def mark(self):
        box = self.page.page.locator(".mark.near circle").bounding_box()
        return np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])


CAMERA = "(({ towards, target, wide }) => ({ towards, target, wide }))(studio.view.camera)"
STILL = "[scrollX, scrollY, document.querySelector('aside').scrollTop, visualViewport.scale]"


NEARER = """(() => { const v = studio.view, [x, y, z] = studio.state.doc.problem.points.near[0].map((c) => {
    const [p, q] = `${c}/1`.split("/"); return p / q; });
  return v.toScreen(v.camera.target)[2] / v.toScreen([x, y, z])[2]; })()"""
"""By what factor the only point is nearer to the eye than the target is, and moves farther with the picture."""


def test_fingers_turn_zoom_and_drag_and_the_page_stays(browser, studio):
    context = browser.new_context(viewport={"width": 400, "height": 800}, has_touch=True, is_mobile=True)
    page = Page(context, studio[1])
    page.until(FINAL)
    fingers, middle, start = Fingers(page), np.array([200.0, 192.0]), page.ask(CAMERA)
    fingers.go((middle, middle + [60, 0]))  # one turns
    turned = page.ask(CAMERA)
    assert turned["towards"] != start["towards"] and turned["wide"] == start["wide"]
    page.page.click("text=Add point")
    page.until(FINAL)
    page.ask("scrollTo(0, 0)")
    (first,), place = page.problem["points"]["near"], fingers.mark
    fingers.go((place, place + [0, 25]))  # a mark is dragged, beneath the finger and next to it
    fingers.go((place + [14, 25], place + [34, 25]))
    page.until(FINAL)
    assert np.abs(fingers.mark - place - [20, 25]).max() < 1
    (second,) = page.problem["points"]["near"]
    assert second != first and page.ask(CAMERA) == turned
    place = fingers.mark
    fingers.go((place, place + [20, 0]), lift=False)
    fingers.go((place + [20, 0], place + [60, 0]), (place - [60, 0], place - [100, 0]))  # a second one zooms instead
    page.until(FINAL)
    zoomed = page.ask(CAMERA)
    assert page.problem["points"]["near"] == [second] and zoomed["towards"] == turned["towards"]
    assert zoomed["wide"] == pytest.approx(turned["wide"] / 2)
    assert np.abs(fingers.mark - place - [20, 0]).max() < 4  # about the middle of the two: (-20, 0) goes to itself
    at, nearer = fingers.mark, page.ask(NEARER)
    fingers.go((middle, middle + [30, 40]), (middle - [80, 0], middle + [-50, 40]))  # two move the picture
    assert page.ask(CAMERA)["wide"] == pytest.approx(zoomed["wide"])
    assert 1 < nearer < 1.5 and np.abs(fingers.mark - at - nearer * np.array([30, 40])).max() < 1
    assert page.ask(STILL) == [0, 0, 0, 1]
    slider = page.page.locator("#c-problem-tension-s")
    slider.scroll_into_view_if_needed()
    box, before = slider.bounding_box(), page.ask(STILL)
    at = np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])
    fingers.go((at, at + [box["width"] / 5, 8]))
    page.until(FINAL)
    assert 600 < int(slider.input_value()) < 800 and float(page.problem["tension"]) > 6 and page.ask(STILL) == before
    assert page.trouble == []
    context.close()


def drawn(page):
    return np.array(page.ask("studio.state.scene.surface.map((p) => Array.from(p.values))"))


def python(page, folder, monkeypatch):
    """The shape that the copied program makes."""
    page.page.click("text=Copy as Python")
    page.until("/copied as Python/.test(document.querySelector('.message').textContent)")
    monkeypatch.chdir(folder)
    space = {}
    exec(compile(page.ask("navigator.clipboard.readText()"), "copied", "exec"), space)
    return space["shape"]


def dragged(page, locator, shift, share=0.5):
    """Drag something by (dx, dy) pixels from its middle, or from a slider's thumb; no lamp is lit on the way."""
    locator.scroll_into_view_if_needed()
    box = locator.bounding_box()
    x, y = box["x"] + box["width"] * share, box["y"] + box["height"] / 2
    page.page.evaluate(LAMPS)
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    try:
        page.page.mouse.move(x + shift[0], y + shift[1], steps=4)
        page.until("lampsWhileMoved.length > 0")
        page.until(SEEN)
    finally:  # else the mark would go along in the tests that follow
        page.page.mouse.up()
    page.until(FINAL)
    assert page.ask("lampsWhileMoved.every(([word, lit]) => word === 'checking' && lit === 0)")


LAMPS = """() => { globalThis.lampsWhileMoved = []; let seq = studio.state.seq;
  const listen = () => { if (studio.state.seq === seq) return; seq = studio.state.seq;
    const lit = document.querySelectorAll(".lamps .proved").length;
    lampsWhileMoved.push([document.querySelector(".overall").textContent, lit]); };
  globalThis.lampsListener?.abort(); globalThis.lampsListener = new AbortController();
  for (const kind of ["pointermove", "input"]) addEventListener(kind, listen, { signal: lampsListener.signal }); }"""
"""What the lamps say right when a state is new: what is seen at rest has verdicts a little later, even while held."""


ARROW = """(kind) => { const g = document.querySelector(`.mark.${kind}`);
  const [, x, y] = /translate\\(([^ ]+) ([^)]+)/.exec(g.getAttribute("transform"));
  const [, u, v] = /L([^ ]+) (.+)/.exec(g.querySelector("path").getAttribute("d"));
  return [x, y, u, v].map(Number); }"""
"""Where a mark is on the screen, and its arrow along the normal."""

OBLIQUE = "studio.view.aim([0.62, -0.62, 0.48])"
QUARTIC = {name: value for name, value in GALLERY["Elbow of one quartic"]["problem"].items() if name != "degree"}


@pytest.fixture
def single(page):
    """The page with a blend of a single cell."""
    before = page.problem
    page.page.evaluate(OPEN, QUARTIC)
    page.until(FINAL)
    yield page
    page.page.evaluate(OBLIQUE)
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


def test_coefficients_of_members_are_dragged_and_let_go(single, tmp_path, monkeypatch, capsys):
    page, before = single, drawn(single)
    slider = page.page.locator("#c-problem-points-coefficients-1-s")
    start = float(page.page.input_value("#c-problem-points-coefficients-1"))
    dragged(page, slider, (-6, 0), int(slider.input_value()) / 1000)
    (held,) = page.problem["points"]["coefficients"].items()
    assert held[0] == "1" and float(held[1]) < start and page.problem["degree"] == 4
    assert page.proved and page.page.input_value("#c-problem-points-coefficients-1") == held[1]
    assert (coefficients(python(page, tmp_path, monkeypatch).surface) == drawn(page)).all()
    slider.focus()
    page.page.keyboard.press("ArrowRight")
    page.until(f"studio.state.doc.problem.points.coefficients['1'] !== '{held[1]}' && {FINAL}")
    assert float(page.problem["points"]["coefficients"]["1"]) > float(held[1])
    page.page.keyboard.press("Control+z")
    assert page.problem["points"]["coefficients"] == dict([held])
    field = page.page.locator("#c-problem-points-coefficients-0")
    field.fill("3")
    field.press("Enter")
    page.until("/coefficient 0 = 3/.test(document.querySelector('.message').textContent)")
    assert page.page.locator(".lamps li").count() == 0
    page.page.click("text=Undo")
    page.page.click("[aria-label='let coefficient 2 follow']")
    page.until(FINAL)
    assert page.problem["points"]["coefficients"] == {} and np.abs(drawn(page) - before).max() < 1e-2
    for _ in range(2):
        page.page.click("text=Undo")
    page.until(FINAL)
    assert page.problem == QUARTIC and page.trouble == []


def test_handles_pull_the_surface_of_a_single_cell(single):
    page = single
    page.page.evaluate("(studio.view.camera.target = [0, 0, 0], studio.view.aim([-1, -0.6, 0.3]))")
    page.page.click("text=Add handle")
    page.until(f"studio.state.doc.problem.points?.handles?.length === 1 && {FINAL}")
    ((handle, value),) = page.problem["points"]["handles"]
    assert page.problem["degree"] == 4 and page.proved
    page.page.evaluate("(studio.view.aim([0, 0, 1]), studio.view.now())")  # there its normal is seen from the side
    x, y, u, v = page.page.evaluate(ARROW, "handle")
    out = np.array([u, v]) / np.hypot(u, v)
    dragged(page, page.page.locator(".mark.handle circle"), 4 * out)
    went = (np.array(page.page.evaluate(ARROW, "handle")[:2]) - [x, y]) @ out
    assert np.hypot(u, v) > 15 and 2 < went < 8  # the surface goes along with the pointer
    ((same, moved),) = page.problem["points"]["handles"]
    assert same == handle and moved != value and page.proved
    field = page.page.locator("#c-problem-points-handles-0-1")
    assert field.input_value() == moved
    page.page.focus(".mark.handle")
    page.page.keyboard.press("ArrowUp")
    page.until(f"studio.state.doc.problem.points.handles[0][1] !== '{moved}' && !studio.state.before && {FINAL}")
    (_, pulled), *_ = page.problem["points"]["handles"]
    assert (float(pulled) - float(moved)) * (float(moved) - float(value)) > 0  # further out
    slider = page.page.locator("#c-problem-points-handles-0-1-s")
    slider.focus()
    page.page.keyboard.press("ArrowLeft")
    assert page.problem["points"]["handles"][0][1] not in (moved, pulled)
    field.fill(moved)
    field.press("Enter")
    page.until(FINAL)
    assert page.problem["points"]["handles"] == [[handle, moved]]
    kept = json.loads(page.ask("decodeURIComponent(location.hash.slice(7))"))
    assert kept["problem"] == page.problem
    page.page.select_option("#c-problem-degree", label="5")  # handles are those of one degree
    assert page.problem["degree"] == 5 and "handles" not in page.problem["points"]
    page.page.click("text=Undo")
    assert page.problem["points"]["handles"] == [[handle, moved]]
    page.page.click("[aria-label='remove handle 1']")
    page.until(FINAL)
    assert page.problem["points"]["handles"] == [] and page.page.locator(".mark.handle").count() == 0


def test_a_drag_ends_where_the_document_is_replaced(single):
    page = single
    page.page.click("text=Add handle")
    page.until(f"studio.state.doc.problem.points?.handles?.length === 1 && {FINAL}")
    placed, mark = page.problem, page.page.locator(".mark.handle circle")
    for undone in (1, 2):  # the drag alone, then also the handle itself
        box = mark.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.page.mouse.move(x, y)
        page.page.mouse.down()
        try:
            page.page.mouse.move(x + 3, y + 5)
            page.until("studio.state.before !== null")
            assert page.problem != placed
            for _ in range(undone):
                page.page.keyboard.press("Control+z")
            page.page.mouse.move(x + 9, y + 15, steps=3)
        finally:
            page.page.mouse.up()
        page.until(FINAL)
        assert page.problem == (placed if undone == 1 else QUARTIC) and page.ask("studio.state.before") is None
    page.page.click("text=Redo")
    page.until(FINAL)
    assert page.problem == placed
    moved = page.problem
    page.page.focus(".mark.handle")
    page.page.keyboard.press("ArrowUp")
    page.page.keyboard.press("Control+z")  # before the half second after which a pull by keys is a state
    page.until(FINAL)
    assert page.problem == moved and page.trouble == []


def test_handles_of_many_cells_are_points_pulled_along_the_normal(page):
    before = page.problem
    page.page.evaluate("studio.view.aim([0.3, -1, 0.3])")
    page.page.click("text=Add handle")
    page.until(f"studio.state.doc.problem.points?.through?.length === 1 && {FINAL}")
    (place,) = page.problem["points"]["through"]
    assert page.proved
    point = np.array(place, dtype=float)
    contacts = [pas.Pipe(**pipe) for pipe in before["pipes"]]
    surface = pas.blend(contacts, before["order"], before["degree"], through=[place]).surface
    assert abs(surface(point)) < 1e-12
    page.page.evaluate("(studio.view.aim([1, -0.3, 0.3]), studio.view.now())")
    *_, u, v = page.page.evaluate(ARROW, "through")
    dragged(page, page.page.locator(".mark.through circle"), 3 * np.array([u, v]) / np.hypot(u, v))
    (moved,) = page.problem["points"]["through"]
    way, normal = np.array(moved, dtype=float) - point, surface.gradient(point[None])[0]
    assert way @ normal / (np.linalg.norm(way) * np.linalg.norm(normal)) > 0.99 and page.proved
    page.page.focus(".mark.through")
    page.page.keyboard.press("ArrowDown")
    page.until(f"studio.state.doc.problem.points.through[0][0] !== '{moved[0]}' && !studio.state.before && {FINAL}")
    assert (np.array(page.problem["points"]["through"][0], dtype=float) - np.array(moved, dtype=float)) @ normal < 0
    for _ in range(3):
        page.page.click("text=Undo")
    page.until(FINAL)
    assert page.problem == before and page.page.locator(".mark").count() == 0
    page.page.evaluate(OBLIQUE)


def test_what_is_copied_and_exported_is_what_is_seen(page, tmp_path):
    page.page.click("text=Copy as Python")
    page.until("/copied as Python/.test(document.querySelector('.message').textContent)")
    space = {}
    exec(compile(page.ask("navigator.clipboard.readText()"), "copied", "exec"), space)
    seen = np.array(page.ask("studio.state.scene.surface.map((p) => Array.from(p.values))"))
    wanted = np.array([patch.dense(4) for patch in space["shape"].surface.patches])
    assert (seen == wanted).all(), np.abs(seen - wanted).max()
    with page.page.expect_download() as download:
        page.page.click("text=Export")
    assert download.value.suggested_filename == "pipes.pas.json"
    download.value.save_as(tmp_path / "pipes.pas.json")
    assert pas.load(tmp_path / "pipes.pas.json").surface.patches == space["shape"].surface.patches
    with page.page.expect_download() as download:
        page.page.click("text=PNG")
    download.value.save_as(tmp_path / "pipes.png")
    assert (tmp_path / "pipes.png").read_bytes()[16:24] == (1200).to_bytes(4, "big") + (900).to_bytes(4, "big")
    corner, levels = page.ask(PICTURE)
    assert corner == [238, 242, 246]  # the page's paper
    # no bands: no residue class of levels has most of the pixels, as in a sum of six rounded shares
    assert max(sum(levels[k::6]) for k in range(6)) < 0.3 * sum(levels)


PICTURE = """(async () => {
  const picture = await createImageBitmap(studio.state.downloaded.blob), reds = new Array(256).fill(0);
  const c = new OffscreenCanvas(1200, 900).getContext("2d"); c.drawImage(picture, 0, 0);
  const a = c.getImageData(0, 0, 1200, 900).data;
  for (let i = 0; i < a.length; i += 4) if (a[i] > 2 * a[i + 2]) reds[a[i]]++;
  return [[...a.slice(0, 3)], reds]; })()"""
"""The colour of a corner, and how many pixels of the surface are how red."""


def test_a_turn_is_filmed_and_pieces_are_outlined(page):
    page.until("!studio.view.still.hidden")
    camera, before = page.ask("studio.view.camera.towards"), page.ask(DARK)
    page.page.click("text=Cells")
    assert page.ask(DARK) > before + 0.01
    page.page.click("text=Cells")
    film = page.ask(FILM)
    assert film["type"] == "video/webm" and film["size"] > 3000 and film["head"] == [0x1A, 0x45, 0xDF, 0xA3]
    assert page.ask("studio.view.camera.towards") == camera


def test_a_film_is_saved(page):
    with page.page.expect_download() as download:
        page.page.click("text=Turntable")
    assert download.value.suggested_filename == "pipes.webm"


FILM = """(async () => { const film = await studio.view.film("#fff", 8);
  return { type: film.type, size: film.size, head: [...new Uint8Array(await film.slice(0, 4).arrayBuffer())] }; })()"""

DARK = """(() => { const v = studio.view, c = v.live, g = v.caster.gl;
  v.sized(1); v.caster.draw(v.camera, { ...v.look, jitter: [0, 0] });
  const a = new Uint8Array(4 * c.width * c.height); let dark = 0, all = 0;
  g.readPixels(0, 0, c.width, c.height, g.RGBA, g.UNSIGNED_BYTE, a);
  for (let i = 0; i < a.length; i += 4) if (a[i + 3] && a[i] > 2 * a[i + 2]) { all++; dark += a[i] < 80; }
  return dark / all; })()"""
"""The share of dark pixels on the surface, cast at full size however slow this machine is."""

OPEN = "(problem) => studio.openDocument({ kind: 'problem', problem }, false)"
UNGUARDED = {
    "prove": False,
    "guard": False,
    "energy": {"kind": "thin-plate"},
    "points": {"near": [["0.8", "0.8", "0.8"]], "near_weight": "100000"},
}


def test_a_refuted_surface_shows_where_and_is_repaired(page):
    good = page.problem
    page.page.evaluate(OPEN, good | UNGUARDED)
    page.until(FINAL)
    assert page.page.inner_text(".overall") == "✗ refuted" and page.page.locator(".mark.witness").count() >= 1
    page.page.click("text=Repair")
    page.until(f"{FINAL} && studio.state.doc.problem.prove === undefined")
    assert page.proved and page.page.locator(".mark.witness").count() == 0
    page.page.click("text=Undo")
    page.until(FINAL)
    page.page.click("text=Back to the last proved")
    page.until(FINAL)
    assert page.proved
    page.page.evaluate(OPEN, good)
    page.until(FINAL)


def test_without_webgl_the_page_says_so(browser, studio):
    context = browser.new_context()
    context.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page = Page(context, studio[1])
    page.until("/has no WebGL 2/.test(document.querySelector('.message').textContent)")
    assert page.trouble == []
    context.close()


def test_an_address_is_opened_in_another_tab_and_elsewhere_it_is_said_what_to_do(browser, studio):
    context = browser.new_context(viewport={"width": 860, "height": 480})
    page = Page(context, studio[1])
    page.until(FINAL)
    page.ask("studio.act.move(['problem', 'tension'], '7', true); studio.act.commit()")
    page.until(FINAL)
    assert "token" not in page.page.url
    other = Page(context, page.page.url)
    other.until(FINAL)
    assert other.problem["tension"] == "7" and other.proved and other.trouble == []
    stranger = browser.new_context()
    alone = Page(stranger, page.page.url)
    known = "/open the address that `pas studio` printed/.test(document.querySelector('.message').textContent)"
    alone.until(known)
    alone.page.evaluate("localStorage.setItem('pas token', 'of another studio')")
    time.sleep(4)  # it has tried again
    alone.until(known)
    alone.page.goto(studio[1])
    alone.page.reload()
    alone.until(FINAL)
    stranger.close()
    context.close()


MEASURED = f"{FINAL} && studio.state.measured === studio.state.shot"


def said(page, where):
    return page.page.locator(where).first.inner_text() if page.page.locator(where).first.is_visible() else ""


def test_what_is_not_fair_is_named_while_it_is_dragged_and_the_last_fair_value_is_marked(page):
    before, path = page.problem, "['problem', 'pipes', 0, 'radius']"
    page.page.evaluate(OPEN, GALLERY["T joint"]["problem"])
    page.until(MEASURED)
    assert (said(page, ".told"), said(page, ".warning")) == ("✓ fair", "")
    page.ask(f"studio.act.move({path}, '0.4')")
    assert said(page, ".told") == "being measured …"  # what was said is of another state
    page.until("studio.state.shown === studio.state.seq && studio.state.fair?.problem.pipes[0].radius === '0.4'")
    page.ask(f"studio.act.move({path}, '1.4')")
    page.until("studio.state.shown === studio.state.seq && studio.state.measured === studio.state.shot")
    assert "times as sharp as its sharpest neighbour" in said(page, ".warning") and said(page, ".told") == "▲ not fair"
    assert said(page, ".number.away .safe:not([hidden])") == "▲ last fair at 0.4"
    assert page.page.locator(".number.away").count() == 1  # the slider that has left it
    at = page.page.locator(".number.away .tick").bounding_box()
    box = page.page.locator("#c-problem-pipes-0-radius-s").bounding_box()
    assert abs((at["x"] - box["x"]) / box["width"] - 0.4 / 2) < 0.06
    page.ask("studio.act.commit()")
    page.until(MEASURED)
    assert page.proved and "times as sharp" in said(page, ".warning")
    page.page.click("text=Back to the last fair")
    page.until(MEASURED)
    assert page.problem["pipes"][0]["radius"] == "0.4" and said(page, ".warning") == ""
    assert page.page.locator(".number.away").count() == 0
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


def test_the_page_says_why_a_shape_without_a_mesh_is_not_written(page):
    before = page.problem
    page.page.evaluate(OPEN, MESHLESS["problem"])
    page.until(FINAL)
    page.ask("studio.view.onslow()")  # as where rays are too slow: it goes on with them
    page.page.select_option("[aria-label=Format]", ".stl")
    page.page.locator("button", has_text=re.compile("^Export$")).click()
    page.until("/no good mesh was found/.test(document.querySelector('.message.bad')?.textContent)")
    assert "refuted" in said(page, ".overall") and page.page.locator(".lamps li").count() == 4
    assert not page.ask("document.querySelector('.place').classList.contains('ghost')")
    assert page.page.locator("button", has_text=re.compile("^Export$")).is_enabled()
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


def test_a_lost_connection_is_taken_up_again(browser, studio):
    sockets = []

    def through(route):
        sockets.append((route, route.connect_to_server()))

    context = browser.new_context(viewport={"width": 860, "height": 480})
    context.route_web_socket(re.compile("/talk$"), through)
    page = Page(context, studio[1])
    page.until(FINAL)
    page.ask("studio.act.move(['problem', 'tension'], '8', true); studio.act.commit()")
    page.until(FINAL)
    sockets[0][1].close()
    sockets[0][0].close()
    page.until("/connection is lost/.test(document.querySelector('.message').textContent)")
    page.until("studio.state.seq > 2")
    page.until(FINAL)
    assert len(sockets) == 2 and page.problem["tension"] == "8" and page.proved
    context.close()


def test_random_dragging_lights_no_lamp_too_early_and_keeps_its_memory(page, studio):
    start = page.problem
    tree = [studio[2].pid, *children(studio[2].pid)]
    page.page.evaluate(RANDOM, 40)
    before = sum(map(resident, tree))
    sizes = page.page.evaluate(RANDOM, 60 * float(os.environ.get("PAS_MINUTES", "10")))
    assert sum(map(resident, tree)) < 1.25 * before + 30e6
    page.ask("studio.act.commit()")
    page.until(FINAL)
    assert sizes["early"] == 0 and sizes["moves"] > 200
    assert sizes["after"] < 1.6 * sizes["before"] + 8e6
    page.page.evaluate(OPEN, start)
    page.until(FINAL)


def resident(pid):
    """Bytes of memory that a process has, 0 where that is not known."""
    status = Path(f"/proc/{pid}/status")
    found = re.search(r"VmRSS:\s+(\d+) kB", status.read_text()) if status.exists() else None
    return 1024 * int(found[1]) if found else 0


RANDOM = """async (seconds) => { let seed = 1, early = 0, moves = 0;
  const rand = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const heap = () => performance.memory.usedJSHeapSize, wait = (t) => new Promise((r) => setTimeout(r, t));
  const lit = () => document.querySelectorAll(".lamps .proved").length > 0;
  const ends = performance.now() + 1000 * seconds;
  for (let i = 0; i < 40; i++) { studio.act.move(["problem", "tension"], (20 * rand()).toFixed(3)); await wait(25); }
  const before = heap();
  while (performance.now() < ends) {
    if (rand() < 0.02) studio.act.move(["problem", "pipes", 0, "radius"], (0.2 + 0.2 * rand()).toFixed(3));
    else studio.act.move(["problem", "tension"], (20 * rand()).toFixed(3));
    moves++;
    if (lit()) early++;
    if (rand() < 0.02) studio.act.commit();
    studio.view.turn(rand() - 0.5, rand() - 0.5); await wait(rand() < 0.05 ? 400 : 25);
    if (lit() && studio.state.shown !== studio.state.seq) early++; }
  return { early, moves, before, after: heap() }; }"""


def test_two_windows_a_changed_file_and_a_lost_connection(page, context, studio):
    file, address, _ = studio
    other = Page(context, address)
    other.until(FINAL)
    other.page.evaluate("studio.act.move(['problem', 'tension'], '7', true); studio.act.commit()")
    other.until(FINAL)
    assert "tension" not in page.problem and other.problem["tension"] == "7"
    camera = other.ask("studio.view.turn(0.3, 0.1), studio.view.camera.towards")
    file.write_text(PROBLEM.replace('"2/5"', '"1/3"'))
    for window in (page, other):
        window.until(f"studio.state.doc.problem.pipes[2].radius === '1/3' && {FINAL}")
    assert other.ask("studio.view.camera.towards") == camera
    other.page.evaluate("studio.act.move(['problem', 'tension'], '7', true); studio.act.commit()")
    other.until(FINAL)
    other.page.reload()
    other.until(FINAL)
    assert other.problem["pipes"][2]["radius"] == "1/3" and other.problem["tension"] == "7" and other.trouble == []
    other.page.close()
    file.write_text(PROBLEM)
    page.until(f"studio.state.doc.problem.pipes[2].radius === '2/5' && {FINAL}")


UNNAMED = """[...document.querySelectorAll("button, input, select")].filter((e) => !e.hidden && e.type !== "file" &&
  !e.textContent.trim() && !e.getAttribute("aria-label") && !document.querySelector(`label[for="${e.id}"]`)).length"""


@pytest.mark.parametrize("name", ["Two quadrics", "Round an obstacle", "Helicoid to pipe"])
def test_shape_values_are_drawn_by_the_page_alone(page, name):
    before, problem = page.problem, GALLERY[name]["problem"]
    page.page.evaluate(OPEN, problem)
    page.until(FINAL)
    at_once = page.ask("""(() => { studio.act.move(["problem", "shape", "l1"], "3/2"); const s = studio.state;
      return [s.shown === s.seq, s.shot, Array.from(s.scene.meshes[s.scene.head.main].points.subarray(0, 14400))];
    })()""")
    assert at_once[:2] == [True, 0] and page.page.locator(".lamps .proved").count() == 0
    page.until(f"{SEEN} && studio.state.shot > 0")  # after a pause, for the verdicts
    blend = problem_of({**problem, "shape": {**problem["shape"], "l1": "3/2"}}).solve()
    origin, scale = page.ask("[studio.state.scene.origin, studio.state.scene.scale]")
    exact = (blend.mesh(size=(120, 40)).points - origin) / scale
    assert np.abs(np.array(at_once[2]).reshape(-1, 3) - exact).max() < 1e-6
    page.page.evaluate(OPEN, before)
    page.until(FINAL)


EDGES = """(() => { const v = studio.view, c = v.live, g = v.caster.gl; v.aim([0.62, -0.62, 0.48]); v.fit(); v.now();
  return [0, c.width - 1].map((x) => { const a = new Uint8Array(4 * c.height);
    g.readPixels(x, 0, 1, c.height, g.RGBA, g.UNSIGNED_BYTE, a);
    return a.filter((_, i) => i % 4 === 3 && a[i]).length; });
})()"""
"""Pixels that are not empty in the first and last column of the picture."""

SHARE = """((meshed) => { const v = studio.view, c = v.live, g = v.caster.gl;
  v.sized(1); v.caster.draw(v.camera, { ...v.look, meshed, jitter: [0, 0] });
  const a = new Uint8Array(4 * c.width * c.height); let all = 0, drawn = 0;
  g.readPixels(0, 0, c.width, c.height, g.RGBA, g.UNSIGNED_BYTE, a);
  for (let i = 0; i < a.length; i += 4) if (a[i + 3] && a[i] > 2 * a[i + 2]) { all++; drawn += a[i]; }
  return [all / a.length * 4, drawn / all]; })"""
"""Of the surface, at full size, cast or from its mesh: how much of the picture it takes, and how bright it is."""


def test_where_rays_are_too_slow_a_mesh_moves(page):
    page.ask("""(() => { const caster = studio.view.caster, finish = caster.finish;
      caster.quick = () => { caster.finish = finish; };
      caster.finish = () => { const began = performance.now(); while (performance.now() - began < 170); };
      for (let i = 0; i < 8; i++) studio.view.now(); })()""")
    page.until("studio.view.tooSlow && studio.view.caster.substitute.length > 0")
    assert page.ask(f"{SHARE}(true)") == pytest.approx(page.ask(f"{SHARE}(false)"), rel=0.03)
    for value in ("5", "5.5", "6"):
        page.ask(f"studio.act.move(['problem', 'tension'], '{value}')")
        page.until(SEEN)
    assert page.ask("studio.view.caster.substitute.length") == 1  # moved with it
    assert page.ask(f"{SHARE}(true)") == pytest.approx(page.ask(f"{SHARE}(false)"), rel=0.03)
    page.ask("studio.act.commit()")
    page.until(f"{FINAL} && studio.view.tooSlow")
    page.ask("studio.view.caster.quick()")
    page.page.click("text=Undo")
    page.until(FINAL)


def test_what_was_slow_for_a_while_only_is_cast_again(page):
    page.ask("""(() => { const v = studio.view, draw = v.caster.draw; v.tooSlow = true; v.caster.finish = () => {};
      v.caster.draw = () => {}; v.smooth(0); v.caster.draw = draw; delete v.caster.finish; v.ask(); })()""")
    assert not page.ask("studio.view.tooSlow")


def test_narrow_windows_and_dark_ones_have_all_controls(page):
    page.page.set_viewport_size({"width": 420, "height": 800})
    page.page.emulate_media(color_scheme="dark")
    wide = page.ask("[document.documentElement.scrollWidth, innerWidth]")
    assert wide[0] <= wide[1]
    for name in page.page.locator("button:visible, input:visible, select:visible").all():
        box = name.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= 421
    unnamed = page.ask(UNNAMED)
    assert unnamed == 0
    page.page.emulate_media(color_scheme="light")
    page.page.set_viewport_size({"width": 300, "height": 1200})  # the picture is higher than wide: nothing is cut off
    assert page.ask(EDGES) == [0, 0]
    page.page.set_viewport_size({"width": 860, "height": 480})
    page.ask("studio.view.fit()")


@pytest.fixture
def widget():
    pipes = [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1)]
    return pas.blend(pipes, 1, 4).studio()


class Notebook:
    """A page that shows views of a widget below a cell to type in, as notebooks do: within a root of their own."""

    def __init__(self, browser, widget):
        self.widget, self.asked, self.trouble = widget, [], []
        self.page = browser.new_page(viewport={"width": 860, "height": 640})
        self.page.on("pageerror", lambda error: self.trouble.append(str(error)))
        widget.send = lambda content, parts=(): self.page.evaluate(
            HEAR, [content, [base64.b64encode(part).decode() for part in parts]]
        )
        self.page.expose_function("ask", lambda request: self.asked.append(request))
        self.page.expose_function("keep", lambda document: setattr(widget, "document", document))
        self.page.evaluate(MODEL, [widget._esm, widget._css, widget.document])
        self.page.evaluate("show()")

    def until(self, text, view=0):
        for _ in range(400):
            while self.asked:
                self.widget.answer(self.asked.pop(0))
            if self.page.evaluate(f"((view) => {text})(views[{view}])"):
                return
            self.page.wait_for_timeout(30)
        raise AssertionError(f"{text}; {self.page.locator('.message').all_inner_texts()}; {self.trouble}")


PROVED = "/all proved/.test(view.querySelector('.overall')?.textContent)"
TENSION = "view.querySelector('#c-sliders-tension').value === '{}' && " + PROVED


def test_the_widget_of_a_notebook_moves_the_blend_in_python(browser, widget):
    notebook = Notebook(browser, widget)
    notebook.until(PROVED)
    before = widget.blend
    field = notebook.page.locator("#c-sliders-tension")
    field.fill("9")
    field.press("Enter")
    notebook.until("/tension=\"9\"/.test(view.querySelector('pre').textContent)")
    assert widget.document["sliders"] == {"tension": "9"} and notebook.trouble == []
    assert widget.blend.surface.patches != before.surface.patches and widget.blend.standing == "proved"
    notebook.page.close()


def test_two_views_of_a_widget_follow_each_other_and_python(browser, widget):
    notebook = Notebook(browser, widget)

    def typed(view, value):
        field = notebook.page.locator("#c-sliders-tension").nth(view)
        field.fill(value)
        field.press("Enter")
        notebook.page.focus(".cell")
        for other in range(notebook.page.locator(".pas-studio").count()):
            notebook.until(TENSION.format(value), other)
        assert widget.document["sliders"] == {"tension": value}

    notebook.until(PROVED)
    typed(0, "5")
    notebook.page.evaluate("show()")  # later, so that it has counted less
    notebook.until(TENSION.format("5"), 1)
    typed(0, "9")
    typed(1, "7")
    widget.document = {**widget.document, "sliders": {"tension": "12"}}
    notebook.page.evaluate("(document) => model.changed(document)", widget.document)
    for view in range(2):
        notebook.until(TENSION.format("12"), view)
    assert notebook.trouble == []
    notebook.page.close()


def test_keys_of_a_widget_are_not_the_notebooks_and_those_of_cells_not_the_widgets(browser, widget):
    notebook = Notebook(browser, widget)
    notebook.until(PROVED)
    keys = notebook.page.keyboard
    notebook.page.focus("#c-sliders-tension-s")
    keys.press("ArrowRight")
    notebook.until(f"Number(view.querySelector('#c-sliders-tension').value) > 4.6 && {PROVED}")
    moved = widget.document["sliders"]["tension"]
    notebook.page.focus(".cell")
    keys.type("x")
    keys.press("Control+z")
    notebook.until(TENSION.format(moved))
    notebook.page.focus(".live")
    for key in ("d", "d", "Home", "Shift+Enter", "Control+s", "Control+z"):
        keys.press(key)
    notebook.until(TENSION.format("23/5"))
    assert notebook.page.evaluate("heard") == ["x", "Control", "z", "Enter", "Control", "s", "Control"]
    notebook.page.close()


MODEL = """async ([esm, css, start]) => {
  const listeners = {}, held = { document: start }, text = JSON.stringify;
  const tell = (name, ...about) => listeners[name].forEach((f) => f(...about));
  const put = (k, v) => { if (text(held[k]) !== text(v)) { held[k] = v; tell(`change:${k}`); } };
  globalThis.model = { get: (k) => held[k], set: (k, v) => { globalThis.keep(v); put(k, v); }, save_changes() {},
    send: (request) => globalThis.ask(request), on: (name, f) => (listeners[name] ||= []).push(f), off() {},
    heard: (...message) => tell("msg:custom", ...message), changed: (document) => put("document", document) };
  globalThis.heard = []; globalThis.views = [];
  document.addEventListener("keydown", (e) => { heard.push(e.key); if (e.key === "s") e.preventDefault(); });
  const url = (source, type) => URL.createObjectURL(new Blob([source], { type }));
  const module = await import(url(esm, "text/javascript"));
  const add = (tag, place) => place.appendChild(document.createElement(tag));
  const cell = add("div", document.body); cell.className = "cell"; cell.contentEditable = "true";
  globalThis.show = () => {
    const root = add("div", document.body).attachShadow({ mode: "open" }); add("style", root).textContent = css;
    views.push(add("div", root)); module.default.render({ model, el: views.at(-1) });
  };
}"""
HEAR = """([content, parts]) => model.heard(content,
  parts.map((p) => new DataView(Uint8Array.from(atob(p), (c) => c.charCodeAt(0)).buffer)))"""


def test_a_network_is_drawn_by_its_bodies_in_their_places(page, tmp_path):
    net = network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1), (0, 2), (2, 3)], "1/8", "1/8")
    part = net.blend(1, "lowest")
    page.page.set_input_files("input[type=file]", part.save(tmp_path / "frame.pas.json"))
    page.until("studio.state.doc.name === 'frame.pas.json' && " + FINAL)
    assert page.proved and page.page.inner_text(".parts").splitlines() == [str(one) for one in part.classes]
    assert page.ask("studio.state.scene.meshes.reduce((n, m) => n + m.places.length / 3, 0)") == len(net.points)
    page.page.evaluate("studio.view.aim([0, 0, 1]); studio.view.fit()")
    (left, right), (low, high) = page.ask(EXTENT)
    assert left > 0.01 and right < 0.99 and abs(left + right - 1) < 0.16 and abs(low + high - 1) < 0.16
    assert page.ask(HOLE) == 0
    assert page.trouble == []


HOLE = """(() => { const v = studio.view; v.now(); const c = v.live, g = v.caster.gl, a = new Uint8Array(4);
  g.readPixels(c.width / 2, c.height / 2, 1, 1, g.RGBA, g.UNSIGNED_BYTE, a); return a[3]; })()"""
"""What is drawn in the middle of the picture: nothing where one looks between struts."""
