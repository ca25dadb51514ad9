"""Membrane energy `1/2 * integral of |grad f|^2`: that of a membrane that is stretched with f."""

from __future__ import annotations

from typing import ClassVar

from pas.fairing.basis import Derivative
from pas.fairing.energies.squares import SquaredDerivatives


class Membrane(SquaredDerivatives):
    """Membrane energy, `1/2 * integral of |grad f|^2` over `domain`; the arguments are those of `pas.ThinPlate`."""

    kind: ClassVar[str] = "membrane"
    derivatives: ClassVar[tuple[tuple[Derivative, int], ...]] = (((0,), 1), ((1,), 1), ((2,), 1))
