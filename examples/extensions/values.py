"""An energy of one's own: `1/2 * integral of f^2` over the region, which keeps the function small.

By itself it says little of the surface's shape; with a little of the thin plate's energy it does:
`pas.blend(pipes, order=2, energy=Values() + pas.ThinPlate(weight="1/10"))`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np

import pas


@pas.register_energy
@dataclass(frozen=True)
class Values(pas.Energy):
    """The integral, times `weight`; its fields are the keys of its table in files."""

    kind: ClassVar[str] = "values"

    weight: Any = 1

    def __post_init__(self) -> None:
        """What files and users write becomes exact."""
        object.__setattr__(self, "weight", Fraction(self.weight))
        if self.weight < 0:
            raise ValueError(f"weight must not be negative, and is {self.weight}")

    def hessian(self, basis: Any) -> Any:
        """`J^T J`, J the members at the points of a Gauss rule, times the roots of the rule's weights."""
        rules = basis.quadrature(2 * basis.degree)
        factor = np.concatenate([np.sqrt(w)[:, None] * basis.values(piece, points) for piece, points, w in rules])
        return factor.T @ factor * (float(self.weight) * basis.scale**3)
