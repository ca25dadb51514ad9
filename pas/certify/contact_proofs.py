"""The proof that a surface meets a contact, where the contact's curve is in faces of the region.

The claim of a contact (f, h) with order k: along all of the curve V(f, h) in the region the surface
continues f with GC^k, `patch = alpha f` modulo h^(k+1) with alpha > 0, and wherever the curve lies
in an outer face, that is a clip face: h vanishes on it, and is negative on the region's side.

Rules, in the order in which they are tried, for `h = plane * cofactor` in each clip plane:

- the patch is a member of `<f, plane^(k+1)>` at every point of the curve in the face (see
  `pas.certify.expansion`); refuted only with a real point of the curve where it is not;
- f > 0 on the rim of the clip faces, and f < 0 somewhere inside: the curve is there and closed;
- the plane divides the clip once, and the cofactor is positive on the curve, so that h < 0 just
  inside the region;
- grad f x grad h does not vanish on the curve: it is regular, and cut out transversally;
- alpha > 0 on the curve;
- the curve does not come into the region elsewhere: there the surface would be in use on one side
  of it only, and the claim is refuted or left undecided (see `pas.certify.free_curves`).

A unit at the points of the curve changes no ideal there, so with these `<f, h^(k+1)>` and
`<f, plane^(k+1)>` say the same (Garrity and Warren 1991).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_floats
from pas.bernstein.forms import rounded_forms
from pas.bernstein.signs import SignResult, prove_positive
from pas.certify.free_curves import free_verdict, transversality
from pas.certify.meetings import alpha_signs, meetings, on_faces, unmet
from pas.certify.openings import opening_verdict
from pas.contacts.joins import Join
from pas.errors import GeometryError
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Point, Status, Verdict


@dataclass(frozen=True)
class Case:
    """One contact of a surface and what is claimed of it."""

    surface: PiecewisePolynomial
    join: Join
    claim: str

    def verdict(self, status: Status, reason: str, point: Point | None = None, measure: int = 0) -> Verdict:
        """A verdict on the claim."""
        return Verdict(status, self.claim, reason, point, measure)

    def failure(self, result: SignResult, reason: str) -> Verdict | None:
        """The verdict of a proof that did not succeed; `reason` says what is wrong where it is refuted."""
        return None if result.status is Status.PROVED else from_signs(self.surface, self.claim, reason, result)


def contact_verdict(surface: PiecewisePolynomial, number: int) -> Verdict:
    """Exact GC^k with one contact, alpha > 0 on its curve, the curve closed, regular and in its place."""
    case = Case(surface, surface.joins[number], f"contact {number + 1} GC^{surface.order}")
    if case.join.opening:
        return _opening(case)
    if not case.join.faces:
        return _free(case)
    for rule in (_met, _closed, _simple, _sided, _regular):
        verdict = rule(case)
        if verdict is not None:
            return verdict
    positive = alpha_signs(surface, case.join, on_curve=True)
    failed = case.failure(positive, "alpha is not positive on the curve")
    if failed is not None:
        return failed
    if not case.join.confined:
        return _free(case)
    reason = f"in <f, h^{surface.order + 1}> exactly all along the curve, alpha > 0 there"
    return case.verdict(Status.PROVED, reason, measure=positive.examined)


def _met(case: Case) -> Verdict | None:
    """The patch is a member of the contact's ideal at every point of the curve in the clip faces."""
    k = case.surface.order
    for meeting in meetings(case.surface, case.join, k):
        achieved = meeting.division.order
        if achieved == k:
            continue
        found = unmet(case.join, meeting)
        if found is None:
            reason = f"f is not in <f_i, h_i^{k + 1}>, and no point of the curve was found where it matters"
            return case.verdict(Status.UNDECIDED, reason)
        met = "does not meet the contact at all" if achieved < 0 else f"meets it with GC^{achieved} only"
        return case.failure(found, f"the patch {met}: f is not in <f_i, h_i^{k + 1}>")
    return None


def _closed(case: Case) -> Verdict | None:
    """The curve is closed inside the clip faces, around a point where the surface is negative."""
    failed = case.failure(curve_in_face(case.join), "the contact's surface is not positive on its clip face's edges")
    if failed is None and case.join.inside_point() is None:
        return case.verdict(Status.UNDECIDED, "no point inside the contact was found on its clip face")
    return failed


def _simple(case: Case) -> Verdict | None:
    """No clip plane is a multiple factor of the clip."""
    if all(plane.simple for plane in case.join.planes):
        return None
    return case.verdict(Status.UNDECIDED, "the clip's gradient vanishes on its face, which is a multiple factor of it")


def _sided(case: Case) -> Verdict | None:
    """The clip is negative on the region's side of its faces, all along the curve."""
    return case.failure(clip_sided(case.join), "the clip is positive on the region's side of its face")


