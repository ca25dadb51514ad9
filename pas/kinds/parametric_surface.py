"""Parametric surfaces as a kind of shape."""

from __future__ import annotations

from typing import Any

from pas.exchange.parametric_records import SURFACE as FORM
from pas.exchange.parametric_records import read_surface, surface_record
from pas.exchange.schema import Table
from pas.kinds.exact_patches import exact_patches
from pas.mesh.mesh import Mesh
from pas.parametric.surface import ParametricSurface
from pas.render.parametric import surface_layers
from pas.shape import Kind
from pas.verdicts import Verdicts


def record(surface: ParametricSurface, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a surface; raises `ValueError` for one made of callables."""
    return {"surface": surface_record(surface)}


def read(content: dict[str, Any]) -> ParametricSurface:
    """The surface of `record`."""
    return read_surface(content["surface"])


def mesh(surface: ParametricSurface, tolerance: Any, domain: Any) -> Mesh:
    """The mesh over a domain."""
    return surface.mesh(tolerance, domain)


SURFACE = Kind(
    "parametric surface",
    ParametricSurface,
    Table({"surface": FORM}),
    record,
    read,
    surface_layers,
    mesh=mesh,
    patches=exact_patches,
    curved=True,
)
