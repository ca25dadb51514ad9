"""Cells as VTK's Lagrange tetrahedra: the right nodes in the right order, with the right values."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved

import pas
from pas.exchange.formats import libraries as module
from pas.exchange.formats.libraries import node_indices
from pas.exchange.write import write_cells
from pas.piecewise import PiecewiseSurface

pyvista = pytest.importorskip("pyvista")

CORNERS = [(0, 0, 0), (2, "1/3", 0), (0, 3, "1/7"), ("-1/2", 0, 1), ("1/3", "1/3", -2)]
PAIR = pas.Partition(CORNERS, [(0, 1, 2, 3), (2, 1, 0, 4)])


def two_cells(degree: int) -> PiecewiseSurface:
    """A full polynomial of a degree, and another, on two skew cells."""
    text = "(1 + x - 2*y/3 + z/5)**{} + x**{}*y - z**{}"
    rows = [text.format(degree, degree - 1, degree), text.format(degree, 0, 1) + " + x*y" * (degree > 1)]
    return PiecewiseSurface.from_polynomials(PAIR, [], 0, rows)


@pytest.mark.parametrize("degree", range(1, 11))
def test_the_nodes_are_all_multi_indices(degree):
    nodes = node_indices(degree)
    assert len(set(nodes)) == len(nodes) == (degree + 1) * (degree + 2) * (degree + 3) // 6
    assert {sum(n) for n in nodes} == {degree}
    assert nodes[:4] == [tuple(degree * (i == j) for j in range(4)) for i in range(4)]


def test_the_nodes_of_degree_three_are_those_of_the_manual():
    edges = [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2), (0, 3), (3, 0), (1, 3), (3, 1), (2, 3), (3, 2)]
    expected = [tuple(2 * (i == a) + (i == b) for i in range(4)) for a, b in edges]
    expected += [tuple(int(i in face) for i in range(4)) for face in [(0, 1, 3), (1, 2, 3), (0, 2, 3), (0, 1, 2)]]
    assert node_indices(3)[4:] == expected


@pytest.mark.parametrize("degree", range(1, 9))
def test_values_at_nodes_are_those_of_the_surface(tmp_path, degree):
    meshio = pytest.importorskip("meshio")
    surface = two_cells(degree)
    again = meshio.read(write_cells(surface, tmp_path / "a.vtu"))
    assert [block.type for block in again.cells] == ["VTK_LAGRANGE_TETRAHEDRON"]
    data = again.cells[0].data
    assert data.shape == (2, len(node_indices(degree)))
    for cell, row in zip(surface.cells, data, strict=True):
        exact = np.array([float(cell.polynomial.at(p)) for p in again.points[row]])
        np.testing.assert_allclose(again.point_data["f"][row], exact, rtol=0, atol=1e-12 * np.abs(exact).max())
        corners = np.array(cell.vertices, dtype=float)
        assert np.array_equal(again.points[row[:4]], corners)


@pytest.mark.parametrize("degree", range(1, 9))
def test_vtk_interpolates_the_polynomials(tmp_path, degree):
    """A wrong order of nodes would give another polynomial between them."""
    from vtkmodules.vtkCommonCore import reference

    surface = two_cells(degree)
    grid = pyvista.read(write_cells(surface, tmp_path / "a.vtu"))
    weights = np.random.default_rng(degree).dirichlet(np.ones(4), size=40)
    for number, cell in enumerate(surface.cells):
        points = weights @ np.array(cell.vertices, dtype=float)
        vtk_cell, expected = grid.GetCell(number), cell.polynomial(points)
        ids = [vtk_cell.GetPointId(i) for i in range(vtk_cell.GetNumberOfPoints())]
        for weight, point, value in zip(weights, points, expected, strict=True):
            functions, place = [0.0] * len(ids), [0.0] * 3
            vtk_cell.InterpolateFunctions(weight[1:].tolist(), functions)
            vtk_cell.EvaluateLocation(reference(0), weight[1:].tolist(), place, [0.0] * len(ids))
            np.testing.assert_allclose(place, point, atol=1e-12)
            assert np.dot(functions, grid["f"][ids]) == pytest.approx(value, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("radii", "order"), [(EQUAL, 1), (UNEQUAL, 2)])
def test_blends_agree_with_their_surface(tmp_path, radii, order):
    surface = solved(radii, order).surface
    grid = pyvista.read(write_cells(surface, tmp_path / "a.vtu"))
    assert grid.n_cells == len(surface.cells) == 6
    assert set(grid.celltypes) == {pyvista.CellType.LAGRANGE_TETRAHEDRON}
    np.testing.assert_allclose(grid["f"], surface(grid.points), rtol=0, atol=1e-12 * np.abs(grid["f"]).max())
    assert np.array_equal(grid.cell_data["piece"], surface.partition.piece_of)
    inside = np.array([float(sum(v[i] for v in c.vertices) / 4) for c in surface.cells for i in range(3)])
    probes = pyvista.PolyData(inside.reshape(-1, 3)).sample(grid)
    assert probes["vtkValidPointMask"].all()
    np.testing.assert_allclose(probes["f"], surface(inside.reshape(-1, 3)), atol=1e-9)


def test_b_coefficients_are_kept(tmp_path):
    surface = solved(UNEQUAL, 2).surface
    grid = pyvista.read(write_cells(surface, tmp_path / "a.vtu"))
    indices = [tuple(int(i) for i in row) for row in grid.field_data["b_indices"]]
    for row, cell in zip(grid.cell_data["b_coefficients"], surface.cells, strict=True):
        assert dict(zip(indices, row.tolist(), strict=True)) == {i: float(c) for i, c in cell.b_coefficients.items()}


def test_failures_leave_nothing(tmp_path, monkeypatch):
    surface = two_cells(2)
    with pytest.raises(ValueError, match=r"'a\.vtk'; the suffix must be one of .*\.vtu"):
        write_cells(surface, tmp_path / "a.vtk")
    single = PiecewiseSurface.from_polynomials(pas.SingleCell(), [], 0, ["x^2 + y^2 - 1"])
    with pytest.raises(ValueError, match="the surface has no cells"):
        write_cells(single, tmp_path / "a.vtu")

    class Broken:
        def save(self, path):
            path.write_text("half")
            raise OSError("full disk")

    monkeypatch.setattr(module, "cell_grid", lambda surface: Broken())
    with pytest.raises(OSError, match="full disk"):
        write_cells(surface, tmp_path / "a.vtu")
    assert not list(tmp_path.iterdir())
