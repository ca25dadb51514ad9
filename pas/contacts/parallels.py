"""Contacts of the inner side of a wall: for each contact a surface a thickness inside, clipped the same.

What a contact is, is recognised from its polynomial, so that blends loaded from files serve as well.  Planes, spheres,
circular cylinders and tori get their parallel surfaces; cones, and what else widens from a tip (paraboloids,
hyperboloids of two sheets), move along their axes, so that cones get theirs as well.  Ellipsoids, elliptic cylinders
and hyperboloids of one sheet, whose parallel surfaces are of higher degree, get semi-axes less the thickness.

Guaranteed: the polynomials are exact.  Parallel surfaces are exact where the radii are rational; irrational numbers are
rounded to 32 binary digits.  Not guaranteed: that the inner surface is inside, which `pas.certify.nesting` proves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from math import frexp, isqrt, ldexp, sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import translation
from pas.algebra.inputs import short
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, cross, dot, exact, minus, plain, to_float, to_floats
from pas.algebra.scaling import Scaled
from pas.contacts.cones import apex, nappe, nappe_rays
from pas.contacts.contact import Contact
from pas.errors import GeometryError

LARGEST_DENOMINATOR = 10**6
"""Of coordinates of a principal axis that is neither the clip's normal nor follows from that: axes are found from
rounded numbers, and then checked exactly."""

ROUND = 64
"""Points round a curve that is in no plane."""

DIGITS = 32
"""Binary digits of numbers that are irrational: few enough for short polynomials, too fine for walls."""

Axes = tuple[tuple[Vector, fmpq], ...]
"""Three vectors across one another, each with the eigenvalue of the quadratic form that belongs to it."""

ZERO = fmpq(0)
ORIGIN = (ZERO, ZERO, ZERO)
UNITS: tuple[Vector, ...] = tuple((fmpq(i == 0), fmpq(i == 1), fmpq(i == 2)) for i in range(3))


def inner_contact(contact: Contact, thickness: fmpq, number: int = 1) -> Contact:
    """The contact a `thickness` (the model's units) inside another, with the same clip.

    Raises `GeometryError`, naming contact `number`, where the thickness is not below its radius, where the point from
    which a cone opens is not deeper inside, and where its surface is none of those that have an inner one.
    """
    factor = fmpq(2) ** Scaled.of([contact.surface]).exponent
    for recognised in KINDS:
        try:
            surface = recognised(contact.scaled, thickness)
        except _TooThickError as error:
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


class _TooThickError(Exception):
    """A radius that the thickness is not below; its text is the radius."""


def _less(square: fmpq, thickness: fmpq) -> fmpq:
    """The square of the root of a number less the thickness."""
    radius = root(square)
    if radius <= thickness:
        raise _TooThickError(f"{to_float(radius):.6g}")
    return (radius - thickness) ** 2


def root(square: fmpq) -> fmpq:
    """The square root of a positive number, exact where it is rational, else rounded."""
    p, q = int(square.p), int(square.q)
    if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
        return fmpq(isqrt(p), isqrt(q))
    return _rounded(sqrt(to_float(square)))


def _rounded(value: float) -> fmpq:
    """A number to its first `DIGITS` binary digits."""
    part, power = frexp(value)
    return exact(ldexp(round(part * 2**DIGITS), power - DIGITS))


def _plane(contact: Contact, thickness: fmpq) -> Polynomial | None:
    """The plane inside a plane; None for other surfaces."""
    f = contact.surface
    if f.degree != 1:
        return None
    slope = _slope(f, ORIGIN)
    return f + Polynomial(thickness * root(dot(slope, slope)))


def _quadric(contact: Contact, thickness: fmpq) -> Polynomial | None:
    """The inner surface of a quadric; None for other surfaces, and those without principal axes or an inside."""
    f = contact.surface
    if f.degree != 2:
        return None
    axes = principal_axes(_matrix(f), _normal(contact))
    if axes is None:
        return None
    center = _center(f, axes)
    rest, slope = f.raw(*center), _slope(f, center)
    values = [value for _, value in axes]
    if sum(v > 0 for v in values) < 2:
        return None
    if any(slope) or (rest >= 0 and min(values) < 0):
        return _moved_in(contact, thickness, axes)
    if rest >= 0:
        return None
    return _narrowed(axes, center, rest, thickness)


def _narrowed(axes: Axes, center: Vector, rest: fmpq, thickness: fmpq) -> Polynomial:
    """Of an ellipsoid, an elliptic cylinder or a hyperboloid of one sheet: with its semi-axes less the thickness."""
    squares = {i: _less(-rest / value, thickness) for i, (_, value) in enumerate(axes) if value > 0}
    first = min(squares)
    scale = axes[first][1] * squares[first]  # the first coefficient stays as it was
    raw = GENERATORS[0] * 0 - scale
    for i, (axis, value) in enumerate(axes):
        if value == 0:
            continue
        along = sum(((g - c) * a for g, c, a in zip(GENERATORS, center, axis, strict=True)), GENERATORS[0] * 0)
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
    length = thickness * _rounded(share / sqrt(to_float(dot(axis, axis))) * way)
    x, y, z = (a * length for a in axis)
    moved = translation((x, y, z)).polynomial(f)
    turned = dot(_slope(moved, middle), axis) * way >= 0  # the tip has passed the rim
    if turned or moved.raw(*middle) >= 0:
        radius = np.linalg.norm(points - np.array(to_floats(middle)), axis=1).min()
        raise _TooThickError(f"{radius:.6g}")
    return moved


def _curve(contact: Contact) -> tuple[Vector, Floats]:
    """A point inside a quadric and points (N, 3) round its contact's curve.

    Of an opening they are in the nappe of its cone in which the point `near` is, or in both.
    """
    f, point = contact.surface, apex(contact.clip)
    if point is None or f.raw(*point) >= 0:
        return contact.rim.center, contact.rim.points()
    towards = np.ones(3) if contact.near is None else np.array(to_floats(minus(contact.near, point)))
    rays = nappe_rays(nappe(contact.clip, towards), ROUND)
    rays = np.concatenate([rays, -rays]) if contact.near is None else rays
    form = np.array([[to_float(entry) for entry in row] for row in _matrix(f).tolist()])
    value, linear = to_float(f.raw(*point)), rays @ to_floats(_slope(f, point))
    square = ((rays @ form) * rays).sum(axis=1)
    with np.errstate(all="ignore"):
        met = -2 * value / (linear + np.sqrt(linear * linear - 4 * square * value))  # the first that is positive
    return point, (np.array(to_floats(point)) + met[:, None] * rays)[met > 0]


def _torus(contact: Contact, thickness: fmpq) -> Polynomial | None:
    """The parallel surface of a torus; None for another surface."""
    f = contact.surface
    lead = f.raw.to_dict().get((4, 0, 0), ZERO) if f.degree == 4 else ZERO
    if lead <= 0:
        return None
    terms = f.raw.to_dict()
    center = tuple(-terms.get(tuple(3 * (i == j) for j in range(3)), ZERO) / (4 * lead) for i in range(3))
    x, y, z = (g - c for g, c in zip(GENERATORS, center, strict=True))
    square = x * x + y * y + z * z
    rest = Polynomial.from_raw(f.raw / lead - square * square)
    if rest.degree != 2:
        return None
    axes = principal_axes(_matrix(rest), _normal(contact))
    if axes is None:
        return None
    axis, most = max(axes, key=lambda pair: pair[1])
    major2 = (most - min(value for _, value in axes)) / 4
    minor2 = major2 - most / 2

    def whole(square: fmpq) -> Polynomial:
        return torus(center, axis, major2, square) * Polynomial.from_raw(GENERATORS[0] * 0 + lead)

    return whole(_less(minor2, thickness)) if minor2 > 0 and whole(minor2) == f else None


def torus(center: Sequence[fmpq], axis: Vector, major2: fmpq, minor2: fmpq) -> Polynomial:
    """`(|w|^2 + R^2 - r^2)^2 - 4 R^2 (|w|^2 - (w . a)^2 / |a|^2)`, w from the centre, by the squares of its radii."""
    x, y, z = (g - c for g, c in zip(GENERATORS, center, strict=True))
    square, along = x * x + y * y + z * z, x * axis[0] + y * axis[1] + z * axis[2]
    tube = square + (major2 - minor2)
    return Polynomial.from_raw(tube * tube - (square - along * along / dot(axis, axis)) * (4 * major2))


KINDS: tuple[Callable[[Contact, fmpq], Polynomial | None], ...] = (_plane, _quadric, _torus)
"""What surfaces are recognised, each with its inner surface."""


def principal_axes(matrix: fmpq_mat, hint: Vector | None = None) -> Axes | None:
    """Three rational eigenvectors of a symmetric matrix, with their eigenvalues, exact; None where there are none.

    `hint` may be one of them.  Others are looked for in the kernel, and near eigenvectors in doubles.
    """
    for first in _candidates(matrix, hint):
        value = _eigenvalue(matrix, first)
        if value is None:
            continue
        least = min(range(3), key=lambda i: abs(first[i]))
        across = cross(first, UNITS[least])
        for second in _turned(matrix, across, cross(first, across)):
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
    x, y, z = (Fraction(v).limit_denominator(LARGEST_DENOMINATOR) for v in values)
    return fmpq(x.numerator, x.denominator), fmpq(y.numerator, y.denominator), fmpq(z.numerator, z.denominator)


def _eigenvalue(matrix: fmpq_mat, vector: Vector) -> fmpq | None:
    """The eigenvalue of an eigenvector; None for another vector."""
    image = matrix * fmpq_mat(3, 1, list(vector))
    found: Vector = (image[0, 0], image[1, 0], image[2, 0])
    return None if any(cross(found, vector)) else dot(found, vector) / dot(vector, vector)


def _matrix(f: Polynomial) -> fmpq_mat:
    """The symmetric matrix of the terms of degree 2."""
    return fmpq_mat(3, 3, [f.diff(i).diff(j).raw(*ORIGIN) / 2 for i in range(3) for j in range(3)])


def _normal(contact: Contact) -> Vector | None:
    """The normal of a plane clip."""
    if contact.clip.degree != 1:
        return None
    return _slope(contact.clip, ORIGIN)


def _slope(f: Polynomial, point: Vector) -> Vector:
    """The gradient at a point, exact."""
    x, y, z = (f.diff(i).raw(*point) for i in range(3))
    return x, y, z


def _center(f: Polynomial, axes: Axes) -> Vector:
    """The centre of a quadric, as far as it has one: along the axes with an eigenvalue other than 0."""
    slope = _slope(f, ORIGIN)
    shares = [-dot(slope, v) / (2 * value * dot(v, v)) if value else ZERO for v, value in axes]
    x, y, z = (sum((s * v[i] for s, (v, _) in zip(shares, axes, strict=True)), ZERO) for i in range(3))
    return x, y, z
