"""The proofs of what a piecewise surface promises; docs/theory/verdicts.md says what each verdict means, and why.

Contacts: see `pas.certify.contact_proofs`.  Faces: exact division, remainder identically zero (theorem 2).

One sheet: with u from the centre, `grad f . u > 0` wherever `f = 0` in each cell (theorem 5).

Enclosed: `f > 0` on the walls, and on all of the clip faces `f = alpha f_i` with `alpha > 0`, alpha times all f_i of
the contacts that share a face (theorem 6).  The sides of an open region that no contact closes are walls, and f < 0 on
a part of them, as they hold the centre.

A contact whose clip passes through the region, as a curved one, leaves the surface in use on one side of the clip only.
One sheet is then still proved of all of the zero set in the region, and refuted only at a point that is in use; that
what is in use is enclosed is never proved.

All inequalities are proved by Bernstein branch and bound with rounding accounted for (see `pas.bernstein.signs`).  What
is not promised: anything outside the region.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, exact_vector, to_float, to_floats
from pas.arrays import Floats
from pas.bernstein.forms import corner_points, nearby_forms, on_simplex
from pas.bernstein.signs import SignResult, positive_on, prove_positive
from pas.certify.certificate import Certificate, Proposition
from pas.certify.contact_proofs import contact_verdict
from pas.certify.incidence import alpha_signs
from pas.registry import Registry
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict


@dataclass(frozen=True)
class Claim:
    """One more thing that is promised of surfaces: `prove` gives its verdicts, with claims in words of their own."""

    name: str
    prove: Callable[[PiecewisePolynomial], Sequence[Verdict]]


CLAIMS: Registry[Claim] = Registry("claim about surfaces", {})
"""Further claims about every surface, beside contacts, faces, sheets and walls; old files have no verdicts on it."""


def certify(surface: PiecewisePolynomial) -> Certificate:
    """Prove everything that is promised of the surface."""
    contacts = tuple(contact_verdict(surface, i) for i in range(len(surface.contacts)))
    return Certificate(
        contacts,
        tuple(face_verdict(surface, i) for i in range(len(surface.partition.interior_faces))),
        sheet_verdict(surface),
        enclosed_verdict(surface, contacts),
        tuple(verdict for claim in CLAIMS.values() for verdict in claim.prove(surface)),
    )


def face_verdict(surface: PiecewisePolynomial, number: int) -> Verdict:
    """Exact C^k across one interior face."""
    face, k = surface.local.interior_faces[number], surface.order
    claim = Proposition(surface, f"face {face.first + 1}|{face.second + 1} C^{k}")
    difference = surface.patches[face.second].raw - surface.patches[face.first].raw
    plane, power = face.plane.raw, 0
    while power <= k and not difference.is_zero():
        quotient, remainder = divmod(difference, plane)
        if not remainder.is_zero():
            reached = "not continuous" if power == 0 else f"C^{power - 1} only"
            reason = f"{reached}: pi^{power + 1} does not divide the difference"
            return claim.refuted(reason, _largest_at(difference, surface.local.corners(face.vertices)))
        difference, power = quotient, power + 1
    return claim.proved(f"pi^{k + 1} divides the difference exactly")


def sheet_verdict(surface: PiecewisePolynomial) -> Verdict:
    """Every ray from the centre meets the surface at most once, transversally."""
    claim = Proposition(surface, "one sheet")
    if surface.partition.center is None or not surface.partition.cells:
        return claim.undecided("the partition has no centre to look from")
    if any(patch.at((0, 0, 0)) >= 0 for patch in surface.patches):
        if _unused(surface, np.zeros(3)):
            return claim.undecided("the centre is beyond a contact's clip")
        return claim.refuted("the centre is not inside the surface", np.zeros(3))
    local, (zeros, off) = surface.local, surface.cell_forms
    cells, values = [local.corners(cell) for cell in local.cells], [*map(radial_derivative, surface.patches)]
    degree = max(surface.degree, *(int(value.total_degree()) for value in values))
    forms, error = nearby_forms([values[piece] for piece in local.piece_of], cells, degree)
    result = prove_positive(forms, corner_points(cells), zeros, error=max(error, off))
    wrong = "a ray from the centre meets the surface more than once or tangentially"
    said = f"grad f . u > 0 wherever f = 0, u from the centre; {result.examined} tetrahedra"
    return claim.settled(_where_used(surface, result), wrong, said)


def enclosed_verdict(surface: PiecewisePolynomial, contacts: Sequence[Verdict]) -> Verdict:
    """The surface leaves the region through its contact curves only, the verdicts on its contacts being known."""
    claim = Proposition(surface, "enclosed")
    if not surface.partition.cells:
        return claim.undecided("there is no region")
    faces = [surface.local.corners(face.vertices) for face in surface.walls]
    values = [surface.patches[face.piece].raw for face in surface.walls], surface.degree
    walls = _where_used(surface, positive_on(faces, values, near=True))
    reached = "the inside of the surface reaches an outer wall"
    if surface.partition.sides and not any(join.opening for join in surface.joins):
        reached = "no contact closes the region, which is open: the inside reaches its sides"
    failed = claim.failed(walls, reached)
    if failed is not None and failed.status is Status.REFUTED:
        return failed
    for number, join in enumerate(surface.joins, start=1):
        if not join.confined:
            where = "passes through the region" if join.faces else "has no face of the region"
            reason = f"the clip of contact {number} {where}, so that the surface is used in a part of it only"
            return claim.undecided(reason)
    if failed is not None:
        return failed
    examined = walls.examined
    for number, join in enumerate(surface.joins, start=1):
        if join.opening:
            if not (found := contacts[number - 1]).proved:
                return claim.undecided(f"contact {number}: {found.reason}")
            continue
        result = alpha_signs(surface, join, on_curve=False)
        if result is None:
            return claim.undecided(f"contact {number} is not met on its clip face")
        if (failed := claim.failed(result, f"alpha is not positive on the clip face of contact {number}")) is not None:
            return failed
        examined += result.examined
    return claim.proved(f"f > 0 on the walls, alpha > 0 on the clip faces; {examined} triangles", examined)


def _unused(surface: PiecewisePolynomial, point: Floats) -> bool:
    """Whether a local point (3,) is beyond a clip that passes through the region."""
    place = exact_vector(point.tolist())
    return any(join.contact.clip.raw(*place) > 0 for join in surface.joins if not join.confined)


def _where_used(surface: PiecewisePolynomial, result: SignResult) -> SignResult:
    """The result, no decision where the witness that refutes is not in use."""
    if result.witness is None or not _unused(surface, result.witness):
        return result
    points = np.concatenate([result.witness[None], result.undecided])
    return replace(result, status=Status.UNDECIDED, undecided=points, witness=None)


def radial_derivative(patch: Polynomial) -> fmpq_mpoly:
    """The product of the gradient and the place."""
    return sum((g * patch.raw.derivative(i) for i, g in enumerate(GENERATORS)), GENERATORS[0] * 0)


def _largest_at(polynomial: fmpq_mpoly, corners: Sequence[Vector]) -> Floats:
    """The lattice point (3,) of a face at which a polynomial is largest in absolute value."""
    on_face = on_simplex(polynomial, corners)
    n = max(int(on_face.total_degree()), 1)
    places = ((fmpq(i, n), fmpq(j, n)) for i in range(n + 1) for j in range(n + 1 - i))
    u, v = map(to_float, max(places, key=lambda place: abs(on_face(*place, fmpq(0)))))
    a, b, c = (np.array(to_floats(p)) for p in corners)
    return np.asarray((1 - u - v) * a + u * b + v * c)
