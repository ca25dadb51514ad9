"""Charts on any quadric as one rational patch of degree 2 by 2, exactly: seen from a point of the quadric.

With f = x.Ax / 2 + b.x + c / 2 and f(o) = 0, the line from o in the direction d meets f = 0 again in

    q(d) o - 2 (g.d) d  over  q(d),   q(d) = d.Ad,  g = A o + b,

which is of degree 2 in u and v where d = axis + u first + v second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats

MARGIN = 0.02
"""By how much of its sides a patch is larger than its chart."""

LEAST_WEIGHT = 1e-3
"""The smallest weight of a patch, over the largest."""

SPANS = (1, 2, 4, 8)
"""Spans a side that are tried until all weights are positive, as CAD programs want them."""

_FROM_VALUES = np.array([[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [0.5, -1.0, 0.5]])
"""Coefficients of a parabola, constant first, from its values at -1, 0 and 1."""


@dataclass(frozen=True, eq=False)
class QuadricPatch:
    """A rational patch on a quadric seen from `eye` (3,), with `frame` (3, 3): the rows first, second and axis.

    `knots` are those of the two directions; `poles` (m, m, 3) and `weights` (m, m) those of the patch.
    """

    eye: Floats
    frame: Floats
    knots: tuple[Floats, Floats]
    poles: Floats
    weights: Floats

    def uv(self, points: Floats) -> Floats:
        """The parameters (N, 2) of points (N, 3)."""
        seen = (points - self.eye) @ self.frame.T
        return np.asarray(seen[:, :2] / seen[:, 2:])


def quadric_patch(matrix: Floats, points: Floats, middle: Floats, normal: Floats) -> QuadricPatch | None:
    """The patch of a quadric with symmetric matrix (4, 4) that has points (N, 3) on it, seen from opposite their middle.

    That is through the quadric's centre; where it has none, against the mean unit normal (3,).  None where no point of
    the quadric is there, or not all of the points are seen from it.
    """
    form, slope = matrix[:3, :3], matrix[:3, 3]
    sizes = np.linalg.svd(form, compute_uv=False)
    way = normal
    if sizes[-1] > 1e-9 * sizes[0]:
        way = middle + np.linalg.solve(form, slope)
        way = way / max(float(np.linalg.norm(way)), 1e-300)
    value, rise, bend = (
        middle @ form @ middle + 2 * middle @ slope + matrix[3, 3],
        -2 * way @ (form @ middle + slope),
        way @ form @ way,
    )
    under = rise * rise - 4 * bend * value
    if under < 0 or abs(bend) * float(np.ptp(points, axis=0).max()) < 1e-6 * abs(rise):
        return None  # there is none, or further away than a million times the chart's size
    roots = (-rise + np.array([1.0, -1.0]) * np.sqrt(under)) / (2 * bend)
    eye = middle - float(roots[int(np.argmax(np.abs(roots)))]) * way
    for _ in range(3):  # the point to the last digit
        gradient = 2 * (form @ eye + slope)
        eye = eye - (eye @ form @ eye + 2 * eye @ slope + matrix[3, 3]) / (gradient @ gradient) * gradient
    axis = (middle - eye) / np.linalg.norm(middle - eye)
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.round(np.abs(axis), 6)))])
    first /= np.linalg.norm(first)
    frame = np.stack([first, np.cross(axis, first), axis])
    seen = (points - eye) @ frame.T
    if seen[:, 2].min() <= 0.01 * np.linalg.norm(seen, axis=1).max():
        return None
    uv = seen[:, :2] / seen[:, 2:]
    room = MARGIN * float(np.ptp(uv, axis=0).max())
    low, high = uv.min(axis=0) - room, uv.max(axis=0) + room
    middle, half = (low + high) / 2, (high - low) / 2
    grid = np.stack(
        np.meshgrid(*(m + h * np.array([-1, 0, 1]) for m, h in zip(middle, half, strict=True)), indexing="ij"), -1
    )
    ways = grid @ frame[:2] + axis
    bends = np.einsum("ijx,xy,ijy->ij", ways, form, ways)
    across = ways @ (form @ eye + slope)
    both = np.concatenate([bends[..., None] * eye - 2 * across[..., None] * ways, bends[..., None]], axis=2)
    coefficients = np.einsum("ik,jl,klx->ijx", _FROM_VALUES, _FROM_VALUES, both) * np.sign(bends[1, 1])
    for spans in SPANS:
        knots = np.concatenate([[-1.0, -1.0], np.linspace(-1, 1, spans + 1), [1.0, 1.0]])
        a, b = knots[1:-2], knots[2:-1]
        blossoms = np.stack([np.ones_like(a), (a + b) / 2, a * b], axis=1)  # of 1, u and u^2
        control = np.einsum("mi,nj,ijx->mnx", blossoms, blossoms, coefficients)
        weights = control[..., 3]
        if weights.min() > LEAST_WEIGHT * weights.max():
            both_knots = (middle[0] + half[0] * knots, middle[1] + half[1] * knots)
            return QuadricPatch(eye, frame, both_knots, control[..., :3] / weights[..., None], weights / weights.max())
    return None
