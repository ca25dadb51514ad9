"""Solids: triangles and seconds of their meshes, and of the teapot's pictures.

    python benchmarks/solids.py [--repeat 3]

`tolerance` is in the model's units; `seconds`, of processor time, are the median of several runs, each with the
solid made afresh, its bounding box included and imports not; `angle` is the smallest one, in degrees.  The pictures are
those of `examples/teapot`, with the meshes of pot and lid that they need; the first one starts OpenGL.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from statistics import median

import pas
from pas import solid
from pas.bench.suites.solids import gear
from pas.designs.teapot import Teapot, teapot
from pas.render.parts import Look, draw_parts
from pas.solid.solid import Solid


def struts(ends: Sequence[tuple[int, int, int]]) -> Solid:
    """Bars from one point."""
    return solid.union([solid.cylinder((0, 0, 0), end, "1/10", f"bar {i}") for i, end in enumerate(ends)])


def lattice() -> Solid:
    """27 bars along the axes through 27 points."""
    bars = []
    for axis, i, j in product(range(3), repeat=3):
        start, end = [i, j], [i, j]
        start.insert(axis, 0)
        end.insert(axis, 2)
        bars.append(solid.cylinder(start, end, "1/10", f"bar {len(bars)}"))
    return solid.union(bars)


def plate() -> Solid:
    """A plate with 15 holes, of which the ideal mesh at 1e-3 has 3372 triangles."""
    holes = [
        solid.cylinder((1 + 2 * i, 1 + 2 * j, -1), (1 + 2 * i, 1 + 2 * j, 2), "3/5", f"hole {i} {j}")
        for i, j in product(range(5), range(3))
    ]
    return solid.box((0, 0, 0), (10, 6, 1)) - solid.union(holes)


def pipes() -> Solid:
    """A blend of three pipes as a solid."""
    return pas.node([((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], order=2).solid()


CASES: dict[str, tuple[Callable[[], Solid], float]] = {
    "box": (lambda: solid.box((0, 0, 0), (1, 2, 3)), 1e-3),
    "ball": (lambda: solid.ball((0, 0, 0), 1), 1e-3),
    "thin ring": (lambda: solid.torus((0, 0, 0), (0, 0, 1), 1, "1/50"), 1e-3),
    "hollow ball": (lambda: solid.ball((0, 0, 0), 1) - solid.ball((0, 0, 0), "19/20"), 1e-3),
    "plate with a hole": (
        lambda: solid.box((-1, -1, "-1/20"), (1, 1, "1/20")) - solid.cylinder((0, 0, -1), (0, 0, 1), "1/50"),
        1e-3,
    ),
    "two cylinders": (
        lambda: solid.cylinder((-2, 0, 0), (2, 0, 0), 1) & solid.cylinder((0, -2, 0), (0, 2, 0), 1),
        1e-3,
    ),
    "three struts": (lambda: struts(((1, 0, 0), (0, 1, 0), (0, 0, 1))), 1e-3),
    "equal cylinders": (
        lambda: solid.cylinder((-2, 0, 0), (2, 0, 0), "1/2", "a") | solid.cylinder((0, -2, 0), (0, 2, 0), "1/2", "b"),
        4e-3,
    ),
    "27 bars": (lattice, 2e-3),
    "gear of 40 sides": (lambda: gear(20), 1e-3),
    "plate, 15 holes": (plate, 1e-3),
    "wall of 1/200": (lambda: solid.ball((0, 0, 0), 1) - solid.ball((0, 0, 0), "99/100"), 2e-3),
    "box, wall of 1/200": (
        lambda: solid.box((0, 0, 0), (1, 1, 1)) - solid.box(("1/200",) * 3, ("199/200",) * 3, "inside"),
        1e-3,
    ),
    "node of three pipes": (pipes, 1e-2),
    "teapot": (lambda: _moved(teapot().solid), 1e-3),
    "teapot (paper)": (lambda: _moved(teapot("paper").solid), 1e-3),
    "its lid": (lambda: _moved(teapot().lid), 4e-3),
    "its hollow pot": (lambda: _moved(teapot().pot), 4e-3),
}


def _moved(shape: Solid) -> Solid:
    """The same solid with nothing kept from its proofs."""
    return shape.translate((0, 0, 0))


def pictures(pot: Teapot, folder: Path) -> dict[str, float]:
    """Seconds of each step."""
    start, result = time.perf_counter(), {}

    def done(name: str) -> None:
        nonlocal start
        result[name] = time.perf_counter() - start
        start = time.perf_counter()

    whole = pot.solid.mesh(1e-3)
    done("mesh of the whole")
    for look in (Look.FOUR_VIEWS, Look.ZEBRA):
        draw_parts(whole, folder / "x.png", look=look)
        done(look.value)
    meshes = pot.assembly.meshes(4e-3)
    done("meshes of pot and lid")
    for look in (Look.EXPLODED, Look.CUT):
        draw_parts(pot.assembly, folder / "x.png", look=look, meshes=meshes)
        done(look.value)
    return result


parser = argparse.ArgumentParser(description="Time the meshes of solids.")
parser.add_argument("--repeat", type=int, default=3)
repeat = parser.parse_args().repeat
print(f"{'solid':<20}{'tolerance':>10}{'triangles':>11}{'angle':>7}{'seconds':>9}")
for name, (make, tolerance) in CASES.items():
    spent = []
    for _ in range(repeat):
        shape = make()
        begin = time.process_time()
        mesh = shape.mesh(tolerance)
        spent.append(time.process_time() - begin)
    angle = mesh.smallest_angles.min()
    print(f"{name:<20}{tolerance:>10g}{len(mesh.triangles):>11}{angle:>7.1f}{median(spent):>9.2f}")
with tempfile.TemporaryDirectory() as folder:
    for name, seconds in pictures(teapot(), Path(folder)).items():
        print(f"{name:<48}{seconds:>9.2f}")
