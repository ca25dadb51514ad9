"""Networks of struts: lattices, a foam and a frame, each a proved body, with files for printing and pictures.

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


def tower() -> Network:
    """A small truss tower whose legs lean in, thicker than its rings and braces."""
    points = [((3 - k) * x, (3 - k) * y, 4 * k) for k in range(3) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    legs = [(n, n + 4) for n in range(8)]
    rings = [(k + n, k + (n + 1) % 4) for k in (0, 8) for n in range(4)]
    braces = [(4 + n, 8 + (n + 1) % 4) for n in range(4)]
    radii = ["1/5"] * len(legs) + ["3/25"] * len(rings + braces)
    return Network(points, legs + rings + braces, radii, grid=1)


EXAMPLES: dict[str, Callable[[], Network]] = {"octet": octet, "kelvin_ball": kelvin_ball, "foam": foam, "tower": tower}


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
