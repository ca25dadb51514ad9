"""Upright solids over profiles with arcs, the edges at whose ends are rounded, or that have fillets around them.

Rounds of a profile that goes on smoothly, arcs of circles and straight edges, are the fillets of these edges: of order
1 of the ball that rolls along, tori and cylinders.  Each is between the planes across the profile through its edge's
ends, and joints are claimed there.

Guaranteed: that the rounds of one end do not meet, as they are on the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, plain, rational, square_root, to_float
from pas.errors import GeometryError, meant
from pas.solid.edges import Loop, PlaneEdge, at, radius_of
from pas.solid.extrusion import Prism, Rounds, square_of
from pas.solid.face_seams import FaceSeam, SmoothEnd
from pas.solid.faces import SolidBoundary
from pas.solid.fillet_forms import FilletPiece
from pas.solid.joints import Joint
from pas.solid.linked import RenamedBoundary
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


def _rounds(loop: int, pieces: Sequence[FilletPiece], height: float) -> Rounds:
    """The fillets along a loop, by its number, of a solid up to a height; see `pieces_along`."""
    (plane, _), sign, radius = pieces[0].seam.faces, pieces[0].seam.sign, to_float(pieces[0].radius)
    slope = plane.diff(2).raw(0, 0, 0)
    level, up = to_float(-plane.raw(0, 0, 0) / slope), sign if slope > 0 else -sign
    foot = min(radius / 64, (level if up > 0 else height - level) / 2 or radius) if sign > 0 else 0.0
    faces = tuple((piece.face, piece.form.surface) for piece in pieces)
    return Rounds(loop, level, up, foot, radius, pieces[0].order, faces)


def rounded(solid: Solid, faces: Sequence[str] | None, radius: fmpq, order: int) -> Solid:
    """The solid with the edges of plane faces or of a profile's ends rounded; see `Solid.rounded`."""
    known = solid.sheets
    first: Any = known.parts[0] if isinstance(known, Operands) and known.is_difference else solid
    body = first.sheets
    if isinstance(body, Prism) and body.rounds:
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
    known_rounds = tuple(_rounds(number, some, body.height) for (number, _), some in rounds.items())
    made = replace(body, rounds=known_rounds)
    if made.coarse is None:
        raise GeometryError(f"radius {plain(radius)} is too large: rounds of the profile's edges would meet on an end")
    rests = (complement(piece.tree()) for some in rounds.values() for piece in some)
    cut = Solid(combined(False, *rests), tuple(claim for some in rounds.values() for claim in _claims(some)))
    moved = cut if body.place is None else cut._moved(body.place)
    joints = (*solid.joints, *moved.joints)
    return replace(solid, tree=combined(False, solid.tree, moved.tree), joints=joints, sheets=made)


def filleted(known: SolidBoundary | None, pieces: Sequence[FilletPiece], gains: bool) -> SolidBoundary | None:
    """The boundary of a solid with fillets all along an end of an upright one, or around it; None if unknown.

    The upright one is the solid itself or an operand of set operations; `gains` says whether the fillets are added to
    it. It is not known where the fillets meet other operands.
    """
    flat = [face for face in pieces[0].seam.faces if face.degree == 1 and all(face in p.seam.faces for p in pieces)]
    face = pieces[0].face
    if len(flat) != 1:
        return None
    if isinstance(known, RenamedBoundary):
        body = filleted(known.body, pieces, gains)
        return body and RenamedBoundary(body, {**known.names, face: face})
    if isinstance(known, Prism):
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


def _prism_filleted(known: Prism, pieces: Sequence[FilletPiece], plane: Polynomial, gains: bool) -> Prism | None:
    """The boundary of an upright solid with such fillets in a plane; see `filleted`."""
    stretch = None if known.lean.slope else _stretch(known)
    if stretch is None:
        return None
    sign, first = 1 if gains else -1, pieces[0]

    def before(polynomial: Polynomial) -> Polynomial:
        """The polynomial of which one is the image where the solid was moved."""
        return known.place.inverse.polynomial(polynomial) if known.place else polynomial

    level = before(plane) * (sign * first.seam.sign)
    faces = {before(face).primitive() for piece in pieces for face in piece.seam.faces}
    surfaces = {before(piece.form.surface).primitive() for piece in pieces}
    for number, loop in enumerate(known.loops if not any(slope_at(level)[:2]) else ()):
        if faces == {level.primitive(), *(edge.curve.primitive() for edge in loop.edges)}:
            own = pieces_along(loop, "", level, first.radius / stretch, first.order, sign)
            new = _rounds(number, [replace(piece, face=first.face) for piece in own], known.height)
            if new.fits(known.height) and surfaces == {piece.form.surface.primitive() for piece in own}:
                made = replace(known, rounds=(*known.rounds, new))
                return made if made.coarse is not None else None
    return None


def _stretch(body: Prism) -> fmpq | None:
    """The factor by which the map of a moved solid lengthens; None where it depends on the direction."""
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
