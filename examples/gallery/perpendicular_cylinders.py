"""Two perpendicular cylinders, an elbow: when is there a blend at all?

The normal forms of Yu, Sun and Ma (2006) give one cubic that meets both unit cylinders with GC^1, and one for
other radii r and distances d only if r1^2 + d1^2 = r2^2 + d2^2.  Their "if and only if" holds
for cubics alone: from degree 4 on there are blends for all radii and distances.

Xu, Chen and Deng (example 3) choose among five of the quartics by thin-plate energy with the point
(-1/4, -1/4, 0) inside.  The four numbers printed there are not the optimum; the exact one, found
here, has energy 449.23.  Its certificate is refuted (it reaches the walls of the box); the member
drawn is the fairest one that was found with a proof.
"""

from __future__ import annotations

from pathlib import Path

import sympy

import pas

PICTURE = Path(__file__).parent / "pictures" / "perpendicular_cylinders.png"
CONTACTS = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
REGION = pas.SingleCell(lower=(-2, -2, -2), upper=(2, 2, 2))
ENERGY = pas.ThinPlate(pas.Box(lower=(-2, -2, -2), upper=(2, 2, 2)))
PUBLISHED = [
    "(x + y - 4)*(y^2 + z^2 - 1) + (x + y)*(x - 2)^2",
    "(z^2 - 4*y + 11)*(y^2 + z^2 - 1) + (z^2 - 4*x - 5)*(x - 2)^2",
    "(y^2 - 4*y + 4)*(x - 2)^2",
    "(y^2 - 4*y + 4)*(y^2 + z^2 - 1) + (y^2 - 4*y + 4)*(x - 2)^2",
    "(x^2 + z^2 - 1)*(x - 2)^2",
]


def conditions() -> pas.Existence:
    """For which radii and distances a cubic exists."""
    r1, r2, d1, d2 = sympy.symbols("r1 r2 d1 d2", positive=True)
    contacts = [(f"y^2 + z^2 - {r1}^2", f"x - {d1}"), (f"x^2 + z^2 - {r2}^2", f"y - {d2}")]
    return pas.existence(contacts, order=1, degree=3, parameters=(r1, r2, d1, d2))


def main(picture: Path = PICTURE) -> tuple[pas.Optimum, pas.Blend]:
    """Conditions, the optimum of Xu, Chen and Deng's problem, and a proved member; returns the last two."""
    print(conditions())
    quartics = pas.solutions(CONTACTS, order=1, degree=4, partition=REGION)
    five = quartics.restricted([(g,) for g in PUBLISHED])
    optimum = five.optimum(ENERGY, inside=[("-1/4", "-1/4", 0)])
    print("Xu, Chen and Deng:", *optimum.coefficients, f"energy {float(optimum.energy):.6g}")
    blend = pas.blend(CONTACTS, order=1, partition=REGION)
    print(blend)
    pas.draw(blend.surface, picture, size=(480, 360))
    return optimum, blend


if __name__ == "__main__":
    main()
