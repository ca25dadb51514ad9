"""Unions and intersections of several solids."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce

from pas.solid.solid import Solid


def union(solids: Sequence[Solid]) -> Solid:
    """The union of at least one solid; raises `ValueError` where there is none."""
    return _fold(solids, Solid.__or__)


def intersection(solids: Sequence[Solid]) -> Solid:
    """The intersection of at least one solid; raises `ValueError` where there is none."""
    return _fold(solids, Solid.__and__)


def _fold(solids: Sequence[Solid], operation: Callable[[Solid, Solid], Solid]) -> Solid:
    items = list(solids)
    if not items:
        raise ValueError("there must be at least one solid")
    return reduce(operation, items)
