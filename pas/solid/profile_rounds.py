"""Upright solids over profiles with arcs, the edges at whose ends are rounded, or that have fillets around them.

Rounds of a profile that goes on smoothly, arcs of circles and straight edges, are the fillets of these edges: of order
1 of the ball that rolls along, tori and cylinders.  Each is between the planes across the profile through its edge's
ends, and joints are claimed there.

Guaranteed: that the rounds of one end do not meet, as they are on the mesh.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, plain, rational, square_root, to_float
from pas.errors import GeometryError, meant
from pas.mesh.rows import Floats, Integers
from pas.solid.edges import Loop, PlaneEdge, at, radius_of
from pas.solid.extrusion import Prism, inwards, square_of
from pas.solid.face_seams import FaceSeam, SmoothEnd
from pas.solid.faces import Faces, SweptBody, jets_of
from pas.solid.fillet_forms import FilletPiece
from pas.solid.joints import Joint
from pas.solid.linked import RenamedBoundary, SolidBoundary
from pas.solid.operands import Operands
from pas.solid.rounding import rounded as of_planes
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined, complement

X, Y, Z = GENERATORS


def pieces_along(
    loop: Loop, end: str, plane: Polynomial, radius: fmpq, order: int, sign: int = -1
) -> list[FilletPiece]:
    """The fillets of the edges of a loop, in turn, at an end in a plane; of one that is a whole circle of all of it; if
    `sign` is 1 those outside, where the plane's polynomial is positive."""
    found, height = list[FilletPiece](), to_float(-plane.raw(0, 0, 0) / plane.diff(2).raw(0, 0, 0))
    for number, edge in enumerate(loop.edges[:1] if loop.whole else loop.edges):
        smooth = list[SmoothEnd]()
        for at_end, step in ((False, -1), (True, 1)) if not loop.whole else ():
            (a, b), (u, v) = edge.end if at_end else edge.start, edge.tangent(at_end)
            across = Polynomial.from_raw(((X - a) * u + (Y - b) * v) * -step)
            after = loop.edges[(number + step) % len(loop.edges)]
            smooth.append(SmoothEnd((end, after.name), across, PlaneEdge.straight((a, b), (a + u, b + v), "").curve))
        points = np.pad(edge.points(2), ((0, 0), (0, 1)), constant_values=height)
        seam = FaceSeam((end, edge.name), (plane, edge.curve * (edge.bow or 1)), points, sign, tuple(smooth))
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
class Rounds:
    """The faces, by name and surface, along the edges of a loop, by its number, in a plane across it at a `level`,
    above it if `up` is 1 and below if -1: rounds of an end of its solid, or, where `foot` is not 0, fillets around it.

    A fillet ends in the plane, in what the solid stands on, and begins where the sides are left.  Rounding would say
    which of two faces in one plane is in front, so that the row of the sides is moved on by `foot` beyond it.
    """

    loop: int
    level: float
    up: int
    foot: float
    radius: float
    order: int
    faces: tuple[tuple[str, Polynomial], ...]

    @classmethod
    def of(cls, loop: int, pieces: Sequence[FilletPiece], height: float) -> Rounds:
        """Those of the fillets along a loop of a solid up to a height; see `pieces_along`."""
        (plane, _), sign, radius = pieces[0].seam.faces, pieces[0].seam.sign, to_float(pieces[0].radius)
        slope = plane.diff(2).raw(0, 0, 0)
        level, up = to_float(-plane.raw(0, 0, 0) / slope), sign if slope > 0 else -sign
        foot = min(radius / 64, (level if up > 0 else height - level) / 2 or radius) if sign > 0 else 0.0
        faces = tuple((piece.face, piece.form.surface) for piece in pieces)
        return cls(loop, level, up, foot, radius, pieces[0].order, faces)

    def fits(self, height: float) -> bool:
        """Whether they are beside a solid up to a height, or at one of its ends."""
        within = 0.0 <= self.level <= height and 0.0 < self.level + self.up * self.radius < height
        return within and (self.foot > 0 or self.level in (0.0, height))

    def rows(self, tolerance: float) -> Floats:
        """How far inwards, and how high, rows (N, 2) along them are, from above."""
        turns = max(2, math.ceil(0.9 * self.order * math.sqrt(3 * self.radius / tolerance)))
        arc = self.radius * _section(self.order, turns) * [-1 if self.foot else 1, self.up]
        beyond = np.array([[0.0, -self.up * self.foot]] if self.foot else np.empty((0, 2)))
        return np.concatenate([beyond, arc])[:: -self.up] + [0, self.level]


