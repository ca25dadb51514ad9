"""Piecewise surfaces as a kind of shape: partition, contacts and polynomials, exact."""

from __future__ import annotations

from typing import Any

from pas.exchange.cell_grid import cell_grid
from pas.exchange.records import read_surface, surface_record
from pas.exchange.schema import Table
from pas.exchange.shapes import SURFACE as SHAPE
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import body
from pas.render.piecewise import layers
from pas.shape import Kind
from pas.verdicts import Verdicts


def record(surface: PiecewiseSurface, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a surface, exact."""
    return {"surface": surface_record(surface)}


def read(content: dict[str, Any]) -> PiecewiseSurface:
    """The surface of `record`."""
    return read_surface(content["surface"])


def _cells(surface: PiecewiseSurface) -> Any:
    return cell_grid(surface)


def _itself(surface: PiecewiseSurface) -> PiecewiseSurface:
    return surface


SURFACE = Kind(
    "surface", PiecewiseSurface, Table({"surface": SHAPE}), record, read, layers, body=body, cells=_cells, curved=True,
    cast=_itself,
)  # fmt: skip
