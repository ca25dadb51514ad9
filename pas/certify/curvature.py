"""Whether two surfaces have equal curvatures along a curve, by normal forms; and a bound on curvature, proved.

The conditions of Yu, Sun and Ma (2006, theorem 3.3) for surfaces f = 0 and g = 0 along V(I), each
the vanishing of normal forms modulo I: (1) g; (2) the components of `grad f x grad g`; (3) `H^2 V* - H*^2 V` with `H =
|grad f|^2`, `V = grad f^T adj(Hess f) grad f`, starred for g.  Gauss curvature is V / H^2, so (3) says that the
curvatures are equal.  (The printed proof has H^2/V* = H*^2/V; what is meant is H^2/V = H*^2/V*.)

Guaranteed: where all remainders are zero, points, tangent planes and Gauss curvatures agree at every point of V(I)
where both surfaces are regular.  The converse needs an ideal I that is all that vanishes on the curve (real, not only
prime: the real zeros of <x^2 + y^2, z> are a point).  Not guaranteed is contact of second order, although the source
says so: docs/theory/exact.md has a counterexample.  That is membership, `g in <f, h^3>`, which is decided too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TypeVar

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.brief import brief
from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import cross, dot, plain, three, to_float
from pas.arrays import Floats, Integers
from pas.bernstein.forms import BoundedForms, nearby_forms, polar_forms
from pas.bernstein.search import Limits
from pas.bernstein.signs import prove_positive
from pas.certify.certificate import Proposition
from pas.contacts.contact import ContactLike, as_contact, contact_ideal
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Verdict

R = TypeVar("R")

Matrix = Sequence[Sequence[R]]


@dataclass(frozen=True)
class CurvatureContact:
    """How g meets f along a curve; each remainder is the witness of its condition, 0 where it holds.

    `value` is the normal form of g, `tangent` those of the components of `grad f x grad g`,
    `curvature` that of `H^2 V* - H*^2 V`, `gradient` those of grad g.  `membership` is the normal
    form of g modulo `<f, h^3>`, None where f is not the contact's surface or no clip is known.
    """

    value: Polynomial
    tangent: tuple[Polynomial, Polynomial, Polynomial]
    curvature: Polynomial
    gradient: tuple[Polynomial, Polynomial, Polynomial]
    membership: Polynomial | None

    __repr__ = brief

    @property
    def on_curve(self) -> bool:
        """Whether g vanishes on the curve."""
        return self.value.is_zero

    @property
    def tangent_planes(self) -> bool:
        """Whether the gradients are parallel along the curve."""
        return all(component.is_zero for component in self.tangent)

    @property
    def equal_curvature(self) -> bool:
        """Whether the Gauss curvatures agree along the curve."""
        return self.curvature.is_zero

    @property
    def holds(self) -> bool:
        """Whether all three conditions hold; that is less than GC^2 (see `gc2`)."""
        return self.on_curve and self.tangent_planes and self.equal_curvature

    @property
    def singular(self) -> bool:
        """Whether grad g vanishes along the whole curve, where the conditions say nothing of planes."""
        return all(component.is_zero for component in self.gradient)

    @property
    def gc2(self) -> bool | None:
        """Whether g is in `<f, h^3>` and not singular: true GC^2; None where that was not decided."""
        return None if self.membership is None else self.membership.is_zero and not self.singular

    def __bool__(self) -> bool:
        raise TypeError("a curvature contact has several conditions; ask for .holds or .gc2")

    def __str__(self) -> str:
        said = {True: "yes", False: "no", None: "not decided"}
        rows = [
            ("vanishes on the curve", said[self.on_curve]),
            ("equal tangent planes", said[self.tangent_planes]),
            ("equal Gauss curvature", said[self.equal_curvature]),
            ("singular along the curve", said[self.singular]),
            ("GC^2 (in <f, h^3>)", said[self.gc2]),
        ]
        return "\n".join(f"{name:<24}  {value}" for name, value in rows)


def curvature_contact(f: PolynomialLike, g: PolynomialLike, contact: ContactLike | Ideal) -> CurvatureContact:
    """The three conditions above for surfaces f and g (anything that `Polynomial` takes).

    `contact` gives the curve: a `Contact`, a `Pipe` or a pair (surface, clip), whose curve has
    the ideal `<surface, clip>`, or that `Ideal` itself.

    Of second order a contact is where g is in <f, h^3> (Garrity and Warren 1991), which is decided too.

    Raises `GeometryError` where f does not pass through the curve or is singular along all of
    it, `ValueError` or `TypeError` for a wrong argument.
    """
    first, second = Polynomial(f), Polynomial(g)
    met = None if isinstance(contact, Ideal) else as_contact(contact)
    curve = contact if isinstance(contact, Ideal) else contact_ideal(contact, 0)
    grad, starred = _gradient(first.raw, curve), _gradient(second.raw, curve)
    if not curve.reduce(first.raw).is_zero():
        raise GeometryError(f"the surface {first} does not contain the curve of the contact")
    if all(component.is_zero() for component in grad):
        raise GeometryError(f"the surface {first} is singular along the whole curve; it has no tangent planes there")
    speed, bend = _curvature(first.raw, grad, curve)
    other_speed, other_bend = _curvature(second.raw, starred, curve)
    difference = curve.reduce(speed * speed * other_bend - other_speed * other_speed * bend)
    cubed = None
    if met is not None and first.primitive() == met.surface.primitive():
        cubed = contact_ideal(met, 2).normal_form(second)
    return CurvatureContact(
        value=Polynomial.from_raw(curve.reduce(second.raw)),
        tangent=_owned([curve.reduce(c) for c in cross(grad, starred)]),
        curvature=Polynomial.from_raw(difference),
        gradient=_owned(starred),
        membership=cubed,
    )


def _gradient(raw: fmpq_mpoly, curve: Ideal) -> list[fmpq_mpoly]:
    return [curve.reduce(raw.derivative(i)) for i in range(3)]


def _curvature(raw: fmpq_mpoly, grad: Sequence[fmpq_mpoly], curve: Ideal) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """`|grad|^2` and `grad^T adj(Hess) grad` modulo the ideal of the curve."""
    rows = [[curve.reduce(raw.derivative(i).derivative(j)) for j in range(3)] for i in range(3)]
    return curve.reduce(dot(grad, grad)), curve.reduce(_form(grad, _adjugate(rows)))


def _adjugate(rows: Matrix[R]) -> Matrix[R]:
    """The adjugate of a symmetric matrix: its rows are the cross products of the matrix's rows."""
    return [cross(rows[(i + 1) % 3], rows[(i + 2) % 3]) for i in range(3)]


