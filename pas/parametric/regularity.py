"""stub"""

from pas.bernstein.signs import Status
from pas.parametric.surface import ParametricSurface
from pas.surface.certificate import Verdict


def regularity(surface: ParametricSurface, effort: int = 20_000) -> Verdict:
    """stub"""
    return Verdict(Status.UNDECIDED, "regular", "stub")
