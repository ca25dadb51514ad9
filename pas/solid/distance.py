"""Distances as functions of solids: values that change by at most 1 per unit of length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.solid.affine import Affine
from pas.solid.tree import Bools


class Distance(ABC):
    """A function whose values change by at most 1 per unit of length, such as a distance less a radius."""

    @abstractmethod
    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in boxes: the values are within half a diagonal."""
        value, reach = self.jets(centers)[:, 0], np.sqrt((halves * halves).sum(axis=1))
        return value + reach <= 0, value - reach > 0

    def moved(self, map_: Affine) -> Distance:
        """The distance after a similarity; raises `ValueError` for other maps."""
        return Moved(self, map_, map_.similarity())


@dataclass(frozen=True, eq=False)
class Moved(Distance):
    """A distance after a similarity that changes lengths by a factor."""

    inner: Distance
    map: Affine
    factor: float

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4)."""
        jets = self.inner.jets(self.map.inverse.points(points))
        jets[:, 0] *= self.factor
        jets[:, 1:] = self.factor * jets[:, 1:] @ self.map.inverse.floats[0]
        return jets
