"""The order of contact of a surface's patches with a contact on its clip faces, by powers of the face's plane.

With t the plane, a patch `sum g_i t^i` meets a surface `sum f_i t^i` with GC^k along V(f, t) iff `g = alpha f` has a
solution with polynomials on the plane as coefficients up to t^k (theorem 3 of docs/theory/verdicts.md).  Where the
curve V(f_0) has several components only those in the face matter: of `f_0 = p q` only p need divide, where q has no
zero on the face, and `alpha_i = n_i / q^(i+1)` with polynomials n_i,

    n_i p = q^i g_i - sum_(j<i) n_j f_(i-j) q^(i-j-1).

Where an irreducible factor of p changes its sign on the face, a polynomial that it does not divide
vanishes at finitely many points of its real curve at most (Bochnak, Coste and Roy 1998, theorem
4.5.1), so that there the test is necessary as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mpoly

from pas.algebra.affine import slope_at
from pas.algebra.monomials import Exponents
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.arrays import Floats
from pas.bernstein.signs import SignResult, alike, positive_on
from pas.contacts.joins import ClipPlane, Join
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status


@dataclass(frozen=True)
class Incidence:
    """How a patch meets a contact on its clip faces in one plane.

    `order` is the largest j with GC^j, up to the one asked for.  `alpha` is n_0, the value of alpha on the face times q
    (None where not even n_0 exists), and `obstacle` the polynomial that p does not divide, None where there is none.
    Both are polynomials on the plane, constant in the variable that is a function of the other two there.

    `factors` are those irreducible factors of the contact's surface on the plane, of multiplicity 1,
    that are not proved to have no zero on the faces; found only where the division by all fails.
    """

    faces: tuple[OuterFace, ...]
    order: int
    alpha: fmpq_mpoly | None
    obstacle: fmpq_mpoly | None
    factors: tuple[fmpq_mpoly, ...] = ()


def powers(polynomial: fmpq_mpoly, plane: Polynomial, count: int) -> list[fmpq_mpoly]:
    """The coefficients of t^0 .. t^(count - 1) of a polynomial, t being the plane.

    One variable with a coefficient in the plane is replaced by t and the other two.
    """
    slope = slope_at(plane)
    chosen = max(i for i in range(3) if slope[i] != 0)
    t = GENERATORS[chosen]
    images = list(GENERATORS)
    images[chosen] = (t - (plane.raw - slope[chosen] * t)) * (1 / slope[chosen])
    parts: list[dict[Exponents, fmpq]] = [{} for _ in range(count)]
    for exponents, coefficient in polynomial.compose(*images, ctx=RING).to_dict().items():
        power = int(exponents[chosen])
        if power < count:
            parts[power][tuple(0 if i == chosen else int(e) for i, e in enumerate(exponents))] = coefficient
    return [RING.from_dict(part) for part in parts]


def divide(
    g: Sequence[fmpq_mpoly], f: Sequence[fmpq_mpoly], p: fmpq_mpoly, q: fmpq_mpoly
) -> tuple[int, fmpq_mpoly | None, fmpq_mpoly | None]:
    """Divide the series g by f, of as many coefficients, where `f[0] = p q` and q is a unit: order, alpha, obstacle."""
    numerators: list[fmpq_mpoly] = []
    for i, coefficient in enumerate(g):
        known = (n * f[i - j] * q ** (i - j - 1) for j, n in enumerate(numerators))
        target = q**i * coefficient - sum(known, RING.constant(0))
        quotient, remainder = divmod(target, p)
        if not remainder.is_zero():
            return i - 1, numerators[0] if numerators else None, target
        numerators.append(quotient)
    return len(g) - 1, numerators[0], None


def incidences(surface: PiecewisePolynomial, join: Join, order: int) -> Iterator[Incidence]:
    """How each patch behind clip faces meets a contact, as far as GC^`order`."""
    for plane in join.planes:
        for piece in dict.fromkeys(face.piece for face in plane.faces):
            yield _incidence(surface.patches[piece], join, plane, piece, order)


def alpha_signs(surface: PiecewisePolynomial, join: Join, *, on_curve: bool) -> SignResult | None:
    """Branch and bound for alpha > 0 on the curve, where `patch = alpha f_i`, or all over the clip faces.

    There other contacts whose curves lie in the same faces have their surfaces divided out of alpha:
    what is left is positive where the patch is negative inside one of the curves alone.  None where a patch does not
    vanish on the contact's curve.
    """
    faces, values, beside = [], [], () if on_curve else surface.joins
    for met in incidences(surface, join, 0):
        if met.alpha is None:
            return None
        alpha = _without(met.alpha, [other for other in beside if other is not join], met.faces[0])
        faces += [join.partition.corners(face.vertices) for face in met.faces]
        values += [alpha] * len(met.faces)
    zeros = [alike(join.contact.surface.raw, faces)] if on_curve else []
    return positive_on(faces, (values, surface.degree), zeros)


def _without(alpha: fmpq_mpoly, others: Sequence[Join], face: OuterFace) -> fmpq_mpoly:
    """The quotient of alpha on a clip face by the factors that are other contacts' surfaces there."""
    for other in others:
        if any(plane.plane == face.plane for plane in other.planes):
            quotient, remainder = divmod(alpha, powers(other.contact.surface.raw, face.plane, 1)[0])
            alpha = quotient if remainder.is_zero() else alpha
    return alpha


def unmet(join: Join, met: Incidence) -> tuple[Floats | None, int]:
    """A point (3,) of the curve on the faces where the obstacle is not zero, if one is found, and how many simplices
    were examined for it."""
    assert met.obstacle is not None
    for factor in met.factors:
        # equal to the obstacle on the curve, and of its size there, however small that is
        remainder = divmod(met.obstacle, factor)[1]
        for sign in (1, -1) if not remainder.is_zero() else ():
            result = on_faces(remainder * sign, join, met.faces, factor)
            if result.status is Status.REFUTED:
                return result.witness, result.examined
    return None, 0


def on_faces(value: fmpq_mpoly, join: Join, faces: Sequence[OuterFace], zero: fmpq_mpoly | None = None) -> SignResult:
    """Branch and bound for `value > 0` on some outer faces, or only where `zero` vanishes."""
    exact = [join.partition.corners(face.vertices) for face in faces]
    return positive_on(exact, alike(value, exact), [] if zero is None else [alike(zero, exact)])


def _incidence(patch: Polynomial, join: Join, plane: ClipPlane, piece: int, order: int) -> Incidence:
    faces = tuple(face for face in plane.faces if face.piece == piece)
    f, g = (powers(p.raw, plane.plane, order + 1) for p in (join.contact.surface, patch))
    found = divide(g, f, f[0], RING.constant(1))
    if found[2] is None:
        return Incidence(faces, *found)
    unit, factors = RING.constant(1), []
    for factor, times in f[0].factor()[1]:
        signs = (s for s in (1, -1) if on_faces(factor * s, join, faces).status is Status.PROVED)
        sign = next(signs, 0)  # that which it is proved to have on all of the faces
        if sign:
            unit *= (factor * sign) ** times
        elif times == 1:
            factors.append(factor)
    return Incidence(faces, *divide(g, f, divmod(f[0], unit)[0], unit), tuple(factors))