def _form(g: Sequence[R], matrix: Matrix[R]) -> R:
    return dot(g, [dot(row, g) for row in matrix])


def _owned(components: Sequence[fmpq_mpoly]) -> tuple[Polynomial, Polynomial, Polynomial]:
    return three(Polynomial.from_raw(c) for c in components)


def curvature_below(surface: PiecewisePolynomial, bound: fmpq) -> Verdict:
    """The verdict on `sqrt(k1^2 + k2^2) < bound` all over the surface, `bound` in 1 / unit of length.

    It holds where the polynomial of `_difference`, of degree 6 (n - 1), is positive wherever f = 0 (see
    docs/theory/verdicts.md, under the bound on curvature).  f is written as of that degree, so that multiples of it
    count: near the surface the polynomial changes by what one of these does, and slowly along it.  A pipe, one of whose
    curvatures is 0, has its own curvature for the root.
    """
    claim = Proposition(surface, f"sqrt(k1^2 + k2^2) below {plain(bound)}")
    local, degree = surface.local, 6 * max(surface.degree - 1, 0)
    pieces, square = local.piece_of.tolist(), to_float((bound * surface.partition.frame.scale) ** 2)

    def values(parts: Floats, numbers: Integers) -> tuple[Floats, float]:
        checkpoint("bounding curvature")
        patches = [surface.scaled.polynomials[pieces[number]] for number in numbers.tolist()]
        jet = _jet(patches, parts, surface.degree, float(np.abs(local.points).max()))
        return _difference(*jet, square).raised(degree).scaled()

    cells = [local.corners(cell) for cell in local.cells]
    found, off = nearby_forms([surface.patches[piece].raw for piece in pieces], cells, surface.degree)
    zero, error = BoundedForms(found, surface.degree, np.full(len(found), off)).raised(degree).scaled()
    corners = local.points[np.array(local.cells)]
    value, other = values(corners, np.arange(len(cells)))
    result = prove_positive(value, corners, zero, error=max(error, other), anew=values)
    reason = f"K^2 |g|^6 > M^2 - 2 |g|^2 g^T adj(H) g wherever f = 0; {result.examined} tetrahedra"
    return claim.settled(result, "it is larger somewhere", reason)


def _jet(
    patches: Sequence[Polynomial], corners: Floats, degree: int, reach: float
) -> tuple[list[BoundedForms], list[list[BoundedForms]]]:
    """The first and the second derivatives of polynomials, one on each tetrahedron (N, 4, 3), made by halving some
    whose corners are up to `reach` in size."""
    moved = Limits().depth  # each halving rounds the new corner

    def forms(order: int, *along: int) -> BoundedForms:
        known = {p: reduce(Polynomial.diff, along, p) for p in dict.fromkeys(patches)}
        lower = max(degree - order, 0)
        values, error = polar_forms([known[p] for p in patches], corners, lower, moved, reach)
        return BoundedForms(values, lower, error)

    second = {(i, j): forms(2, i, j) for i in range(3) for j in range(i, 3)}
    return [forms(1, i) for i in range(3)], [[second[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def _difference(g: Sequence[BoundedForms], h: Matrix[BoundedForms], square: float) -> BoundedForms:
    """`K^2 |g|^6 - M^2 + 2 |g|^2 g^T adj(H) g` of first and second derivatives."""
    length = dot(g, g)
    bent = length * (h[0][0] + h[1][1] + h[2][2]) - _form(g, h)
    return length * length * length * square - bent * bent + length * _form(g, _adjugate(h)) * 2
