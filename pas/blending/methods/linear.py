""" "linear": normal forms and remainders of all monomials are zero, one rational matrix.

A single cell is solved in the user's coordinates, where the numbers are short.  On many cells around a
centre homogeneous splines serve, on others the net of B-coefficients, both with sparse elimination.
"""

from __future__ import annotations

from pas.algebra.polynomial import Polynomial
from pas.blending import spherical
from pas.blending.conditions import Conditions
from pas.blending.method import Patches, SolvingMethod, patches_of
from pas.blending.net import Net
from pas.partition.boxes import SingleCell
from pas.surface.placed import PlacedContacts

MANY_CELLS = 12
"""Cells above which sparse elimination serves: on C^1 quartics both take 10 to 20 ms with 6 cells, with 48 cells the
net 1.3 s and dense elimination 17 s.  Homogeneous splines take 0.1 s on a node of 48 cells."""


def _solve(placed: PlacedContacts, degree: int) -> Patches:
    if len(placed.partition.pieces) == 1:
        alone = PlacedContacts(SingleCell(), placed.contacts, placed.order)
        (found,) = Conditions(alone).solve(degree).matrices
        members = [Polynomial.from_row(row, degree).primitive() for row in found.tolist()]
        return patches_of(placed, degree, [(member,) for member in members])
    if len(placed.partition.cells) > MANY_CELLS:
        layout = placed.partition.layout
        return Net(placed, degree).solve() if layout is None else spherical.solve(placed, layout, degree)
    return Conditions(placed).solve(degree)


LINEAR = SolvingMethod("linear", _solve, several=True)
