"""Differential geometry of a surface f = 0 at points, from the derivatives of f up to the third order.

In a frame T1, T2, n of principal directions and outward normal, with L = |grad f|:

    S_ab  = H_ab / L                                                       shape operator
    C_abc = (F_abc - S_ab H_cn - S_ca H_bn - S_cb H_an) / L                its covariant derivative

with the second derivatives H and the third F of f in the frame.  S is positive where the surface bends like a
ball that is inside.  C is symmetric (Codazzi).
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, exponents, homogeneous_exponents, monomial_values, positions

JETS = tuple(e for d in range(4) for e in homogeneous_exponents(d, 3))
"""The derivatives of f that are used, by exponents: value, gradient, Hessian, third order; 20 in all."""

_PLACE = {e: i for i, e in enumerate(JETS)}
ORDERS = np.array([sum(e) for e in JETS])


def _place(*axes: int) -> int:
    return _PLACE[axes.count(0), axes.count(1), axes.count(2)]


FIRST = np.array([_place(i) for i in range(3)])
SECOND = np.array([[_place(i, j) for j in range(3)] for i in range(3)])
THIRD = np.array([[[_place(i, j, k) for k in range(3)] for j in range(3)] for i in range(3)])
"""Where the entries of gradient, Hessian and third derivatives stand in a jet."""


def jets(points: Floats, column: Floats, degree: int) -> Floats:
    """The jets (N, 20) at points (N, 3) of the polynomial with coefficients (C(n+3, 3),)."""
    indices, factors = derivatives(degree)
    table = monomial_values(points, degree)
    return np.stack([(factors[row] * column) @ table[indices[row]] for row in range(len(JETS))], axis=1)


class Geometry:
    """Frames, shape operators and their covariant derivatives, of jets (N, 20)."""

    def __init__(self, jets: Floats) -> None:
        g, hessian, third = jets[:, FIRST], jets[:, SECOND], jets[:, THIRD]
        self.length = np.linalg.norm(g, axis=1)
        n = g / self.length[:, None]
        other = np.where((np.abs(n[:, 0]) < 0.6)[:, None], [1.0, 0, 0], [0, 1.0, 0])
        t1 = np.cross(n, other)
        t1 /= np.linalg.norm(t1, axis=1)[:, None]
        frame = np.stack([t1, np.cross(n, t1), n], axis=2)
        tangent = np.matmul(frame.transpose(0, 2, 1), np.matmul(hessian, frame))
        angle = 0.5 * np.arctan2(2 * tangent[:, 0, 1], tangent[:, 0, 0] - tangent[:, 1, 1])
        cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
        turned = [cos * frame[:, :, 0] + sin * frame[:, :, 1], cos * frame[:, :, 1] - sin * frame[:, :, 0]]
        self.frame = np.stack([*turned, n], axis=2)
        self.hessian = np.matmul(self.frame.transpose(0, 2, 1), np.matmul(hessian, self.frame))
        partly = np.matmul(third.reshape(len(g), 9, 3), self.frame).reshape(len(g), 3, 3, 3)  # ijc
        partly = np.matmul(partly.transpose(0, 1, 3, 2), self.frame[:, None])  # icb
        self.third = np.matmul(partly.transpose(0, 3, 2, 1), self.frame[:, None])  # bca, symmetric
        self.shape = self.hessian[:, :2, :2] / self.length[:, None, None]
        s, h = self.shape, self.hessian[:, :2, 2]
        self.variation = (
            self.third[:, :2, :2, :2]
            - s[:, :, :, None] * h[:, None, None, :]
            - s[:, :, None, :] * h[:, None, :, None]
            - s[:, None, :, :] * h[:, :, None, None]
        ) / self.length[:, None, None, None]

    @property
    def normals(self) -> Floats:
        """Outward unit normals (N, 3)."""
        return self.frame[:, :, 2]

    @property
    def principal(self) -> Floats:
        """Principal curvatures (N, 2), the larger first."""
        return np.stack([self.shape[:, 0, 0], self.shape[:, 1, 1]], axis=1)


@cache
def derivatives(degree: int) -> tuple[NDArray[np.intp], Floats]:
    """For each jet entry and monomial: the monomial that its derivative is a multiple of, and the factor."""
    where, table = positions(degree), exponents(degree)
    indices, factors = np.zeros((len(JETS), len(table)), dtype=np.intp), np.zeros((len(JETS), len(table)))
    for row, jet in enumerate(JETS):
        for column, e in enumerate(table):
            lower = tuple(p - q for p, q in zip(e, jet, strict=True))
            if min(lower) >= 0:
                indices[row, column] = where[lower]
                factors[row, column] = np.prod([float(p - k) for p, q in zip(e, jet, strict=True) for k in range(q)])
    return indices, factors