@dataclass(frozen=True, eq=False, kw_only=True)
class RoundedPrism(SweptBody):
    """What bounds an upright solid over loops with rounds, or fillets around it, all along some of them."""

    height: float
    rounds: tuple[Rounds, ...]

    def made(self, tolerance: float) -> Faces | None:
        """Its faces, finer where they are nearly singular, as tori are that nearly meet themselves."""
        finer, finest = tolerance, min(tolerance, 2.0**-20 * self.extent)
        while (found := self._rows(finer)) is not None and found.deviation > tolerance and finer > finest:
            finer /= 4
        return found

    def _rows(self, tolerance: float) -> Faces | None:
        """Rows of the loops' polygons, moved along the rounds, all between them, and both ends."""
        found = self.polygons(tolerance / 3)
        if found is None:
            return None
        made, rims = Faces([], 0.0), list[tuple[Integers, Integers]]()
        for number, polygon in enumerate(zip(*found[:2], strict=True)):
            ends = self._put_sides(made, number, polygon, tolerance)
            if ends is None:
                return None
            rims.append(ends)
        tops, bottoms = zip(*rims, strict=True)
        return made if made.put_level("top", tops, 1) and made.put_level("bottom", bottoms, -1) else None

    def _sections(
        self, made: Faces, number: int, polygon: tuple[Floats, list[int]], tolerance: float
    ) -> list[tuple[Integers, Rounds | None]] | None:
        """The rows of vertices of a loop, from above: those of its rounds, and others; None where rounds meet."""
        rounds = [one for one in self.rounds if one.loop == number]
        found: list[tuple[Floats, Rounds | None]] = [(one.rows(tolerance), one) for one in rounds]
        found += [(np.array([[0.0, z]]), None) for z in {self.height, 0.0} - {one.level for one in rounds}]
        sections = sorted(found, key=lambda section: -section[0][:, 1].mean())
        rows, ends = np.concatenate([some for some, _ in sections]), np.cumsum([len(some) for some, _ in sections])
        falls = -np.diff(rows[:, 1])
        if falls.min() < 0 or falls[ends[:-1] - 1].min() == 0:
            return None
        moved = polygon[0] + rows[:, :1, None] * np.concatenate(inwards(self.loops[number], *polygon))
        heights = np.broadcast_to(rows[:, 1, None, None], (*moved.shape[:2], 1))
        numbers = made.added(np.concatenate([moved, heights], axis=2).reshape(-1, 3)).reshape(len(rows), -1)
        for row, rim in zip(numbers, moved, strict=True):
            same = np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1) < 2.0**-40 * self.extent
            row[:] = row[~same][np.cumsum(~same) - 1]  # of an arc of the radius one point is left
        return [*zip(np.split(numbers, ends[:-1]), (one for _, one in sections), strict=True)]

    def _put_sides(
        self, made: Faces, number: int, polygon: tuple[Floats, list[int]], tolerance: float
    ) -> tuple[Integers, Integers] | None:
        """The faces of a loop but for both ends, whose rows of vertices are given back; None where they cross."""
        loop, sections = self.loops[number], self._sections(made, number, polygon, tolerance)
        if sections is None:
            return None
        bands: list[tuple[Integers, Rounds | None]] = [(rows, one) for rows, one in sections if one]
        bands += [(np.stack([above[-1], below[0]]), None) for (above, _), (below, _) in pairwise(sections)]
        for place, (rows, one) in enumerate(bands):
            if one and one.foot:
                *arc, rim, inner = rows[:: one.up]
                if not made.put_level(one.faces[0][0], (rim, inner[::-1]), -one.up):
                    return None
                bands[place] = np.stack([*arc, rim])[:: one.up], one
        borders = np.cumsum([0, *polygon[1]])
        for (rows, one), (k, edge) in product(bands, enumerate(loop.edges)):
            name, surface = one.faces[0 if loop.whole else k] if one else (edge.name, edge.curve)
            across = rows[:, np.arange(borders[k], borders[k + 1] + 1) % rows.shape[1]]
            made.put_side(name, [*across.T], jets_of(surface))
        return sections[0][0][0], sections[-1][0][-1]


