"""Contact along a clip face, decided by powers of the face's plane.

With t the plane, a patch is `sum g_i t^i` and a surface `sum f_i t^i`, with polynomials on the plane
as coefficients.  The patch meets the surface with GC^k along V(f, t), that is, it is a member of
`<f, t^(k+1)>`, iff the power series `alpha = sum alpha_i t^i` with `g = alpha f` has polynomials as
coefficients up to t^k: a division for each order, `alpha_i f_0 = g_i - sum_(j<i) alpha_j f_(i-j)`.

Where the curve V(f_0) has several components only those in the face matter.  Let `f_0 = p q`, where
q has no zero on the face.  Then q is a unit at each point of the face, and membership there (in the
localised ideal) means that p alone divides: `alpha_i = n_i / q^(i+1)` with polynomials n_i,

    n_i p = q^i g_i - sum_(j<i) n_j f_(i-j) q^(i-j-1).

Where an irreducible factor of p changes its sign on the face, a polynomial that it does not divide
vanishes at finitely many points of its real curve at most (Bochnak, Coste and Roy 1998, theorem
4.5.1), so that there the test is necessary as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Exponents
from pas.algebra.polynomial import GENERATORS, RING, Polynomial


@dataclass(frozen=True)
class Division:
    """How far the division goes: `order` is the largest j with GC^j, up to the one asked for.

    `alpha` is n_0, the value of alpha on the face times q (None where not even n_0 exists), and
    `obstacle` the polynomial that p does not divide, None where there is none.  Both are polynomials
    on the plane, constant in the variable that is a function of the other two there.
    """

    order: int
    alpha: fmpq_mpoly | None
    obstacle: fmpq_mpoly | None


def powers(polynomial: fmpq_mpoly, plane: Polynomial, count: int) -> list[fmpq_mpoly]:
    """The coefficients of t^0 .. t^(count - 1) of a polynomial, t being the plane.

    One variable with a coefficient in the plane is replaced by t and the other two.
    """
    terms = plane.raw.to_dict()
    slope = [terms.get((i == 0, i == 1, i == 2), fmpq(0)) for i in range(3)]
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


def divide(g: Sequence[fmpq_mpoly], f: Sequence[fmpq_mpoly], p: fmpq_mpoly, q: fmpq_mpoly) -> Division:
    """Divide the series g by f, of as many coefficients, where `f[0] = p q` and q is a unit."""
    numerators: list[fmpq_mpoly] = []
    for i, coefficient in enumerate(g):
        known = (n * f[i - j] * q ** (i - j - 1) for j, n in enumerate(numerators))
        target = q**i * coefficient - sum(known, RING.constant(0))
        quotient, remainder = divmod(target, p)
        if not remainder.is_zero():
            return Division(i - 1, numerators[0] if numerators else None, target)
        numerators.append(quotient)
    return Division(len(g) - 1, numerators[0], None)
