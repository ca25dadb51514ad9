"""The usual solids, exact: half spaces, boxes, balls, cylinders, cones, tori, and any polynomial.

Points are three exact numbers, lengths are exact numbers, both in the model's units.
"""

from __future__ import annotations

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine, away, height
from pas.algebra.lengths import across
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import (
    Exact,
    Vector,
    VectorLike,
    dot,
    exact,
    exact_vector,
    minus,
    plain,
    positive,
    rational,
    to_float,
    to_floats,
    vector,
)
from pas.contacts.torus import torus_polynomial
from pas.solid.edges import Loop, PlaneEdge
from pas.solid.revolution import Turned
from pas.solid.solid import Solid, patch
from pas.solid.tree import Atom, combined


def half_space(plane: PolynomialLike, face: str = "plane") -> Solid:
    """The points where a linear polynomial is <= 0, such as `"x + y - 1"`; without a name a wall.

    Raises `ValueError` for a polynomial of another degree.
    """
    polynomial = Polynomial.named(plane, "plane", constant=False)
    if polynomial.degree != 1:
        raise ValueError(f"plane must be a linear polynomial, not {polynomial}; use implicit for others")
    return patch(face, polynomial)


def implicit(polynomial: PolynomialLike, *region: PolynomialLike, face: str = "surface") -> Solid:
    """The points where a polynomial is <= 0, in a region given by polynomials that must be >= 0.

    Raises `ValueError` for a constant.
    """
    return patch(face, polynomial, *region)


def box(lower: VectorLike, upper: VectorLike, face: str = "box") -> Solid:
    """The box between two corners, with sides along the axes.

    Its faces are named `box x-` to `box z+`.  Raises `ValueError` where `lower` is not below `upper` in each
    coordinate.
    """
    low, high = vector(lower, "lower"), vector(upper, "upper")
    for axis, a, b in zip("xyz", low, high, strict=True):
        if a >= b:
            raise ValueError(f"lower must be below upper: they are {plain(a)} and {plain(b)} in {axis}")
    sides = zip("xyz", GENERATORS, low, high, strict=True)
    planes = {f"{face} {name}{sign}": f for name, g, a, b in sides for sign, f in (("-", a - g), ("+", g - b))}
    return Solid(combined(False, *(Atom(Polynomial.from_raw(f), name) for name, f in planes.items())))


def ball(center: VectorLike, radius: Exact, face: str = "ball") -> Solid:
    """The ball of a radius about a centre, both in the model's units.

    Raises `ValueError` for a radius that is not positive.
    """
    r, w = positive(radius, "radius"), away(vector(center, "center"))
    return patch(face, Polynomial.from_raw(dot(w, w) - r * r))


def cylinder(start: VectorLike, end: VectorLike, radius: Exact, face: str = "cylinder") -> Solid:
    """The circular cylinder around the segment from start to end, with flat ends; lengths in the model's units.

    Raises `ValueError` for a radius that is not positive, and where both ends are the same point.
    """
    return cone(start, end, radius, radius, face)


def cone(start: VectorLike, end: VectorLike, radius: Exact, end_radius: Exact = 0, face: str = "cone") -> Solid:
    """The cone, or truncated cone, around the segment from start to end, with flat ends.

    `radius` is that at the start, `end_radius` that at the end (the model's units); one may be 0 (an apex).

    Raises `ValueError` for a negative radius or two that are 0, and where both ends are the same point.
    """
    a, b = vector(start, "start"), vector(end, "end")
    axis = minus(b, a)
    square = dot(axis, axis)
    if square == 0:
        raise ValueError("start and end must be different points")
    r0, r1 = rational(radius, "radius"), rational(end_radius, "end_radius")
    if r0 < 0 or r1 < 0 or r0 == r1 == 0:
        raise ValueError(f"radius must be positive and end_radius not negative, not {plain(r0)} and {plain(r1)}")
    w, along = away(a), height(a, axis) * (1 / square)
    surface = dot(w, w) - along * along * square - (r0 + along * (r1 - r0)) ** 2
    ends = ((-along, r0, f"{face} start"), (along - 1, r1, f"{face} end"))
    walls = [Atom(Polynomial.from_raw(plane), name if radius > 0 else "") for plane, radius, name in ends]
    apexes = [p for p, r in ((a, r0), (b, r1)) if r == 0]
    special = tuple((to_float(x), to_float(y), to_float(z)) for x, y, z in apexes)
    tree = combined(False, Atom(Polynomial.from_raw(surface), face), *walls)
    body = None if r0 == r1 else _turned(face, (a, b), (r0, r1))
    return Solid(tree, (), special, body)


def _turned(face: str, ends: tuple[Vector, Vector], radii: tuple[fmpq, fmpq]) -> Turned:
    """What bounds a cone of two radii: its section, turned.

    Slender tips and blunt rims are what lattices hardly show.
    """
    start, end = np.array(to_floats(ends[0])), np.array(to_floats(ends[1]))
    length, zero = exact(float(np.linalg.norm(end - start))), fmpq(0)
    corners = [(zero, zero), (radii[0], zero), (radii[1], length), (zero, length)]
    names = f"{face} start", face, f"{face} end", ""
    sides = zip(corners, [*corners[1:], corners[0]], names, strict=True)
    loop = Loop(tuple(PlaneEdge.straight(a, b, name) for a, b, name in sides if a != b))
    axis = (end - start) / float(length)
    first, second, third = map(exact_vector, np.stack([*across(axis), axis], axis=1).tolist())
    return Turned(loops=(loop,), angle=2 * np.pi, place=Affine((first, second, third), ends[0]))


def torus(center: VectorLike, axis: VectorLike, major: Exact, minor: Exact, face: str = "torus") -> Solid:
    """The ring torus: points up to `minor` from the circle of radius `major` about a centre and axis.

    Lengths are in the model's units.

    Raises `ValueError` unless 0 < minor < major, and for a zero axis.
    """
    big, small = positive(major, "major"), positive(minor, "minor")
    if small >= big:
        raise ValueError(f"minor must be smaller than major, not {plain(small)} >= {plain(big)}")
    a = vector(axis, "axis")
    if not any(a):
        raise ValueError("axis must not be the zero vector")
    return patch(face, torus_polynomial(vector(center, "center"), a, big * big, small * small))
