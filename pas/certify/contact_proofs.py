"""The proof that a surface meets a contact, in faces of the region or through an opening.

The claim of a contact (f, h) with order k: along all of the curve V(f, h) in the region the surface continues f with
GC^k, `patch = alpha f` modulo h^(k+1) with alpha > 0, and h is negative on the region's side of the clip faces in which
it lies.  Theorem 3 of docs/theory/verdicts.md says what is proved for that, and its assumptions are tried in their
order; a curve that comes into the region elsewhere is that of `pas.certify.free_curves`.

Openings: the edge of a plate lies in the plane that a blend touches all along it, so no plane face of a region can end
the blend there.  Seen from a centre below the plate it ends where rays do: the clip is a cone q of degree 2 with its
apex in the centre, the region a convex cone cut off, and in use is the nappe q <= 0 (theorem 4).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations

from flint import fmpq_mat

from pas.algebra.inputs import shown_point
from pas.algebra.matrices import solved
from pas.algebra.monomials import exponents
from pas.algebra.polynomial import RING, Polynomial
from pas.bernstein.signs import SignResult, alike, positive_on
from pas.certify.certificate import Proposition
from pas.certify.free_curves import free_verdict, transversality
from pas.certify.incidence import alpha_signs, incidences, on_faces, unmet
from pas.contacts.contact import Contact
from pas.contacts.joins import Join
from pas.errors import GeometryError
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict


def contact_verdict(surface: PiecewisePolynomial, number: int) -> Verdict:
    """Exact GC^k with one contact, alpha > 0 on its curve, the curve closed, regular and in its place."""
    claim, join = Proposition(surface, f"contact {number + 1} GC^{surface.order}"), surface.joins[number]
    if join.opening:
        return _opening_verdict(claim, join)
    if not join.faces:
        return free_verdict(claim, join)
    for met in incidences(surface, join, surface.order):
        if met.order < surface.order:
            return claim.unmet(met.order, *unmet(join, met))
    for signs, reason, _ in _flaws(join):
        return claim.undecided(reason) if signs is None else claim.settled(signs, reason, "")
    positive = alpha_signs(surface, join, on_curve=True)
    assert positive is not None
    if (failed := claim.failed(positive, "alpha is not positive on the curve")) is not None:
        return failed
    if not join.confined:
        return free_verdict(claim, join)
    reason = f"in <f, h^{surface.order + 1}> exactly all along the curve, alpha > 0 there"
    return claim.proved(reason, positive.examined)


def clip_sided(join: Join) -> SignResult:
    """`h_i < 0` on the region's side of the clip faces, where `f_i = 0`."""
    results = [on_faces(plane.cofactor.raw, join, plane.faces, join.contact.surface.raw) for plane in join.planes]
    return next((r for r in results if r.status is not Status.PROVED), results[0])


def check_join(number: int, join: Join) -> None:
    """Check that contact `number` can be met at all: its curve is closed, regular and in its faces.

    Raises `GeometryError` with the place where it fails.
    """
    for _, _, flaw in _flaws(join):
        raise GeometryError(f"contact {number}: {flaw}")
    if len(join.partition.pieces) > 1 and not join.confined:
        raise GeometryError(
            f"contact {number}: its clip {join.contact.clip} cuts its surface inside the region, too, around "
            f"{_place(join.elsewhere)}; give the plane of its face alone as the clip"
        )


