"""Ways to solve for all members of a degree, which `pas.blending.solving` lists.

"linear": normal forms and remainders of all monomials are zero, one rational matrix.  A single cell is solved in the
user's coordinates, where the numbers are short.  On many cells around a centre homogeneous splines serve, on others the
net of B-coefficients, both with sparse elimination.

"normal-form": `NF(g) = 0` and `NF(grad f_i x grad g) = 0` modulo `<f_i, h_i>`, for GC^0 and GC^1; above, membership in
`<f_i, h_i^(k+1)>` (see `pas.blending.normal_form_system`).

"intersection": the members of the intersection of the contact ideals, by its graded Groebner basis (Warren 1989; Lou,
Feng, Chen and Deng 2001).

"syzygy": `g = gamma_i f_i + beta_i h_i^(k+1)` for all contacts, solved for the multipliers (Xu, Chen and Deng; see
`pas.blending.multipliers`).
"""

from __future__ import annotations

from functools import lru_cache

from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import Polynomial
from pas.blending import spherical
from pas.blending.conditions import Conditions
from pas.blending.multipliers import consistency
from pas.blending.net import Net
from pas.blending.normal_form_system import normal_form_system
from pas.blending.solving import Patches, SolvingMethod, patches_of
from pas.contacts.contact import Contact, contact_ideal
from pas.partition.boxes import SingleCell
from pas.surface.placed import PlacedContacts

MANY_CELLS = 12
"""Cells above which sparse elimination serves: on C^1 quartics both take 10 to 20 ms with 6 cells, with 48 cells the
net 1.3 s and dense elimination 17 s.  Homogeneous splines take 0.1 s on a node of 48 cells."""


def _linear(placed: PlacedContacts, degree: int) -> Patches:
    if len(placed.partition.pieces) == 1:
        alone = PlacedContacts(SingleCell(), placed.contacts, placed.order)
        (found,) = Conditions(alone).solve(degree).matrices
        members = [Polynomial.from_row(row, degree).primitive() for row in found.tolist()]
        return patches_of(placed, degree, [(member,) for member in members])
    if len(placed.partition.cells) > MANY_CELLS:
        layout = placed.partition.layout
        return Net(placed, degree).solve() if layout is None else spherical.solve(placed, layout, degree)
    return Conditions(placed).solve(degree)


LINEAR = SolvingMethod("linear", _linear, several=True)


def _normal_form(placed: PlacedContacts, degree: int) -> Patches:
    found = normal_form_system(placed.contacts, placed.order, degree).solutions
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


NORMAL_FORM = SolvingMethod("normal-form", _normal_form, several=False)


@lru_cache(maxsize=32)
def intersection(contacts: tuple[Contact, ...], order: int) -> Ideal:
    """The ideal of all polynomials that meet every contact with GC^`order`."""
    first, *others = (contact_ideal(contact, order) for contact in contacts)
    for other in others:
        first = first & other
    return first


def _intersection(placed: PlacedContacts, degree: int) -> Patches:
    found = intersection(placed.contacts, placed.order).members(degree)
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


INTERSECTION = SolvingMethod("intersection", _intersection, several=False)


def _syzygy(placed: PlacedContacts, degree: int) -> Patches:
    members = [solution.patches for solution in consistency(placed).solve(degree)]
    if len(placed.partition.pieces) == 1:
        members = [(patch.primitive(),) for (patch,) in members]
    return patches_of(placed, degree, members)


SYZYGY = SolvingMethod("syzygy", _syzygy, several=True)
