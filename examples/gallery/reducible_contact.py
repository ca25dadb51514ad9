"""A cross of two pipes as ONE contact: a reducible surface with a curved clip.

The quartic f = (y^2 + z^2 - 1)(x^2 + z^2 - 1) is two cylinders, and the sphere
h = x^2 + y^2 + z^2 - 5 cuts it in four circles at once.  The one ideal <f, h^2> says the same as four
contacts with four planes: both have the same two quartics, f itself and h^2.  Neither alone is a
blend (one is the cylinders again, the other is singular along the circles), but what lies between
is, and it is proved to be: for the four pipes, whose clips are sides of the box.
"""

from __future__ import annotations

from pathlib import Path

import pas

PICTURE = Path(__file__).parent / "pictures" / "reducible_contact.png"
REGION = pas.SingleCell(lower=(-2, -2, -2), upper=(2, 2, 2))
ONE = [("(y^2 + z^2 - 1)*(x^2 + z^2 - 1)", "x^2 + y^2 + z^2 - 5")]
FOUR = [
    ("y^2 + z^2 - 1", "x - 2"),
    ("y^2 + z^2 - 1", "-x - 2"),
    ("x^2 + z^2 - 1", "y - 2"),
    ("x^2 + z^2 - 1", "-y - 2"),
]


def main(picture: Path = PICTURE) -> tuple[bool, pas.Blend]:
    """Compare the two spaces, choose, prove and draw; returns whether they are equal, and the blend."""
    one = pas.solutions(ONE, order=1, partition=REGION)
    four = pas.solutions(FOUR, order=1, partition=REGION)
    equal = one.equals(four)
    print(f"one contact: {one}", f"four contacts: {four}", f"the same space: {equal}", sep="\n")
    print(one.trivial_part)
    blend = four.fit(inside=[(0, 0, 0)], normalize=pas.ValueAt((0, 0, 0), -1))
    print(blend)
    pas.draw(blend.surface, picture, size=(480, 360))
    return equal, blend


if __name__ == "__main__":
    main()
