"""Upright solids over profiles with arcs, the edges at whose ends are rounded.

Rounds of a profile that goes on smoothly, arcs of circles and straight edges, are the fillets of these edges: of order
1 of the ball that rolls along, tori and cylinders.  Each is between the planes across the profile through its edge's
ends, and joints are claimed there.

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
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, plain, rational, square_root, to_float
from pas.errors import GeometryError, meant
from pas.mesh.rows import Integers
from pas.solid.edges import Loop, PlaneEdge, at, radius_of
from pas.solid.extrusion import Prism, inwards, square_of
from pas.solid.face_seams import FaceSeam, SmoothEnd
from pas.solid.fillet_forms import FilletPiece
from pas.solid.joints import Joint
from pas.solid.linked import RenamedBoundary, SolidBoundary
from pas.solid.operands import Operands
from pas.solid.rounding import rounded as of_planes
from pas.solid.sheets import Faces
from pas.solid.solid import Solid
from pas.solid.swept import SweptBody, flat, jets_of, put_flat, put_side
from pas.solid.tree import atoms, combined, complement

X, Y, Z = GENERATORS


def pieces_along(loop: Loop, end: str, plane: Polynomial, radius: fmpq, order: int) -> list[FilletPiece]:
    """The fillets of the edges of a loop, in turn, at an end in a plane; of one that is a whole circle of all of it."""
    found, height = list[FilletPiece](), to_float(-plane.raw(0, 0, 0) / plane.diff(2).raw(0, 0, 0))
    for number, edge in enumerate(loop.edges[:1] if loop.whole else loop.edges):
        smooth = list[SmoothEnd]()
        for at_end, step in ((False, -1), (True, 1)) if not loop.whole else ():
            (a, b), (u, v) = edge.end if at_end else edge.start, edge.tangent(at_end)
            across = Polynomial.from_raw(((X - a) * u + (Y - b) * v) * -step)
            after = loop.edges[(number + step) % len(loop.edges)]
            smooth.append(SmoothEnd((end, after.name), across, PlaneEdge.straight((a, b), (a + u, b + v), "").curve))
        points = np.pad(edge.points(2), ((0, 0), (0, 1)), constant_values=height)
        seam = FaceSeam((end, edge.name), (plane, edge.curve * (edge.bow or 1)), points, -1, tuple(smooth))
        found.append(FilletPiece(f"{edge.name} / {end}", seam, radius, order))
    return found


def _claims(pieces: Sequence[FilletPiece]) -> Iterator[Joint]:
    """The joints of fillets along a loop with the faces beside them, and with one another."""
    for one, after in zip(pieces, (*pieces[1:], pieces[0]), strict=True):
        yield from one.claims()
        if after.face != one.face:
            yield Joint(one.face, after.face, one.section(one.seam.smooth[1]), 1)


def _section(order: int, parts: int) -> Floats:
    """Points (parts + 1, 2) of the section 2 s t = (1 - s - t)^(order + 1) of a fillet: t and s of each.

    They are in the directions of points evenly along the circle that it is of order 1.
    """
    turns = np.linspace(0, np.pi / 2, parts + 1)
    circle = 1 - np.stack([np.sin(turns), np.cos(turns)], axis=1)
    shares = circle / circle.sum(axis=1)[:, None]
    low, high = np.zeros(parts + 1), np.ones(parts + 1)
    for _ in range(60):  # halvings, after which doubles are equal
        middle = (low + high) / 2
        inside = 2 * shares.prod(axis=1) * middle**2 < (1 - middle) ** (order + 1)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(shares * high[:, None]) if order else shares


@dataclass(frozen=True)
class RoundFace:
    """The name and the surface of a face."""

    face: str
    surface: Polynomial


@dataclass(frozen=True, eq=False, kw_only=True)
class RoundedPrism(SweptBody):
    """What bounds an upright solid over loops with the edges at some ends of some of them rounded, by number."""

    height: float
    radius: float
    order: int
    rounds: Mapping[tuple[int, str], tuple[RoundFace, ...]]

    def made(self, tolerance: float) -> Faces | None:
        """Its faces, finer where they are nearly singular, as tori are that nearly meet themselves."""
        finer, finest = tolerance, min(tolerance, 2.0**-20 * self.extent)
        while (found := self._rows(finer)) is not None and found.deviation > tolerance and finer > finest:
            finer /= 4
        return found

    def _rows(self, tolerance: float) -> Faces | None:
        """At each end rows of the loops' polygons, moved inwards along the rounds, and all between them."""
        found = self.polygons(tolerance / 3)
        if found is None:
            return None
        turns = max(2, math.ceil(0.9 * self.order * math.sqrt(3 * self.radius / tolerance)))
        arc = self.radius * _section(self.order, turns)  # how deep in, and below the end
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
            for row, rim in ((numbers[0], flat_points[0]), (numbers[-1], flat_points[-1])):
                same = np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1) < 2.0**-40 * self.extent
                row[:] = row[~same][np.cumsum(~same) - 1]  # of an arc of the radius one point is left
            parts = (("top", 0, len(top)), ("", len(top) - 1, len(top) + 1), ("bottom", len(top), len(rows)))
            for (end, low, high), (k, edge) in product(parts, enumerate(loop.edges)):
                found_rounds = self.rounds.get((number, end), ())
                some = found_rounds[0 if loop.whole else k] if found_rounds else RoundFace(edge.name, edge.curve)
                if high - low > 1:
                    across = numbers[low:high, np.arange(borders[k], borders[k + 1] + 1) % n]
                    put_side(made, some.face, [*across.T], jets_of(some.surface))
            for end, row in (("top", numbers[0]), ("bottom", numbers[-1])):
                rims[end].append(row[row != np.roll(row, 1)])
        for end, sign in (("top", 1), ("bottom", -1)):
            triangles = flat([made.points[rim, :2] for rim in rims[end]])
            if triangles is None or not len(triangles):
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
    if check_order(order) not in (1, 2):
        raise GeometryError(f"edges of a profile with arcs are rounded with GC^1 or GC^2: order is 1 or 2, not {order}")
    stretch = _stretch(body)
    if stretch is None:
        raise GeometryError("the solid was stretched in a direction: round its edges before that")
    made = rounded_prism(first, body, faces, radius / stretch, order)
    if first is solid:
        return made
    assert isinstance(known, Operands)
    made = reduce(sub, known.parts[1:], made)
    return replace(made, joints=tuple(dict.fromkeys((*made.joints, *solid.joints))))


