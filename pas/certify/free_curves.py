"""The proof that a surface meets a contact whose curve lies inside the region, in none of its faces.

Where a clip is curved, or has a factor that is no face of the region, the curve V(f, d) is a space
curve; d is the clip without the planes of its clip faces.  Proved of a single patch g:

- g is a member of `<f, d^(k+1)>`, exactly;
- f and d have no common zero on the region's boundary, so that the curve is closed inside, and it
  has a point there;
- `v = (grad g x grad d) . (grad f x grad d) > 0` on the curve.  Since `g = alpha f + beta d^(k+1)`,
  `v = alpha |grad f x grad d|^2` there: the curve is regular and alpha > 0.

All by Bernstein branch and bound over the cells with two equations.  Refuted only at points of the
curve that are proved to exist, with a sign that is proved around them (see `pas.certify.space_curve`).

The order is refuted with a derivation that is tangent to V(f), `D = ((grad f x grad d) x grad f) . grad`:
of a member of `<f, d^j>`, `g = alpha f + beta d^j`, it makes `D^j g = j! beta (D d)^j` on the curve,
and where that is not zero, g is no member of `<f, d^(j+1)>`.

Only the part `h <= 0` of the surface is used; which part of the region that is, is not examined.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.normal_form import NormalForm
from pas.algebra.polynomial import RING, Polynomial
from pas.certify.space_curve import Curve
from pas.contacts.joins import Join
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status

Finding = tuple[Status, str, Floats | None]
"""A status, the reason and a point (3,) in local coordinates."""


def free_verdict(surface: PiecewisePolynomial, join: Join) -> Finding:
    """Whether the surface meets a contact along the part of its curve that is in no clip face."""
    f, d, k = join.contact.surface, join.rest, surface.order
    if len(surface.patches) > 1 or d.degree < 1:
        what = f"{d} = 0" if d.degree > 0 else "the plane of a clip face"
        return Status.UNDECIDED, f"the clip cuts the surface inside the region as well, where {what}", None
    patch, curve = surface.patches[0], Curve(f, d, join.partition)
    achieved, obstacle = contact_order(patch, f, d, k)
    if obstacle is not None:
        return _unmet(curve, achieved, obstacle, k)
    exactly = f"in <f, h^{k + 1}> exactly"
    if not join.partition.cells:
        return Status.UNDECIDED, f"{exactly}; alpha is not examined, since there is no region", None
    if not curve.closed():
        return Status.UNDECIDED, f"{exactly}; but the curve may reach the boundary of the region", None
    if next(curve.enclosures(), None) is None:
        absent = join.elsewhere.status is Status.PROVED
        what = "the curve does not come into the region" if absent else "no point of it was found in the region"
        return Status.UNDECIDED, f"{exactly}; but {what}", None
    transverse = transversality(patch, f, d)
    wrong = next((e for e in curve.enclosures(-transverse) if e.sign(transverse.raw) < 0), None)
    if wrong is not None:
        return Status.REFUTED, "alpha is not positive on the curve", wrong.middle
    if not curve.positive(transverse):
        return Status.UNDECIDED, f"{exactly}; but alpha > 0 on a regular curve is not proved", None
    if join.faces:
        reason = f"{exactly}; but the curve is inside the region, too, where {d} = 0: one side of it only is in use"
        return Status.UNDECIDED, reason, None
    return Status.PROVED, f"{exactly}, alpha > 0 on the curve, which is closed inside the region", None


def _unmet(curve: Curve, achieved: int, obstacle: Polynomial, k: int) -> Finding:
    met = "does not meet the contact at all" if achieved < 0 else f"meets it with GC^{achieved} only"
    found = next((e for e in curve.enclosures(obstacle * obstacle) if e.sign(obstacle.raw)), None)
    if found is not None:
        return Status.REFUTED, f"the patch {met}: f is not in <f_i, h_i^{k + 1}>", found.middle
    reason = f"f is not in <f_i, h_i^{k + 1}>, and no point of the curve was found where it matters"
    return Status.UNDECIDED, reason, None


def contact_order(patch: Polynomial, f: Polynomial, d: Polynomial, highest: int) -> tuple[int, Polynomial | None]:
    """The largest j <= `highest` with the patch in `<f, d^(j+1)>` (-1 for none), and an obstacle.

    The obstacle is None for `highest`; elsewhere the patch has no higher order at points of the
    curve where the obstacle is not zero.
    """
    if NormalForm([f.raw, d.raw ** (highest + 1)]).reduce(patch.raw).is_zero():
        return highest, None
    for j in range(highest + 1):
        remainder = NormalForm([f.raw, d.raw ** (j + 1)]).reduce(patch.raw)
        if not remainder.is_zero():
            obstacle = Polynomial.from_raw(remainder)
            for _ in range(j):
                obstacle = _derived(obstacle, f, d)
            return j - 1, obstacle
    raise ArithmeticError("a power of an ideal is in its lower ones")  # pragma: no cover


def transversality(g: Polynomial, f: Polynomial, d: Polynomial) -> Polynomial:
    """`(grad g x grad d) . (grad f x grad d)`."""
    first, second = _cross(_gradient(g), _gradient(d)), _cross(_gradient(f), _gradient(d))
    return Polynomial.from_raw(_dot(first, second))


def _derived(g: Polynomial, f: Polynomial, d: Polynomial) -> Polynomial:
    """The derivative of g along `(grad f x grad d) x grad f`."""
    along = _cross(_cross(_gradient(f), _gradient(d)), _gradient(f))
    return Polynomial.from_raw(_dot(along, _gradient(g)))


def _gradient(polynomial: Polynomial) -> list[fmpq_mpoly]:
    return [polynomial.raw.derivative(i) for i in range(3)]


def _cross(a: Sequence[fmpq_mpoly], b: Sequence[fmpq_mpoly]) -> list[fmpq_mpoly]:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _dot(a: Sequence[fmpq_mpoly], b: Sequence[fmpq_mpoly]) -> fmpq_mpoly:
    return sum((x * y for x, y in zip(a, b, strict=True)), RING.constant(0))
