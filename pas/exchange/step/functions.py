"""Functions by number, whose common zeros are where faces meet and where they are cut, in a solid's local coordinates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.mesh.projection import newton

Integers = NDArray[np.intp]
Plane = tuple[Floats, float]
"""The points with n.x = d, as (n, d) with |n| = 1."""

REACH = 0.05
"""How far a step may move a point of a mesh, in local coordinates, when it is put on its curve."""


class Functions:
    """Functions by number, in a solid's local coordinates, as `pas.mesh.projection` wants them."""

    def __init__(self) -> None:
        self._jets: list[Callable[[Floats], Floats]] = []
        self._numbers: dict[object, int] = {}

    def number(self, key: object, jets: Callable[[Floats], Floats]) -> int:
        """That of a function, by a key."""
        if key not in self._numbers:
            self._numbers[key] = len(self._jets)
            self._jets.append(jets)
        return self._numbers[key]

    def plane(self, plane: Plane) -> int:
        """That of a plane."""
        normal, height = plane

        def jets(points: Floats) -> Floats:
            values = points @ normal - height
            return np.concatenate([values[:, None], np.broadcast_to(normal, points.shape)], axis=1)

        return self.number((*normal.tolist(), height), jets)

    def jets(self, points: Floats, label: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of one function, or of each point's own (N,)."""
        labels = np.asarray(label, dtype=np.intp)
        if labels.ndim == 0 or (labels == labels[:1]).all():
            return self._jets[int(labels.ravel()[0])](points)
        result = np.empty((len(points), 4))
        for number in np.unique(labels):
            rows = labels == number
            result[rows] = self._jets[int(number)](points[rows])
        return result

    def placed(self, points: Floats, numbers: tuple[int, ...]) -> Floats:
        """Points (N, 3) moved onto the common zeros of functions."""
        if not len(points):
            return points
        each = np.tile(np.array(numbers, dtype=np.intp), (len(points), 1))
        return newton(points, self, each, np.full(len(points), REACH))
