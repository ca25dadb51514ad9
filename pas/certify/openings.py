"""The proof that a surface meets a contact through which its region is open.

The edge of a plate lies in the plane that a blend touches all along it, so no plane face of a region can end the blend
there.  Seen from a centre below the plate it ends where rays do: the clip is a cone q of degree 2 with its apex in the
centre O, the region a convex cone cut off, and in use is the nappe q <= 0.  With `g = alpha f + beta q^(k+1)` in each
piece it is proved that

- it is the only contact through which the region is open: what is in use has one cone for its border;
- q > 0 on the sides of the region, all of them through O, and q < 0 somewhere in it: so one nappe is in the region;
- q < 0 on the curves of all other contacts, in their clip faces.  A nappe is convex, so it holds all that such a curve
  surrounds: the other contacts are in use, and no ray of the nappe's surface leaves through them;
- alpha > 0 where q = 0: there g has the sign of f.

With one sheet and f > 0 on the walls (see `pas.certify.proofs`) each ray of the nappe's surface meets f = 0 once, at an
angle, since the derivative of g along it is alpha times that of f: V(f, q) is one closed regular curve, and the surface
leaves the nappe through it alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations

from flint import fmpq, fmpq_mat, fmpq_mpoly

from pas.algebra.monomials import exponents
from pas.algebra.polynomial import RING, Polynomial
from pas.bernstein.signs import SignResult, alike, positive_on
from pas.certify.certificate import Proposition
from pas.certify.incidence import on_faces
from pas.contacts.joins import Join
from pas.partition.cells import Partition
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict


def cofactor(patch: Polynomial, join: Join, order: int) -> Polynomial | None:
    """alpha of `patch = alpha f + beta q^(order+1)`; None where the patch is no member of `<f, q^(order+1)>`."""
    return _cofactor(patch, join.contact.surface, join.contact.clip, order)


@lru_cache(maxsize=64)
def _cofactor(patch: Polynomial, f: Polynomial, q: Polynomial, order: int) -> Polynomial | None:
    power = q.raw ** (order + 1)
    degree = max(patch.degree - power.total_degree(), 0)
    monomials = [RING.from_dict({e: 1}) for e in exponents(degree)]
    rests = [divmod(m * power, f.raw)[1] for m in monomials]
    beta = _combination(divmod(patch.raw, f.raw)[1], rests)
    if beta is None:
        return None
    rest = patch.raw - power * sum((b * m for b, m in zip(beta, monomials, strict=True)), RING.constant(0))
    return Polynomial.from_raw(divmod(rest, f.raw)[0])


def _combination(wanted: fmpq_mpoly, given: Sequence[fmpq_mpoly]) -> list[fmpq] | None:
    """The numbers with which polynomials add up to one; None where they do not."""
    parts = [p.to_dict() for p in (*given, wanted)]
    terms = sorted({e for part in parts for e in part})
    table = fmpq_mat(len(terms), len(parts), [part.get(e, 0) for e in terms for part in parts])
    reduced, rank = table.rref()
    result = [fmpq(0)] * len(given)
    for row in range(rank):
        column = next(j for j in range(len(parts)) if reduced[row, j] != 0)
        if column == len(given):
            return None
        result[column] = reduced[row, len(given)]
    return result


def side_signs(join: Join) -> SignResult:
    """Branch and bound for q > 0 on the far edges of the region's sides, from which q > 0 on all of them follows."""
    local = join.partition
    edges = [local.corners(_far_edge(local, side.vertices)) for side in local.sides]
    return positive_on(edges, alike(join.contact.clip.raw, edges))


def _inside_cone(join: Join, other: Join) -> bool:
    """Whether q < 0 is proved on the curve of another contact in its clip faces."""
    result = on_faces(-join.contact.clip.raw, other, other.faces, other.contact.surface.raw)
    return bool(other.faces) and result.status is Status.PROVED


def _far_edge(local: Partition, side: tuple[int, ...]) -> tuple[int, ...]:
    return next(edge for edge in combinations(side, 2) if local.center not in local.corners(edge))


def cone_signs(surface: PiecewisePolynomial, join: Join) -> SignResult | None:
    """Branch and bound for alpha > 0 where q = 0 in the region; None where a patch is no member of its ideal."""
    local = surface.local
    alphas = [alpha for patch in surface.patches if (alpha := cofactor(patch, join, surface.order)) is not None]
    if len(alphas) < len(surface.patches):
        return None
    cells = [local.corners(cell) for cell in local.cells]
    values = [alphas[piece].raw for piece in local.piece_of.tolist()], max(0, *(alpha.degree for alpha in alphas))
    return positive_on(cells, values, [alike(join.contact.clip.raw, cells)])


def opening_verdict(claim: Proposition, join: Join) -> Verdict:
    """Whether the surface meets the contact through which its region is open."""
    surface = claim.surface
    k = surface.order
    if any(other.opening and other is not join for other in surface.joins):
        return claim.undecided("the region is open through another contact as well")
    for number, other in enumerate(surface.joins, start=1):
        if other is not join and not _inside_cone(join, other):
            return claim.undecided(f"the curve of contact {number} is not proved to be inside the clip")
    if side_signs(join).status is not Status.PROVED:
        return claim.undecided("the clip is not proved to be positive on the sides of the region")
    if not any(join.contact.clip.raw(*vertex) < 0 for vertex in join.partition.vertices):
        return claim.undecided("no point inside the clip was found in the region")
    signs = cone_signs(surface, join)
    if signs is None:
        return claim.undecided(f"f is not in <f_i, h_i^{k + 1}>")
    right = f"in <f, h^{k + 1}> exactly, alpha > 0 where h = 0"
    return claim.settled(signs, "alpha is not positive on the clip", right)
