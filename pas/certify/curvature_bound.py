"""A bound on the curvature of the whole surface, proved by Bernstein forms.

With g = grad f, H the second derivatives of f and M = |g|^2 tr H - g^T H g,

    k1^2 + k2^2 = (M^2 - 2 |g|^2 g^T adj(H) g) / |g|^6

so that `sqrt(k1^2 + k2^2) < K` wherever f = 0 if the polynomial `K^2 |g|^6 - M^2 + 2 |g|^2 g^T adj(H) g`, of degree
6 (n - 1), is positive there: branch and bound as for the other proofs.  f is written as of the same degree, so that
multiples of it count: near the surface the polynomial changes by what one of these does, and slowly along it.

The bound holds for both principal curvatures; a pipe, one of whose curvatures is 0, has its own curvature for the root.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.polynomial import RING
from pas.algebra.rational import Vector, plain
from pas.bernstein.forms import b_form, on_simplex, rounded
from pas.bernstein.signs import prove_positive
from pas.certify.contact_proofs import from_signs
from pas.limits import checkpoint
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict

Matrix = list[list[fmpq_mpoly]]


def curvature_below(surface: PiecewisePolynomial, bound: fmpq) -> Verdict:
    """The verdict on `sqrt(k1^2 + k2^2) < bound` all over the surface, `bound` in 1 / unit of length."""
    claim = f"sqrt(k1^2 + k2^2) below {plain(bound)}"
    local = surface.local
    square = (bound * surface.partition.frame.scale) ** 2
    zero, value, degree = [], [], 6 * max(surface.degree - 1, 0)
    for cell, piece in zip(local.cells, local.piece_of, strict=True):
        checkpoint("bounding curvature")
        corners, patch = local.corners(cell), surface.patches[int(piece)].raw
        zero.append(rounded(b_form(on_simplex(patch, corners), degree, 3)))
        value.append(rounded(b_form(_difference(patch, corners, square), degree, 3)))
    result = prove_positive(np.array(value), local.points[np.array(local.cells)], np.array(zero))
    if result.status is Status.PROVED:
        reason = f"K^2 |g|^6 > M^2 - 2 |g|^2 g^T adj(H) g wherever f = 0; {result.examined} tetrahedra"
        return Verdict(Status.PROVED, claim, reason, measure=result.examined)
    return from_signs(surface, claim, "it is larger somewhere", result)


def _difference(patch: fmpq_mpoly, corners: Sequence[Vector], square: fmpq) -> fmpq_mpoly:
    """`K^2 |g|^6 - M^2 + 2 |g|^2 g^T adj(H) g` on a tetrahedron.

    The derivatives are brought there one by one: the whole has thousands of terms.
    """
    slopes = [patch.derivative(i) for i in range(3)]
    g = [on_simplex(slope, corners) for slope in slopes]
    upper = {(i, j): on_simplex(slopes[i].derivative(j), corners) for i in range(3) for j in range(i, 3)}
    h: Matrix = [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]
    length = sum((a * a for a in g), RING.constant(0))
    bent = length * (h[0][0] + h[1][1] + h[2][2]) - _form(g, h)
    adjugate: Matrix = [[_cofactor(h, i, j) for j in range(3)] for i in range(3)]
    return length * length * length * square - bent * bent + length * _form(g, adjugate) * 2


def _form(g: Sequence[fmpq_mpoly], matrix: Matrix) -> fmpq_mpoly:
    return sum((g[i] * g[j] * matrix[i][j] for i in range(3) for j in range(3)), RING.constant(0))


def _cofactor(h: Matrix, i: int, j: int) -> fmpq_mpoly:
    (a, b), (c, d) = ([x for x in range(3) if x != k] for k in (i, j))
    minor = h[a][c] * h[b][d] - h[a][d] * h[b][c]
    return minor if (i + j) % 2 == 0 else -minor
