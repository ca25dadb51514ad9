"""Three perpendicular unit cylinders, joined with GC^1 by one polynomial.

Yu, Sun and Ma (2006, example 4.2) speak of a quadratic surface; the lowest degree is 4, with
two dimensions: the printed quartic and the square of the sphere x^2 + y^2 + z^2 = 5, which is
singular along all three circles.
"""

from __future__ import annotations

from pathlib import Path

import pas

PICTURE = Path(__file__).parent / "pictures" / "three_cylinders.png"
CONTACTS = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2"), ("x^2 + y^2 - 1", "z - 2")]
REGION = pas.SingleCell(lower=(-2, -2, -2), upper=(2, 2, 2))


def main(picture: Path = PICTURE) -> pas.Blend:
    """Solve by four methods, choose, prove and draw."""
    for method in ("linear", "normal-form", "intersection", "syzygy"):
        space = pas.solutions(CONTACTS, order=1, partition=REGION, method=method)
        print(f"{method:<13} degree {space.degree}, dimension {space.dimension}")
    print(space.trivial_part)
    blend = pas.blend(CONTACTS, order=1, partition=REGION)
    print(blend)
    pas.draw(blend.surface, picture, style=pas.Style.ZEBRA, size=(480, 360))
    return blend


if __name__ == "__main__":
    main()
