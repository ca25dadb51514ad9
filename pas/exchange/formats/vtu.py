"""VTU (VTK's XML of cells), by pyvista: the tetrahedra of a volume, or a piecewise surface's cells with polynomials."""

from __future__ import annotations

from functools import singledispatch
from pathlib import Path
from typing import Any

from pas.exchange.cell_grid import cell_grid
from pas.exchange.formats.format import Content, Format, Request
from pas.exchange.volume import tetrahedra_of
from pas.surface.piecewise import PiecewiseSurface


@singledispatch
def grid_of(thing: Any, request: Request) -> Any:
    """The `pyvista.UnstructuredGrid` of a thing: of a volume, or of a solid that is filled first."""
    return tetrahedra_of(thing, request).to_pyvista()


@grid_of.register
def _(surface: PiecewiseSurface, request: Request) -> Any:
    return cell_grid(surface)


def write_vtu(grid: Any, path: Path, request: Request) -> None:
    """The grid with its arrays."""
    grid.save(path)


VTU: Format[Any] = Format(".vtu", Content("cells", grid_of, ("tolerance",)), write_vtu)
