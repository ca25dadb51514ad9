"""The teapot: part list with proved joints, meshes and pictures.

    python examples/teapot/teapot.py --style better -o out/teapot --spout-tilt 1/10

Writes teapot.stl (closed, one piece), teapot.pas.json, parts.glb and parts.3mf (pot and lid apart), and
pictures of four views, isophotes, the parts exploded, and the pot cut in half.
"""

import argparse
import time
from pathlib import Path

from pas.designs.teapot import STYLES, teapot

parser = argparse.ArgumentParser(description="Build, prove, mesh and draw a teapot.")
parser.add_argument("--style", choices=STYLES, default="better")
parser.add_argument("--tolerance", type=float, default=1e-3, help="of the closed mesh (default 0.001)")
parser.add_argument("--lid-height", default="7/5")
parser.add_argument("--spout-tilt", default="0")
parser.add_argument("--handle-size", default="1")
parser.add_argument("-o", "--output", type=Path, default=Path("out/teapot"))
options = parser.parse_args()
options.output.mkdir(parents=True, exist_ok=True)


def told(text, start):
    print(f"{text:<32} {time.perf_counter() - start:6.2f} s")


start = time.perf_counter()
pot = teapot(
    options.style,
    lid_height=options.lid_height,
    spout_tilt=options.spout_tilt,
    handle_size=options.handle_size,
)
print(pot.solid)
told("built and proved", start)

start = time.perf_counter()
mesh = pot.solid.mesh(options.tolerance)
told(f"mesh, {len(mesh.triangles)} triangles", start)
print(f"volume {pot.solid.volume(options.tolerance):.4f}, area {pot.solid.area(options.tolerance):.4f}")
print(f"closed {mesh.is_closed}, pieces {mesh.components}, Euler characteristic {mesh.euler_characteristic}")

start = time.perf_counter()
mesh.draw(options.output / "views.png", four_views=True)
mesh.draw(options.output / "zebra.png", style="zebra")
told("pictures of the whole", start)

start = time.perf_counter()
parts = pot.assembly.meshes(4 * options.tolerance)
told("meshes of pot and lid", start)

start = time.perf_counter()
pot.assembly.draw(options.output / "exploded.png", exploded=True, mesh=parts)
pot.assembly.draw(options.output / "cut.png", cut=True, mesh=parts)
told("pictures of the parts", start)
mesh.write(options.output / "teapot.stl")
pot.assembly.save(options.output / "teapot.pas.json")
for suffix in ("glb", "3mf"):
    pot.assembly.write(options.output / f"parts.{suffix}", tolerance=4 * options.tolerance)
print("written:", *sorted(options.output.iterdir()), sep="\n  ")
