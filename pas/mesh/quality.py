"""What a mesh should have where it cannot have both: good angles, or few triangles."""

from __future__ import annotations

from enum import Enum

from pas.algebra.inputs import shown


class Quality(Enum):
    """`ANGLES`: no long triangles; `COUNT`: as few triangles as the tolerance allows, however long.

    `BALANCED`, which is usual, has long triangles along straight lines, with at least 1/40 of their length in height.
    """

    ANGLES = "angles"
    BALANCED = "balanced"
    COUNT = "count"

    @classmethod
    def of(cls, given: Quality | str) -> Quality:
        """The one that is meant, by itself or by name.  Raises `ValueError` for any other."""
        try:
            return cls(given)
        except ValueError:
            names = ", ".join(repr(q.value) for q in cls)
            raise ValueError(f"quality must be one of {names}, not {shown(given)}") from None

    @property
    def slenderest(self) -> float:
        """The least height over the longest side of triangles that are made long."""
        return SLENDER if self is Quality.COUNT else PRINTABLE


PRINTABLE, SLENDER = 0.025, 5e-4
"""Of triangles that printers' programs take; and of such that rounding to single precision, as STL has it, leaves."""
