"""Plane sections of a surface, along rays from the centre: their planes, directions and parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats

AROUND = 720
"""Directions of a plane section."""


def planes(means: Sequence[Floats]) -> Iterator[tuple[Floats, Floats]]:
    """Orthonormal pairs that span the planes of two neighbours' directions each."""
    for a, b in combinations(means, 2):
        first = a / np.linalg.norm(a)
        rest = b - (b @ first) * first
        if np.linalg.norm(rest) > 1e-6 * np.linalg.norm(b):
            yield first, rest / np.linalg.norm(rest)


def circle(first: Floats, second: Floats) -> Floats:
    """The unit vectors (AROUND, 3) along which a section in the plane of two orthonormal ones is looked at."""
    angles = (np.arange(AROUND) + 0.5) * 2 * np.pi / AROUND
    return np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * second


def runs(there: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Runs of True round a circle (n,), as index arrays."""
    if there.all():
        return [np.arange(len(there))]
    if not there.any():
        return []
    start = int(np.flatnonzero(~there)[0])
    order = (np.arange(len(there)) + start) % len(there)
    breaks = np.flatnonzero(np.diff(there[order].astype(int)))
    parts = np.split(order, breaks + 1)
    return [part for part in parts if there[part[0]]]
