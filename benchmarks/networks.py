"""Lattices of a thousand nodes: proved and smooth here, beside the creased union of cylinders and balls by manifold3d.

    python benchmarks/networks.py [NAME ...]

prints, of each lattice at a ratio of radius to length: seconds of processor time for the blends of its classes, for its
mesh and its certificate, triangles and the share of them with an angle below five degrees, volume; and seconds,
triangles, slivers and volume of the union whose cylinders and balls are as near to round ones as that mesh is to its
surface.  All of one run.
"""

from __future__ import annotations

import sys
import time
from math import acos, ceil, pi

import manifold3d
import numpy as np

from pas import network

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


def main(names: list[str]) -> None:
    """Print the table."""
    print("lattice   struts | blends  mesh  proof  triangles slivers  volume | union triangles slivers  volume")
    for name in names or CASES:
        cells, radius = CASES[name]
        net = network.lattice(name, cells, radius)
        clock = [time.process_time()]
        part = net.blend()
        clock.append(time.process_time())
        mesh = part.mesh()
        clock.append(time.process_time())
        proved = part.certificate.proved and mesh.certificate.proved
        clock.append(time.process_time())
        other = union(net, part.pieces().deviation)
        found = other.to_mesh()
        clock.append(time.process_time())
        blends, meshing, proof, joining = np.diff(clock)
        points, triangles = np.asarray(found.vert_properties)[:, :3], np.asarray(found.tri_verts)
        print(
            f"{name:8} {len(net.edges):7d} | {blends:6.1f} {meshing:5.2f} {proof:6.1f} {len(mesh.triangles):10d} "
            f"{slivers(mesh.points, mesh.triangles):7.1%} {part.volume:7.2f} | {joining:5.1f} {len(triangles):9d} "
            f"{slivers(points, triangles):7.1%} {other.volume():7.2f}" + ("" if proved else "  NOT PROVED"),
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
