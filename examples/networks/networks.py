"""Networks of struts: lattices, a foam and two frames, each a proved body, with files for printing and pictures.

    python examples/networks/networks.py [-o DIR] [NAME ...]

prints classes of nodes, density and verdicts, and writes NAME.3mf and NAME.png into DIR (default: out/networks).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np

from pas import network
from pas.network import Network


def octet() -> Network:
    """A block of the octet truss, whose density is about 32 %."""
    return network.lattice("octet", (3, 3, 2), radius="7/100")


def kelvin_ball() -> Network:
    """The cells of Kelvin's foam whose corners are all within a ball; struts that end there are left out."""
    block = network.lattice("Kelvin", 5, radius="1/24")
    inside = np.linalg.norm(block.points - 2.5, axis=1) < 2.3
    kept = block.edges[inside[block.edges].all(axis=1)]
    while (single := np.bincount(kept.ravel(), minlength=len(inside))[kept] == 1).any():
        kept = kept[~single.any(axis=1)]
    return Network(block.points, kept, "1/24", block.grid).repair()[0]


def foam() -> Network:
    """Edges of random cells, as of a sponge: the shortest have become points.

    Where struts leave a node at narrow angles its blend bends sharply; here all angles are over 60 degrees.
    """
    return network.voronoi(4, "1/60", seed=50).repair(collapse=True)[0]


def bicycle() -> Network:
    """The frame of a bicycle in millimetres: head, seat, top and down tube, bottom bracket, and stays that part.

    Stays are cones, thinner at the wheel; tubes that end are flat there.
    """
    bracket, seat, upper, lower = (0, 0, 0), (-150, 0, 500), (390, 0, 560), (420, 0, 460)
    chain, wish, wheel = (-220, 0, 38), (-270, 0, 306), [(-415, side * 66, 72) for side in (-1, 1)]
    tubes = [
        ((372, 0, 620), upper, (18, 18)),
        (upper, lower, (18, 18)),
        (lower, (441, 0, 390), (18, 18)),
        (bracket, seat, (16, 16)),
        (seat, (-165, 0, 550), (16, 16)),
        (seat, upper, (14, 14)),
        (bracket, lower, (18, 18)),
        *((bracket, (0, side * 60, 0), (20, 20)) for side in (-1, 1)),
        (bracket, chain, (12, 12)),
        (seat, wish, (10, 10)),
        *((chain, end, (12, 8)) for end in wheel),
        *((wish, end, (10, 8)) for end in wheel),
    ]
    points = sorted({end for tube in tubes for end in tube[:2]})
    edges = [(points.index(first), points.index(second)) for first, second, _ in tubes]
    return Network(points, edges, [radii for *_, radii in tubes], grid=1)


def space_frame() -> Network:
    """A roof of two square grids, half a bay apart, with diagonals between them, thinner than the chords."""
    bays = 3
    below = [(2 * x, 2 * y, 0) for x in range(bays + 1) for y in range(bays + 1)]
    above = [(2 * x + 1, 2 * y + 1, 1.5) for x in range(bays) for y in range(bays)]
    chords = [
        (p, q)
        for layer in (below, above)
        for p in layer
        for q in layer
        if (q[0] - p[0], q[1] - p[1]) in ((2, 0), (0, 2))
    ]
    diagonals = [(p, q) for p in below for q in above if abs(p[0] - q[0]) == abs(p[1] - q[1]) == 1]
    points = below + above
    edges = [(points.index(p), points.index(q)) for p, q in chords + diagonals]
    return Network(points, edges, ["1/8"] * len(chords) + ["1/10"] * len(diagonals), grid="1/2")


EXAMPLES: dict[str, Callable[[], Network]] = {
    "octet": octet, "kelvin_ball": kelvin_ball, "foam": foam, "bicycle": bicycle, "space_frame": space_frame,
}  # fmt: skip


def main() -> None:
    """Make what is named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(EXAMPLES)} (default: all)")
    parser.add_argument("-o", "--output", default="out/networks", metavar="DIR")
    options = parser.parse_args()
    folder = Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    for name in options.names or EXAMPLES:
        part = EXAMPLES[name]().blend(cache=folder / "kept")
        print(f"{name}\n{part}\n")
        part.write(folder / f"{name}.3mf", unit="mm")
        part.draw(folder / f"{name}.png")


if __name__ == "__main__":
    main()
