"""Pipes along lines and bends: exact envelopes of balls whose radius changes evenly along the lines.

A ball is a point (c, r) of a space with the product c . c' - r r'.  Balls along a line there have a cylinder or cone as
envelope, those along a circle a torus or a Dupin cyclide (Pottmann and Peternell 1998).  Where two lines with unit
directions d and e meet in the ball m, the circle that touches both as far as t from m has the envelope
A C = w^2 B^2: A and C are the powers |x - c|^2 - r^2 of the balls m - t d and m + t e, B is that of m less t^2, and
w^2 = (1 + d . e) / 2.  It meets the cones of both lines with GC^1 in circles.

Guaranteed: pieces are exact.  Points are where they were asked for to within 1e-12 of the distance between two:
directions must be rational for circles to be so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from flint import fmpq
from scipy.spatial import cKDTree

from pas.algebra.affine import away, height
from pas.algebra.inputs import shown
from pas.algebra.lengths import across
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import (
    Exact,
    Vector,
    VectorLike,
    binary_exponent,
    dot,
    exact,
    plain,
    positive,
    rational,
    square_root,
    to_float,
    to_floats,
    vector,
)
from pas.arrays import Floats, Integers
from pas.errors import GeometryError
from pas.mesh.shading import unit_rows
from pas.solid.faces import FacedBody, Faces
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined, complement


@dataclass(frozen=True)
class Ball:
    """A ball, or the difference of two: a centre, and a radius that may be negative."""

    center: Vector
    radius: fmpq

    def plus(self, other: Ball, times: fmpq) -> Ball:
        """The sum with a multiple of another one."""
        x, y, z = (a + times * b for a, b in zip(self.center, other.center, strict=True))
        return Ball((x, y, z), self.radius + times * other.radius)

    def times(self, other: Ball) -> fmpq:
        """The product of two."""
        return dot(self.center, other.center) - self.radius * other.radius

    @property
    def floats(self) -> Floats:
        """Centre and radius (4,)."""
        return np.array(to_floats((*self.center, self.radius)))

    @property
    def power(self) -> Polynomial:
        """The polynomial |x - center|^2 - radius^2."""
        w = away(self.center)
        return Polynomial.from_raw(dot(w, w) - self.radius**2)

    def across(self, way: Ball) -> Polynomial:
        """The plane in which balls that move along a direction touch their envelope here; positive beyond it."""
        return Polynomial.from_raw(height(self.center, way.center) + self.radius * way.radius)

    def cone(self, way: Ball) -> Polynomial:
        """The envelope of balls that move along a unit direction."""
        return self.power - self.across(way) ** 2


@dataclass(frozen=True)
class PipePiece:
    """The envelope from one ball to another, with the directions in both; `corner` is where a bend's lines meet."""

    name: str
    start: Ball
    end: Ball
    ways: tuple[Ball, Ball]
    corner: Ball | None = None

    @property
    def share(self) -> fmpq:
        """The square of the weight of a bend's corner."""
        return (1 + self.ways[0].times(self.ways[1])) / 2

    @property
    def around(self) -> Polynomial | None:
        """The ball around a bend, through the circles in which it ends."""
        if self.corner is None:
            return None
        reach = self.corner.plus(self.start, fmpq(-1))
        return self.corner.power - reach.times(reach)

    @cached_property
    def surface(self) -> Polynomial:
        """Its polynomial, negative inside."""
        if self.around is None:
            return self.start.cone(self.ways[0])
        return self.start.power * self.end.power - self.around**2 * self.share

    def tree(self, walls: Sequence[Polynomial]) -> Tree:
        """Its points: what is inside, between walls."""
        sides = [*walls, self.around] if self.around else walls
        return combined(False, Atom(self.surface, self.name), *(Atom(side, "") for side in sides))

    def balls(self, count: int) -> Floats:
        """Centre, radius and direction of balls along it (count + 1, 8)."""
        t = np.linspace(0, 1, count + 1)[:, None]
        start, end = self.start.floats, self.end.floats
        middle, weight = self.corner.floats if self.corner else (start + end) / 2, math.sqrt(to_float(self.share))
        control = np.array([[*start, 1.0], [*(weight * middle), weight], [*end, 1.0]])
        lower, upper = ((1 - t) * a + t * b for a, b in pairwise(control))
        value, slope = (1 - t) * lower + t * upper, upper - lower
        way = slope[:, :4] * value[:, 4:] - value[:, :4] * slope[:, 4:]
        return np.column_stack([value[:, :4] / value[:, 4:], way])

    def steps(self, tolerance: float) -> int:
        """Into how many parts it is cut so that chords of circles along it are within a tolerance."""
        start, middle, end = self.balls(2)[:, :4]
        sag = float(np.linalg.norm(middle - (start + end) / 2))
        return 1 + int(math.sqrt(3 * sag / tolerance))  # 1 outside of bends


