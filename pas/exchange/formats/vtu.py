"""VTU (VTK's XML of cells), by pyvista: the tetrahedra of a volume, or a piecewise surface's cells with polynomials."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pas.exchange.formats.format import Content, Format, Request
from pas.exchange.volume import tetrahedra_of
from pas.shape import Shape, kind_of


def grid_of(thing: Any, request: Request) -> Any:
    """The `pyvista.UnstructuredGrid` of a thing: its cells where its kind has such, else tetrahedra that fill it."""
    cells = kind_of(thing).cells if isinstance(thing, Shape) else None
    return tetrahedra_of(thing, request).to_pyvista() if cells is None else cells(thing)


def write_vtu(grid: Any, path: Path, request: Request) -> None:
    """The grid with its arrays."""
    grid.save(path)


VTU: Format[Any] = Format(".vtu", Content("cells", grid_of, ("tolerance",)), write_vtu)
