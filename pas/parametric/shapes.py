"""Ready-made parametric surfaces and patches: planes, closed quadrics, torus, helicoid, revolution, tubes.

Circles are parametrised rationally, by t -> ((1 - t^2)/(1 + t^2), 2t/(1 + t^2)), t the tangent of half the angle; t
over all reals gives all points but (-1, 0).  So these surfaces are exact and lie exactly on their implicit equations.
With `angle=True` the parameter is the angle itself: closed, with a finite domain, but not exact.  All sizes are exact
numbers, lengths in the model's units.  Standard position is along the z-axis; `ParametricSurface.moved` places them.

Rational Bezier patches of balls, cylinders, cones and tori are exact.  A quarter of the unit circle is the conic with
control points (1, 0), (1, 1), (0, 1) and weights 1, 1, 2: `((1 - t^2) / (1 + t^2), 2 t / (1 + t^2))`.  All its numbers
are whole, so that the patches are exactly on their surfaces, up to one rounding of control points that the given
numbers and the axis' frame cause.

Guaranteed: patches of one surface share their boundary curves, with the same control points to the last
bit and the same weights up to a power of 2; normals `x_u x x_v` point outwards.  Not guaranteed: normals at
points where a side of a patch shrinks to a point (poles and apexes).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_count, short
from pas.algebra.lengths import across
from pas.algebra.rational import Exact, VectorLike, dot, minus, plain, positive, rational, to_float, to_floats, vector
from pas.algebra.rational_function import FunctionLike
from pas.arrays import Floats
from pas.parametric.maps import IntervalLike
from pas.parametric.patches import RationalPatch
from pas.parametric.surface import ParametricSurface

COSINE, SINE = "((1 - {0}^2)/(1 + {0}^2))", "(2*{0}/(1 + {0}^2))"
TURN = (-math.pi, math.pi)


def plane(
    point: VectorLike = (0, 0, 0), first: VectorLike = (1, 0, 0), second: VectorLike = (0, 1, 0)
) -> ParametricSurface:
    """The plane `point + t first + h second`; raises `ValueError` for parallel directions."""
    p, a, b = vector(point, "point"), vector(first, "first"), vector(second, "second")
    if all(a[i] * b[j] == a[j] * b[i] for i in range(3) for j in range(3)):
        raise ValueError("first and second must not be parallel")
    x, y, z = (f"{plain(o)} + ({plain(u)})*t + ({plain(v)})*h" for o, u, v in zip(p, a, b, strict=True))
    return ParametricSurface(x, y, z)


def elliptic_cylinder(a: Exact = 1, b: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 = 1: t goes round, h = z.

    `a` and `b` are in the model's units; with `angle` t is the angle in radians.
    Raises `ValueError` for a size that is not positive.
    """
    return _ringed(_positive(a=a, b=b), "1", "h", angle)


