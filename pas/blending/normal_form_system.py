"""Single surfaces that meet contacts, as one linear system on all their coefficients.

The normal form conditions (Yu, Sun and Ma 2006): with G the
graded reverse lexicographic basis of `<f, h>`, x > y > z, the polynomial g meets (f, h)

- with G0 where `NF(g, G) = 0`,
- with G1 where also `NF(d_j, G) = 0`, j = 1, 2, 3, for the minors d_j of (grad f, grad g), which
  are the components of `grad f x grad g`, the second with the other sign.

Both are linear in the coefficients of g.  For higher orders the source has no linear condition
(see `pas.curvature_contact` for its quartic one); there the system says that g lies in
`<f, h^(k+1)>`, which is GC^k.  For k = 0, and for k = 1 where f is regular along a curve whose
ideal `<f, h>` is radical, the two say the same.  Solutions may be singular along the curve, such
as a square.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Unpack

from flint import fmpq, fmpq_mpoly

from pas.algebra.brief import brief
from pas.algebra.inputs import check_degree, check_order
from pas.algebra.monomials import Exponents, count, exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import RING, Polynomial
from pas.contacts.contact import Contact, ContactLike, as_contact
from pas.limits import WorkLimits, checkpoint, limited

Form = Mapping[int, fmpq]
"""A linear form in the coefficients of g: {position in `exponents(degree)`: number}."""


@dataclass(frozen=True)
class NormalFormSystem:
    """The equations on the coefficients of one polynomial g of degree <= `degree`.

    `equations` holds each coefficient form that is not zero, as {unknown: number}; the unknowns
    are the positions in `pas.algebra.monomials.exponents(degree)`.
    """

    contacts: tuple[Contact, ...]
    order: int
    degree: int
    equations: tuple[Form, ...]

    __repr__ = brief

    @property
    def unknowns(self) -> int:
        """How many coefficients g has."""
        return count(self.degree)

    @property
    def raw(self) -> int:
        """How many coefficient forms are not zero."""
        return len(self.equations)

    @cached_property
    def distinct(self) -> int:
        """How many different ones there are, over all contacts and before any scaling."""
        return len({tuple(sorted((u, int(c.p), int(c.q)) for u, c in form.items())) for form in self.equations})

    @property
    def rank(self) -> int:
        """How many of the equations are independent."""
        return self.unknowns - self.dimension

    @property
    def dimension(self) -> int:
        """The dimension of the space of solutions."""
        return len(self.solutions)

    @cached_property
    def solutions(self) -> tuple[Polynomial, ...]:
        """The reduced basis of the solutions."""
        basis = nullspace(self.equations, self.unknowns).tolist()
        return tuple(Polynomial.from_row(row, self.degree) for row in basis)

    def __str__(self) -> str:
        return (
            f"{self.distinct} distinct equations ({self.raw} in all) of rank {self.rank} for the {self.unknowns} "
            f"coefficients of degree {self.degree}; {self.dimension} solutions"
        )


@limited("solving for all surfaces", "a lower degree")
def normal_form_system(
    contacts: Sequence[ContactLike], order: int, degree: int, **limits: Unpack[WorkLimits]
) -> NormalFormSystem:
    """The linear system of the normal form conditions of G^`order` on one g of degree <= `degree`.

    Source: Yu, Sun and Ma (2006).  `contacts` are pipes, contacts or pairs (surface, clip).  For orders above 1 the
    conditions are those of membership in `<f, h^(order+1)>` (see the module).

    Raises `ValueError` or `TypeError` for a wrong argument.
    """
    met = tuple(as_contact(contact, f"contacts[{i}]") for i, contact in enumerate(contacts))
    if not met:
        raise ValueError("contacts must hold at least one contact")
    check_order(order)
    check_degree(degree)
    equations = tuple(form for contact in met for form in _equations(contact, order, degree))
    return NormalFormSystem(met, order, degree, equations)


def _equations(contact: Contact, order: int, degree: int) -> Iterator[Form]:
    """The nonzero coefficient forms of one contact."""
    f = contact.surface.raw
    monomials = [RING.from_dict({e: fmpq(1)}) for e in exponents(degree)]
    normal = contact.ideal(0 if order < 2 else order)
    conditions = [monomials]
    if order == 1:
        gradient = [f.derivative(i) for i in range(3)]
        gradients = [[m.derivative(i) for i in range(3)] for m in monomials]
        # Minors without signs: the signs do not change the solutions, but which equations coincide.
        conditions += [
            [gradient[a] * m[b] - gradient[b] * m[a] for m in gradients] for a, b in ((1, 2), (0, 2), (0, 1))
        ]
    for images in conditions:
        yield from normal.equations(_terms(images), max(0, *(int(p.total_degree()) for p in images)))


def _terms(images: Sequence[fmpq_mpoly]) -> Iterator[tuple[int, Iterable[tuple[Exponents, fmpq]]]]:
    for unknown, polynomial in enumerate(images):
        checkpoint("writing the normal form equations", unknown / len(images))
        yield unknown, polynomial.to_dict().items()
