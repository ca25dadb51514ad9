"""What pictures are made of: meshes with their colours."""

from __future__ import annotations

from dataclasses import dataclass

from pas.algebra.monomials import Floats
from pas.mesh.field import TriangleMesh

BLEND_COLOR, PIPE_COLOR, CURVE_COLOR = "#e8a33d", "#b9c4cf", "#22303c"


@dataclass(frozen=True)
class Layer:
    """A mesh in a colour; `tint` is that of the bright stripes, `curvature` (N,) for colours by curvature.

    `outlined` draws its boundary, `opacity` is 1 for what is not seen through.
    """

    mesh: TriangleMesh
    color: str
    tint: str = "white"
    curvature: Floats | None = None
    outlined: bool = False
    opacity: float = 1.0