def elliptic_cone(a: Exact = 1, b: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 = z^2: t goes round, h = z (the model's units); the normal vanishes at the apex h = 0.

    `a` and `b` are lengths over lengths; with `angle` t is the angle in radians.
    Raises `ValueError` for a size that is not positive.
    """
    return _ringed(_positive(a=a, b=b), "h", "h", angle)


def elliptic_paraboloid(a: Exact = 1, b: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 = z: t goes round, h = sqrt(z) >= 0; the normal vanishes at the vertex h = 0.

    `a`^2 and `b`^2 are in the model's units; with `angle` t is the angle in radians.
    Raises `ValueError` for a size that is not positive.
    """
    return _ringed(_positive(a=a, b=b), "h", "h^2", angle, (0, None))


def ellipsoid(a: Exact = 1, b: Exact = 1, c: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 + z^2/c^2 = 1: t goes round, h from -1 (lower pole) to 1 (upper pole).

    h is the tangent of half the latitude; the normal vanishes at the poles.  `a`, `b` and `c` are in the model's units;
    with `angle` t is the angle in radians.  Raises `ValueError` for a size that is not positive.
    """
    sizes = _positive(a=a, b=b, c=c)
    return _ringed(sizes[:2], COSINE.format("h"), f"{plain(sizes[2])}*{SINE.format('h')}", angle, (-1, 1))


def one_sheet_hyperboloid(a: Exact = 1, b: Exact = 1, c: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 - z^2/c^2 = 1, by its straight lines: t constant is one of them, h = z/c.

    `a`, `b` and `c` are in the model's units; with `angle` t is the angle in radians.
    Raises `ValueError` for a size that is not positive.
    """
    a, b, c = _positive(a=a, b=b, c=c)
    u, v, domain = _circle(angle)
    return ParametricSurface(
        f"{plain(a)}*({u} - h*{v})", f"{plain(b)}*({v} + h*{u})", f"{plain(c)}*h", domain=(domain, None)
    )


def two_sheet_hyperboloid(a: Exact = 1, b: Exact = 1, c: Exact = 1, angle: bool = False) -> ParametricSurface:
    """x^2/a^2 + y^2/b^2 - z^2/c^2 = -1, the upper sheet: t goes round, h >= 1, z/c = (h + 1/h)/2.

    The normal vanishes at the vertex h = 1.  The lower sheet is the mirror image: see `moved`.  `a`, `b` and `c` are in
    the model's units; with `angle` t is the angle in radians.  Raises `ValueError` for a size that is not positive.
    """
    sizes = _positive(a=a, b=b, c=c)
    return _ringed(sizes[:2], "((h^2 - 1)/(2*h))", f"{plain(sizes[2])}*(h^2 + 1)/(2*h)", angle, (1, None))


def torus(major: Exact = 2, minor: Exact = 1, angle: bool = False) -> ParametricSurface:
    """(sqrt(x^2 + y^2) - major)^2 + z^2 = minor^2: t goes round the axis, h round the tube.

    `major` and `minor` are in the model's units; with `angle` t and h are angles in radians.

    Raises `ValueError` unless 0 < minor < major.
    """
    r, s = _positive(major=major, minor=minor)
    if not s < r:
        raise ValueError(f"minor must be less than major, not {short(plain(s))} >= {short(plain(r))}")
    u, v, _ = _circle(angle, "h")
    turn = TURN if angle else None
    return _ringed((fmpq(1), fmpq(1)), f"({plain(r)} + {plain(s)}*{u})", f"{plain(s)}*{v}", angle, turn)


def helicoid(pitch: Exact = 1, start: Exact = 0) -> ParametricSurface:
    """(h sin t, h cos t, start + pitch t): transcendental, so not exact.

    t is the angle in radians, `pitch` the rise (the model's units) for each radian, `start` the height at t = 0.
    Raises `ValueError` for pitch 0.
    """
    p, s = rational(pitch, "pitch"), rational(start, "start")
    if p == 0:
        raise ValueError("pitch must not be 0; that would be a plane")
    return ParametricSurface("h*sin(t)", "h*cos(t)", f"{plain(s)} + ({plain(p)})*t")


def surface_of_revolution(
    radius: FunctionLike, height: FunctionLike, angle: bool = False, interval: IntervalLike = None
) -> ParametricSurface:
    """The curve (radius(h), height(h)) turned about the z-axis: t goes round, h in `interval`.

    `radius` and `height` are strings, sympy expressions or numbers in h; rational ones keep it exact.
    Their values are in the model's units; with `angle` t is the angle in radians.

    Raises `ValueError` or `TypeError` for what is no expression in h.
    """
    u, v, domain = _circle(angle)
    return ParametricSurface(f"({radius})*{u}", f"({radius})*{v}", f"{height}", domain=(domain, interval))


def tube(
    center: Sequence[FunctionLike],
    radius: FunctionLike,
    first: Sequence[FunctionLike],
    second: Sequence[FunctionLike],
    angle: bool = False,
    domain: IntervalLike = None,
) -> ParametricSurface:
    """C(t) + r (e1 cos + e2 sin): t runs along the `center` curve C, h goes round.

    `center`, `first` (e1) and `second` (e2) are triples of expressions in t, `radius` is one in t and h (strings, sympy
    expressions or numbers); rational ones keep it exact, cos and sin then being rational in h.  With unit vectors
    e1, e2 perpendicular to C' and each other it is a circular tube; that is not asked.  `domain` is that of t.
    Lengths are in the model's units; with `angle` h is the angle in radians.

    Raises `ValueError` or `TypeError` where one of the three is no triple of expressions.
    """
    u, v, turn = _circle(angle, "h")
    triples = [_triple(center, "center"), _triple(first, "first"), _triple(second, "second")]
    x, y, z = (f"({c}) + ({radius})*(({a})*{u} + ({b})*{v})" for c, a, b in zip(*triples, strict=True))
    return ParametricSurface(x, y, z, domain=(domain, turn))


def _ringed(
    sizes: Sequence[fmpq], radius: str, height: str, angle: bool, interval: IntervalLike = None
) -> ParametricSurface:
    """Ellipses with the half-axes sizes * radius(h) at z = height(h)."""
    u, v, domain = _circle(angle)
    x, y = (f"{plain(size)}*{radius}*{w}" for size, w in zip(sizes, (u, v), strict=True))
    return ParametricSurface(x, y, height, domain=(domain, interval))


def _circle(angle: bool, name: str = "t") -> tuple[str, str, tuple[float, float] | None]:
    """Cosine and sine in the parameter, and its domain."""
    if angle:
        return f"cos({name})", f"sin({name})", TURN
    return COSINE.format(name), SINE.format(name), None


def _positive(**sizes: Exact) -> tuple[fmpq, ...]:
    return tuple(positive(size, name) for name, size in sizes.items())


def _triple(items: Sequence[FunctionLike], name: str) -> tuple[str, ...]:
    check_count(items, 3, f"{name} must be three expressions in t, such as ('cos(t)', 'sin(t)', 0)")
    return tuple(map(str, items))


def ball_patches(center: VectorLike, radius: Exact) -> list[RationalPatch]:
    """The sphere: eight biquadratic octants; the poles are on the z axis.  Lengths are in the model's units.

    Raises `ValueError` for a radius that is not positive.
    """
    r = to_float(positive(radius, "radius"))
    frame = _frame(center, (0, 0, 1))
    return _revolved(_arc(0.0, r, -1), frame) + _revolved(_arc(0.0, r, 0), frame)


def cone_patches(
    start: VectorLike, end: VectorLike, radius: Exact, end_radius: Exact = 0, *, ends: bool = True
) -> list[RationalPatch]:
    """The cone (or cylinder) around a segment: four quarters, of degree 2 around and 1 along it.

    With `ends` also the quarters of its flat ends.  Lengths are in the model's units.

    Raises `ValueError` for a negative radius or two that are 0, and where both ends are the same point.
    """
    a, b = vector(start, "start"), vector(end, "end")
    axis = minus(b, a)
    if dot(axis, axis) == 0:
        raise ValueError("start and end must be different points")
    first, last = to_float(rational(radius, "radius")), to_float(rational(end_radius, "end_radius"))
    if first < 0 or last < 0 or first == last == 0:
        raise ValueError(f"radius must be positive and end_radius not negative, not {first:g} and {last:g}")
    frame, height = _frame(a, axis), to_float(dot(axis, axis)) ** 0.5
    result = _revolved(_line((first, 0.0), (last, height)), frame)
    if ends and first:
        result += _revolved(_line((0.0, 0.0), (first, 0.0)), frame)
    if ends and last:
        result += _revolved(_line((last, height), (0.0, height)), frame)
    return result


def cylinder_patches(start: VectorLike, end: VectorLike, radius: Exact, *, ends: bool = True) -> list[RationalPatch]:
    """The cylinder around a segment; see `cone_patches`.  Lengths are in the model's units.

    Raises `ValueError` as that does.
    """
    return cone_patches(start, end, radius, radius, ends=ends)


def torus_patches(center: VectorLike, axis: VectorLike, major: Exact, minor: Exact) -> list[RationalPatch]:
    """The ring torus: sixteen biquadratic patches.  Lengths are in the model's units.

    Raises `ValueError` unless 0 < minor < major, and for a zero axis.
    """
    big, small = (to_float(size) for size in _positive(major=major, minor=minor))
    if small >= big:
        raise ValueError(f"minor must be smaller than major, not {small:g} >= {big:g}")
    frame = _frame(center, axis)
    return [patch for k in range(4) for patch in _revolved(_arc(big, small, k), frame)]


def _quarter(start: int) -> tuple[Floats, Floats, Floats]:
    """Control points (x, y) and weights of a quarter of the unit circle, from `start` right angles on."""
    x, y, weights = np.array([(1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, 1.0, 2.0)]).T
    for _ in range(start % 4):
        x, y = 0.0 - y, x
    return x, y, weights


def _arc(middle: float, radius: float, start: int) -> Floats:
    """Control points (3, 3) as (distance from the axis, height, weight) of a quarter from `start` right angles on."""
    x, y, weights = _quarter(start)
    return np.stack([middle + x * radius, y * radius, weights], axis=1)


def _line(start: tuple[float, float], end: tuple[float, float]) -> Floats:
    return np.array([(*start, 1.0), (*end, 1.0)])


def _revolved(profile: Floats, frame: tuple[Floats, Floats]) -> list[RationalPatch]:
    """The quarters of the surface that a profile (distance, height, weight) sweeps about the frame's third axis."""
    origin, axes = frame
    result = []
    for k in range(4):
        x, y, weights = _quarter(k)
        flat = np.stack([np.outer(x, profile[:, 0]), np.outer(y, profile[:, 0])], axis=-1)
        heights = np.broadcast_to(profile[:, 1], flat.shape[:2])
        local = np.concatenate([flat, heights[..., None]], axis=-1)
        points = origin + sum(local[..., i, None] * axes[i] for i in range(3))
        result.append(RationalPatch(points, np.outer(weights, profile[:, 2])))
    return result


def _frame(center: VectorLike, axis: VectorLike) -> tuple[Floats, Floats]:
    """A point and three orthonormal rows, the last along the axis; the usual ones for the z axis."""
    a = vector(axis, "axis")
    if dot(a, a) == 0:
        raise ValueError("axis must not be the zero vector")
    third = np.array(to_floats(a))
    third /= np.linalg.norm(third)
    first, second = across(third)
    return np.array(to_floats(vector(center, "center"))), np.stack([0.0 - second, first, third])