def rounded(solid: Solid, faces: Sequence[str] | None, radius: fmpq, order: int) -> Solid:
    """The solid with the edges of plane faces or of a profile's ends rounded; see `Solid.rounded`."""
    known = solid.sheets
    first: Any = known.parts[0] if isinstance(known, Operands) and known.is_difference else solid
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
    made = known.made_with(made)
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
    known_rounds = tuple(Rounds.of(number, some, body.height) for (number, _), some in rounds.items())
    made = RoundedPrism(loops=body.loops, height=body.height, rounds=known_rounds, place=body.place)
    if made.coarse is None:
        raise GeometryError(f"radius {plain(radius)} is too large: rounds of the profile's edges would meet on an end")
    rests = (complement(piece.tree()) for some in rounds.values() for piece in some)
    cut = Solid(combined(False, *rests), tuple(claim for some in rounds.values() for claim in _claims(some)))
    moved = cut if body.place is None else cut._moved(body.place)
    joints = (*solid.joints, *moved.joints)
    return replace(solid, tree=combined(False, solid.tree, moved.tree), joints=joints, sheets=made)


def filleted(known: SolidBoundary | None, pieces: Sequence[FilletPiece], gains: bool) -> SolidBoundary | None:
    """What bounds a solid with fillets all along an end of an upright one, or around it, which it is or set operations
    are made of; `gains` says whether they are added to it.

    None where they are not that, or would meet there.
    """
    flat = [face for face in pieces[0].seam.faces if face.degree == 1 and all(face in p.seam.faces for p in pieces)]
    face = pieces[0].face
    if len(flat) != 1:
        return None
    if isinstance(known, RenamedBoundary):
        body = filleted(known.body, pieces, gains)
        return body and RenamedBoundary(body, {**known.names, face: face})
    if isinstance(known, Prism | RoundedPrism):
        return _prism_filleted(known, pieces, flat[0], gains)
    if isinstance(known, Operands):
        for number, part in enumerate(known.parts):
            more = gains != bool(known.turned[number])
            if (body := filleted(part.sheets, pieces, more)) is not None:
                trees = (piece.tree((), [Atom(flat[0] * -piece.seam.sign, face)]) for piece in pieces)
                tree = combined(more, part.tree, *(tree if more else complement(tree) for tree in trees))
                parts = (*known.parts[:number], Solid(tree, sheets=body), *known.parts[number + 1 :])
                return replace(known, parts=parts)
    return None


def _prism_filleted(
    known: Prism | RoundedPrism, pieces: Sequence[FilletPiece], plane: Polynomial, gains: bool
) -> RoundedPrism | None:
    """What bounds an upright solid with such fillets in a plane; see `filleted`."""
    old = known.rounds if isinstance(known, RoundedPrism) else ()
    stretch = None if isinstance(known, Prism) and known.lean.slope else _stretch(known)
    if stretch is None:
        return None
    sign, first = 1 if gains else -1, pieces[0]

    def before(polynomial: Polynomial) -> Polynomial:
        """That of which a polynomial is the image where the solid was moved."""
        return known.place.inverse.polynomial(polynomial) if known.place else polynomial

    level = before(plane) * (sign * first.seam.sign)
    faces = {before(face).primitive() for piece in pieces for face in piece.seam.faces}
    surfaces = {before(piece.form.surface).primitive() for piece in pieces}
    for number, loop in enumerate(known.loops if not any(slope_at(level)[:2]) else ()):
        if faces == {level.primitive(), *(edge.curve.primitive() for edge in loop.edges)}:
            own = pieces_along(loop, "", level, first.radius / stretch, first.order, sign)
            new = Rounds.of(number, [replace(piece, face=first.face) for piece in own], known.height)
            if new.fits(known.height) and surfaces == {piece.form.surface.primitive() for piece in own}:
                made = RoundedPrism(loops=known.loops, height=known.height, rounds=(*old, new), place=known.place)
                return made if made.coarse is not None else None
    return None


def _stretch(body: Prism | RoundedPrism) -> fmpq | None:
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
