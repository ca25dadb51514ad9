"""How the geometry of a surface f = 0 changes with f: exact derivatives by the jets of f.

At a point, in its frame T1, T2, n (see `pas.surface.geometry`), the jet in the frame has the entries of
`COLUMNS`; normal, |grad f|, shape operator and its covariant derivative are differentiated by these.  The
frame is carried along with the normal, without a turn around it.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from pas.algebra.monomials import Floats
from pas.surface.geometry import FIRST, JETS, SECOND, THIRD, Geometry

COLUMNS = 12
"""Entries of a jet in the frame of a point: g1 g2 gn, H11 H12 H22 H1n H2n, F111 F112 F122 F222."""

_HESSIAN = {(0, 0): 3, (0, 1): 4, (1, 0): 4, (1, 1): 5}
_PAIRS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2))
_TRIPLES = ((0, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1))


class MovingGeometry(Geometry):
    """Frames, shape operators and their covariant derivatives of jets (N, 20), with their derivatives."""

    def changes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives by the framed jet: normal (N, 3, 12), length (N, 12), shape (N, 3, 12), variation (N, 4, 12)."""
        count = len(self.length)
        inverse = 1 / self.length[:, None]
        turn = np.zeros((count, 2, COLUMNS))
        turn[:, 0, 0] = turn[:, 1, 1] = inverse[:, 0]
        normal = np.matmul(self.frame[:, :, :2], turn)
        length = np.zeros((count, COLUMNS))
        length[:, 2] = 1
        h, s = self.hessian, self.shape
        shape: dict[tuple[int, int], Floats] = {}
        for a, b in ((0, 0), (0, 1), (1, 1)):
            change = -turn[:, a] * h[:, b, 2, None] - turn[:, b] * h[:, a, 2, None] - length * s[:, a, b, None]
            change[:, _HESSIAN[a, b]] += 1
            shape[a, b] = shape[b, a] = change * inverse
        mixed = []
        for c in (0, 1):
            change = -turn[:, c] * h[:, 2, 2, None] + sum(turn[:, e] * h[:, c, e, None] for e in (0, 1))
            change[:, 6 + c] += 1
            mixed.append(change)
        variation = [self._variation_change(axes, turn, length, shape, mixed) * inverse for axes in _TRIPLES]
        return normal, length, np.stack([shape[0, 0], shape[0, 1], shape[1, 1]], axis=1), np.stack(variation, axis=1)

    def _variation_change(
        self,
        axes: tuple[int, int, int],
        turn: Floats,
        length: Floats,
        shape: dict[tuple[int, int], Floats],
        mixed: list[Floats],
    ) -> Floats:
        a, b, c = axes
        third, s, h = self.third, self.shape, self.hessian
        change = -turn[:, a] * third[:, 2, b, c, None] - turn[:, b] * third[:, a, 2, c, None]
        change -= turn[:, c] * third[:, a, b, 2, None] + length * self.variation[:, a, b, c, None]
        change[:, 8 + a + b + c] += 1
        for x, y, z in ((a, b, c), (c, a, b), (c, b, a)):
            change -= shape[x, y] * h[:, z, 2, None] + mixed[z] * s[:, x, y, None]
        return change

    def frame_to_jet(self) -> Floats:
        """The framed jet as a linear function of the jet: (N, 12, 20)."""
        matrix = np.zeros((len(self.length), COLUMNS, len(JETS)))
        f = self.frame.transpose(0, 2, 1)  # the vectors of the frame as rows
        matrix[:, :3, FIRST] = f
        seconds, thirds = _folds()
        pairs = np.stack([f[:, a, :, None] * f[:, b, None, :] for a, b in _PAIRS], axis=1)
        matrix[:, 3:8] = pairs.reshape(len(f), -1, 9) @ seconds
        triples = np.stack(
            [f[:, a, :, None, None] * f[:, b, None, :, None] * f[:, c, None, None, :] for a, b, c in _TRIPLES], axis=1
        )
        matrix[:, 8:] = triples.reshape(len(f), -1, 27) @ thirds
        return matrix


@cache
def _folds() -> tuple[Floats, Floats]:
    """The entries of a second and of a third derivative, all of them, as entries of a jet: (9, 20) and (27, 20)."""
    unit = np.eye(len(JETS))
    return unit[SECOND.ravel()], unit[THIRD.ravel()]
