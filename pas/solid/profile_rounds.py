"""Upright solids over profiles with arcs, the edges at whose ends are rounded.

Rounds of a profile that goes on smoothly, arcs of circles and straight edges, are of the ball that rolls along: tori
and cylinders, each between the planes across the profile through its edge's ends.  Their joints are claimed there.

Guaranteed: that the rounds of one end do not meet, as they are on the mesh.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import product
from operator import sub
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_order
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, plain, rational, square_root, to_float
from pas.contacts.torus import torus_polynomial
from pas.errors import GeometryError, meant
from pas.mesh.rows import Integers
from pas.solid.edges import Loop, PlaneEdge, at, gradient, radius_of
from pas.solid.extrusion import Prism, circle_of, inwards, square_of
from pas.solid.joints import Joint
from pas.solid.operands import Operands
from pas.solid.rounding import rounded as of_planes
from pas.solid.sheets import Faces
from pas.solid.solid import Solid
from pas.solid.swept import SweptBody, flat, jets_of, put_flat, put_side
from pas.solid.tree import Atom, Tree, combined

X, Y, Z = GENERATORS


@dataclass(frozen=True, eq=False)
class ProfileRound:
    """The surface along an edge of a profile at an end, with the functions that are positive where it is.

    `flat` is 1 on the end's plane and 0 where the surface goes on in the edge's side, `side` is 0 where it goes on in
    the plane; `ends` are those at the edge's ends.  Where a torus meets itself, `outer` is positive outside of that.
    """

    end: str
    edge: PlaneEdge
    flat: Polynomial
    side: Polynomial
    surface: Polynomial
    ends: tuple[Polynomial, ...]
    outer: tuple[Polynomial, ...] = ()

    @classmethod
    def of(cls, end: str, edge: PlaneEdge, flat: Polynomial, radius: fmpq, whole: bool) -> ProfileRound:
        """That of an edge with a unit normal or a rational radius; `whole` that of all of a circle."""
        ends: tuple[Polynomial, ...] = ()
        if not whole:
            (u, v), (w, t), (a, b), (c, d) = edge.tangent(False), edge.tangent(True), edge.start, edge.end
            ends = tuple(map(Polynomial.from_raw, ((X - a) * u + (Y - b) * v, (c - X) * w + (d - Y) * t)))
        if edge.control is None:
            side = 1 + edge.curve * (1 / (radius * square_root(square_of(edge))))
            return cls(end, edge, flat, side, flat * flat + side * side - 1, ends)
        (a, b), size = circle_of(edge)
        major = size - edge.bow * radius
        side = Polynomial.from_raw(((X - a) ** 2 + (Y - b) ** 2 - major**2) * edge.bow)
        height = -flat.raw(0, 0, 0) / flat.diff(2).raw(0, 0, 0)
        axis, inner = (fmpq(0), fmpq(0), fmpq(1)), radius**2 - major**2  # the square of how far that is from the centre
        outer = [Polynomial.from_raw((X - a) ** 2 + (Y - b) ** 2 + (Z - height) ** 2 - inner)] if inner > 0 else []
        surface = torus_polynomial((a, b, height), axis, major**2, radius**2)
        return cls(end, edge, flat, side, surface, ends, tuple(outer))

    @property
    def face(self) -> str:
        """Its name."""
        return f"{self.edge.name} / {self.end}"

    @property
    def rest(self) -> Tree:
        """The points that it does not cut off."""
        walls = (Atom(wall, "") for wall in (self.flat, self.side, *self.ends, *self.outer))
        return combined(True, *walls, Atom(self.surface, self.face))

    def claims(self, after: ProfileRound, radius: fmpq) -> Iterator[Joint]:
        """The joints with the end, the side and the round of the next edge."""
        yield Joint(self.face, self.end, (self.flat - 1, self.side), 1, self.ends)
        yield Joint(self.face, self.edge.name, (self.edge.curve, self.flat), 1, self.ends)
        if after.face != self.face:
            (a, b), (u, v) = self.edge.end, gradient(self.edge.curve, self.edge.end)
            out = (self.edge.bow or 1) / square_root(u * u + v * v)
            depth = Polynomial.from_raw(((X - a) * u + (Y - b) * v) * (out / radius)) + 1
            yield Joint(self.face, after.face, (self.flat**2 + depth**2 - 1, self.ends[1]), 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class RoundedPrism(SweptBody):
    """What bounds an upright solid over loops with the edges at some ends of some of them rounded, by number."""

    height: float
    radius: float
    rounds: Mapping[tuple[int, str], tuple[ProfileRound, ...]]

    def made(self, tolerance: float) -> Faces | None:
        """Its faces: at each end rows of the loops' polygons, moved inwards along the rounds."""
        found = self.polygons(tolerance / 3)
        if found is None:
            return None
        turns = np.linspace(0, np.pi / 2, 1 + max(2, math.ceil(0.9 * math.sqrt(3 * self.radius / tolerance))))
        arc = self.radius * (1 - np.stack([np.sin(turns), np.cos(turns)], axis=1))  # how deep in, and below the end
        none, made, rims, first = np.zeros((1, 2)), Faces([], 0.0), dict[str, list[Integers]](top=[], bottom=[]), 0
        for number, (loop, points, counts) in enumerate(zip(self.loops, found[0], found[1], strict=True)):
            top, bottom = (arc if (number, end) in self.rounds else none for end in ("top", "bottom"))
            rows = np.concatenate([top * [1, -1] + [0, self.height], bottom[::-1]])
            flat_points = points + rows[:, :1, None] * np.concatenate(inwards(loop, points, counts))
            heights = np.broadcast_to(rows[:, 1, None, None], (*flat_points.shape[:2], 1))
            made.blocks.append(np.concatenate([flat_points, heights], axis=2).reshape(-1, 3))
            n, borders = len(points), np.cumsum([0, *counts])
            numbers = first + np.arange(len(rows) * n).reshape(-1, n)
            first += numbers.size
            parts = (("top", 0, len(top)), ("", len(top) - 1, len(top) + 1), ("bottom", len(top), len(rows)))
            for (end, low, high), (k, edge) in product(parts, enumerate(loop.edges)):
                found_rounds = self.rounds.get((number, end), ())
                some = next((r for r in found_rounds if r.edge == edge or len(found_rounds) == 1), None)
                name, surface = (some.face, some.surface) if some else (edge.name, edge.curve)
                if high - low > 1:
                    across = numbers[low:high, np.arange(borders[k], borders[k + 1] + 1) % n]
                    put_side(made, name, [*across.T], jets_of(surface))
            rims["top"].append(numbers[0])
            rims["bottom"].append(numbers[-1])
        for end, sign in (("top", 1), ("bottom", -1)):
            triangles = flat([made.points[rim, :2] for rim in rims[end]])
            if triangles is None:
                return None
            put_flat(made, end, np.concatenate(rims[end])[triangles][:, ::sign], np.array([0.0, 0.0, sign]))
        return made