@dataclass(frozen=True, eq=False, kw_only=True)
class PipeBody(FacedBody):
    """The boundary of a pipe: the pieces of its outside, and of its inside where it has one."""

    sides: tuple[tuple[PipePiece, ...], ...]
    face: str

    @cached_property
    def extent(self) -> float:
        """The longest side of a box around the centres, and twice the largest radius."""
        balls = np.concatenate([piece.balls(1) for piece in self.sides[0]])
        return float(np.ptp(balls[:, :3], axis=0).max() + 2 * balls[:, 3].max())

    def made(self, tolerance: float) -> Faces:
        """Its faces: a row of points for each of the circles in which balls touch their envelope."""
        made, part = Faces(), tolerance / 4  # for circles around and along, whose errors add up on diagonals
        widest = max(to_float(ball.radius) for piece in self.sides[0] for ball in (piece.start, piece.end))
        angles = np.linspace(0, 2 * np.pi, 1 + max(6, math.ceil(math.pi / math.acos(max(1 - part / widest, 0.5)))))
        rims: list[Integers] = []
        for number, pieces in enumerate(self.sides):
            cut = [piece.balls(piece.steps(part)) for piece in pieces]
            found = [_circles(balls) for balls in cut]
            for end in (0, -1):  # flat ones are across the middle line
                centers, radii, _ = found[end]
                centers[end], radii[end] = cut[end][end, :3], cut[end][end, 3] ** 2 / radii[end]
            normal = found[0][2][0]
            ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:-1] @ across(normal)
            rows: list[Integers] = []
            for piece, circles in zip(pieces, found, strict=True):
                begin = max(len(rows) - 1, 0)
                for center, radius, onward in [*zip(*circles, strict=True)][len(rows) > 0 :]:
                    ways = ways - np.outer(ways @ onward, normal + onward) / (1 + normal @ onward)  # the smallest turn
                    normal, row = onward, made.added(center + radius * ways)
                    rows.append(np.append(row, row[0]))
                made.put_side(piece.name, rows[begin:][:: -1 if number else 1], piece.surface.jets)
            rims += [rows[0], rows[-1]]
        for side, name in enumerate(("start", "end")):
            outer, inner = rims[side], rims[side - 2]
            if inner is outer:
                inner = np.repeat(made.added(made.points[outer[:-1]].mean(axis=0)[None]), len(outer))
            a, b = (outer, inner) if side else (inner, outer)
            corners = np.concatenate([np.stack(t, axis=1) for t in ((a[:-1], a[1:], b[1:]), (a[:-1], b[1:], b[:-1]))])
            normal = _circles(self.sides[0][-side].balls(1))[2][-side] * (2 * side - 1)
            made.put_flat(f"{self.face} {name}", corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)], normal)
        return made


def _circles(balls: Floats) -> tuple[Floats, Floats, Floats]:
    """Centres, radii and unit normals of the circles in which balls (N, 8) touch their envelope."""
    normals, radii = unit_rows(balls[:, 4:7]), balls[:, 3]
    lean = balls[:, 7] / np.linalg.norm(balls[:, 4:7], axis=1)
    return balls[:, :3] - (radii * lean)[:, None] * normals, radii * np.sqrt(np.maximum(1 - lean * lean, 0)), normals