def rounded_prism(solid: Solid, body: Prism, faces: Sequence[str] | None, radius: fmpq, order: int) -> Solid:
    """A solid over a profile with arcs with edges at its ends rounded; see `Solid.rounded`."""
    known = dict.fromkeys(["bottom", "top", *(edge.name for loop in body.loops for edge in loop.edges)])
    for name in faces or ():
        if name not in known:
            raise GeometryError(f"the solid has no face {name!r}{meant(name, known) or ''}")
    chosen = {*known} if faces is None else {*faces}
    height, rounds = rational(body.height), dict[tuple[int, str], list[FilletPiece]]()
    ends = {"top": Polynomial.from_raw(Z - height), "bottom": Polynomial.from_raw(-Z)}
    for (number, loop), end in product(enumerate(body.loops), (end for end in ends if end in chosen)):
        names = {edge.name for edge in loop.edges} & chosen
        if not names:
            continue
        _refuse_unrounded(loop, names, radius, order)
        rounds[number, end] = pieces_along(loop, end, ends[end], radius, order)
    if not rounds:
        raise GeometryError("no edge at the top or bottom is between two of the faces")
    most = height / len({end for _, end in rounds})
    if radius >= most:
        raise GeometryError(f"radius must be below {plain(most)}, where the sides are used up, not {plain(radius)}")
    made = _rounded_body(body, radius, order, rounds)
    if made.coarse is None:
        raise GeometryError(f"radius {plain(radius)} is too large: rounds of the profile's edges would meet on an end")
    rests = (complement(piece.tree()) for some in rounds.values() for piece in some)
    cut = Solid(combined(False, *rests), tuple(claim for some in rounds.values() for claim in _claims(some)))
    moved = cut if body.place is None else cut._moved(body.place)
    joints = (*solid.joints, *moved.joints)
    return replace(solid, tree=combined(False, solid.tree, moved.tree), joints=joints, sheets=made)


