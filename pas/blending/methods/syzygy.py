""" "syzygy": `g = gamma_i f_i + beta_i h_i^(k+1)` for all contacts, solved for the multipliers.

Xu, Chen and Deng; see `pas.blending.multipliers`.
"""

from __future__ import annotations

from pas.blending.method import Patches, SolvingMethod, patches_of
from pas.blending.multipliers import consistency
from pas.surface.placed import PlacedContacts


def _solve(placed: PlacedContacts, degree: int) -> Patches:
    members = [solution.patches for solution in consistency(placed).solve(degree)]
    if len(placed.partition.pieces) == 1:
        members = [(patch.primitive(),) for (patch,) in members]
    return patches_of(placed, degree, members)


SYZYGY = SolvingMethod("syzygy", _solve, several=True)