def pipe(
    points: Sequence[VectorLike],
    radius: Exact | Sequence[Exact],
    bend: Exact | Sequence[Exact] | None = None,
    wall: Exact | None = None,
    face: str = "pipe",
) -> Solid:
    """A round pipe, full or hollow, along lines between points, with bends between the lines: exact envelopes of balls
    (Pottmann and Peternell 1998).

    `radius` is that of the pipe, or one for each point, between which it changes evenly: balls of these radii touch it.
    `bend` is the radius of the arcs of the middle line, or one for each point but the first and last; where the radius
    changes they are arcs of conics.  `wall` is the thickness of a hollow pipe.  Lengths are in the model's units.

    The pieces, cylinders, cones, tori and Dupin cyclides, are named "pipe 1", "pipe bend 1", "pipe 2", ..., those
    inside "inside of pipe 1", ..., the flat ends "pipe start" and "pipe end"; GC^1 between them is claimed.  Raises
    `ValueError` for numbers that are missing or not positive, `GeometryError` where a bend is too tight or needs more
    than there is of a line, the path turns back, or the radius changes by more than the distance.

        solid.pipe([(0, 0, 0), (0, 0, 50), (30, 0, 50)], 5, bend=12, wall=1)
    """
    if isinstance(points, str) or not hasattr(points, "__len__") or len(points) < 2:
        raise ValueError(f"points must be two points at least, such as [(0, 0, 0), (0, 0, 5)], not {shown(points)}")
    places = [vector(p, f"points[{i}]") for i, p in enumerate(points)]
    radii = _each(radius, len(places), "radius", "point")
    if len(places) > 2 and bend is None:
        raise ValueError("bend is missing: a pipe of more than two points takes the radius of its bends")
    bends = _each(1 if bend is None else bend, len(places) - 2, "bend", "point but the first and last")
    lines = _lines([Ball(p, r) for p, r in zip(places, radii, strict=True)], bends)
    sides = [tuple(_pieces(lines, fmpq(0), face))]
    if wall is not None:
        if positive(wall, "wall") >= min(radii):
            raise ValueError(f"wall must be below the radius, {plain(min(radii))}, not {wall}")
        sides.append(tuple(_pieces(lines, rational(wall), f"inside of {face}")))
    trees, claims = [], []
    for pieces in sides:
        planes = [piece.start.across(piece.ways[0]) for piece in pieces[1:]]
        walls = zip([[], *([-p] for p in planes)], [*([p] for p in planes), []], strict=True)
        trees.append(combined(True, *(piece.tree(a + b) for piece, (a, b) in zip(pieces, walls, strict=True))))
        for plane, (one, other) in zip(planes, pairwise(pieces), strict=True):
            claims.append(Joint(one.name, other.name, (plane, other.start.cone(other.ways[0])), 1))
    planes = [Polynomial.from_raw(height(lines[k][0].center, lines[k][1].center)) for k in (0, -1)]
    ends = Atom(-planes[0], f"{face} start"), Atom(planes[1], f"{face} end")
    tree = combined(False, trees[0], *map(complement, trees[1:]), *ends)
    return Solid(tree, tuple(claims), (), None if _meets_itself(sides[0]) else PipeBody(sides=tuple(sides), face=face))


Line = tuple[Ball, Ball, fmpq, fmpq]
"""Where a line begins, its unit direction, its length, what the bend before it takes of that; the last is an end."""


def _each(given: Any, count: int, name: str, what: str) -> list[fmpq]:
    """Positive numbers, one for each of `count` things; a single one is for all."""
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        return [positive(given, name)] * count
    if len(given) != count:
        raise ValueError(f"{name} must be one number, or one for each {what}: {count}, not {len(given)}")
    return [positive(value, f"{name}[{i}]") for i, value in enumerate(given)]


def _lines(balls: Sequence[Ball], bends: Sequence[fmpq]) -> list[Line]:
    """The lines between balls, which are moved a little so that directions are rational."""
    made: list[Line] = []
    at, taken = balls[0], fmpq(0)
    for number, ball in enumerate(balls[1:]):
        way, length = _direction(ball.plus(at, fmpq(-1)), number)
        if made:
            before, last = made[-1][1], made[-1][2] - made[-1][3]
            cosine = before.times(way)
            if 1 + cosine < fmpq(1, 10**6):
                raise GeometryError(f"the path turns back at points[{number}]; two bends, one after the other, turn it")
            square = abs(1 - cosine) / (1 + cosine)
            root = square_root(square)
            taken = bends[number - 1] * (root if root * root == square else exact(to_float(root)))
            if abs(last - taken) * 10**9 < last:  # both bends take all of the line, to rounding
                taken = last
        made.append((at, way, length, taken))
        at = at.plus(way, length)
    made.append((at, way, fmpq(0), fmpq(0)))
    for number, ((_, _, length, taken), (*_, after)) in enumerate(pairwise(made)):
        if length < taken + after:
            raise GeometryError(
                f"the line from points[{number}] to points[{number + 1}] is shorter by "
                f"{to_float(taken + after - length):.6g} than its bends need; take a smaller bend or move them apart"
            )
    return made


