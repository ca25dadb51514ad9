"""Two elliptic cylinders on one axis, turned by a quarter turn against one another, with GC^2.

Pipes need not be round: contacts are any polynomials.  The transition from the wide ellipse to the tall
one is a single polynomial of degree 5.
"""

from __future__ import annotations

from pathlib import Path

import pas

PICTURE = Path(__file__).parent / "pictures" / "elliptic_cylinders.png"
CONTACTS = [("y^2/4 + z^2 - 1", "x - 2"), ("y^2 + z^2/4 - 1", "-x - 2")]
REGION = pas.SingleCell(lower=(-2, -3, -3), upper=(2, 3, 3))


def main(picture: Path = PICTURE) -> pas.Blend:
    """Choose, prove and draw."""
    blend = pas.blend(CONTACTS, order=2, partition=REGION)
    print(blend)
    pas.draw(blend.surface, picture, style=pas.Style.ZEBRA, size=(480, 360))
    return blend


if __name__ == "__main__":
    main()
