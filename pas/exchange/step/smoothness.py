"""How well charts that should go on in each other do: angles and jumps of curvature across their borders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats

if TYPE_CHECKING:
    from pas.exchange.step.shapes import ShapeMaker

ACROSS = 17
"""Points along a border at which it is looked at."""


@dataclass(frozen=True)
class Smoothness:
    """The largest angle between normals, in radians, and the largest jump of curvature over the largest curvature."""

    angle: float
    curvature_jump: float


def smoothness(maker: ShapeMaker) -> Smoothness:
    """Across the borders at which charts are claimed to go on in each other: GC^1 for angles, GC^2 for curvatures."""
    angle = jump = 0.0
    largest = 0.0
    for border, curve in zip(maker.borders.borders, maker.curves, strict=True):
        if border.order < 1:
            continue
        places = curve.parameters(ACROSS + 2)[1:-1]
        step = (curve.end - curve.start) * 1e-4
        along = curve(places + step) - curve(places - step)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        (one, k), (other, m) = (_across(maker, chart, curve(places), along) for chart in (border.left, border.right))
        sines = np.linalg.norm(np.cross(one, other), axis=1)
        angle = max(angle, float(np.arctan2(sines, (one * other).sum(axis=1)).max()))
        largest = max(largest, float(np.abs([k, m]).max()))
        if border.order > 1:
            jump = max(jump, float(np.abs(k - m).max()))
    return Smoothness(angle, jump / largest if largest else 0.0)


def _across(maker: ShapeMaker, chart: int, points: Floats, along: Floats) -> tuple[Floats, Floats]:
    """Outward normals (N, 3) and curvatures (N,) across directions (N, 3) in which a border runs, of a chart's surface."""
    from OCP.gp import gp_Pnt, gp_Vec

    point, vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
    found = np.empty((len(points), 5, 3))
    for row, uv in enumerate(maker.parameters[chart].uv(points).tolist()):
        maker.surfaces[chart].D2(*uv, point, *vectors)
        found[row] = [(v.X(), v.Y(), v.Z()) for v in vectors]
    u, v, uu, vv, uv_ = found.transpose(1, 0, 2)
    normals = np.cross(u, v) * (1.0 if maker.natural[chart] else -1.0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    across = np.cross(normals, along)
    first = np.stack([[(u * u).sum(1), (u * v).sum(1)], [(u * v).sum(1), (v * v).sum(1)]]).transpose(2, 0, 1)
    second = np.stack(
        [[(uu * normals).sum(1), (uv_ * normals).sum(1)], [(uv_ * normals).sum(1), (vv * normals).sum(1)]]
    ).transpose(2, 0, 1)
    parts = np.linalg.solve(first, np.stack([(across * u).sum(1), (across * v).sum(1)], axis=1)[..., None])
    return normals, (parts.transpose(0, 2, 1) @ second @ parts)[:, 0, 0]
