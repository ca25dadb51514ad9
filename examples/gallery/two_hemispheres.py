"""Two hemispheres of radii 2 and 1, joined with GC^2 by one polynomial.

Published by Lou, Feng, Chen and Deng (2002): the intersection of <g_i, h_i^3> by Groebner bases, and
its members by interpolation and by weighted least squares with the normalised distance.  The basis
p1, p2, p3 below is theirs, and the program finds it by itself.
"""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import pas

PICTURE = Path(__file__).parent / "pictures" / "two_hemispheres.png"
CONTACTS = [("(x + 2)^2 + y^2 + z^2 - 4", "-x - 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")]
REGION = pas.SingleCell(lower=(-2, -3, -3), upper=(1, 3, 3))
P1 = "-16 + 28*x - 15*x^2 + x^3 + 2*x^4 + 9*y^2 - 9*x*y^2 + 9*z^2 - 9*x*z^2"
P2 = "-16 + 36*x + 3*x^2 - 5*x^3 + 3*y^2 - 15*x*y^2 - 6*x^2*y^2 + 3*z^2 - 15*x*z^2 - 6*x^2*z^2"
P3 = "-16 + 12*x - 3*x^2 + x^3 + 21*y^2 - 9*x*y^2 - 6*y^4 + 21*z^2 - 9*x*z^2 - 12*y^2*z^2 - 6*z^4"
POINTS = [
    (0, "1/2", 0),
    (1 / 2, sqrt(3) / 2, 0),
    ("2/5", "4/5", 0),
    (1 - 1 / sqrt(2), 1 / sqrt(2), 0),
    (-1, sqrt(3), 0),
    ("-4/5", "8/5", 0),
    (-2 + sqrt(2), sqrt(2), 0),
]


def main(picture: Path = PICTURE) -> tuple[pas.LeastSquares, pas.Blend]:
    """The published fit and a proved blend; returns both."""
    space = pas.solutions(CONTACTS, order=2, partition=REGION, method="intersection")
    print("degree", space.degree, "dimension", space.dimension)
    basis = space.restricted([(P1,), (P2,), (P3,)])
    fit = basis.least_squares(POINTS)
    print("least squares:", *fit.coefficients, "quotient", fit.quotient)
    blend = pas.blend(CONTACTS, order=2, partition=REGION, near=[(0, "1/2", 0)])
    print(blend)
    pas.draw(blend.surface, picture, size=(480, 360))
    return fit, blend


if __name__ == "__main__":
    main()
