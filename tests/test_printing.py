"""What goes to the printer is sound: files read back and judged by libigl with exact arithmetic."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from conftest import UNEQUAL, fair
from igl.copyleft import cgal

import pas
from pas import solid
from pas.designs.teapot import teapot


def corner(order: int) -> solid.Solid:
    return fair(UNEQUAL, order).solid("1/2")


SOLIDS = {
    "paper teapot": lambda: teapot("paper").solid,
    "better teapot": lambda: teapot("better").solid,
    "lid": lambda: teapot("better").lid,
    "corner": lambda: corner(2),
    "hollow corner": lambda: corner(1).shell(0.08, open=[f"neighbour {i} end" for i in (1, 2, 3)]),
    "coil": lambda: solid.tube(("cos(t)", "sin(t)", "t/5"), "1/8", (0, 12)),
    "steinmetz": lambda: solid.cylinder((-2, 0, 0), (2, 0, 0), 1) & solid.cylinder((0, -2, 0), (0, 2, 0), 1),
}


def intersecting(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The pairs of triangles (N, 2) that cross, by exact predicates."""
    found = cgal.remesh_self_intersections(
        np.ascontiguousarray(points, dtype=float), np.ascontiguousarray(triangles, dtype=np.int64), detect_only=True
    )
    return found[2]


SLOW = ("paper teapot", "better teapot", "lid", "hollow corner")


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in SOLIDS])
@pytest.mark.sampled(3)
def test_files_for_printing_are_sound(name, tmp_path):
    mesh = SOLIDS[name]().mesh()
    path = pas.write_solid(mesh, tmp_path / "part.stl")
    read = meshio.read(path)
    points, inverse = np.unique(read.points, axis=0, return_inverse=True)
    triangles = inverse.reshape(-1)[read.cells_dict["triangle"]]
    assert len(triangles) == len(mesh.triangles)
    assert len(points) == len(mesh.points)  # no two vertices became one in single precision
    assert solid.SolidMesh.from_triangles(points, triangles).is_closed
    assert len(intersecting(points, triangles)) == 0
    p = points[triangles].astype(float)
    double_area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    longest = np.max([np.linalg.norm(p[:, i] - p[:, i - 1], axis=1) for i in range(3)], axis=0)
    assert (double_area > 1e-2 * longest**2).all()


def test_the_check_finds_crossings():
    ball = solid.ball((0, 0, 0), 1).mesh(0.1)
    both = np.concatenate([ball.points, ball.points + [0.5, 0, 0]])
    triangles = np.concatenate([ball.triangles, ball.triangles + len(ball.points)])
    assert len(intersecting(both, triangles)) > 10
