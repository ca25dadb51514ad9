"""Newton's method between two ends: where functions of one number change their sign, many at once.

A step that would leave its bracket is a halving of it instead (Press, Teukolsky, Vetterling and Flannery 2007, section
9.4), and so is each step after the first ones, so that the end comes however a function bends.  Of several changes of
sign between the ends one is found.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pas.arrays import Floats, Integers
from pas.limits import checkpoint

STEPS, HALVINGS = 24, 50
"""Newton's steps at most: ten are enough but for functions that are very flat at their zeros; and halvings after them,
which leave a bracket about as long as its rounding."""

STILL = 1e-14
"""A step as short as this, over the larger end, is the last: the next would be beyond rounding."""

Jets = Callable[[Floats, Integers], tuple[Floats, Floats]]
"""The values and slopes (K,) at numbers (K,) of the functions that are numbered so (K,)."""


def sign_change(jets: Jets, low: Floats, high: Floats, start: Floats, still: float = STILL) -> Floats:
    """Where functions that are at most 0 at `low` and above 0 at `high` (N,) change their sign, (N,).

    From the numbers `start` (N,) between these, until a step is as short as `still` times the larger of them.
    """
    low, high, found = low.copy(), high.copy(), start.copy()
    shortest, rows = still * np.maximum(np.abs(low), np.abs(high)), np.arange(len(found))
    for number in range(STEPS + HALVINGS):
        checkpoint()
        here = found[rows]
        values, slopes = jets(here, rows)
        below = values <= 0
        low[rows], high[rows] = np.where(below, here, low[rows]), np.where(below, high[rows], here)
        new = here - values / np.where(slopes != 0, slopes, np.inf)
        halved = (slopes == 0) | (new < low[rows]) | (new > high[rows]) | (number >= STEPS)
        new = np.where(halved, (low[rows] + high[rows]) / 2, new)
        found[rows] = new
        rows = rows[np.abs(new - here) > shortest[rows]]
        if not len(rows):
            break
    return found


def jets_of_columns(profiles: Floats) -> Jets:
    """The values and slopes of polynomials by their coefficients (n + 1, N), those of the lowest power first."""

    def jets(at: Floats, rows: Integers) -> tuple[Floats, Floats]:
        values, slopes = np.zeros(len(at)), np.zeros(len(at))
        for row in profiles[::-1]:
            slopes = slopes * at + values
            values = values * at + row[rows]
        return values, slopes

    return jets


def zeros_of_columns(profiles: Floats) -> Floats:
    """Where polynomials that are negative at 0, coefficients (n + 1, N), change their sign before 1, (N,); 1 for those
    that do not."""
    size = profiles.shape[1]
    return sign_change(jets_of_columns(profiles), np.zeros(size), np.ones(size), np.full(size, 0.5))
