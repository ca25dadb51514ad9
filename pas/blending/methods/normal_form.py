""" "normal-form": `NF(g) = 0` and `NF(grad f_i x grad g) = 0` modulo `<f_i, h_i>`, for GC^0 and GC^1.

Above, membership in `<f_i, h_i^(k+1)>`; see `pas.blending.normal_form_system`.
"""

from __future__ import annotations

from pas.blending.method import Patches, SolvingMethod, patches_of
from pas.blending.normal_form_system import normal_form_system
from pas.surface.placed import PlacedContacts


def _solve(placed: PlacedContacts, degree: int) -> Patches:
    found = normal_form_system(placed.contacts, placed.order, degree).solutions
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


NORMAL_FORM = SolvingMethod("normal-form", _solve, several=False)