def _regular(case: Case) -> Verdict | None:
    """The clip cuts the surface transversally along the curve."""
    return case.failure(curve_regular(case.join), "the clip is tangent to the surface on the curve")


def _free(case: Case) -> Verdict:
    """The verdict on the parts of the curve that are in no clip face."""
    status, reason, point = free_verdict(case.surface, case.join)
    return case.verdict(status, reason, None if point is None else global_point(case.surface, point))


def _opening(case: Case) -> Verdict:
    """The verdict on the contact through which the region is open."""
    status, reason, signs = opening_verdict(case.surface, case.join)
    if status is Status.PROVED or signs is None:
        return case.verdict(status, reason, measure=signs.examined if signs else 0)
    return from_signs(case.surface, case.claim, reason, signs)


def curve_in_face(join: Join) -> SignResult:
    """`f_i > 0` on the rim of the clip faces: the curve is closed inside them."""
    rim = join.rim()
    corners = np.array([[to_floats(p) for p in edge] for edge in rim])
    return prove_positive(rounded_forms(join.contact.surface.raw, rim), corners)


def curve_regular(join: Join) -> SignResult:
    """`|grad f_i x grad h_i|^2 > 0` where `f_i = 0` on the clip faces."""
    f, h = join.contact.surface, join.contact.clip
    return on_faces(transversality(f, f, h).raw, join, join.faces, f.raw)


def clip_sided(join: Join) -> SignResult:
    """`h_i < 0` on the region's side of the clip faces, where `f_i = 0`."""
    results = [on_faces(plane.cofactor.raw, join, plane.faces, join.contact.surface.raw) for plane in join.planes]
    return next((r for r in results if r.status is not Status.PROVED), results[0])


def check_join(number: int, join: Join) -> None:
    """That contact `number` can be met at all: its curve is closed, regular and in its faces.

    Raises `GeometryError` with the place where it fails.
    """
    contact = join.contact
    inside = curve_in_face(join)
    if inside.status is not Status.PROVED:
        turned = all(contact.surface.raw(*a) < 0 for a, _ in join.rim())
        hint = " (a surface must be negative inside; is its sign turned round?)" if turned else ""
        raise GeometryError(
            f"contact {number}: its curve is not closed inside its face of the partition; the surface "
            f"{contact.surface} must be positive on the face's edges, and is not at {_place(inside)}{hint}"
        )
    if join.inside_point() is None:
        raise GeometryError(
            f"contact {number}: the surface {contact.surface} is nowhere negative on its clip face, so "
            "there is no curve to meet (a surface must be negative inside; is its sign turned round?)"
        )
    if not all(plane.simple for plane in join.planes):
        raise GeometryError(
            f"contact {number}: the plane of its clip face is a multiple factor of its clip {contact.clip}; "
            "give it once"
        )
    sided = clip_sided(join)
    if sided.status is not Status.PROVED:
        raise GeometryError(
            f"contact {number}: its clip {contact.clip} is not negative on the region's side of its face "
            f"at {_place(sided)}; it must be so along the whole curve, and in each of its faces"
        )
    regular = curve_regular(join)
    if regular.status is not Status.PROVED:
        raise GeometryError(
            f"contact {number}: its clip does not cut its surface transversally at {_place(regular)}; "
            "the two must cross at an angle along the whole curve"
        )
    if len(join.partition.pieces) > 1 and not join.confined:
        raise GeometryError(
            f"contact {number}: its clip {contact.clip} cuts its surface inside the region, too, around "
            f"{_place(join.elsewhere)}; give the plane of its face alone as the clip"
        )


def from_signs(surface: PiecewisePolynomial, claim: str, reason: str, result: SignResult) -> Verdict:
    """The verdict that a proof came to; `reason` says what is wrong where it is refuted."""
    if result.witness is not None:
        point = global_point(surface, result.witness)
        return Verdict(Status.REFUTED, claim, reason, point, result.examined)
    left = len(result.undecided)
    point = global_point(surface, result.undecided[0])
    place = f"{left} simplices undecided, one around ({point[0]:.4g}, {point[1]:.4g}, {point[2]:.4g})"
    return Verdict(Status.UNDECIDED, claim, f"open whether {reason}: {place}", measure=result.examined)


def global_point(surface: PiecewisePolynomial, local: Floats) -> Point:
    """A local point (3,) in the user's coordinates."""
    x, y, z = surface.partition.frame.global_points(local).tolist()
    return x, y, z


def _place(result: SignResult) -> str:
    point = result.undecided[0] if result.witness is None else result.witness
    return "({:.6g}, {:.6g}, {:.6g})".format(*point)
