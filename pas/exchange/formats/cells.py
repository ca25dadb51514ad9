"""VTU (VTK's XML of cells), by pyvista: the tetrahedra of a volume, or a piecewise surface's cells with polynomials;
and Gmsh's .msh of tetrahedra, version 2.2, by meshio, with parts and faces as physical groups.

A polynomial of degree n is given on its tetrahedron by its values at the nodes `(i a + j b + k c + l d) / n`,
`i + j + k + l = n`, which is VTK_LAGRANGE_TETRAHEDRON of degree n.  Bezier cells would be shorter, but VTK
contours their coefficients as if they were values.

Guaranteed: points and values are the exact ones, rounded once; the nodes stand in VTK's order; the B-coefficients go
with them.  Not guaranteed: that a contour by another program is on the surface (programs cut the cells into flat ones
first); `PiecewiseSurface.mesh` is.  Cells share no points, since each has its own polynomial.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.monomials import homogeneous_exponents
from pas.errors import library, optional
from pas.exchange.formats import Content, Format, Request
from pas.exchange.parts import all_different
from pas.exchange.volume import TETRAHEDRA, VolumeMesh, is_filled, tetrahedra_of
from pas.piecewise import PiecewiseSurface
from pas.shape import Shape, kind_of
from pas.surface.function import Cell


def _piecewise(thing: Any) -> PiecewiseSurface | None:
    find = kind_of(thing).piecewise if isinstance(thing, Shape) else None
    return None if find is None else find(thing)


def grid_of(thing: Any, request: Request) -> Any:
    """The `pyvista.UnstructuredGrid` of a thing: its cells where it is piecewise, else tetrahedra that fill it."""
    surface = _piecewise(thing)
    return tetrahedra_of(thing, request).to_pyvista() if surface is None else cell_grid(surface)


def has_cells(thing: Any) -> bool:
    """Whether a thing has cells already."""
    surface = _piecewise(thing)
    return is_filled(thing) if surface is None else bool(surface.partition.cells)


def cell_grid(surface: PiecewiseSurface) -> Any:
    """The cells of a surface as a `pyvista.UnstructuredGrid`.

    Point data `f` (N,) has the values, negative inside.  Cell data `piece` has the numbers of the
    polynomials and `b_coefficients` (C, (n+1)(n+2)(n+3)/6) the B-coefficients, whose multi-indices, one a
    row, are the field data `b_indices`.  Raises `ValueError` for a surface without cells.
    """
    pyvista = optional("pyvista")
    if not surface.cells:
        raise ValueError("the surface has no cells: give its region a box, as in pas.SingleCell(lower, upper)")
    degree = max(surface.degree, 1)
    nodes = node_indices(degree)
    points = [_node(cell, index) for cell in surface.cells for index in nodes]
    polynomials = [cell.polynomial for cell in surface.cells for _ in nodes]
    size, number = len(nodes), len(surface.cells)
    connectivity = np.concatenate(
        [np.full((number, 1), size), np.arange(number * size).reshape(number, size)], axis=1, dtype=int
    )
    types = np.full(number, pyvista.CellType.LAGRANGE_TETRAHEDRON, dtype=np.uint8)
    grid = pyvista.UnstructuredGrid(connectivity.ravel(), types, np.array(points, dtype=float))
    values = [float(p.at(x)) for p, x in zip(polynomials, points, strict=True)]
    grid.point_data["f"] = np.array(values)
    grid.cell_data["piece"] = np.asarray(surface.partition.piece_of, dtype=int)
    indices = homogeneous_exponents(surface.degree, 4)
    coefficients = [[float(cell.b_coefficients[i]) for i in indices] for cell in surface.cells]  # type: ignore[index]
    grid.cell_data["b_coefficients"] = np.array(coefficients).reshape(number, -1)
    grid.field_data["b_indices"] = np.array(indices)
    return grid


def node_indices(degree: int) -> list[tuple[int, int, int, int]]:
    """The multi-indices of the nodes of VTK's Lagrange tetrahedron, in its order.

    They refer to the corners of the cell as they are numbered; VTK itself puts the first corner last.
    """
    from vtkmodules.vtkCommonDataModel import vtkHigherOrderTetra

    result = []
    for node in range((degree + 1) * (degree + 2) * (degree + 3) // 6):
        index = [0, 0, 0, 0]
        vtkHigherOrderTetra.BarycentricIndex(node, index, degree)
        result.append((index[3], index[0], index[1], index[2]))
    return result


def _node(cell: Cell, index: tuple[int, int, int, int]) -> tuple[Fraction, ...]:
    """The exact point of a multi-index."""
    weights = [Fraction(i, sum(index)) for i in index]
    return tuple(
        sum((w * v[axis] for w, v in zip(weights, cell.vertices, strict=True)), Fraction(0)) for axis in range(3)
    )


def write_vtu(grid: Any, path: Path, request: Request) -> None:
    """The grid with its arrays."""
    grid.save(path)


VTU: Format[Any] = Format(".vtu", Content("cells", grid_of, ("tolerance",), has_cells), write_vtu, unitless=True)


def _require_meshio() -> Any:
    return library("meshio", "files of Gmsh need meshio: pip install meshio")


def write_msh(mesh: VolumeMesh, path: Path, request: Request) -> None:
    """In version 2.2, which every reader knows; faces are groups 1 to F, parts F + 1 onwards."""
    meshio = _require_meshio()
    faces = len(mesh.names)
    tags = [(mesh.faces + 1).astype(np.int32), (mesh.regions + 1 + faces).astype(np.int32)]
    names = _quotable([*mesh.names, *mesh.region_names])
    groups = {name: np.array([i + 1, 2 if i < faces else 3]) for i, name in enumerate(names)}
    meshio.Mesh(
        mesh.points,
        [("triangle", mesh.boundary), ("tetra", mesh.tetrahedra)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=groups,
    ).write(path, file_format="gmsh22", binary=False)


def _quotable(names: Sequence[str]) -> list[str]:
    """The names without quotes and line ends, all different (a part may be named as a face)."""
    return all_different((" ".join(name.replace('"', "'").split()) for name in names), " ")


MSH = Format(".msh", TETRAHEDRA, write_msh, _require_meshio, unitless=True)
