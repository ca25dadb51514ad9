"""From contacts in place to the space of all surfaces of a degree that meet them, by registered methods."""

from __future__ import annotations

from typing import Any

from pas.algebra.inputs import shown
from pas.blending.method import SolvingMethod
from pas.blending.space import Space
from pas.partition.cells import Partition
from pas.registry import Registry
from pas.surface.placed import PlacedContacts

METHODS: Registry[SolvingMethod] = Registry(
    "method",
    {
        "linear": "pas.blending.methods.linear:LINEAR",
        "normal-form": "pas.blending.methods.normal_form:NORMAL_FORM",
        "intersection": "pas.blending.methods.intersection:INTERSECTION",
        "syzygy": "pas.blending.methods.syzygy:SYZYGY",
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
