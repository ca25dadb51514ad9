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

from itertools import combinations
from math import frexp, ldexp, sqrt

from flint import fmpq, fmpq_mat

from pas.algebra.affine import quadratic_form
from pas.algebra.inputs import short
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import UNITS, Vector, cross, exact, listed, plain, square_root, three, to_float, two_across
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
    """Raise `GeometryError` where the point from which a contact opens, if it does, is not inside the inner surface."""
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


def principal_axes(matrix: fmpq_mat) -> Axes | None:
    """Three rational eigenvectors of a symmetric matrix, with their eigenvalues, exact; None where there are none."""
    found: list[tuple[Vector, fmpq]] = []
    for value, times in matrix.charpoly().roots():
        rows = _less(matrix, value)
        across = next((row for row in rows if any(row)), None)
        alone = (v for pair in combinations(rows, 2) if any(v := cross(*pair)))
        own = UNITS if across is None else two_across(across) if times > 1 else [next(alone)]
        found += [(three(c / max(way, key=abs) for c in way), value) for way in own]
    return tuple(found) if len(found) == len(UNITS) else None


def axis_of_revolution(form: fmpq_mat) -> tuple[fmpq, fmpq, Vector] | None:
    """A double eigenvalue of a symmetric matrix (3, 3), the other one and an eigenvector of that; None without one."""
    double = next((value for value, times in form.charpoly().roots() if times > 1), None)
    if double is None:
        return None
    single = form[0, 0] + form[1, 1] + form[2, 2] - 2 * double
    return double, single, next((row for row in _less(form, double) if any(row)), UNITS[2])


def _less(matrix: fmpq_mat, value: fmpq) -> list[Vector]:
    """The rows of a matrix (3, 3) less a value on its diagonal."""
    return [three(matrix[i, j] - value * (i == j) for j in range(3)) for i in range(3)]


def quadratic_terms(f: Polynomial) -> fmpq_mat:
    """The symmetric matrix of the terms of degree 2, of a polynomial of no higher degree."""
    return fmpq_mat([row[:3] for row in quadratic_form(f).tolist()[:3]])
