"""Contacts of the inner side of a wall: for each contact a surface a thickness inside, clipped the same.

What a contact is, is recognised from its polynomial, so that blends loaded from files serve as well: by the function
`inner_surface` of the kinds of contacts that have one.  Planes, spheres, circular cylinders and tori get their parallel
surfaces; cones, and what else widens from a tip (paraboloids, hyperboloids of two sheets), move along their axes, so
that cones get theirs as well.  Ellipsoids, elliptic cylinders and hyperboloids of one sheet, whose parallel surfaces
are of higher degree, get semi-axes less the thickness.

Guaranteed: the polynomials are exact.  Parallel surfaces are exact where the radii are rational; irrational numbers are
rounded to 32 binary digits.  Not guaranteed: that the inner surface is inside, which `pas.certify.nesting` proves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from math import frexp, ldexp, sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import quadratic_form, slope_at
from pas.algebra.inputs import short
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import (
    UNITS,
    Vector,
    cross,
    dot,
    exact,
    listed,
    plain,
    rational,
    square_root,
    three,
    to_float,
    to_floats,
    two_across,
)
from pas.algebra.scaling import Scaled
from pas.contacts.cones import apex
from pas.contacts.contact import CONTACTS, Contact
from pas.errors import GeometryError

DIGITS = 32
"""Binary digits of numbers that are irrational: few enough for short polynomials, too fine for walls."""


Axes = tuple[tuple[Vector, fmpq], ...]
"""Three vectors across one another, each with the eigenvalue of the quadratic form that belongs to it."""


def inner_contact(contact: Contact, thickness: fmpq, number: int = 1) -> Contact:
    """The contact a `thickness` (the model's units) inside another, with the same clip.

    Raises `GeometryError`, naming contact `number`, where the thickness is not below its radius, where the point from
    which a cone opens is not deeper inside, and where its surface is none of those that have an inner one.
    """
    factor = fmpq(2) ** Scaled.of([contact.surface]).exponent
    for rule in filter(None, (getattr(kind, "inner_surface", None) for kind in CONTACTS.values())):
        try:
            surface = rule(contact.scaled, thickness)
        except TooThickError as error:
            raise GeometryError(
                f"contact {number} has the radius {error}; the thickness must be below that, not {plain(thickness)}"
            ) from None
        if surface is not None:
            _check_apex(contact, surface, thickness, number)
            return Contact(Polynomial.from_raw(surface.raw * factor), contact.clip, contact.near)
    raise GeometryError(
        f"contact {number}: no inner surface is known for {short(str(contact.surface))}, only for planes, tori and "
        "quadrics with rational principal axes that have an inside; give the inner contacts yourself, as in "
        "blend.hollow(inner=[(surface, clip), ...])"
    )


def _check_apex(contact: Contact, inner: Polynomial, thickness: fmpq, number: int) -> None:
    """That the point from which a contact opens, if it does, is inside the inner surface as well."""
    point = apex(contact.clip)
    if point is not None and contact.surface.raw(*point) < 0 <= inner.raw(*point):
        raise GeometryError(
            f"contact {number} opens along a cone from ({listed(point)}), which is no more than the "
            f"thickness, {plain(thickness)}, inside; make the wall thinner, or let the cone open from further inside"
        )


class TooThickError(Exception):
    """A radius that the thickness is not below; its text is the radius."""


def shrunk(square: fmpq, thickness: fmpq) -> fmpq:
    """The square of the root of a number less the thickness."""
    radius = root(square)
    if radius <= thickness:
        raise TooThickError(f"{to_float(radius):.6g}")
    return (radius - thickness) ** 2


def root(square: fmpq) -> fmpq:
    """The square root of a positive number, exact where it is rational, else rounded."""
    exactly = square_root(square)
    return exactly if exactly**2 == square else rounded(sqrt(to_float(square)))


def rounded(value: float) -> fmpq:
    """A number to its first `DIGITS` binary digits."""
    part, power = frexp(value)
    return exact(ldexp(round(part * 2**DIGITS), power - DIGITS))


def principal_axes_of(surface: Polynomial, contact: Contact) -> Axes | None:
    """Those of a polynomial's terms of degree 2, one of which may be the normal of a contact's plane clip."""
    hint = slope_at(contact.clip) if contact.clip.degree == 1 else None
    return principal_axes(quadratic_terms(surface), hint)


def principal_axes(matrix: fmpq_mat, hint: Vector | None = None) -> Axes | None:
    """Three rational eigenvectors of a symmetric matrix, with their eigenvalues, exact; None where there are none.

    `hint` may be one of them.  Others are looked for in the kernel, and near eigenvectors in doubles.
    """
    for first in _candidates(matrix, hint):
        value = _eigenvalue(matrix, first)
        if value is None:
            continue
        for second in _turned(matrix, *two_across(first)):
            third = cross(first, second)
            values = [_eigenvalue(matrix, v) for v in (second, third)]
            if values[0] is not None and values[1] is not None:
                return (first, value), (second, values[0]), (third, values[1])
    return None


def _candidates(matrix: fmpq_mat, hint: Vector | None) -> Iterator[Vector]:
    if hint is not None:
        yield hint
    rows: list[Vector] = [(matrix[i, 0], matrix[i, 1], matrix[i, 2]) for i in range(3)]
    yield from (v for a, b in combinations(rows, 2) if any(v := cross(a, b)))
    yield from UNITS
    floats = np.array([to_floats(row) for row in rows])
    for column in np.linalg.eigh(floats)[1].T.tolist():
        yield _short([c / max(column, key=abs) for c in column])


def _turned(matrix: fmpq_mat, first: Vector, second: Vector) -> Iterator[Vector]:
    """Candidates for an eigenvector in the plane of two vectors across one another."""
    yield first
    a, b = (np.array(to_floats(v)) / sqrt(to_float(dot(v, v))) for v in (first, second))
    floats = np.array([[to_float(matrix[i, j]) for j in range(3)] for i in range(3)])
    plane = np.array([[u @ floats @ v for v in (a, b)] for u in (a, b)])
    for s, t in np.linalg.eigh(plane)[1].T.tolist():
        found = s * a + t * b
        yield _short((found / found[np.abs(found).argmax()]).tolist())


def _short(values: Sequence[float]) -> Vector:
    # Of coordinates of a principal axis that is neither the clip's normal nor follows from that: axes are found from
    # rounded numbers, and then checked exactly.
    largest_denominator = 10**6
    return three(rational(Fraction(v).limit_denominator(largest_denominator)) for v in values)


def _eigenvalue(matrix: fmpq_mat, vector: Vector) -> fmpq | None:
    """The eigenvalue of an eigenvector; None for another vector."""
    image = matrix * fmpq_mat(3, 1, list(vector))
    found: Vector = (image[0, 0], image[1, 0], image[2, 0])
    return None if any(cross(found, vector)) else dot(found, vector) / dot(vector, vector)


def axis_of_revolution(form: fmpq_mat) -> tuple[fmpq, fmpq, Vector] | None:
    """A double eigenvalue of a symmetric matrix (3, 3), the other one and an eigenvector of that; None without one."""
    characteristic = form.charpoly()
    common = characteristic.gcd(characteristic.derivative())
    if common.degree() == 0:
        return None
    double = -common[0] / common[1] if common.degree() == 1 else -common[1] / (2 * common[2])
    single = form[0, 0] + form[1, 1] + form[2, 2] - 2 * double
    rows = [three(form[i, j] - double * (i == j) for j in range(3)) for i in range(3)]
    return double, single, next((row for row in rows if any(row)), UNITS[2])


def quadratic_terms(f: Polynomial) -> fmpq_mat:
    """The symmetric matrix of the terms of degree 2, of a polynomial of no higher degree."""
    return fmpq_mat([row[:3] for row in quadratic_form(f).tolist()[:3]])