def rounded(solid: Solid, faces: Sequence[str] | None, radius: fmpq, order: int) -> Solid:
    """The solid with the edges of plane faces or of a profile's ends rounded; see `Solid.rounded`."""
    known = solid.sheets
    first: Any = known.parts[0] if isinstance(known, Operands) and known.operation == "Subtract" else solid
    body = first.sheets
    if isinstance(body, RoundedPrism):
        raise GeometryError("edges of the solid are rounded already: name the faces of all that are to be in one call")
    arcs = isinstance(body, Prism) and any(edge.control for loop in body.loops for edge in loop.edges)
    if not isinstance(body, Prism) or body.lean.slope or not arcs:
        return of_planes(solid, faces, radius, order)
    if check_order(order) != 1:
        raise GeometryError("edges of a profile with arcs are rounded with GC^1 only: order must be 1")
    made = rounded_prism(first, body, faces, radius / _stretch(body))
    if first is solid:
        return made
    assert isinstance(known, Operands)
    made = reduce(sub, known.parts[1:], made)
    return replace(made, joints=tuple(dict.fromkeys((*made.joints, *solid.joints))))


def rounded_prism(solid: Solid, body: Prism, faces: Sequence[str] | None, radius: fmpq) -> Solid:
    """A solid over a profile with arcs with edges at its ends rounded; see `Solid.rounded`."""
    known = dict.fromkeys(["bottom", "top", *(edge.name for loop in body.loops for edge in loop.edges)])
    for name in faces or ():
        if name not in known:
            raise GeometryError(f"the solid has no face {name!r}{meant(name, known) or ''}")
    chosen = {*known} if faces is None else {*faces}
    height, rounds = rational(body.height), dict[tuple[int, str], tuple[ProfileRound, ...]]()
    ends = {"top": Z - height, "bottom": -Z}
    for (number, loop), end in product(enumerate(body.loops), (end for end in ends if end in chosen)):
        names = {edge.name for edge in loop.edges} & chosen
        if not names:
            continue
        _refuse_unrounded(loop, names, end, radius)
        flat_ = Polynomial.from_raw(ends[end]) * (1 / radius) + 1
        edges = loop.edges[:1] if loop.whole else loop.edges
        rounds[number, end] = tuple(ProfileRound.of(end, edge, flat_, radius, loop.whole) for edge in edges)
    if not rounds:
        raise GeometryError("no edge at the top or bottom is between two of the faces")
    most = height / len({end for _, end in rounds})
    if radius >= most:
        raise GeometryError(f"radius must be below {plain(most)}, where the sides are used up, not {plain(radius)}")
    made = RoundedPrism(loops=body.loops, height=body.height, radius=to_float(radius), rounds=rounds, place=body.place)
    if made.coarse is None:
        raise GeometryError(f"radius {plain(radius)} is too large: rounds of the profile's edges would meet on an end")
    every = [one for some in rounds.values() for one in some]
    pairs = (pair for some in rounds.values() for pair in zip(some, some[1:] + some[:1], strict=True))
    claims = [claim for one, after in pairs for claim in one.claims(after, radius)]
    cut = Solid(combined(False, *(one.rest for one in every)), tuple(claims))
    moved = cut if body.place is None else cut._moved(body.place)
    joints = (*solid.joints, *moved.joints)
    return replace(solid, tree=combined(False, solid.tree, moved.tree), joints=joints, sheets=made)


