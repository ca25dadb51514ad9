"""How the geometry of a surface f = 0 changes with f: exact derivatives by the jets of f.

At a point, in its frame T1, T2, n (see `pas.surface.geometry`), the jet in the frame has the entries of
`COLUMNS`; normal, |grad f|, shape operator and its covariant derivative are differentiated by these.  The
frame is carried along with the normal, without a turn around it.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from pas.algebra.monomials import Floats
from pas.surface.geometry import JETS, ORDERS, SECOND, THIRD, Geometry

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

    def frame_to_jet(self) -> tuple[Floats, Floats, Floats]:
        """The framed jet as linear functions of the jet's first, second and third derivatives, in the order of `JETS`:
        (3, 3, N), (5, 6, N) and (4, 10, N)."""
        f = self.axes
        count = f.shape[2]
        seconds, thirds = _folds()
        pairs = {(a, b): seconds @ (f[a, :, None] * f[b]).reshape(9, count) for a, b in _PAIRS}
        second = np.stack([pairs[pair] for pair in _PAIRS])
        third = np.stack([thirds @ (pairs[a, b][:, None] * f[c]).reshape(18, count) for a, b, c in _TRIPLES])
        return f, second, third


@cache
def _folds() -> tuple[Floats, Floats]:
    """What is equal of products is added: of two vectors to second derivatives (6, 9), of these and a vector to third
    ones (10, 18)."""
    pairs, triples = np.eye(len(JETS))[:, SECOND.ravel()], np.eye(len(JETS))[:, THIRD.reshape(9, 3)]
    seconds, thirds = ORDERS == 2, ORDERS == 3
    first = pairs[seconds].argmax(axis=1)  # one of the places of each
    return pairs[seconds], triples[thirds][:, first].reshape(-1, 18)
