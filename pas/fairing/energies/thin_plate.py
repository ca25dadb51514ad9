"""Thin-plate energy `1/2 * integral of |Hess f|_F^2`: that of a plate that bends with f."""

from __future__ import annotations

from typing import ClassVar

from pas.fairing.basis import Derivative
from pas.fairing.energies.squares import SquaredDerivatives


class ThinPlate(SquaredDerivatives):
    """Thin-plate energy, `1/2 * integral of |Hess f|_F^2` over `domain`.

    Without a domain, of every patch over its own piece.  With a `Box`, of the patch of piece number
    `piece` (from 0) over that box, as some of the literature has it.
    `weight` multiplies it: 0 leaves the choice to points and their least squares.
    """

    kind: ClassVar[str] = "thin-plate"
    derivatives: ClassVar[tuple[tuple[Derivative, int], ...]] = (
        ((0, 0), 1), ((1, 1), 1), ((2, 2), 1), ((0, 1), 2), ((0, 2), 2), ((1, 2), 2),
    )  # fmt: skip
