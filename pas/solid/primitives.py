"""The usual solids, exact: half spaces, boxes, balls, cylinders, cones, tori, and any polynomial.

Points are three exact numbers, lengths are exact numbers, both in the model's units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine, away, height, translation
from pas.algebra.inputs import check_count, whole
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
    square_root,
    three,
    to_float,
    to_floats,
    two_across,
    vector,
)
from pas.contacts.torus import torus_polynomial
from pas.solid.edges import Loop, PlaneEdge
from pas.solid.extrusion import Prism
from pas.solid.joints import Joint
from pas.solid.linked import RenamedBoundary
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
    tree = combined(False, *(Atom(Polynomial.from_raw(f), name) for name, f in planes.items()))
    left, right, near, far, bottom, top = planes
    corners = [(x, y) for x, y in ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))]
    edges = zip(corners, [*corners[1:], corners[0]], (near, right, far, left), strict=True)
    loop = Loop(tuple(PlaneEdge.straight(*edge) for edge in edges))
    up = translation((fmpq(0), fmpq(0), low[2]))
    body = Prism(loops=(loop,), height=to_float(high[2] - low[2]), place=up)
    return Solid(tree, (), (), RenamedBoundary(body, {"bottom": bottom, "top": top}))


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
    apexes = tuple(three(to_floats(p)) for p, r in ((a, r0), (b, r1)) if r == 0)
    tree = combined(False, Atom(Polynomial.from_raw(surface), face), *walls)
    return Solid(tree, (), apexes, _turned(face, (a, b), (r0, r1)))


def _turned(face: str, ends: tuple[Vector, Vector], radii: tuple[fmpq, fmpq]) -> Turned:
    """The boundary of a cone of two radii as a turned section; lattices hardly show slender tips and blunt rims."""
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


def flange(
    center: VectorLike,
    axis: VectorLike,
    radius: Exact,
    outer_radius: Exact,
    thickness: Exact,
    bolts: int = 0,
    bolt_radius: Exact | None = None,
    bolt_circle: Exact | None = None,
    face: str = "flange",
) -> Solid:
    """A round plate from `center` along an axis, with a bore of a radius, 0 for none, and holes for bolts around it.

    The holes are evenly on a circle of radius `bolt_circle`, by default midway between bore and rim; lengths are in the
    model's units.  Faces are "flange", "flange start", "flange end", "flange bore", "flange hole", "flange hole #2",
    and so on; all are exactly about or across the axis.  Raises `ValueError` for a zero axis, lengths that are not
    positive, a bore as wide as the rim, and holes that lack a radius or meet the bore, the rim or each other.

        solid.flange((0, 0, 0), (0, 0, 1), 10, 25, 5, bolts=6, bolt_radius=2)
    """
    place, way, bore = vector(center, "center"), vector(axis, "axis"), rational(radius, "radius")
    rim = positive(outer_radius, "outer_radius")
    if not any(way):
        raise ValueError("axis must not be the zero vector")
    if not 0 <= bore < rim:
        raise ValueError(f"radius must be 0 or more and below outer_radius, {plain(rim)}, not {radius}")
    rise = three(w * positive(thickness, "thickness") / square_root(dot(way, way)) for w in way)
    below, end, above = (three(p + k * r for p, r in zip(place, rise, strict=True)) for k in (-1, 1, 2))
    plate = cylinder(place, end, rim, face)
    if bore:
        plate = _drilled(plate, cylinder(below, above, bore, f"{face} bore"))
    if whole(bolts, "bolts", 0, 1000) or (bolt_radius, bolt_circle) != (None, None):
        size, around = _bolts(bore, rim, bolts, bolt_radius, bolt_circle)
        aside, _ = two_across(way)
        first = three(a * around / square_root(dot(aside, aside)) for a in aside)
        low, high = (three(p + f for p, f in zip(at, first, strict=True)) for at in (below, above))
        holes = cylinder(low, high, size, f"{face} hole").circular_pattern(bolts, way, place)
        plate = _drilled(plate, holes)
    return plate


def _drilled(part: Solid, drill: Solid) -> Solid:
    """A part less cylinders whose flat ends reach out of it, and are no faces of it."""
    ends = (face for face, (polynomial,) in drill.polynomials.items() if polynomial.degree == 1)
    return (part - drill)._called(dict.fromkeys(ends, ""))


def _bolts(bore: fmpq, rim: fmpq, bolts: int, radius: Exact | None, circle_radius: Exact | None) -> tuple[fmpq, fmpq]:
    """The radii of a flange's holes and of their circle; raises `ValueError` where they do not fit beside its bore."""
    if not bolts or radius is None:
        raise ValueError(f"{'bolts' if not bolts else 'bolt_radius'} is missing: holes take their number and radius")
    around = (bore + rim) / 2 if circle_radius is None else positive(circle_radius, "bolt_circle")
    if not bore < around < rim:
        raise ValueError(f"bolt_circle must be between {plain(bore)} and {plain(rim)}, not {circle_radius}")
    between = to_float(around) * math.sin(math.pi / bolts) if bolts > 1 else math.inf
    room = min(to_float(around - bore), to_float(rim - around), between)
    size = positive(radius, "bolt_radius")
    if to_float(size) >= room:
        raise ValueError(
            f"bolt_radius must be below {room:.6g}, so that holes meet neither bore, rim nor each other, not {radius}"
        )
    return size, around


