"""Lattices of a thousand nodes: proved and smooth here, beside the creased union of cylinders and balls by manifold3d.

    python benchmarks/networks.py [NAME ...]
    python benchmarks/networks.py --foam COUNT [--lowest]
    python benchmarks/networks.py --whole CELLS [--cache FOLDER] [--lowest]

prints, of each lattice at a ratio of radius to length: seconds of processor time for the blends of its classes, for its
mesh and its certificate, triangles and the share of them with an angle below five degrees, volume; and seconds,
triangles, slivers and volume of the union whose cylinders and balls are as near to round ones as that mesh is to its
surface.  All of one run.  With `--foam`: how many of so many nodes, drawn in groups over a foam of ten thousand after
repair, are proved and fair, a line for each with the shares so far.  With `--whole`: a smaller foam as one mesh, looked
at by two libraries, beside that union; what a folder keeps of it is not made again.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from math import acos, ceil, pi

import manifold3d
import numpy as np
import trimesh
from measured import spent as processor_seconds
from scipy.spatial import cKDTree

from pas import network
from pas.errors import PasError
from pas.network import nodes
from pas.pipeline.blend import blend
from pas.settings import MeshSettings

CASES = {"cubic": (10, "1/5"), "BCC": (8, "1/8"), "octet": (6, "7/100"), "Kelvin": (5, "1/16"), "diamond": (5, "1/12")}
SLIVER, GROUP = 5.0, 10


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


def joined(part: network.NetworkPart) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of the bodies that files have, each in one of its places."""
    bodies = [body for body, _ in part.bodies(MeshSettings())]
    starts = np.cumsum([0, *(len(body.points) for body in bodies)])
    triangles = [body.triangles + start for body, start in zip(bodies, starts[:-1], strict=True)]
    return np.concatenate([body.points for body in bodies]), np.concatenate(triangles)


def around(net: network.Network, count: int) -> tuple[network.Network, list[int]]:
    """So many nodes in groups around points drawn over a network: what is within two struts of them, and their numbers.

    Ends are found from there: those of a whole foam take half an hour.
    """
    centers = random.Random(38).sample(range(len(net.places)), ceil(count / GROUP))
    wanted = np.unique(cKDTree(net.points).query(net.points[centers], GROUP)[1])
    kept = np.isin(np.arange(len(net.places)), wanted)
    for _ in range(2):
        kept[net.edges[kept[net.edges].any(axis=1)]] = True
    numbers = np.cumsum(kept) - 1
    edges = numbers[net.edges[kept[net.edges].all(axis=1)]]
    part = network.Network(net.points[kept], edges, net.radii[0], net.grid)
    return part, random.Random(38).sample(numbers[wanted].tolist(), len(wanted))


def foam(count: int, lowest: bool) -> None:
    """Print the shares of nodes of a foam that are proved and fair so far, and what others are beyond."""
    net = network.voronoi(2000, "1/630", seed=1).repair(collapse=True)[0]
    print(f"{net}, {len(net.check())} problems", flush=True)
    net, wanted = around(net, count)
    drawn = list(map(tuple, net.places[wanted].tolist()))
    clock = processor_seconds()
    while True:
        try:
            kinds = nodes.placed_ends(net, 1)
            break
        except network.NetworkError as error:
            print(f"{len(error.struts)} struts become points: {error}", flush=True)
            net = net.repair(collapse=error.struts)[0]
    numbers = {tuple(place): number for number, place in enumerate(net.places.tolist())}
    wanted = [numbers[place] for place in drawn if place in numbers]
    print(f"{len(wanted)} nodes in {net}, placed in {processor_seconds() - clock:.0f} s", flush=True)
    made, beyond, seconds = 0, Counter[str](), []
    for node in wanted:
        one, clock, said = kinds.classes[kinds.kinds[kinds.of[node]].form.key], processor_seconds(), "fair"
        try:
            found = blend(nodes.pipes_of(one), 1, "lowest" if lowest else None) if one.blended else None
        except PasError as error:
            said = f"not proved: {error}"
        else:
            made += 1
            if found is not None and (why := found.fairness.beyond(found.limits)):
                said = ", ".join(why)
                beyond[" and ".join(sorted(measure.split()[0] for measure in why))] += 1
        seconds.append(processor_seconds() - clock)
        done = f"{len(seconds)}: {made} proved, {made - beyond.total()} fair, {np.mean(seconds):.1f} s a node"
        print(f"{done}; node {node}, {seconds[-1]:.1f} s: {said}", flush=True)
    print(f"beyond limits by {dict(beyond)}; seconds: {np.median(seconds):.1f} median, {max(seconds):.0f} at most")


def whole(cells: int, cache: str, degree: str | None) -> None:
    """Print what a whole foam of so many cells, with struts like those of the other, comes to as one mesh."""
    net = network.voronoi(cells, f"1/{round(50 * cells ** (1 / 3))}", seed=1).repair(collapse=True)[0]
    clock = processor_seconds()
    part = net.blend(degree=degree, cache=cache)
    print(f"{net}: blends in {processor_seconds() - clock:.0f} s, {len(part.unfair)} not fair", flush=True)
    mesh = part.mesh()
    solid = manifold3d.Manifold(manifold3d.Mesh(mesh.points.astype(np.float32), mesh.triangles.astype(np.uint32)))
    closed = trimesh.Trimesh(mesh.points, mesh.triangles, process=False)
    print(
        f"{len(mesh.triangles)} triangles, watertight {closed.is_watertight}, genus {part.genus}, by euler number "
        f"{1 - closed.euler_number // 2}, by manifold3d {solid.genus()} ({solid.status()}); "
        f"{slivers(mesh.points, mesh.triangles):.1%} slivers",
        flush=True,
    )
    other = union(net, part.pieces().deviation)
    found = other.to_mesh()
    points, triangles = np.asarray(found.vert_properties)[:, :3], np.asarray(found.tri_verts)
    print(
        f"cylinders and balls: {len(triangles)} triangles, {slivers(points, triangles):.1%} slivers, volume "
        f"{other.volume():.4g}; here {part.volume:.4g}; bodies of files: "
        f"{slivers(*joined(part)):.1%} of {len(joined(part)[1])}",
        flush=True,
    )
    print(part.certificate, mesh.certificate, sep="\n")
    print(f"{processor_seconds() - clock:.0f} s in all")


def main() -> None:
    """Print the table, or the shares of a foam's nodes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(CASES)} (default: all)")
    parser.add_argument("--foam", type=int, metavar="COUNT")
    parser.add_argument("--whole", type=int, metavar="CELLS")
    parser.add_argument("--cache", metavar="FOLDER")
    parser.add_argument("--lowest", action="store_true")
    options = parser.parse_args()
    if options.whole:
        whole(options.whole, options.cache, "lowest" if options.lowest else None)
    elif options.foam:
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
