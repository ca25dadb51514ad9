"""First meshes of surfaces in boxes: from the first lattice where merging would close a neck; no rays in vain."""

from __future__ import annotations

import numpy as np
import pytest

import pas
from pas.mesh.contour import crossings, knotted
from pas.surface.meshing import around_centre
from pas.verdicts import Status

NECK = "x^2 + 2*y^2 - z^2 - 1/4 + x/7"


def boxed(text: str, half: int = 1) -> pas.PiecewiseSurface:
    return pas.Polynomial(text).surface([-half] * 3, [half] * 3)


def test_a_neck_around_a_node_is_meshed_from_a_coarse_lattice():
    """All crossings around the node in the middle of the neck would merge, and pinch it."""
    surface = boxed(NECK)
    beginnings = surface.mesher.beginnings
    first = next(mesh for mesh, _ in beginnings if not isinstance(mesh, ArithmeticError))
    assert len(first.triangles) < 700  # the third lattice has 2814; in the first one nodes are on the surface
    mesh = surface.mesh(2e-3)
    assert all(v.status in (Status.PROVED, Status.HOLDS_MEASURED) for v in mesh.certificate.verdicts)
    assert mesh.euler_characteristic == 0


def test_crossings_that_are_no_disc_are_told_from_those_that_are():
    """All crossings around a node are a sphere; without one triangle, a disc; those far from it do not merge."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, -1, -1)])
    tetrahedra = np.array([(0, 1, 2, 3), (0, 1, 2, 4), (0, 1, 3, 4), (0, 2, 3, 4)])
    edges, triangles = crossings(np.arange(5) == 0, tetrahedra)
    near = np.where(edges[:, 0] == 0, 0.1, 0.9)
    assert knotted(triangles, edges, near, 0.42, len(corners)).tolist() == [True, False, False, False, False]
    assert not knotted(triangles, edges, near, 0.05, len(corners)).any()
    some = triangles[1:]  # without one of them a disc is left
    assert not knotted(some, edges, near, 0.42, len(corners)).any()


@pytest.mark.parametrize(
    ("text", "is_one"), [("x^2 + y^2 + z^2 - 1/2", True), (NECK, False), ("z - x^2 - y^2 - 1/4", False)]
)
def test_only_what_is_outside_in_the_middle_of_all_walls_is_looked_at_from_the_centre(text, is_one):
    assert around_centre(boxed(text)) is is_one
    assert (boxed(text).mesher.radial_field is not None) is is_one


def test_ways_onto_walls_and_edges_are_pseudoinverses():
    """In a box and in an oblique tetrahedron."""
    corners = [(0, 0, 0), (2, 0, 0), (1, 2, 0), (1, 1, 3), (1, 1, 1)]
    oblique = pas.Partition(corners, [(0, 1, 2, 4), (0, 1, 3, 4), (0, 2, 3, 4), (1, 2, 3, 4)], center=(1, 1, 1))
    for surface in (boxed(NECK), pas.PiecewiseSurface(oblique, [], 1, [pas.Polynomial("z - 1/2 - x/9")] * 4)):
        planes, across, back = surface.mesher.cell_field._planes
        for row, wanted in enumerate(np.linalg.pinv(planes[:, :, :3])):
            assert np.allclose(back[row].T, wanted, atol=1e-14)
            flat = across[row][np.abs(across[row]).sum(axis=1) > 0]
            assert np.allclose(flat @ flat.T, np.eye(len(flat)), atol=1e-14)
            assert np.allclose(wanted @ planes[row, :, :3], flat.T @ flat, atol=1e-14)
