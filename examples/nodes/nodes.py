"""Nodes of pipes and other surfaces in any directions: blended, proved, measured, and drawn in one sheet.

    python examples/nodes/nodes.py [-o DIR] [NAME ...]

prints a table and writes `nodes.png` into DIR (default: this folder): each node from two sides, plain at GC^1 and with
stripes at GC^2.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from math import cos, radians, sin
from pathlib import Path

from PIL import Image

import pas

HERE = Path(__file__).parent
SIZE = (360, 300)
VIEWS = ((1.0, -1.6, 1.1), (-1.2, 1.3, -0.8))
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def back(axis: tuple[int, int, int]) -> tuple[int, int, int]:
    """The opposite direction."""
    return -axis[0], -axis[1], -axis[2]


def bicycle() -> list[tuple[tuple[str, str, str], str]]:
    """The bottom bracket of a racing bicycle in millimetres: the shell both ways, seat and down tube.

    The seat tube leans back by 17 degrees from the vertical, the down tube forward by 51.
    """
    seat, down = radians(90 + 17), radians(90 - 51)
    tubes = [("0", "1", "0"), ("0", "-1", "0"), exact(cos(seat), 0, sin(seat)), exact(cos(down), 0, sin(down))]
    return list(zip(tubes, ("20", "20", "143/10", "159/10"), strict=True))


def joint() -> list[tuple[tuple[int, int, int] | tuple[str, str, str], str]]:
    """A joint of a bicycle's frame in millimetres: a tube that leans by 17 degrees out of a wider one's side."""
    lean = radians(73)
    return list(zip((X, back(X), exact(cos(lean), sin(lean), 0)), ("17.45", "17.45", "14.3"), strict=True))


def exact(*direction: float) -> tuple[str, str, str]:
    """A direction with three decimals."""
    x, y, z = (f"{c:.3f}" for c in direction)
    return x, y, z


NODES = {
    "elbow": lambda order: pas.struts([(X, 1, 2), (Y, 1, 2)], order),
    "elbow of 120 degrees": lambda order: pas.struts([((1, -1, 0), 1), ((0, 1, -1), "3/5")], order),
    "T": lambda order: pas.struts([(X, 1, 2), (back(X), 1, 2), (Y, 1, 2)], order),
    "T with a narrower branch": lambda order: pas.struts([(X, 1, 2), (back(X), 1, 2), (Y, "4/5", 2)], order),
    "bicycle joint": lambda order: pas.struts(joint(), order),
    "Y": lambda order: pas.struts([((2, -1, -1), 1), ((-1, 2, -1), 1), ((-1, -1, 2), 1)], order),
    "cross": lambda order: pas.struts([(X, 1, 2), (back(X), 1, 2), (Y, 1, 2), (back(Y), 1, 2)], order),
    "tetrahedral": lambda order: pas.struts(
        [(v, "1/2") for v in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))], order
    ),
    "five directions": lambda order: pas.struts(
        [((4, 1, 1), 1), ((-1, 3, 1), "4/5"), ((-4, -1, 1), 1), ((0, -3, 2), "6/5"), ((1, 1, -4), 1)], order
    ),
    "six-way": lambda order: pas.struts([(axis, 1, 2) for v in (X, Y, Z) for axis in (v, back(v))], order),
    "axes that miss": lambda order: [
        pas.Pipe(X, "1/3", 1, (0, "1/20", "-1/30")),
        pas.Pipe(Y, "1/4", 1),
        pas.Pipe(Z, "2/5", 1),
    ],
    "cone and two pipes": lambda order: [
        pas.Cone(Z, "1/2", 2, "-1/4"),
        pas.Pipe(X, "1/2", 2),
        pas.Pipe((-1, 2, 0), "2/5", "3/4"),
    ],
    "sphere and pipe": lambda order: [
        pas.Contact("x^2 + y^2 + (z + 2)^2 - 4", "-z - 3/2"),
        pas.Pipe(Z, "1/2", 1),
    ],
    "pipe on a plate": lambda order: [pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)],
    "nozzle": lambda order: [pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)],
    "bottom bracket": lambda order: pas.struts(bicycle(), order),
}


def pictures(blend: pas.Blend, style: pas.Style) -> list[Image.Image]:
    """A blend from two sides."""
    with tempfile.TemporaryDirectory() as folder:
        found = []
        for number, view in enumerate(VIEWS):
            path = Path(folder) / f"{number}.png"
            pas.draw(blend.surface, path, style=style, view=view, size=SIZE)
            found.append(Image.open(path).convert("RGB"))
    return found


def main() -> None:
    """Blend, print and draw them all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="some of the nodes, by name")
    parser.add_argument("-o", "--output", type=Path, default=HERE)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in options.names or NODES:
        row = []
        for order, style in ((1, pas.Style.PLAIN), (2, pas.Style.ZEBRA)):
            start = time.process_time()
            blend = pas.blend(NODES[name](order), order)
            spent = time.process_time() - start
            found, beyond = blend.fairness, blend.fairness.beyond(blend.limits)
            print(
                f"| {name} | GC^{order} | {blend.surface.partition.title} | {blend.surface.degree} | "
                f"{blend.dimension} | "
                f"{found.sharpness:.2f} | {found.hollowness:.2f} | {found.bulge:.2f} | "
                f"{f'{found.waist:.3f}' if found.waisted else 'none'} | {spent:.1f} |"
                f"{' beyond: ' + ', '.join(beyond) if beyond else ''}",
                flush=True,
            )
            assert blend.certificate.proved
            row += pictures(blend, style)
        rows.append(row)
    whole = Image.new("RGB", (SIZE[0] * 4, SIZE[1] * len(rows)), "white")
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            whole.paste(picture, (SIZE[0] * j, SIZE[1] * i))
    palette = whole.quantize(256)  # shades that are dithered, not in steps
    few = whole.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
    few.save(options.output / "nodes.png", optimize=True)


if __name__ == "__main__":
    main()