def _stretch(body: Prism) -> fmpq:
    """By how much lengths grew where it was moved; raises `GeometryError` where not all by the same."""
    if body.place is None:
        return fmpq(1)
    columns = [*zip(*body.place.matrix, strict=True)]
    factor = square_root(dot(columns[0], columns[0]))
    if any(dot(a, b) != (factor**2 if a is b else 0) for a, b in product(columns, columns)):
        raise GeometryError("the solid was stretched in a direction: round its edges before that")
    return factor


def _refuse_unrounded(loop: Loop, names: set[str], end: str, radius: fmpq) -> None:
    """Raise `GeometryError` where a loop has a part that no round of a ball goes along exactly."""
    smooth = [*loop.smooth_corners]
    for one, other in loop.corners if not loop.whole else ():
        if (one, other) not in smooth and one.curve.primitive() != other.curve.primitive():
            raise GeometryError(
                f"edges {one.name!r} and {other.name!r} meet with an angle at {at(one.end)}: with arcs in a profile "
                f"such edges are rounded as go on smoothly; make an arc of the corner"
            )
        if (one.name in names) != (other.name in names):
            raise GeometryError(
                f"sides {one.name!r} and {other.name!r} go on smoothly in one another; name both or none"
            )
    for edge in loop.edges:
        if edge.control is None:
            if square_root(square_of(edge)) ** 2 != square_of(edge):
                raise GeometryError(f"the edge {edge.name!r} has no rational length: no cylinder is along it exactly")
            continue
        found = radius_of(edge.curve)
        if found is None or square_root(found[1]) ** 2 != found[1]:
            raise GeometryError(f"the edge {edge.name!r} is no arc of a circle of rational radius: it is not rounded")
        if edge.bow > 0 and radius >= square_root(found[1]):
            size = plain(square_root(found[1]))
            raise GeometryError(f"radius must be below {size}, that of the edge {edge.name!r}, not {plain(radius)}")
