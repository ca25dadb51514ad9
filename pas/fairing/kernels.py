"""Where members pass levels along rays in compiled code, where there is some; `pas.fairing.rays` does it with numpy."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.kernels import compiling
from pas.algebra.monomials import Floats
from pas.kernels.library import Functions

ROOM = 8
"""Crossings of a ray on average, for which there is room."""

Crossed = tuple[NDArray[np.intp], Floats, Floats]
"""Ray numbers (N,), shares of the rays (N,), and slopes in the share (N,)."""


class CompiledCrossings:
    """The function of the compiled library."""

    def __init__(self, functions: Functions) -> None:
        self._call = functions.call

    def __call__(self, profiles: Floats, shares: Floats, band: float) -> Crossed | None:
        """See `pas.fairing.rays.crossed`; None where there are more crossings than are usual."""
        room = ROOM * (profiles.shape[1] + 1)
        rays, number = np.empty(room, dtype=np.intp), np.zeros(1, dtype=np.intp)
        places, slopes = np.empty(room), np.empty(room)
        sizes = (len(profiles) - 1, profiles.shape[1])
        try:
            self._call(
                "pas_levels", *sizes, profiles, len(shares), shares, float(band), room, rays, places, slopes, number
            )
        except MemoryError:
            return None
        found = int(number[0])
        return rays[:found], places[:found], slopes[:found]


def compiled() -> CompiledCrossings | None:
    """The compiled functions, None where the environment asks for numpy."""
    return _best() if compiling() else None


@cache
def _best() -> CompiledCrossings:
    return CompiledCrossings(Functions())