def _flaws(join: Join) -> Iterator[tuple[SignResult | None, str, str]]:
    """The flaws of a contact on its clip faces: the proof of signs that failed, if there is one, the words of verdicts,
    and the words for whoever gave the contact."""
    surface, clip = join.contact.surface, join.contact.clip
    inside = positive_on(join.rim(), alike(surface.raw, join.rim()))
    if inside.status is not Status.PROVED:
        turned = all(surface.raw(*a) < 0 for a, _ in join.rim())
        hint = " (a surface must be negative inside; is its sign turned round?)" if turned else ""
        yield (
            inside,
            "the contact's surface is not positive on its clip face's edges",
            f"its curve is not closed inside its face of the partition; the surface {surface} must be positive on the "
            f"face's edges, and is not at {_place(inside)}{hint}",
        )
    if join.inside_point() is None:
        yield (
            None,
            "no point inside the contact was found on its clip face",
            f"the surface {surface} is nowhere negative on its clip face, so there is no curve to meet (a surface must "
            "be negative inside; is its sign turned round?)",
        )
    if not all(plane.simple for plane in join.planes):
        yield (
            None,
            "the clip's gradient vanishes on its face, which is a multiple factor of it",
            f"the plane of its clip face is a multiple factor of its clip {clip}; give it once",
        )
    sided = clip_sided(join)
    if sided.status is not Status.PROVED:
        yield (
            sided,
            "the clip is positive on the region's side of its face",
            f"its clip {clip} is not negative on the region's side of its face at {_place(sided)}; it must be so along "
            "the whole curve, and in each of its faces",
        )
    regular = on_faces(transversality(surface, surface, clip).raw, join, join.faces, surface.raw)
    if regular.status is not Status.PROVED:
        yield (
            regular,
            "the clip is tangent to the surface on the curve",
            f"its clip does not cut its surface transversally at {_place(regular)}; the two must cross at an angle "
            "along the whole curve",
        )


def _place(result: SignResult) -> str:
    return shown_point(result.undecided[0] if result.witness is None else result.witness, 6)


@lru_cache(maxsize=64)
def cofactor(patch: Polynomial, contact: Contact, order: int) -> Polynomial | None:
    """alpha of `patch = alpha f + beta q^(order+1)`; None where the patch is no member of `<f, q^(order+1)>`."""
    f, power = contact.surface.raw, contact.clip.raw ** (order + 1)
    monomials = [RING.from_dict({e: 1}) for e in exponents(max(patch.degree - power.total_degree(), 0))]
    rests = [divmod(p, f)[1].to_dict() for p in (*(m * power for m in monomials), patch.raw)]
    terms = sorted({e for rest in rests for e in rest})
    found = solved(fmpq_mat(len(terms), len(rests), [rest.get(e, 0) for e in terms for rest in rests]))
    if found is None:
        return None
    beta = sum((b * m for b, m in zip(found[0], monomials, strict=True)), RING.constant(0))
    return Polynomial.from_raw(divmod(patch.raw - power * beta, f)[0])


def _inside_cone(join: Join, other: Join) -> bool:
    """Whether q < 0 is proved on the curve of another contact in its clip faces."""
    result = on_faces(-join.contact.clip.raw, other, other.faces, other.contact.surface.raw)
    return bool(other.faces) and result.status is Status.PROVED


def _opening_verdict(claim: Proposition, join: Join) -> Verdict:
    """Whether the surface meets the contact through which its region is open."""
    surface = claim.surface
    k = surface.order
    if any(other.opening and other is not join for other in surface.joins):
        return claim.undecided("the region is open through another contact as well")
    for number, other in enumerate(surface.joins, start=1):
        if other is not join and not _inside_cone(join, other):
            return claim.undecided(f"the curve of contact {number} is not proved to be inside the clip")
    sides = [join.partition.corners(side.vertices) for side in join.partition.sides]
    # from what holds on their far edges it follows on all of them
    edges = [next(e for e in combinations(side, 2) if join.partition.center not in e) for side in sides]
    if positive_on(edges, alike(join.contact.clip.raw, edges)).status is not Status.PROVED:
        return claim.undecided("the clip is not proved to be positive on the sides of the region")
    if not any(join.contact.clip.raw(*vertex) < 0 for vertex in join.partition.vertices):
        return claim.undecided("no point inside the clip was found in the region")
    found = [cofactor(patch, join.contact, k) for patch in surface.patches]
    alphas = [alpha for alpha in found if alpha is not None]
    if len(alphas) < len(found):
        return claim.undecided(f"f is not in <f_i, h_i^{k + 1}>")
    cells = [surface.local.corners(cell) for cell in surface.local.cells]
    values = [alphas[piece].raw for piece in surface.local.piece_of], max(0, *(alpha.degree for alpha in alphas))
    signs = positive_on(cells, values, [alike(join.contact.clip.raw, cells)])
    right = f"in <f, h^{k + 1}> exactly, alpha > 0 where h = 0"
    return claim.settled(signs, "alpha is not positive on the clip", right)
