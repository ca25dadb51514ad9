"""The intersections of planes with faces' surfaces: lines of tangency, and sections along which two faces continue.

Guaranteed: exact, but for where on a section the faces are, which is seen at some places.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, permutations

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.curve import gradient
from pas.algebra.ideal import Ideal
from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import cross
from pas.arrays import Bools, Floats
from pas.mesh.projection import CommonZeros, least_norm
from pas.solid.evaluator import TreeEvaluator
from pas.solid.tree import Tree, atoms

HIGHEST = 6
"""Degree of functions of which plane sections are looked at: that of the blends of pipes with continuous curvature."""

STARTS = 64
"""Points from which places on a section are looked for."""

SLACK = 1e-9
"""How far places may be outside the box by rounding, over its longest side."""

ASIDE = (0.01, 0.03)
"""How far before and behind the plane it is looked, over the longest side of the box."""


def tangent_line(plane: Polynomial, quadric: Polynomial) -> Polynomial | None:
    """The m that vanishes where a plane touches a quadric along a line: on the plane that is c m^2; None elsewhere."""
    factors = on_plane(quadric, plane).factor()[1]
    return Polynomial.from_raw(factors[0][0]) if [power for _, power in factors] == [2] else None


def multiples(plane: Polynomial, first: Polynomial, second: Polynomial) -> bool:
    """Whether two polynomials are positive multiples of one another on a plane, and not 0; exact."""
    f, g = on_plane(first, plane), on_plane(second, plane)
    if f.is_zero() or g.is_zero():
        return False
    a, b = f.leading_coefficient(), g.leading_coefficient()
    return bool((f * b - g * a).is_zero() and a * b > 0)


def smooth_sections(tree: Tree, box: Floats) -> Iterator[tuple[Polynomial, Polynomial]]:
    """Planes, and functions that vanish with them on sections along which two faces of a solid in a box continue."""
    faces_of = (a.function.primitive() for a in atoms(tree) if a.face and isinstance(a.function, Polynomial))
    functions = dict.fromkeys(faces_of)
    for plane in (f for f in functions if f.degree == 1):
        faces: dict[Polynomial, list[Polynomial]] = {}
        for function in (f for f in functions if 1 < f.degree <= HIGHEST):
            for factor, _ in on_plane(function, plane).factor()[1]:
                if factor.total_degree() > 1:
                    faces.setdefault(Polynomial.from_raw(factor).primitive(), []).append(function)
        for curve, cut in ((c, several) for c, several in faces.items() if len(several) > 1):
            ideal = Ideal(plane, curve)
            pairs = (pair for pair in combinations(cut, 2) if touch_along(*pair, ideal))
            if any(_go_on(tree, box, plane, curve, pair) for pair in pairs):
                yield plane, curve


def on_plane(polynomial: Polynomial, plane: Polynomial) -> fmpq_mpoly:
    """A polynomial in two coordinates of the points of a plane, whose first variable is substituted."""
    return divmod(polynomial.raw, plane.raw)[1]


def touch_along(first: Polynomial, second: Polynomial, curve: Ideal) -> bool:
    """Whether two surfaces have the same normals along a curve; where they cross their own functions say where, and a
    wall through one of the curves in which they do nothing of the others."""
    return all(map(curve.contains, cross(gradient(first), gradient(second))))


def _go_on(tree: Tree, box: Floats, plane: Polynomial, curve: Polynomial, pair: tuple[Polynomial, Polynomial]) -> bool:
    """Whether one of two faces alone bounds the solid on one side of a plane, and the other on its other side."""
    size = float(np.ptp(box, axis=0).max())
    starts = box[0] + np.random.default_rng(0).random((STARTS, 3)) * np.ptp(box, axis=0)
    points, found = _near(starts, (plane, curve))
    points = points[
        found & (points >= box[0] - SLACK * size).all(axis=1) & (points <= box[1] + SLACK * size).all(axis=1)
    ]
    normals = unit(pair[0].gradient(points))
    ways = plane.gradient(points)
    ways = unit(ways - (ways * normals).sum(axis=1)[:, None] * normals)
    sides = [np.concatenate([points + side * share * size * ways for share in ASIDE]) for side in (-1, 1)]
    evaluator = TreeEvaluator(tree)
    bounding = [[_bounds(evaluator, f, side) for side in sides] for f in pair]
    return any(bool((a[0] & b[1]).any() and not (a[1] | b[0]).any()) for a, b in permutations(bounding))


def _bounds(evaluator: TreeEvaluator, function: Polynomial, points: Floats) -> Bools:
    """At which points (N, 3), moved onto a face, the solid is on one side of it alone."""
    points, near = _near(points, (function,))
    number = evaluator.column_of(function)
    signs = evaluator.signs(points)
    both = []
    for side in (True, False):
        signs[number] = side
        both.append(evaluator.inside(signs))
    return np.asarray(near & (both[0] != both[1]))


def _near(points: Floats, functions: tuple[Polynomial, ...]) -> tuple[Floats, Bools]:
    """Common zeros (N, 3) of one function or two near points (N, 3), and which are some."""
    zeros = CommonZeros(functions)
    with np.errstate(all="ignore"):  # some go so far away that they overflow
        points = zeros.placed(points, np.inf, 20)
        left = lengths(least_norm(zeros, range(len(functions)), points))
    return points, np.asarray(left <= 1e-9 * np.maximum(lengths(points), 1.0))
