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

from math import frexp, isqrt, ldexp, sqrt

from flint import fmpq

from pas.algebra.inputs import short
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import exact, plain, to_float
from pas.algebra.scaling import Scaled
from pas.contacts.cones import apex
from pas.contacts.contact import CONTACTS, Contact
from pas.errors import GeometryError

DIGITS = 32
"""Binary digits of numbers that are irrational: few enough for short polynomials, too fine for walls."""


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
            f"contact {number} opens along a cone from ({', '.join(map(plain, point))}), which is no more than the "
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
    p, q = int(square.p), int(square.q)
    if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
        return fmpq(isqrt(p), isqrt(q))
    return rounded(sqrt(to_float(square)))


def rounded(value: float) -> fmpq:
    """A number to its first `DIGITS` binary digits."""
    part, power = frexp(value)
    return exact(ldexp(round(part * 2**DIGITS), power - DIGITS))