def filleted(known: SolidBoundary | None, pieces: Sequence[FilletPiece]) -> SolidBoundary | None:
    """What bounds a solid with fillets all along the end of an upright one, which it is or set operations are made of.

    None where they are not that, or would meet there.
    """
    names = {name for piece in pieces for name in piece.seam.names}
    if isinstance(known, Operands):
        for number, part in enumerate(known.parts):
            body = filleted(part.sheets, pieces) if names.issubset(atom.face for atom in atoms(part.tree)) else None
            if body is not None:
                tree = combined(False, part.tree, *(complement(piece.tree()) for piece in pieces))
                parts = (*known.parts[:number], Solid(tree, sheets=body), *known.parts[number + 1 :])
                return replace(known, parts=parts)
    if isinstance(known, RenamedBoundary):
        old = {new: name for name, new in known.names.items()}
        pairs = ((p.seam, [old.get(name, name) for name in p.seam.names]) for p in pieces)
        seams = [replace(seam, names=(first, second)) for seam, (first, second) in pairs]
        body = filleted(known.body, [replace(p, seam=seam) for p, seam in zip(pieces, seams, strict=True)])
        return body and RenamedBoundary(body, {**known.names, pieces[0].face: pieces[0].face})
    stretch = None if not isinstance(known, Prism) or known.lean.slope else _stretch(known)
    if not isinstance(known, Prism) or stretch is None:
        return None
    end, size, order = "top" if "top" in names else "bottom", pieces[0].radius / stretch, pieces[0].order
    plane = Polynomial.from_raw(Z - rational(known.height) if end == "top" else -Z)
    for number, loop in enumerate(known.loops):
        if {end, *(edge.name for edge in loop.edges)} == names:
            own = [replace(p, face=pieces[0].face) for p in pieces_along(loop, end, plane, size, order)]
            surfaces = (p.form.surface if known.place is None else known.place.polynomial(p.form.surface) for p in own)
            if {surface.primitive() for surface in surfaces} == {p.form.surface.primitive() for p in pieces}:
                made = _rounded_body(known, size, order, {(number, end): own})
                return made if made.coarse is not None else None
    return None


def _rounded_body(
    body: Prism, radius: fmpq, order: int, rounds: dict[tuple[int, str], list[FilletPiece]]
) -> RoundedPrism:
    """What bounds a solid over a profile with rounds."""
    size, place = to_float(radius), body.place
    known = {key: tuple(RoundFace(piece.face, piece.form.surface) for piece in some) for key, some in rounds.items()}
    return RoundedPrism(loops=body.loops, height=body.height, radius=size, order=order, rounds=known, place=place)


def _stretch(body: Prism) -> fmpq | None:
    """By how much lengths grew where it was moved; None where not all by the same."""
    if body.place is None:
        return fmpq(1)
    columns = [*zip(*body.place.matrix, strict=True)]
    factor = square_root(dot(columns[0], columns[0]))
    alike = all(dot(a, b) == (factor**2 if a is b else 0) for a, b in product(columns, columns))
    return factor if alike else None


def _refuse_unrounded(loop: Loop, names: set[str], radius: fmpq, order: int) -> None:
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
        size, most = square_root(found[1]), "below" if order > 1 or loop.whole else "at most"
        if edge.bow > 0 and (radius > size or (radius == size and most == "below")):
            raise GeometryError(
                f"radius must be {most} {plain(size)}, that of the edge {edge.name!r}, not {plain(radius)}"
            )
