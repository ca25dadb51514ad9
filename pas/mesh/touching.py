"""Points where two surfaces touch, by the Gauss-Newton method on their functions and the product of their gradients.

The system f = g = 0, grad f x grad g = 0 has more equations than unknowns, but where it has a solution at which the
surfaces do not touch along a curve it converges quadratically (Deuflhard 2011, section 4.3).  Of points on such a
curve none is given.
"""

from __future__ import annotations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.field import FaceField
from pas.mesh.rows import Floats, Integers, cross
from pas.mesh.shading import unit_rows

STEPS, STILL = 24, 1e-15
"""Of the method, and the length of a step, over the extent of the box, where it ends."""

SLOPE_STEP = 1e-5
"""Of the differences that give second derivatives, over the extent of the box."""

FOUND, PARALLEL = 1e-10, 1e-5
"""Distance over the extent of the box up to which a point is on a surface; sine up to which gradients are parallel."""

ISOLATED = 1e-3
"""Least singular value, in the scale of `reach`, above which no curve of such points passes."""

INDEPENDENT = 1e-6
"""Ratio of singular values below which equations do not move a point."""


def touching(field: FaceField, points: Floats, pairs: Integers, reach: Floats) -> Floats:
    """The points (N, 3) near given ones where the functions of two labels (N, 2) vanish with parallel gradients.

    NaN where none is found within steps of `reach` (N,).
    """
    extent = float(np.ptp(field.box, axis=0).max())
    lengths = [np.linalg.norm(field.jets(points, column)[:, 1:], axis=1) for column in pairs.T]
    scale = 1 / np.maximum(np.stack(lengths, axis=1), 1e-300)
    points, apart = points.copy(), SLOPE_STEP * extent
    active = np.arange(len(points))
    for _ in range(STEPS):
        checkpoint()
        step = _step(*_system(field, points[active], pairs[active], scale[active], reach[active], apart))
        length = np.sqrt((step * step).sum(axis=1))
        points[active] += step * np.minimum(1.0, reach[active] / np.maximum(length, 1e-300))[:, None]
        active = active[length > STILL * extent]  # not where it is NaN
        if not len(active):
            break
    found = _touch(field, points, pairs, FOUND * extent)
    matrix = _system(field, points[found], pairs[found], scale[found], reach[found], apart)[1]
    found[found] = np.linalg.svd(matrix, compute_uv=False)[:, 2] > ISOLATED
    points[~found] = np.nan
    return points


def _system(
    field: FaceField, points: Floats, pairs: Integers, scale: Floats, size: Floats, apart: float
) -> tuple[Floats, Floats]:
    """The equations' values (N, 5) and derivatives (N, 5, 3).

    `scale` (N, 2) are factors of functions, `size` (N,) of the gradients' product.
    """
    sides = apart * np.concatenate([np.eye(3), -np.eye(3)])
    around = (points[:, None] + sides).reshape(-1, 3)
    values, gradients, bends = [], [], []
    for label, factor in zip(pairs.T, scale.T, strict=True):
        jets = field.jets(points, label) * factor[:, None]
        slopes = field.jets(around, np.repeat(label, len(sides)))[:, 1:].reshape(-1, 2, 3, 3)
        values.append(jets[:, :1])
        gradients.append(jets[:, None, 1:])
        bends.append((slopes[:, 0] - slopes[:, 1]) * (factor / (2 * apart))[:, None, None])
    (a, b), (bend_a, bend_b) = gradients, bends
    turn = np.cross(bend_a, b) + np.cross(a, bend_b)  # row k: the product's derivative along axis k
    value = np.concatenate([*values, size[:, None] * np.cross(a, b)[:, 0]], axis=1)
    matrix = np.concatenate([a, b, size[:, None, None] * turn.transpose(0, 2, 1)], axis=1)
    return value, matrix


def _step(value: Floats, matrix: Floats) -> Floats:
    """The least steps (N, 3) of the method; NaN where the equations are not finite."""
    good = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(value).all(axis=1)
    result = np.full((len(value), 3), np.nan)
    result[good] = -np.einsum("nij,nj->ni", np.linalg.pinv(matrix[good], rcond=INDEPENDENT), value[good])
    return result


def _touch(field: FaceField, points: Floats, pairs: Integers, close: float) -> np.ndarray:
    """Whether both surfaces pass through points (N, 3) with one normal."""
    result = np.asarray(np.isfinite(points).all(axis=1))
    here, functions = points[result], pairs[result]
    jets = [field.jets(here, column) for column in functions.T]
    off = [np.abs(j[:, 0]) / np.maximum(np.linalg.norm(j[:, 1:], axis=1), 1e-300) for j in jets]
    sine = np.linalg.norm(cross(*(unit_rows(j[:, 1:]) for j in jets)), axis=1)
    result[result] = (np.max(off, axis=0) < close) & (sine < PARALLEL)
    return result
