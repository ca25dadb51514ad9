"""From contacts in place to the space of all surfaces of a degree that meet them, by registered methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq_mat

from pas.algebra.inputs import shown
from pas.algebra.monomials import count
from pas.algebra.polynomial import Polynomial
from pas.algebra.products import Products
from pas.blending.space import Space
from pas.partition.cells import Partition
from pas.registry import Registry
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


METHODS: Registry[SolvingMethod] = Registry(
    "method",
    {
        "linear": "pas.blending.methods:LINEAR",
        "normal-form": "pas.blending.methods:NORMAL_FORM",
        "intersection": "pas.blending.methods:INTERSECTION",
        "syzygy": "pas.blending.methods:SYZYGY",
    },
)
"""The methods of `pas.solutions` by name."""


def solve(placed: PlacedContacts, degree: int, method: str = "linear") -> Space:
    """The space of one degree."""
    return Space(placed, degree, METHODS[method].solve(placed, degree))


def register_method(method: SolvingMethod) -> SolvingMethod:
    """Make a way to solve known to `pas.solutions`, by its name; returns it.

    Raises `ValueError` for a name that is taken, `TypeError` for what is no method.
    """
    if not isinstance(method, SolvingMethod):
        raise TypeError(f"method must be a pas.SolvingMethod, not {shown(method)}")
    return METHODS.register(method)


def check_method(method: Any, partition: Partition) -> str:
    """A method's name, checked against what serves the partition."""
    single = len(partition.pieces) == 1
    served = [name for name, entry in METHODS.items() if single or entry.several]
    if method not in served:
        kind = "a single cell" if single else "several cells"
        raise ValueError(f"method must be one of {', '.join(served)} for {kind}, not {method!r}")
    return str(method)
