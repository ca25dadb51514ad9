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

_PAIRS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2))
_TRIPLES = ((0, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1))


class MovingGeometry(Geometry):
    """Frames, shape operators and their covariant derivatives of jets (N, 20), with their derivatives."""

    def changes(self) -> tuple[Floats, Floats, Floats]:
        """Derivatives by the framed jet: normal (3, 12, N), shape (3, 12, N), variation (4, 12, N).

        That of the length is 1 by gn, and nothing else.
        """
        h, s, c = self.second, self._shape, self._variation
        inverse = 1 / self.length
        normal = np.zeros((3, COLUMNS, len(inverse)))
        normal[:, :2] = (self.axes[:2] * inverse).transpose(1, 0, 2)
        shape = np.zeros((3, COLUMNS, len(inverse)))
        for row, (a, b) in enumerate(_PAIRS[:3]):
            shape[row, a] -= h[b, 2] * inverse
            shape[row, b] -= h[a, 2] * inverse
            shape[row, 2] = -s[a, b]
            shape[row, 3 + row] = 1
        shape *= inverse
        mixed = np.zeros((2, COLUMNS, len(inverse)))
        for row in (0, 1):
            mixed[row, :2] = s[row]
            mixed[row, row] -= h[2, 2] * inverse
            mixed[row, 6 + row] = 1
        variation = np.zeros((4, COLUMNS, len(inverse)))
        for row, axes in enumerate(_TRIPLES):
            variation[row, 2] = -c[axes]
            variation[row, 8 + row] = 1
            for place, z in enumerate(axes):
                x, y = axes[:place] + axes[place + 1 :]
                variation[row, z] -= self.third[x, y, 2] * inverse
                variation[row] -= shape[x + y] * h[z, 2] + mixed[z] * s[x, y]
        variation *= inverse
        return normal, shape, variation

    def frame_to_jet(self) -> Floats:
        """The framed jet as a linear function of the jet: (12, 20, N)."""
        f = self.axes
        matrix = np.zeros((COLUMNS, len(JETS), len(self.length)))
        matrix[:3, FIRST] = f
        seconds, thirds = _folds()
        pairs = {(a, b): (f[a, :, None] * f[b]).reshape(9, -1) for a, b in _PAIRS}
        for row, pair in enumerate(_PAIRS, 3):
            matrix[row] = seconds @ pairs[pair]
        for row, (a, b, c) in enumerate(_TRIPLES, 8):
            matrix[row] = thirds @ (pairs[a, b][:, None] * f[c]).reshape(27, -1)
        return matrix


@cache
def _folds() -> tuple[Floats, Floats]:
    """The entries of a jet by those of a second and of a third derivative, all of them: (20, 9) and (20, 27)."""
    unit = np.eye(len(JETS))
    return unit[:, SECOND.ravel()], unit[:, THIRD.ravel()]
