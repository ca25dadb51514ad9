"""Planes through exact points, in whole numbers: points are taken times a common denominator of their coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from math import gcd, lcm

from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import Vector
from pas.errors import GeometryError

Whole = tuple[int, int, int]

LINEAR = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0))
"""The exponents of x, y, z and 1."""


def plane_through(a: Vector, b: Vector, c: Vector) -> Polynomial:
    """The plane through three points, as a linear polynomial with coprime integer coefficients."""
    denominator, (p, q, r) = over_one((a, b, c))
    return linear(normal(p, q, r), p, denominator, 1)


def over_one(points: Sequence[Vector]) -> tuple[int, list[Whole]]:
    """A common denominator, and points times it."""
    denominator = lcm(*(int(x.q) for point in points for x in point))
    whole = [[int(x.p) * (denominator // int(x.q)) for x in point] for point in points]
    return denominator, [(x, y, z) for x, y, z in whole]


def normal(a: Whole, b: Whole, c: Whole) -> Whole:
    """The vector product of b - a and c - a."""
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    u, v, w = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return y * w - z * v, z * u - x * w, x * v - y * u


def linear(way: Whole, point: Whole, denominator: int, sign: int) -> Polynomial:
    """What rises along a way, times a sign, from 0 at a point over a denominator; coprime integer coefficients."""
    x, y, z = way
    values = denominator * x, denominator * y, denominator * z, -(x * point[0] + y * point[1] + z * point[2])
    divisor = sign * gcd(*values)
    if divisor == 0:
        raise GeometryError("three points of a face are on one line")
    return Polynomial.from_raw(RING.from_dict({e: v // divisor for e, v in zip(LINEAR, values, strict=True) if v}))