def transition(
    start: Sequence[Exact],
    end: Sequence[Exact],
    length: Exact,
    order: int = 1,
    straight: Exact | None = None,
    face: str = "transition",
) -> Solid:
    """From an ellipse of half axes `start` along x and y, at z = 0, to one of half axes `end`, at z = `length`.

    The squares of the half axes are polynomials of the height, of degree 2 `order` + 1, so that the surface is exact,
    and level at both ends up to that order, 1 or 2.  With `straight` cylinders go on at both ends by so much, and
    GC^order onto them is claimed.  Faces are "transition", "transition straight 1", "transition straight 2",
    "transition start" and "transition end"; lengths are in the model's units.  Raises `ValueError` for lengths that are
    not positive.

        solid.transition((3, 3), (5, 2), 8, straight=2)
    """
    height, k = positive(length, "length"), whole(order, "order", 1, 2)
    s = GENERATORS[2] * (1 / height)
    step = s**2 * (3 - 2 * s) if k == 1 else s**3 * (6 * s**2 - 15 * s + 10)
    axes = _half_axes(start, "start"), _half_axes(end, "end")
    ends = [(a * a, b * b) for a, b in axes]
    first, second = (a + step * (b - a) for a, b in zip(*ends, strict=True))
    x, y, _ = GENERATORS
    common = first.gcd(second)  # is no surface, and positive but for a factor
    surface = (x**2 * second + y**2 * first - first * second) / common * common(0, 0, 0)
    low, high = -GENERATORS[2], GENERATORS[2] - height
    more = fmpq(0) if straight is None else positive(straight, "straight")
    pieces = [(face, surface, [low, high])]
    if more:
        for number, (a, b), sides in zip((1, 2), ends, ([-low], [-high]), strict=True):
            pieces.append((f"{face} straight {number}", x**2 * b + y**2 * a - a * b, sides))
    made = [
        combined(False, *(Atom(Polynomial.from_raw(f), n) for f, n in ((f, name), *((side, "") for side in sides))))
        for name, f, sides in pieces
    ]
    walls = [(low - more, f"{face} start"), (high - more, f"{face} end")]
    reach = 2 * max(map(max, axes))  # walls beyond the solid, by which boxes around it are found
    walls += [(sign * g - reach, "") for g in (x, y) for sign in (1, -1)]
    whole_ = combined(False, combined(True, *made), *(Atom(Polynomial.from_raw(f), name) for f, name in walls))
    joints = (
        Joint(face, name, (Polynomial.from_raw(side[0]), Polynomial.from_raw(f)), k) for name, f, side in pieces[1:]
    )
    return Solid(whole_, tuple(joints))


def _half_axes(given: Sequence[Exact], name: str) -> tuple[fmpq, fmpq]:
    """Two positive lengths."""
    check_count(given, 2, f"{name} must be two half axes, such as (3, 2)", ValueError)
    return positive(given[0], f"{name}[0]"), positive(given[1], f"{name}[1]")
