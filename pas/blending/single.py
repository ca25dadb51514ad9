"""All single polynomials of a degree that meet the contacts: four methods, one space.

- "linear": normal forms modulo `<f_i, h_i^(k+1)>` of all monomials, one rational matrix (as for
  partitions, see `pas.blending.conditions`).
- "normal-form": the conditions `NF(g) = 0` and `NF(grad f_i x grad g) = 0` modulo `<f_i, h_i>`,
  for GC^0 and GC^1; above, membership in `<f_i, h_i^(k+1)>` (see `pas.blending.normal_form_system`).
- "intersection": the members of the intersection of the contact ideals, by its graded Groebner
  basis (Warren 1989; Lou, Feng, Chen and Deng 2001).
- "syzygy": `g = gamma_i f_i + beta_i h_i^(k+1)` for all i, solved for the multipliers (Xu, Chen and
  Deng; see `pas.blending.multipliers`).

Everything here is in the user's coordinates; there is no region.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import Polynomial
from pas.blending.conditions import Conditions
from pas.blending.multipliers import consistency
from pas.blending.normal_form_system import normal_form_system
from pas.partition.single_cell import SingleCell
from pas.surface.contact import Contact, contact_ideal

Contacts = tuple[Contact, ...]


@lru_cache(maxsize=32)
def intersection(contacts: Contacts, order: int) -> Ideal:
    """The ideal of all polynomials that meet every contact with GC^`order`."""
    first, *others = (contact_ideal(contact, order) for contact in contacts)
    for other in others:
        first = first & other
    return first


def members(contacts: Sequence[Contact], order: int, degree: int, method: str) -> tuple[Polynomial, ...]:
    """A basis of all polynomials of degree <= `degree` that meet every contact with GC^`order`.

    Their coefficients are coprime integers.
    """
    return tuple(p.primitive() for p in METHODS[method](tuple(contacts), order, degree))


def _linear(contacts: Contacts, order: int, degree: int) -> tuple[Polynomial, ...]:
    carriers = ((0,),) * len(contacts)
    (patch,) = Conditions(SingleCell(), contacts, carriers, order).solve(degree)
    return tuple(Polynomial.from_row(row, degree) for row in patch.tolist())


def _intersection(contacts: Contacts, order: int, degree: int) -> tuple[Polynomial, ...]:
    return intersection(contacts, order).members(degree)


def _normal_form(contacts: Contacts, order: int, degree: int) -> tuple[Polynomial, ...]:
    return normal_form_system(contacts, order, degree).solutions


def _syzygy(contacts: Contacts, order: int, degree: int) -> tuple[Polynomial, ...]:
    return tuple(s.patches[0] for s in consistency(SingleCell(), contacts, order).solve(degree))


METHODS: dict[str, Callable[[Contacts, int, int], tuple[Polynomial, ...]]] = {
    "linear": _linear,
    "normal-form": _normal_form,
    "intersection": _intersection,
    "syzygy": _syzygy,
}
