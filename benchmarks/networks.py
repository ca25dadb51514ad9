"""Lattices of a thousand nodes: proved and smooth here, beside the creased union of cylinders and balls by manifold3d.

    python benchmarks/networks.py [NAME ...]
    python benchmarks/networks.py --foam COUNT [--lowest]

prints, of each lattice at a ratio of radius to length: seconds of processor time for the blends of its classes, for its
mesh and its certificate, triangles and the share of them with an angle below five degrees, volume; and seconds,
triangles, slivers and volume of the union whose cylinders and balls are as near to round ones as that mesh is to its
surface.  All of one run.  With `--foam`: how many of so many nodes, drawn over a foam of ten thousand after repair, are
proved and fair, a line for each that is not, and seconds.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from math import acos, ceil, pi

import manifold3d
import numpy as np
from measured import spent as processor_seconds

from pas import network
from pas.errors import PasError
from pas.network import nodes
from pas.pipeline.blend import blend

CASES = {"cubic": (10, "1/5"), "BCC": (8, "1/8"), "octet": (6, "7/100"), "Kelvin": (5, "1/16"), "diamond": (5, "1/12")}
SLIVER = 5.0


def slivers(points: np.ndarray, triangles: np.ndarray) -> float:
    """The share of triangles with an angle below `SLIVER` degrees."""
    sides = np.roll(points[triangles], 1, axis=1) - points[triangles]
    units = sides / np.maximum(np.linalg.norm(sides, axis=2, keepdims=True), 1e-300)
    angles = np.degrees(np.arccos(np.clip(-(units * np.roll(units, 1, axis=1)).sum(axis=2), -1, 1)))
    return float((angles.min(axis=1) < SLIVER).mean())


def union(net: network.Network, deviation: float) -> manifold3d.Manifold:
    """Cylinders and balls of so many sides that chords are no farther from the circles than that."""
    radius = float(net.radii[0])
    sides = max(8, ceil(pi / acos(1 - deviation / radius)))
    ball = manifold3d.Manifold.sphere(radius, sides)
    parts = [ball.translate(p) for p in net.points.tolist()]
    for first, second in net.points[net.edges]:
        axis = (second - first) / np.linalg.norm(second - first)
        across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        across /= np.linalg.norm(across)
        frame = np.column_stack([across, np.cross(axis, across), axis, first])
        length = float(np.linalg.norm(second - first))
        parts.append(manifold3d.Manifold.cylinder(length, radius, radius, sides).transform(frame))
    return manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)


def foam(count: int, lowest: bool) -> None:
    """Print the shares of nodes of a foam that are proved and fair, and what others are beyond."""
    net = network.voronoi(2000, "1/630", seed=1).repair(collapse=True)[0]
    clock = processor_seconds()
    kinds = nodes.placed_ends(net, 1)
    print(f"{net}, {len(net.check())} problems; placed in {processor_seconds() - clock:.0f} s", flush=True)
    made, beyond, seconds = 0, Counter[str](), []
    for node in random.Random(38).sample(range(len(net.places)), count):
        kind, clock = kinds.kinds[kinds.of[node]], processor_seconds()
        try:
            found = blend(nodes.pipes_of(kind, net, 1), 1, "lowest" if lowest else None) if kind.blended else None
        except PasError as error:
            print(f"node {node}: {error}", flush=True)
        else:
            made += found is None or found.certificate.proved
            if found is not None and (why := found.fairness.beyond(found.limits)):
                print(f"node {node}: {', '.join(why)}", flush=True)
                beyond[" and ".join(sorted(measure.split()[0] for measure in why))] += 1
        seconds.append(processor_seconds() - clock)
    print(f"{made} of {count} proved, {made - beyond.total()} fair, others beyond limits by {dict(beyond)}")
    print(f"seconds: {np.mean(seconds):.1f} in the mean, {np.median(seconds):.1f} median, {max(seconds):.0f} at most")


def main() -> None:
    """Print the table, or the shares of a foam's nodes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(CASES)} (default: all)")
    parser.add_argument("--foam", type=int, metavar="COUNT")
    parser.add_argument("--lowest", action="store_true")
    options = parser.parse_args()
    if options.foam:
        foam(options.foam, options.lowest)
    else:
        table(options.names)


def table(names: list[str]) -> None:
    """Print the table."""
    print("lattice   struts | blends  mesh  proof  triangles slivers  volume | union triangles slivers  volume")
    for name in names or CASES:
        cells, radius = CASES[name]
        net = network.lattice(name, cells, radius)
        clock = [processor_seconds()]
        part = net.blend()
        clock.append(processor_seconds())
        mesh = part.mesh()
        clock.append(processor_seconds())
        proved = part.certificate.proved and mesh.certificate.proved
        clock.append(processor_seconds())
        other = union(net, part.pieces().deviation)
        found = other.to_mesh()
        clock.append(processor_seconds())
        blends, meshing, proof, joining = np.diff(clock)
        points, triangles = np.asarray(found.vert_properties)[:, :3], np.asarray(found.tri_verts)
        print(
            f"{name:8} {len(net.edges):7d} | {blends:6.1f} {meshing:5.2f} {proof:6.1f} {len(mesh.triangles):10d} "
            f"{slivers(mesh.points, mesh.triangles):7.1%} {part.volume:7.2f} | {joining:5.1f} {len(triangles):9d} "
            f"{slivers(points, triangles):7.1%} {other.volume():7.2f}" + ("" if proved else "  NOT PROVED"),
            flush=True,
        )


if __name__ == "__main__":
    main()
