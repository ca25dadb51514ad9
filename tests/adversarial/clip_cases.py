"""A surface at a contact with what may be said of it, affine maps of such, and random polynomials.

All are made in the box [-1, 1]^3 or one like it and moved by an affine map, exactly: membership, the
sign of alpha, curves and their places do not change under it.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

import pas
from pas import Polynomial, Status

PROVED, REFUTED, UNDECIDED = {Status.PROVED}, {Status.REFUTED}, {Status.UNDECIDED}
NEVER_PROVED, NEVER_REFUTED = REFUTED | UNDECIDED, PROVED | UNDECIDED

T = Polynomial("x - 1")
"""The plane of the face that carries the contact."""

Check = Callable[[np.ndarray], bool]


@dataclass(frozen=True)
class Case:
    """One contact (the first) of a surface with one polynomial, and what may be said of it.

    `allowed` are the verdicts that are true or cautious; any other is false.

    `wrong` tells in the coordinates of construction whether a witness (3,) witnesses.
    """

    name: str
    contacts: tuple[tuple[Polynomial, Polynomial], ...]
    order: int
    patch: Polynomial
    allowed: set[Status]
    wrong: Check | None = None
    enclosed: set[Status] | None = None
    region: pas.Partition = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    place: tuple[np.ndarray, np.ndarray] = (np.eye(3), np.zeros(3))

    def surface(self) -> pas.PiecewiseSurface:
        """The surface, unproved."""
        contacts = [pas.Contact(*c) for c in self.contacts]
        patches = [self.patch] * len(self.region.pieces)
        return pas.PiecewiseSurface.from_polynomials(self.region, contacts, self.order, patches)

    def back(self, point: object) -> np.ndarray:
        """A point in the coordinates of construction."""
        matrix, shift = self.place
        return np.linalg.solve(matrix, np.array(point) - shift)


def moved(case: Case, rng: random.Random) -> Case:
    """The case under a random affine map, and its polynomials times positive numbers of any size."""
    size = Fraction(10) ** rng.randint(-4, 4)
    while True:
        matrix = [[size * rng.choice((-1, 0, 0, 1, Fraction(1, 2), 2)) for _ in range(3)] for _ in range(3)]
        inverse = _inverse(matrix)
        if inverse is not None and _stretch(matrix) < 12:
            break
    shift = [size * Fraction(rng.randint(-40, 40), 7) for _ in range(3)]
    variables = [Polynomial(v) for v in "xyz"]
    images = [sum(((variables[j] - shift[j]) * inverse[i][j] for j in range(3)), Polynomial(0)) for i in range(3)]

    def there(polynomial: Polynomial) -> Polynomial:
        return polynomial.compose(*images)

    def scaled(polynomial: Polynomial) -> Polynomial:
        return there(polynomial) * Fraction(10) ** rng.choice((0, 0, -300, -7, 5, 300))

    region = case.region
    vertices = [[sum(matrix[i][j] * Fraction(str(v[j])) for j in range(3)) + shift[i] for i in range(3)]
                for v in region.vertices]  # fmt: skip
    middle = region.center
    center = middle and [sum(matrix[i][j] * Fraction(str(middle[j])) for j in range(3)) + shift[i] for i in range(3)]
    return replace(
        case,
        contacts=tuple((scaled(f), scaled(h)) for f, h in case.contacts),
        patch=scaled(case.patch),
        region=pas.Partition(vertices, region.cells, center, region.pieces),
        place=(np.array(matrix, dtype=float), np.array(shift, dtype=float)),
    )


def _inverse(m: list[list[Fraction]]) -> list[list[Fraction]] | None:
    cofactor = [
        [m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
         - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3] for j in range(3)]
        for i in range(3)
    ]  # fmt: skip
    determinant = sum(m[0][j] * cofactor[0][j] for j in range(3))
    return None if determinant == 0 else [[cofactor[j][i] / determinant for j in range(3)] for i in range(3)]


def _stretch(m: list[list[Fraction]]) -> float:
    return float(np.linalg.cond(np.array(m, dtype=float)))


def number(rng: random.Random, low: float, high: float) -> Fraction:
    """A fraction between two numbers with a denominator of 60."""
    return Fraction(rng.randint(round(60 * low), round(60 * high)), 60)


def linear(rng: random.Random, size: float) -> Polynomial:
    """A linear polynomial of absolute value below `size` on the box."""
    part = size / 4
    return Polynomial({e: number(rng, -part, part) for e in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))})


def positive(rng: random.Random) -> Polynomial:
    """A polynomial that is positive on the box."""
    return 1 + linear(rng, 0.8) + linear(rng, 1) ** 2


def ellipse(
    rng: random.Random, y: Fraction | None = None, z: Fraction | None = None, largest: float = 0.45
) -> Polynomial:
    """A polynomial in y and z, negative inside an ellipse that fits a face of the box."""
    a, b = (number(rng, -0.3, 0.3) if c is None else c for c in (y, z))
    v, w = Polynomial("y") - a, Polynomial("z") - b
    return (
        v * v * number(rng, 1, 2)
        + w * w * number(rng, 1, 2)
        + v * w * number(rng, -0.5, 0.5)
        - number(rng, 0.15, largest) ** 2
    )


def near(*polynomials: Polynomial, tolerance: float = 1e-7) -> Check:
    """That all polynomials vanish at a point, up to rounding."""
    return lambda p: all(abs(q(p)) < tolerance for q in polynomials)


def below(polynomial: Polynomial, *on: Polynomial, tolerance: float = 1e-7) -> Check:
    """That a polynomial is negative at a point, and that others vanish there."""
    return lambda p: polynomial(p) < tolerance and near(*on, tolerance=tolerance)(p)
