"""One mesh: whatever has a surface gives the same type, by the same verb, with what it knows of itself."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas import solid
from pas.mesh.mesh import Mesh
from pas.mesh.quality import smallest_angles
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.nets import extent

PIPES = [pas.Pipe(a, "1/3", 1) for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]


def circle(height: float, radius: float, name: str) -> Boundary:
    return pas.boundary_from(
        {"quadric": f"x^2 + y^2 - {radius}^2", "plane": f"z - {height}", "name": name, "side": -1 if height > 0 else 1}
    )


def neck() -> pas.GeneratrixBlend:
    return pas.generatrix_blend(circle(-2, 2, "wide"), circle(2, 1, "narrow"))


def sphere() -> pas.SphereBlend:
    import runpy

    return runpy.run_path(str(ROOT / "examples/parametric/generatrix/generatrix.py"))["three_pipes"]()


SHAPES = {
    "piecewise": lambda: pas.blend(PIPES, 1).surface,
    "solid": lambda: solid.ball((0, 0, 0), 1) - solid.ball((1, 0, 0), "1/2", "dent"),
    "parametric": lambda: pas.torus(2, 1, angle=True),
    "generatrix": neck,
    "sphere": sphere,
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.sampled(6)
def test_the_same_verb_gives_the_same_type(kind):
    shape = SHAPES[kind]()
    coarse, fine = shape.mesh(0.05), shape.mesh(tolerance=0.01)
    for mesh, tolerance in ((coarse, 0.05), (fine, 0.01)):
        assert isinstance(mesh, Mesh)
        assert mesh.is_manifold and mesh.is_closed == (kind in ("solid", "parametric"))
        assert 0 < mesh.deviation <= tolerance
        assert mesh.normals.shape == (len(mesh.triangles), 3, 3)
        assert mesh.faces.max() == len(mesh.names) - 1 and len(mesh.faces) == len(mesh.triangles)
        facets = np.cross(*(mesh.points[mesh.triangles[:, i]] - mesh.points[mesh.triangles[:, 0]] for i in (1, 2)))
        assert (np.einsum("tcx,tx->tc", mesh.normals, facets) > 0).mean() > 0.999
        data = mesh.to_pyvista()
        assert data.n_cells == len(mesh.triangles) and data.point_data.active_normals is not None
        assert ("parameters" in data.point_data) == (mesh.parameters is not None)
        assert len(mesh.to_trimesh().faces) == len(mesh.triangles)
    assert len(fine.triangles) > len(coarse.triangles)
    assert repr(coarse).startswith(f"<Mesh: {len(coarse.points)} points, {len(coarse.triangles)} triangles, ")
    assert len(repr(coarse)) < 100 and "within" in str(coarse)


@pytest.mark.parametrize("kind", ["generatrix", pytest.param("sphere", marks=pytest.mark.slow)])
def test_blends_by_a_generatrix_are_within_the_tolerance(kind):
    """Points of the blend are no further from the mesh than the deviation says (and some nearly as far)."""
    from scipy.spatial import cKDTree

    shape = SHAPES[kind]()
    mesh = shape.mesh(0.02)
    places = np.random.default_rng(1).random((100, 2))
    parts = [shape] if kind == "generatrix" else shape.blends
    points = np.concatenate([part.surface(places) for part in parts])
    tree = cKDTree(mesh.points[mesh.triangles].mean(axis=1))
    near = tree.query(points, 40)[1]
    corners = mesh.points[mesh.triangles[near]] - points[:, None, None]
    far = np.array([min(distance(*triangle) for triangle in group) for group in corners]).max()
    assert far <= 1.05 * mesh.deviation
    if kind == "sphere":
        on = np.linalg.norm(mesh.points[mesh.triangles[mesh.faces == 3]].mean(axis=1) - shape.center, axis=1)
        assert mesh.names == ("blend 1", "blend 2", "blend 3", "sphere")
        assert 0 < (shape.radius - on).max() <= mesh.deviation


def distance(a, b, c) -> float:
    """Of the origin from a triangle."""
    normal = np.cross(b - a, c - a)
    square = float(normal @ normal)
    weights = [float(np.cross(p, q) @ normal) / square for p, q in ((b, c), (c, a), (a, b))]
    if min(weights) >= 0:
        return abs(float(a @ normal)) / square**0.5
    shares = ((p, q - p, np.clip(-(p @ (q - p)) / ((q - p) @ (q - p)), 0, 1)) for p, q in ((a, b), (b, c), (c, a)))
    return min(float(np.linalg.norm(p + t * d)) for p, d, t in shares)


def test_a_grid_is_asked_for_by_its_size():
    blend = neck()
    assert blend.mesh().deviation is None and len(blend.mesh().points) == 100 * 100
    with pytest.raises(TypeError, match=r"a grid is given as size=\(30, 10\)"):
        blend.mesh((30, 10))
    with pytest.raises(ValueError, match="tolerance and size are two ways"):
        blend.mesh(0.1, size=(30, 10))
    with pytest.raises(TypeError, match=r"size=\(30, 10\)"):
        sphere().mesh((30, 10))


@pytest.mark.slow
def test_a_blend_whose_surface_is_turned_keeps_its_normals():
    blend = neck()
    turned = pas.generatrix_blend(*(circle(*data) for data in ((2, 1, "narrow"), (-2, 2, "wide"))))
    for made in (blend, turned):
        by_grid, by_tolerance = made.mesh(size=(60, 30)), made.mesh(0.01)
        outward = [(m.point_normals[:, :2] * m.points[:, :2]).sum() for m in (by_grid, by_tolerance)]
        assert np.sign(outward[0]) == np.sign(outward[1])
        assert by_tolerance.is_manifold


@pytest.mark.parametrize("factor", [1, 1000])
def test_the_default_tolerance_is_a_share_of_the_size(factor):
    pipes = [pas.Pipe(a, f"{factor}/3", factor) for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    mesh = pas.blend(pipes, 1, energy=pas.ThinPlate()).surface.mesh()
    assert 1e-4 < mesh.deviation / extent_of(mesh) < 2e-3
    torus = pas.torus(2 * factor, factor, angle=True)
    assert torus.mesh().deviation <= 1e-3 * extent(torus)[1]


def extent_of(mesh: Mesh) -> float:
    return float(np.ptp(mesh.points, axis=0).max())


def test_old_names_are_the_same():
    assert pas.Mesh is pas.ParametricMesh is solid.SolidMesh is Mesh
    surface = pas.blend(PIPES, 1, energy=pas.ThinPlate()).surface
    assert np.array_equal(surface.triangulate(0.02).points, surface.mesh(0.02).points)
    square = pas.plane().mesh(1, ((0, 1), (0, 1)))
    assert square.proved and square.certified


def test_open_meshes_say_what_they_are():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    up = np.broadcast_to([0.0, 0, 1], (2, 3, 3))
    mesh = Mesh(points, np.array([[0, 1, 2], [2, 1, 3]]), np.array([0, 1]), ("a", "b"), up)
    assert repr(mesh) == "<Mesh: 4 points, 2 triangles, 2 faces, open>"
    assert np.sort(mesh.feature_edges, axis=1).tolist() == [[1, 2]]
    assert mesh.euler_characteristic == 1 and mesh.components == 1 and len(mesh.boundary) == 4
    assert mesh.face_areas == {"a": 0.5, "b": 0.5}
    assert mesh.flipped.flipped.triangles.tolist() == mesh.triangles.tolist()
    assert (mesh.flipped.point_normals == [0, 0, -1]).all()
    assert len(mesh.shading[0]) == 4
    with pytest.raises(pas.GeometryError, match="open"):
        _ = mesh.volume


def test_sharp_edges_double_points_and_their_parameters():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    mesh = Mesh.from_triangles(points, triangles)
    assert len(mesh.shading[0]) == 12 and mesh.volume == pytest.approx(1 / 6)
    assert np.array_equal(points[mesh.shading_points], mesh.shading[0])
    assert len(mesh.smoothed.shading[0]) == 4
    assert mesh.mesh(0.1) is mesh and mesh.box.tolist() == [[0, 0, 0], [1, 1, 1]]


def test_smooth_meshes_have_the_normals_of_their_points():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    normals = np.array([[0.0, 0, 1], [0, 0.6, 0.8], [0.6, 0, 0.8]])
    mesh = pas.Mesh.smooth(points, np.array([[0, 1, 2]]), normals, deviation=0.5)
    assert mesh.deviation == 0.5 and mesh.smoothed is mesh
    for one in (mesh, copy.copy(mesh), pickle.loads(pickle.dumps(mesh)), replace(mesh, deviation=None)):
        assert (one.normals == normals[None]).all() and (one.point_normals == normals).all()
        assert (one.flipped.normals == -normals[None, ::-1]).all() and (one.flipped.point_normals == -normals).all()
    with pytest.raises(AttributeError, match="a mesh has no 'nothing'"):
        _ = mesh.nothing


def polynomial(text, size):
    return pas.Polynomial(text).surface((-size,) * 3, (size,) * 3)


TRADED = {
    "graph over directions": lambda: pas.blend(PIPES, 1).surface,
    "blend": lambda: pas.blend(PIPES, 1),
    "hollow blend": lambda: pas.blend(PIPES, 1).hollow("1/20"),
    "from a lattice": lambda: polynomial("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)", 2),
    "ends at walls": lambda: polynomial("z - x^2 + y^2", 1),
}


@pytest.mark.parametrize("name", TRADED)
@pytest.mark.sampled(4)
def test_surfaces_have_meshes_with_good_angles_or_few_triangles(name):
    shape, tolerance = TRADED[name](), 3e-3
    angles, usual, count = (shape.mesh(tolerance, quality=q) for q in ("angles", "balanced", "count"))
    assert len(count.triangles) < 0.9 * len(usual.triangles)
    if name != "hollow blend":  # each of its sides has a best mesh, and the rings between them are what they are
        worst = [smallest_angles(mesh.points[mesh.triangles]).min() for mesh in (angles, usual, count)]
        assert worst[0] >= worst[1] and worst[0] > worst[2]
    assert all(mesh.is_manifold for mesh in (angles, usual, count))
    assert max(mesh.deviation for mesh in (angles, usual, count)) <= tolerance
    assert np.array_equal(usual.points, shape.mesh(tolerance).points)
    with pytest.raises(ValueError, match="quality must be one of 'angles', 'balanced', 'count', not 'good'"):
        shape.mesh(tolerance, quality="good")


def test_the_smallest_angles_of_triangles():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [3**0.5, 0, 0], [0, 0, 1]]], dtype=float)
    assert np.allclose(np.degrees(smallest_angles(corners)), [45, 30])
