"""VTU (VTK's XML of cells), by pyvista: the tetrahedra of a volume, or a piecewise surface's cells with polynomials."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pas.exchange.formats.format import Content, Format, Request
from pas.exchange.volume import is_filled, tetrahedra_of
from pas.shape import Shape, kind_of


def grid_of(thing: Any, request: Request) -> Any:
    """The `pyvista.UnstructuredGrid` of a thing: its cells where its kind has such, else tetrahedra that fill it."""
    cells = kind_of(thing).cells if isinstance(thing, Shape) else None
    return tetrahedra_of(thing, request).to_pyvista() if cells is None else cells(thing)


def has_cells(thing: Any) -> bool:
    """Whether a thing has cells already."""
    kind = kind_of(thing) if isinstance(thing, Shape) else None
    if kind is None or kind.cells is None:
        return is_filled(thing)
    return kind.cast is None or bool(kind.cast(thing).partition.cells)


def write_vtu(grid: Any, path: Path, request: Request) -> None:
    """The grid with its arrays."""
    grid.save(path)


VTU: Format[Any] = Format(".vtu", Content("cells", grid_of, ("tolerance",), has_cells), write_vtu)
