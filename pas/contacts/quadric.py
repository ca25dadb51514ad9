"""Quadrics of any kind as contacts, by a polynomial or a matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import Any, ClassVar, TypeAlias

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.affine import height, slope_at, translation
from pas.algebra.inputs import set_fields, shown
from pas.algebra.polynomial import GENERATORS, RING, Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, dot, minus, rational, three, to_float, to_floats
from pas.arrays import Floats
from pas.contacts.cones import apex, nappe, nappe_rays
from pas.contacts.contact import Contact, Movable
from pas.contacts.parallels import Axes, TooThickError, principal_axes, quadratic_terms, rounded, shrunk

QuadricLike: TypeAlias = "PolynomialLike | Sequence[Sequence[Exact]]"
"""What is taken for a quadric: a polynomial of degree 2, or a symmetric 4x4 matrix of exact numbers."""


@dataclass(frozen=True, repr=False)
class QuadricContact(Movable):
    """A quadric with a clip: any of the kinds that there are, in any position.

    `quadric` is a polynomial of degree 2, or a symmetric 4x4 matrix Q of exact numbers that stands for
    `(x, y, z, 1) Q (x, y, z, 1)^T` (Salmon 1862); negative inside.  `clip` is a polynomial, as a rule a plane, negative
    on the blend's side.

    Raises `ValueError` for what is no quadric, for a constant clip and one that has a factor in common with the
    quadric.
    """

    table: ClassVar[str] = "quadrics"

    quadric: Polynomial
    clip: Polynomial

    def __init__(self, quadric: QuadricLike, clip: PolynomialLike) -> None:
        found = Contact(_polynomial(quadric), clip)
        if found.surface.degree != 2:
            raise ValueError(f"quadric must be of degree 2, and {found.surface} is of degree {found.surface.degree}")
        set_fields(self, quadric=found.surface, clip=found.clip)

    @cached_property
    def contact(self) -> Contact:
        return Contact(self.quadric, self.clip)

    @staticmethod
    def inner_surface(contact: Contact, thickness: fmpq) -> Polynomial | None:
        """The inner surface of a quadric; None for other surfaces, and those without principal axes or an inside."""
        f = contact.surface
        if f.degree != 2:
            return None
        axes = principal_axes(quadratic_terms(f))
        if axes is None:
            return None
        center = _center(f, axes)
        rest, slope = f.raw(*center), slope_at(f, center)
        values = [value for _, value in axes]
        if sum(v > 0 for v in values) < 2:
            return None
        if any(slope) or (rest >= 0 and min(values) < 0):
            return _moved_in(contact, thickness, axes)
        if rest >= 0:
            return None
        return _narrowed(axes, center, rest, thickness)

    def __str__(self) -> str:
        return f"quadric {self.quadric} = 0 up to {self.clip} = 0"


def _polynomial(quadric: Any) -> Polynomial:
    if isinstance(quadric, str) or not hasattr(quadric, "__len__") or hasattr(quadric, "keys"):
        return Polynomial.named(quadric, "quadric")
    if len(quadric) != 4 or any(not hasattr(row, "__len__") or len(row) != 4 for row in quadric):
        raise ValueError(
            f"quadric must be a polynomial or a symmetric matrix of 4 rows of 4 numbers, not {shown(quadric)}"
        )
    rows = [[rational(c, f"quadric[{i}][{j}]") for j, c in enumerate(row)] for i, row in enumerate(quadric)]
    wrong = next(((i, j) for i in range(4) for j in range(i) if rows[i][j] != rows[j][i]), None)
    if wrong is not None:
        i, j = wrong
        raise ValueError(f"quadric must be symmetric, and quadric[{i}][{j}] is not quadric[{j}][{i}]")
    four: list[fmpq_mpoly] = [*GENERATORS, RING.constant(1)]
    raw = sum((four[i] * four[j] * c for i, row in enumerate(rows) for j, c in enumerate(row)), RING.constant(0))
    return Polynomial.from_raw(raw)


def _narrowed(axes: Axes, center: Vector, rest: fmpq, thickness: fmpq) -> Polynomial:
    """An ellipsoid, an elliptic cylinder or a hyperboloid of one sheet with its semi-axes less the thickness."""
    squares = {i: shrunk(-rest / value, thickness) for i, (_, value) in enumerate(axes) if value > 0}
    first = min(squares)
    scale = axes[first][1] * squares[first]  # the first coefficient stays as it was
    raw = GENERATORS[0] * 0 - scale
    for i, (axis, value) in enumerate(axes):
        if value == 0:
            continue
        along = height(center, axis)
        by = 1 / squares[i] if i in squares else value / -rest
        raw += along * along * (scale * by / dot(axis, axis))
    return Polynomial.from_raw(raw)


def _moved_in(contact: Contact, thickness: fmpq, axes: Axes) -> Polynomial | None:
    """Of what widens from a tip: moved along its axis until it is the thickness inside at its rim.

    There a surface that moves along a unit vector a by s moves along its normal by `s |a . grad f| / |grad f|`, and a
    cone does so everywhere.
    """
    axis = min(axes, key=lambda pair: pair[1])[0]
    f = contact.surface
    middle, points = _curve(contact)
    slopes = f.gradient(points)
    along = slopes @ (np.array(to_floats(axis)) / sqrt(to_float(dot(axis, axis))))
    if not (along.min() > 0 or along.max() < 0):
        return None
    share = float((np.linalg.norm(slopes, axis=1) / np.abs(along)).max())
    way = -1 if along[0] > 0 else 1
    length = thickness * rounded(share / sqrt(to_float(dot(axis, axis))) * way)
    moved = translation([a * length for a in axis]).polynomial(f)
    turned = dot(slope_at(moved, middle), axis) * way >= 0  # the tip has passed the rim
    if turned or moved.raw(*middle) >= 0:
        radius = np.linalg.norm(points - np.array(to_floats(middle)), axis=1).min()
        raise TooThickError(f"{radius:.6g}")
    return moved


def _curve(contact: Contact) -> tuple[Vector, Floats]:
    """A point inside a quadric and points (N, 3) round its contact's curve.

    Of an opening they are in the nappe of its cone in which the point `near` is, or in both.
    """
    number = 64  # points round a curve that is in no plane
    f, point = contact.surface, apex(contact.clip)
    if point is None or f.raw(*point) >= 0:
        return contact.rim.center, contact.rim.points()
    towards = np.ones(3) if contact.near is None else np.array(to_floats(minus(contact.near, point)))
    rays = nappe_rays(nappe(contact.clip, towards), number)
    rays = np.concatenate([rays, -rays]) if contact.near is None else rays
    form = np.array([[to_float(entry) for entry in row] for row in quadratic_terms(f).tolist()])
    value, linear = to_float(f.raw(*point)), rays @ to_floats(slope_at(f, point))
    square = ((rays @ form) * rays).sum(axis=1)
    with np.errstate(all="ignore"):
        met = -2 * value / (linear + np.sqrt(linear * linear - 4 * square * value))  # the first that is positive
    return point, (np.array(to_floats(point)) + met[:, None] * rays)[met > 0]


def _center(f: Polynomial, axes: Axes) -> Vector:
    """The centre of a quadric, as far as it has one: along the axes with an eigenvalue other than 0."""
    slope = slope_at(f)
    shares = [-dot(slope, v) / (2 * value * dot(v, v)) if value else fmpq(0) for v, value in axes]
    return three(sum((s * v[i] for s, (v, _) in zip(shares, axes, strict=True)), fmpq(0)) for i in range(3))
