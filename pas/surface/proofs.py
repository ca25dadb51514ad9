"""The proofs of what a piecewise surface promises.

Contacts and faces: exact division, remainder identically zero (Garrity and Warren 1991), and
`alpha > 0` on each contact curve, so that the surface is regular there and on the right side.

One sheet: with the guide field u(x) = x - O from the centre O, `grad f . u > 0` wherever `f = 0`
in each cell.  Since rays from O do not change cells, f changes sign at most once along each, and
upwards: no second sheet, no bubble, no singular point.

Enclosed: `f > 0` on the outer faces that are not in a clip plane, and `f = alpha f_i` with
`alpha > 0` on all of the clip faces, so the surface leaves the region through its contact curves
alone.  Together the two say that the surface is a graph over the sphere of directions less one
disc a contact: for c contacts its Euler characteristic is 2 - c.

All inequalities are proved by Bernstein branch and bound with rounding accounted for (see
`pas.bernstein.signs`).  What is not promised: anything outside the region.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.normal_form import NormalForm
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, to_floats
from pas.bernstein.forms import b_form, on_simplex, rounded
from pas.bernstein.signs import Limits, SignResult, Status, prove_positive
from pas.errors import GeometryError
from pas.surface.certificate import Certificate, Point, Verdict
from pas.surface.joins import Join

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface


SEARCH_CELLS = Limits(halvings=24, largest_batch=3000, exhaustive=True)
SEARCH_FACES = Limits(halvings=16, largest_batch=1500, exhaustive=True)
DEEP = Limits(exhaustive=True)
"""A search for violations may end early: what it leaves open becomes new constraints."""


@dataclass(frozen=True)
class Violations:
    """Points (local coordinates) where a condition failed or was left open, with their pieces (of
    contacts: their numbers)."""

    sheet: list[tuple[int, Floats]]
    walls: list[tuple[int, Floats]]
    contacts: list[tuple[int, Floats]]

    @property
    def none(self) -> bool:
        """Whether every inequality was proved."""
        return not (self.sheet or self.walls or self.contacts)


def certify(surface: PiecewiseSurface) -> Certificate:
    """Prove everything that is promised of the surface."""
    return Certificate(
        tuple(contact_verdict(surface, i) for i in range(len(surface.contacts))),
        tuple(face_verdict(surface, i) for i in range(len(surface.partition.interior_faces))),
        sheet_verdict(surface),
        enclosed_verdict(surface),
    )


def contact_verdict(surface: PiecewiseSurface, number: int) -> Verdict:
    """Exact GC^k with one contact, alpha > 0 on its curve, the curve regular and in its face."""
    join, k = surface.joins[number], surface.order
    claim = f"contact {number + 1} GC^{k}"
    achieved = min(_contact_order(surface.patches[piece], join, k) for piece in join.pieces)
    curve = join.curve()
    point = _global_point(surface, curve[0]) if len(curve) else None
    if achieved < k:
        met = "does not meet the contact at all" if achieved < 0 else f"meets it with GC^{achieved} only"
        return Verdict(Status.REFUTED, claim, f"the patch {met}: f is not in <f_i, h_i^{k + 1}>", point)
    if not join.faces:
        reason = f"in <f, h^{k + 1}> exactly; alpha is not examined, since no face of the region lies in the clip plane"
        return Verdict(Status.UNDECIDED, claim, reason)
    inside = _curve_in_face(join)
    if inside.status is not Status.PROVED:
        return _from_signs(surface, claim, "the curve is not closed inside its clip face", inside)
    if join.inside_point() is None:
        return Verdict(Status.UNDECIDED, claim, "no point inside the contact was found on its clip face")
    regular = _curve_regular(join)
    if regular.status is not Status.PROVED:
        return _from_signs(surface, claim, "the clip is tangent to the surface on the curve", regular)
    positive = _alpha_positive(surface, join, on_curve=True)
    if positive.status is not Status.PROVED:
        return _from_signs(surface, claim, "alpha is not positive on the curve", positive)
    reason = f"in <f, h^{k + 1}> exactly, alpha > 0 on the curve"
    return Verdict(Status.PROVED, claim, reason, measure=positive.simplices + regular.simplices)


def face_verdict(surface: PiecewiseSurface, number: int) -> Verdict:
    """Exact C^k across one interior face."""
    face, k = surface.local.interior_faces[number], surface.order
    claim = f"face {face.first + 1}|{face.second + 1} C^{k}"
    difference = surface.patches[face.second].raw - surface.patches[face.first].raw
    plane, power = face.plane.raw, 0
    while power <= k and not difference.is_zero():
        quotient, remainder = divmod(difference, plane)
        if not remainder.is_zero():
            jump = on_simplex(difference, surface.local.corners(face.vertices))
            point = _nonzero_point(jump, surface.local.corners(face.vertices))
            reached = "not continuous" if power == 0 else f"C^{power - 1} only"
            reason = f"{reached}: pi^{power + 1} does not divide the difference"
            return Verdict(Status.REFUTED, claim, reason, _global_point(surface, np.array(point)))
        difference, power = quotient, power + 1
    return Verdict(Status.PROVED, claim, f"pi^{k + 1} divides the difference exactly")


def sheet_verdict(surface: PiecewiseSurface) -> Verdict:
    """Every ray from the centre meets the surface at most once, transversally."""
    claim = "one sheet"
    if surface.partition.center is None or not surface.partition.cells:
        return Verdict(Status.UNDECIDED, claim, "the partition has no centre to look from")
    if any(patch.at((0, 0, 0)) >= 0 for patch in surface.patches):
        return Verdict(
            Status.REFUTED, claim, "the centre is not inside the surface", _global_point(surface, np.zeros(3))
        )
    result = sheet_signs(surface)
    if result.status is Status.PROVED:
        reason = f"grad f . u > 0 wherever f = 0, u from the centre; {result.simplices} tetrahedra"
        return Verdict(Status.PROVED, claim, reason, measure=result.simplices)
    return _from_signs(surface, claim, "a ray from the centre meets the surface more than once or tangentially", result)


def enclosed_verdict(surface: PiecewiseSurface) -> Verdict:
    """The surface leaves the region through its contact curves only."""
    claim = "enclosed"
    if not surface.partition.cells:
        return Verdict(Status.UNDECIDED, claim, "there is no region")
    walls = wall_signs(surface)
    if walls.status is not Status.PROVED:
        return _from_signs(surface, claim, "the surface reaches an outer wall", walls)
    examined = walls.simplices
    for number, join in enumerate(surface.joins, start=1):
        if not join.faces:
            return Verdict(Status.UNDECIDED, claim, f"no face of the region lies in the clip plane of contact {number}")
        if any(_contact_order(surface.patches[piece], join, 0) < 0 for piece in join.pieces):
            return Verdict(Status.UNDECIDED, claim, f"contact {number} is not met on its clip face")
        result = _alpha_positive(surface, join, on_curve=False)
        if result.status is not Status.PROVED:
            return _from_signs(surface, claim, f"the surface meets clip face {number} off the contact curve", result)
        examined += result.simplices
    reason = f"f > 0 on the walls, alpha > 0 on the clip faces; {examined} triangles"
    return Verdict(Status.PROVED, claim, reason, measure=examined)


def violations(surface: PiecewiseSurface, *, deep: bool = False) -> Violations:
    """Where the inequalities of the proofs fail or stay open: points for new constraints.

    A shallow search leaves open what is merely close; a `deep` one goes as far as the proofs do.
    """
    cells, faces = (DEEP, DEEP) if deep else (SEARCH_CELLS, SEARCH_FACES)
    sheet = sheet_signs(surface, cells)
    walls = wall_signs(surface, faces)
    wall_pieces = [face.piece for face in surface.walls]
    piece_of = surface.partition.piece_of
    contacts: list[tuple[int, Floats]] = []
    for number, join in enumerate(surface.joins):
        result = _alpha_positive(surface, join, on_curve=False, limits=faces)
        contacts += [(number, points) for _, points in _by_source(result)]
    return Violations(
        [(int(piece_of[cell]), points) for cell, points in _by_source(sheet)],
        [(wall_pieces[face], points) for face, points in _by_source(walls)],
        contacts,
    )


def sheet_signs(surface: PiecewiseSurface, limits: Limits | None = None) -> SignResult:
    """Branch and bound for `f = 0 => grad f . u > 0` over all cells."""
    local = surface.local
    degree = surface.degree
    zero, value = [], []
    for cell, piece in zip(local.cells, local.piece_of, strict=True):
        corners, patch = local.corners(cell), surface.patches[piece]
        zero.append(rounded(b_form(on_simplex(patch.raw, corners), degree, 3)))
        value.append(rounded(b_form(on_simplex(_radial_derivative(patch), corners), degree, 3)))
    corners = local.points[np.array(local.cells)]
    return prove_positive(np.array(value), corners, np.array(zero), limits)


def wall_signs(surface: PiecewiseSurface, limits: Limits | None = None) -> SignResult:
    """Branch and bound for `f > 0` on the outer faces in no clip plane."""
    local, degree = surface.local, surface.degree
    forms = [
        rounded(b_form(on_simplex(surface.patches[face.piece].raw, local.corners(face.vertices)), degree, 2))
        for face in surface.walls
    ]
    corners = np.array([local.points[list(face.vertices)] for face in surface.walls])
    return prove_positive(np.array(forms), corners, limits=limits)


def alpha_on_face(patch: Polynomial, contact: Polynomial, corners: Sequence[Vector]) -> fmpq_mpoly | None:
    """`alpha` on a clip face, where `patch = alpha * contact`, in barycentric coordinates.

    None where the contact does not divide the patch on the face.
    """
    quotient, remainder = divmod(on_simplex(patch.raw, corners), on_simplex(contact.raw, corners))
    return quotient if remainder.is_zero() else None


def _alpha_positive(
    surface: PiecewiseSurface, join: Join, *, on_curve: bool, limits: Limits | None = None
) -> SignResult:
    values, zeros, corners = [], [], []
    contact = join.contact.surface
    for face in join.faces:
        exact = join.partition.corners(face.vertices)
        alpha = alpha_on_face(surface.patches[face.piece], contact, exact)
        if alpha is None:
            raise ValueError("alpha is defined where the contact is met only")
        values.append(rounded(b_form(alpha, surface.degree, 2)))
        zeros.append(rounded(b_form(on_simplex(contact.raw, exact), contact.degree, 2)))
        corners.append(join.partition.points[list(face.vertices)])
    where_zero = np.array(zeros) if on_curve else None
    return prove_positive(np.array(values), np.array(corners), where_zero, limits)


def check_join(number: int, join: Join) -> None:
    """That contact `number` can be met at all: its curve is closed, regular and in its face.

    Raises `GeometryError` with the place where it fails.
    """
    inside = _curve_in_face(join)
    if inside.status is not Status.PROVED:
        turned = all(join.contact.surface.raw(*a) < 0 for a, _ in join.rim())
        hint = " (a surface must be negative inside; is its sign turned round?)" if turned else ""
        raise GeometryError(
            f"contact {number}: its curve is not closed inside its face of the partition; the surface "
            f"{join.contact.surface} must be positive on the face's edges, and is not at {_place(inside)}{hint}"
        )
    if join.inside_point() is None:
        raise GeometryError(
            f"contact {number}: the surface {join.contact.surface} is nowhere negative on its clip face, so "
            "there is no curve to meet (a surface must be negative inside; is its sign turned round?)"
        )
    regular = _curve_regular(join)
    if regular.status is not Status.PROVED:
        raise GeometryError(
            f"contact {number}: its clip does not cut its surface transversally at {_place(regular)}; "
            "the two must cross at an angle along the whole curve"
        )


def _place(result: SignResult) -> str:
    points = result.counterexamples if len(result.counterexamples) else result.undecided
    return "({:.6g}, {:.6g}, {:.6g})".format(*points[0])


def _curve_in_face(join: Join) -> SignResult:
    """`f_i > 0` on the rim of the clip faces: the curve is closed inside them."""
    surface = join.contact.surface
    rim = join.rim()
    forms = [rounded(b_form(on_simplex(surface.raw, edge), surface.degree, 1)) for edge in rim]
    corners = np.array([[to_floats(p) for p in edge] for edge in rim])
    return prove_positive(np.array(forms), corners)


def _curve_regular(join: Join) -> SignResult:
    """`|grad f_i x grad h_i|^2 > 0` where `f_i = 0` on the clip faces."""
    f, h = join.contact.surface, join.contact.clip
    df, dh = ([p.diff(i).raw for i in range(3)] for p in (f, h))
    cross = [df[(i + 1) % 3] * dh[(i + 2) % 3] - df[(i + 2) % 3] * dh[(i + 1) % 3] for i in range(3)]
    square = sum((c * c for c in cross), GENERATORS[0] * 0)
    degree = max(int(square.total_degree()), 0)
    values, zeros = [], []
    for face in join.faces:
        exact = join.partition.corners(face.vertices)
        values.append(rounded(b_form(on_simplex(square, exact), degree, 2)))
        zeros.append(rounded(b_form(on_simplex(f.raw, exact), f.degree, 2)))
    corners = np.array([join.partition.points[list(face.vertices)] for face in join.faces])
    return prove_positive(np.array(values), corners, np.array(zeros))


def _contact_order(patch: Polynomial, join: Join, highest: int) -> int:
    """The largest j <= `highest` with the patch in `<f_i, h_i^(j+1)>`; -1 for none."""
    f, h = join.contact.surface.raw, join.contact.clip.raw
    for j in range(highest, -1, -1):
        if NormalForm([f, h ** (j + 1)]).reduce(patch.raw).is_zero():
            return j
    return -1


def _radial_derivative(patch: Polynomial) -> fmpq_mpoly:
    return sum((g * patch.raw.derivative(i) for i, g in enumerate(GENERATORS)), GENERATORS[0] * 0)


def _nonzero_point(restricted: fmpq_mpoly, corners: Sequence[Vector]) -> tuple[float, ...]:
    """The lattice point of a face at which a polynomial on it is largest in absolute value."""
    n = max(int(restricted.total_degree()), 1)
    best = max(
        ((i, j) for i in range(n + 1) for j in range(n + 1 - i)),
        key=lambda ij: abs(Polynomial.from_raw(restricted).at((f"{ij[0]}/{n}", f"{ij[1]}/{n}", 0))),
    )
    a, b, c = (np.array(to_floats(p)) for p in corners)
    u, v = best[0] / n, best[1] / n
    return tuple(((1 - u - v) * a + u * b + v * c).tolist())


def _from_signs(surface: PiecewiseSurface, claim: str, reason: str, result: SignResult) -> Verdict:
    if result.status is Status.REFUTED:
        point = _global_point(surface, result.counterexamples[0])
        return Verdict(Status.REFUTED, claim, reason, point, result.simplices)
    left = len(result.undecided)
    if left == 0:
        return Verdict(Status.UNDECIDED, claim, reason, measure=result.simplices)
    point = _global_point(surface, result.undecided[0])
    text = f"{left} simplices undecided, one around ({point[0]:.4g}, {point[1]:.4g}, {point[2]:.4g})"
    return Verdict(Status.UNDECIDED, claim, text, measure=result.simplices)


def _by_source(result: SignResult) -> list[tuple[int, Floats]]:
    points = np.concatenate([result.counterexamples, result.undecided])
    return [(int(s), points[result.sources == s]) for s in np.unique(result.sources)]


def _global_point(surface: PiecewiseSurface, local: Floats) -> Point:
    x, y, z = surface.partition.frame.global_points(local).tolist()
    return x, y, z