def _direction(way: Ball, number: int) -> tuple[Ball, fmpq]:
    """The unit direction from points[number] on, rational and next to a way, and how far it goes that way."""
    square = way.times(way)
    if not any(way.center):
        raise GeometryError(f"points[{number}] and points[{number + 1}] are one point")
    if square <= 0:
        raise GeometryError(
            f"the radius changes by {plain(abs(way.radius))} from points[{number}] to points[{number + 1}], which must "
            f"be less than their distance, {math.sqrt(to_float(dot(way.center, way.center))):.6g}"
        )
    length = square_root(square)
    if length * length == square:
        return Ball(way.center, way.radius).plus(way, 1 / length - 1), length
    unit = way.floats / math.sqrt(to_float(square))
    lean = _simple(unit[3] / (1 + math.hypot(1, unit[3])))
    flat, axis = unit[:3] / np.linalg.norm(unit[:3]), int(np.abs(unit[:3]).argmax())
    a, b = (_simple(flat[(axis + k) % 3] / (1 + abs(flat[axis]))) for k in (1, 2))
    long, whole = (1 + lean * lean) / (1 - lean * lean), 1 + a * a + b * b  # from a point of a circle, of a sphere
    turned = [long * (2 - whole) / whole * (1 if flat[axis] > 0 else -1), long * 2 * a / whole, long * 2 * b / whole]
    x, y, z = (turned[(k - axis) % 3] for k in range(3))
    shrink = 2 * lean / (1 - lean * lean)
    common = math.lcm(*(int(value.q) for value in (x, y, z, shrink)))
    # lengths are multiples of something so that points have short coordinates
    fine = common * fmpq(2) ** (binary_exponent(length) - 50 - common.bit_length())
    return Ball((x, y, z), shrink), fine * round(to_float(length / fine))


def _simple(value: float) -> fmpq:
    """A number next to a double, by less than 1e-12."""
    return rational(Fraction(float(value)).limit_denominator(10**6))


def _pieces(lines: Sequence[Line], wall: fmpq, face: str) -> Iterator[PipePiece]:
    """The envelopes of balls along lines and bends, in order; raises `GeometryError` where a bend crosses itself."""
    inside = [(Ball(at.center, at.radius - wall), way, length, taken) for at, way, length, taken in lines]
    for number, ((at, way, length, taken), (after, onward, _, next_taken)) in enumerate(pairwise(inside)):
        if length > taken + next_taken:
            yield PipePiece(f"{face} {number + 1}", at.plus(way, taken), after.plus(way, -next_taken), (way, way))
        if next_taken:
            ends = after.plus(way, -next_taken), after.plus(onward, next_taken)
            piece = PipePiece(f"{face} bend {number + 1}", *ends, (way, onward), after)
            centers, radii, normals = _circles(piece.balls(1))
            ahead = np.array([(centers[1] - centers[0]) @ normal for normal in normals[::-1]])
            if (ahead <= radii * np.linalg.norm(np.cross(*normals))).any():  # planes meet within these circles
                raise GeometryError(
                    f"{face} crosses itself in its bend at points[{number + 1}]: take a larger bend or a smaller radius"
                )
            yield piece


def _meets_itself(pieces: Sequence[PipePiece]) -> bool:
    """Whether balls of pieces may meet that have two others between them at least; planes part nearer ones."""
    found = []
    for number, piece in enumerate(pieces):
        ends = piece.balls(1)
        balls = piece.balls(max(4, math.ceil(4 * np.linalg.norm(np.diff(ends[:, :3], axis=0)) / ends[:, 3].min())))
        reach = balls[:, 3] ** 2 / _circles(balls)[1] + np.linalg.norm(np.diff(balls[:, :3], axis=0), axis=1).max() / 2
        found.append(np.column_stack([balls[:, :3], reach, np.full(len(balls), number)]))
    every = np.concatenate(found)
    pairs = cKDTree(every[:, :3]).query_pairs(2 * float(every[:, 3].max()), output_type="ndarray")
    one, other = every[pairs[np.abs(np.diff(every[pairs, 4])[:, 0]) > 2]].swapaxes(0, 1)
    return bool((np.linalg.norm(one[:, :3] - other[:, :3], axis=1) < one[:, 3] + other[:, 3]).any())
