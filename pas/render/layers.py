"""What pictures are made of: meshes with their colours, and the curves that curvature combs stand on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh

BLEND_COLOR, PIPE_COLOR, CURVE_COLOR = "#e8a33d", "#b9c4cf", "#22303c"

COLORS = ("#5b8db8", "#7fae7a", "#b07aa1", "#9c755f", "#76b7b2", "#c95d63")
"""Of the surfaces that a blend meets, in their order, and of several surfaces."""

BLEND_TINT, TINTS = "#f6c877", ("#b9d3ea", "#c6e2c0", "#dfc3d8", "#d9c3b4", "#c5e4e1", "#efbcbf")
"""Of their bright stripes."""


@dataclass(frozen=True, eq=False)
class Comb:
    """A curve on a surface: its `points` (n, 3), unit `normals` (n, 3) of the surface and its normal `curvatures` (n,).

    The curvatures, over the model's length, are those of the surface along the curve, positive where it bends like a
    ball whose normals point outwards.
    """

    points: Floats
    normals: Floats
    curvatures: Floats


@dataclass(frozen=True)
class Layer:
    """A mesh in a colour; `tint` is that of the bright stripes.

    `principal` gives the principal curvatures (N, 2) at the mesh's points, the larger first, positive where the
    surface bends like a ball whose normals point outwards; None where they are not known.  `unit` is a curvature to
    compare them with, `combs` are drawn on the layer.  `outlined` draws its boundary and the edges between its faces,
    `opacity` is 1 for what is not seen through.  `aside`: what stands around the surface that matters, and is drawn
    faintly where curvature is shown.
    """

    mesh: Mesh
    color: str
    tint: str = "white"
    principal: Callable[[], Floats] | None = None
    unit: float | None = None
    combs: tuple[Comb, ...] = ()
    outlined: bool = False
    opacity: float = 1.0
    aside: bool = False
