"""What a way to solve is: from contacts in place and a degree to a basis of all members."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import fmpq_mat

from pas.algebra.monomials import count
from pas.algebra.polynomial import Polynomial
from pas.algebra.products import Products
from pas.surface.placed import PlacedContacts

Patches = tuple[fmpq_mat, ...] | Products
"""For each piece the patches of a basis in local coordinates, one member a row: (dimension, C(n+3, 3))."""


@dataclass(frozen=True)
class SolvingMethod:
    """One way to find all members of a degree; `several` says whether it serves several pieces.

    All ways find the same space, by different bases.
    """

    name: str
    solve: Callable[[PlacedContacts, int], Patches]
    several: bool


def patches_of(placed: PlacedContacts, degree: int, members: Sequence[Sequence[Polynomial]]) -> Patches:
    """The patches of members given by one polynomial for each piece, in the user's coordinates."""
    frame, found = placed.partition.frame, []
    for piece in range(len(placed.partition.pieces)):
        rows = [frame.localise(member[piece]).row(degree) for member in members]
        found.append(fmpq_mat(len(rows), count(degree), [v for row in rows for v in row]))
    return tuple(found)
