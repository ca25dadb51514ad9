"""What pictures are made of: meshes with their colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh
from pas.parametric.surface import ParametricSurface

BLEND_COLOR, PIPE_COLOR, CURVE_COLOR = "#e8a33d", "#b9c4cf", "#22303c"

COLORS = ("#5b8db8", "#7fae7a", "#b07aa1", "#9c755f", "#76b7b2", "#c95d63")
"""Of the surfaces that a blend meets, in their order, and of several surfaces."""

BLEND_TINT, TINTS = "#f6c877", ("#b9d3ea", "#c6e2c0", "#dfc3d8", "#d9c3b4", "#c5e4e1", "#efbcbf")
"""Of their bright stripes."""

FLAT = 1e-12
"""Where the normal is shorter, over the tangents, there is no curvature."""


@dataclass(frozen=True)
class Layer:
    """A mesh in a colour; `tint` is that of the bright stripes, `curvature` (N,) for colours by curvature.

    `outlined` draws its boundary and the edges between its faces, `opacity` is 1 for what is not seen through.
    """

    mesh: Mesh
    color: str
    tint: str = "white"
    curvature: Floats | None = None
    outlined: bool = False
    opacity: float = 1.0


def mean_curvatures(surface: ParametricSurface, parameters: Floats) -> Floats:
    """Mean curvatures at parameters (N, 2), positive where the surface bends towards dP/dt x dP/dh; nan at poles."""
    (p, q), (a, b, c) = (
        (surface.derivative(parameters, *orders) for orders in group)
        for group in (((1, 0), (0, 1)), ((2, 0), (1, 1), (0, 2)))
    )
    normal = np.cross(p, q)
    first = [(u * v).sum(axis=-1) for u, v in ((p, p), (p, q), (q, q))]
    length = np.linalg.norm(normal, axis=-1)
    with np.errstate(all="ignore"):
        second = [(u * normal).sum(axis=-1) / length for u in (a, b, c)]
        above = second[0] * first[2] - 2 * second[1] * first[1] + second[2] * first[0]
        result = above / (2 * length * length)
    return np.where(length > FLAT * np.sqrt(first[0] * first[2]), result, np.nan)
