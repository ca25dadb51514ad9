"""Solids of revolution of profiles.

Where an edge's polynomial is E + r O, with E and O even in the distance r from the axis, it is at most 0 where both E
and O are, where E <= 0 and E^2 >= r^2 O^2, and where O <= 0 and E^2 <= r^2 O^2.  The surface is that of E^2 - r^2 O^2,
or of E where O is 0: of segments planes, cylinders and cones, of arcs of circles tori and spheres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.affine import rotation
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import plain, to_float
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.solid.edges import Loop, PlaneEdge, at
from pas.solid.faces import Faces, SolidBoundary, SweptBody
from pas.solid.formulas import PlaneSet, Truth, formula, joined, negated
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined

X, Y, Z = GENERATORS
ROUND = X * X + Y * Y


def revolved(profile: PlaneSet, degrees: fmpq) -> Solid:
    """The solid that a profile sweeps out; see `Profile.revolve`."""
    if not 0 < degrees <= 360:
        raise ValueError(f"degrees must be above 0 and at most 360, not {plain(degrees)}")
    for loop in profile.all_loops:
        for edge in loop.edges:
            if _passes_axis(edge):
                raise GeometryError(
                    f"the profile passes the axis: its edge {edge.name!r} from {at(edge.start)} to {at(edge.end)} has "
                    f"points with negative x, which is the distance from the axis"
                )
    made = profile.tree(lambda loop, _: formula(loop, lambda edge: _swept(edge.curve, edge.name)))
    turn = rotation((0, 0, 1), degrees, (0, 0, 0)).direction((fmpq(1), fmpq(0), fmpq(0)))
    if degrees < 360:
        begin, end = Polynomial.from_raw(-Y), Polynomial.from_raw(Y * turn[0] - X * turn[1])
        wedge = combined(degrees > 180, Atom(begin, "start"), Atom(end, "end"))
        made = combined(False, made, wedge)
    loops = profile.boundary
    angle = math.atan2(to_float(turn[1]), to_float(turn[0])) % (2 * math.pi) or 2 * math.pi
    body: SolidBoundary = (
        profile.operands(lambda part: revolved(part, degrees)) if loops is None else Turned(loops=loops, angle=angle)
    )
    every = list(profile.all_loops if loops is None else loops)
    claims = dict.fromkeys(claim for loop in every for claim in _joints(loop))
    ends = dict.fromkeys(edge.start for loop in every for edge in loop.edges if edge.start[0] == 0)
    return Solid(made, tuple(claims), tuple((0.0, 0.0, to_float(z)) for _, z in ends), body)


def _passes_axis(edge: PlaneEdge, halvings: int = 12) -> bool:
    """Whether x is negative somewhere on an edge; of an arc that comes within 4^-12 of its length of that it may be
    said, too."""
    if min(edge.start[0], edge.end[0]) < 0:
        return True
    if edge.control is None or edge.control[0] >= 0:
        return False
    return halvings == 0 or any(_passes_axis(half, halvings - 1) for half in edge.halves)


def _swept(curve: Polynomial, face: str) -> Truth:
    """The set of points at which a polynomial in x and y is at most 0 at the distance from the axis and the height."""
    even, odd = RING.from_dict({}), RING.from_dict({})
    for (i, j, _), c in curve.raw.to_dict().items():
        term = ROUND ** (i // 2) * Z**j * c
        even, odd = (even, odd + term) if i % 2 else (even + term, odd)
    if not odd:
        return _at_most_zero(even, face)
    squares = even * even - ROUND * odd * odd
    below, falling = _at_most_zero(even, ""), _at_most_zero(odd, "")
    return joined(
        True,
        joined(False, below, falling),
        joined(False, below, negated(_at_most_zero(squares, face))),
        joined(False, falling, _at_most_zero(squares, face)),
    )


def _at_most_zero(raw: fmpq_mpoly, face: str) -> Truth:
    if raw.is_constant():
        return not raw or bool(raw.leading_coefficient() < 0)
    return Atom(Polynomial.from_raw(raw), face)


def _jets(curve: Polynomial, points: Floats) -> Floats:
    """Values and gradients (N, 4) of a polynomial in the distance from the axis and the height, at points (N, 3).

    On the axis, where an edge may end in an apex, the gradient is that of a plane through it.
    """
    r = np.linalg.norm(points[:, :2], axis=1)
    found = curve.jets(np.stack([r, points[:, 2], np.zeros_like(r)], axis=1))
    away = points[:, :2] / np.where(r > 0, r, 1.0)[:, None]
    return np.concatenate([found[:, :1], found[:, 1:2] * away, found[:, 2:3]], axis=1)


def _joints(loop: Loop) -> Iterator[Joint]:
    """The claims that faces continue one another smoothly along circles."""
    for one, other in loop.smooth_corners:
        r, z = one.end
        if r:
            circle = Polynomial.from_raw(ROUND - r * r), Polynomial.from_raw(Z - z)
            yield Joint(one.name, other.name, circle, 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class Turned(SweptBody):
    """A solid that loops sweep out, turning by an angle (radians)."""

    angle: float

    @property
    def is_full(self) -> bool:
        """Whether it turns all round, so that it has no flat ends."""
        return self.angle == 2 * math.pi

    def made(self, tolerance: float) -> Faces:
        """Its faces: a row of points for each point of the polygons, one point on the axis."""
        polygons, counts, triangles = self.polygons(tolerance / 2)
        points = np.concatenate(polygons)
        widest = float(points[:, 0].max())
        step = 2 * math.acos(max(1 - tolerance / (2 * widest), 0.5))  # chords of a circle leave it by that
        many = max(math.ceil(self.angle / step), 3)
        angles = np.linspace(0, self.angle, many + 1)
        turns = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        space = [
            np.column_stack([r * turns, np.full(many + 1, z)])[: 1 if r == 0 else many if self.is_full else None]
            for r, z in points.tolist()
        ]
        ends = pairwise(np.cumsum([0, *map(len, space)]).tolist())
        made, first = Faces(np.concatenate(space)), 0
        rows = [np.resize(np.arange(*between), many + 1) for between in ends]
        for loop, some, count in zip(self.loops, polygons, counts, strict=True):
            borders = np.cumsum([0, *count])
            for edge, (a, b) in zip(loop.edges, pairwise(borders.tolist()), strict=True):
                if edge.control is not None or edge.start[0] != 0 or edge.end[0] != 0:  # it is not on the axis
                    turned = [rows[first + k % len(some)] for k in range(a, b + 1)]
                    made.put_side(edge.name, turned, partial(_jets, edge.curve))
            first += len(some)
        if not self.is_full:
            last = turns[-1]
            made.put_flat("start", np.array([row[0] for row in rows])[triangles], np.array([0.0, -1.0, 0.0]))
            end = np.array([row[-1] for row in rows])[triangles[:, ::-1]]
            made.put_flat("end", end, np.array([-last[1], last[0], 0.0]))
        return made
