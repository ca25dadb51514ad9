"""Meshes of half edges: what splits, flips, collapses, moves and cuts keep and make."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas.mesh.grading import Settings
from pas.mesh.halfedges import HalfEdges, VertexKind, following
from pas.mesh.labelled import Labelled
from pas.mesh.quality import smallest_angles
from pas.mesh.remesher import Remesher
from pas.mesh.topology import Edges, euler_characteristic, fans_of, is_manifold
from pas.surface.graph import rim_numbers
from pas.surface.sheet import open_mesh

TORUS = "(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"
BENT = np.zeros(2, dtype=np.int8)


def torus():
    """A torus whose points are not quite on it, with normals, as half edges of two labels."""
    mesh = pas.Polynomial(TORUS).surface((-2,) * 3, (2,) * 3).mesh(5e-2)
    points = mesh.points + np.random.default_rng(3).normal(scale=0.03, size=mesh.points.shape)
    labels = (points[mesh.triangles].mean(axis=1)[:, 0] > 0).astype(np.intp)
    found = HalfEdges(Labelled.of(points, mesh.triangles, labels), BENT)
    found.normals[:] = mesh.point_normals[found.vertex_of]
    return found


def opened():
    """A corner of three pipes, with three boundary curves."""
    surface = solved(EQUAL, 2).surface
    mesh, field = surface.mesh(2e-2), surface.mesher.radial_field
    points = field.frame.local_points(mesh.points)
    first = open_mesh(field, points, mesh.triangles, rim_numbers(field, points, mesh.triangles))
    found = HalfEdges(first, BENT[:1])
    found.normals[:] = mesh.point_normals
    return found


def check(mesh):
    """What is known of half edges is right."""
    twins, halves = mesh.twins, np.arange(len(mesh.corners))
    inner = np.flatnonzero(twins >= 0)
    assert np.array_equal(twins[twins[inner]], inner)
    assert np.array_equal(mesh.corners[twins[inner]], mesh.ends[inner])
    assert np.array_equal(mesh.corners[following(halves)], mesh.ends)
    assert np.array_equal(mesh.vertex_of[mesh.wedge_of], mesh.corners)
    assert np.array_equal(mesh.face_of[mesh.wedge_of], np.repeat(mesh.labels, 3))
    assert np.array_equal(mesh.corners[mesh.outgoing], np.arange(len(mesh.points)))
    edge = np.zeros(len(mesh.points), dtype=bool)
    edge[mesh.corners[twins < 0]] = True
    assert (twins[mesh.outgoing[edge]] < 0).all()  # the first about a vertex of the boundary is on it
    fresh = HalfEdges(mesh.value, mesh.faces)
    assert np.array_equal(np.where(twins < 0, twins, -1), np.where(fresh.twins < 0, fresh.twins, -1))
    assert np.array_equal(np.minimum(fresh.kinds, 2), np.minimum(mesh.kinds, 2))
    assert is_manifold(mesh.triangles)


def edges_of(mesh, number, seed=1):
    """Some half edges, of different edges."""
    halves = np.arange(len(mesh.corners))
    every = halves[(mesh.twins < 0) | (mesh.twins > halves)]
    return np.random.default_rng(seed).permutation(every)[:number]


def areas(mesh):
    """The vectors across triangles, summed by labels."""
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    return np.array([across[mesh.labels == label].sum(axis=0) for label in np.unique(mesh.labels)])


@pytest.mark.parametrize("make", [torus, opened])
def test_splits_keep_the_mesh(make):
    mesh = make()
    before, euler, size, whole = len(mesh.labels), euler_characteristic(mesh.triangles), len(mesh.points), areas(mesh)
    halves = edges_of(mesh, 10_000)  # all edges, whose triangles are cut again and again
    middles = mesh.middles(np.empty(0, dtype=np.intp), halves)
    open_ = (mesh.twins[halves] < 0).sum()
    mesh.split(halves)
    check(mesh)
    assert len(mesh.points) == size + len(halves)
    assert len(mesh.labels) == before + 2 * len(halves) - open_ == 4 * before
    assert np.array_equal(mesh.points[size:], middles)
    assert euler_characteristic(mesh.triangles) == euler
    assert areas(mesh) == pytest.approx(whole, abs=1e-12)


@pytest.mark.parametrize("make", [torus, opened])
def test_flips_make_angles_larger(make):
    mesh = make()
    rng = np.random.default_rng(4)
    inner = mesh.kinds == VertexKind.INSIDE
    mesh.points[inner] += 0.02 * rng.normal(size=(inner.sum(), 3))
    before, curves = np.percentile(smallest_angles(mesh.points[mesh.triangles]), 5), mesh.on_curves.sum()
    triangles = mesh.triangles.copy()
    mesh.flip()
    check(mesh)
    assert not np.array_equal(mesh.triangles, triangles)
    assert np.percentile(smallest_angles(mesh.points[mesh.triangles]), 5) > before
    assert mesh.on_curves.sum() == curves


@pytest.mark.parametrize("make", [torus, opened])
def test_collapses_keep_topology_and_curves(make):
    mesh = make()
    size, euler, corners = (
        len(mesh.points),
        euler_characteristic(mesh.triangles),
        (mesh.kinds >= VertexKind.CORNER).sum(),
    )
    labels, boundary = set(mesh.labels.tolist()), set((-1 - mesh.twins[mesh.twins < 0]).tolist())
    on_curves = set(map(tuple, mesh.points[mesh.corners[mesh.on_curves]].tolist()))
    for seed in range(6):
        mesh.sizes[:], mesh.plain = 10.0, True
        mesh.collapse(edges_of(mesh, 200, seed), longer=1.3, kept=0.5, off=1e9, flat=(0, 0, 0))
        check(mesh)
    assert len(mesh.points) < 0.8 * size
    assert euler_characteristic(mesh.triangles) == euler
    assert set(mesh.labels.tolist()) == labels
    assert set((-1 - mesh.twins[mesh.twins < 0]).tolist()) == boundary
    assert (mesh.kinds >= VertexKind.CORNER).sum() == corners
    assert set(map(tuple, mesh.points[mesh.corners[mesh.on_curves]].tolist())) < on_curves


@pytest.mark.parametrize("faces", [4, 8])
def test_a_closed_mesh_does_not_collapse_to_nothing(faces):
    """A tetrahedron and an octahedron, whatever their normals say."""
    triangles = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])
    points = np.array([(1.0, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
    if faces == 8:
        points = np.concatenate([np.eye(3), -np.eye(3)])
        triangles = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    mesh = HalfEdges(Labelled.of(points, triangles, np.zeros(faces, dtype=np.intp)), BENT)
    mesh.normals[:], mesh.sizes[:], mesh.plain = points, 10.0, True
    for _ in range(5):
        mesh.collapse(edges_of(mesh, 20), longer=0.0, kept=-2.0, off=1e9, flat=(0, 0, 0))
        check(mesh)
    assert len(mesh.labels) == 4


def test_flips_make_no_edge_between_opposite_sides():
    """Of a thin strip across its ridge: the shorter diagonal is taken where its ends look the same way, roughly."""
    points = np.array([[-3.0, 0, 0], [3, 0, 0], [0, -1, 0], [0, 1, 0]])
    first = Labelled.of(points, np.array([[0, 1, 3], [1, 0, 2]]), np.zeros(2, dtype=np.intp))
    for lean, taken in ((0.5, True), (0.9, True), (1.1, False), (2.0, False)):
        mesh = HalfEdges(first, BENT)
        normals = np.array([[0, 0, 1], [0, 0, 1], [0, -lean, 1], [0, lean, 1]])
        mesh.normals[:] = normals / np.linalg.norm(normals, axis=1)[:, None]
        mesh.flip()
        assert (mesh.triangles != first.triangles).any() == taken


def test_no_edge_is_made_twice():
    """Between the far corners of two slender triangles there may be an edge elsewhere."""
    points = np.array([(-1.0, 0, 0), (1, 0, 0), (0, 0.2, 0), (0, -0.2, 0), (0, 0, 5)])
    triangles = np.array([(0, 1, 2), (1, 0, 3), (2, 3, 4)])
    for number in (2, 3):
        mesh = HalfEdges(Labelled.of(points, triangles[:number], np.zeros(number, dtype=np.intp)), BENT)
        mesh.normals[:] = (0, 0, 1)
        mesh.flip()
        assert np.array_equal(mesh.triangles, triangles[:number]) is (number == 3)


def wanted(points, every, bends, curves, reach, tolerance, settings):
    """How long edges should be: a chord is off its arc by its square over 8 radii; `curves` are bends of curves."""
    sizes = np.minimum(np.sqrt(8 * tolerance / bends), settings.longest * reach)
    sizes = np.minimum(sizes, settings.bent / np.maximum(bends, curves))
    ways = settings.grade * np.linalg.norm(points[every[:, 0]] - points[every[:, 1]], axis=1)
    for _ in range(60):
        for (a, b), way in zip(every.tolist(), ways, strict=True):
            sizes[a], sizes[b] = min(sizes[a], sizes[b] + way), min(sizes[b], sizes[a] + way)
    return sizes


def test_edges_are_as_long_as_the_curvature_lets_them_be():
    surface, settings = solved(EQUAL, 2).surface, Settings()
    field, mesh = surface.mesher.radial_field, opened()
    remesher = Remesher(field, 1e-1, settings)  # so that it matters how the boundary bends
    mesh = remesher.begun(mesh.value)
    remesher._sizes(mesh, 1)
    edges, curves = Edges(mesh.triangles, len(mesh.points)), np.zeros(len(mesh.points))
    before, after = ({int(e[i]): int(e[1 - i]) for e in edges.rim} for i in (1, 0))
    for v in after:
        ways = np.array([mesh.points[v] - mesh.points[before[v]], mesh.points[after[v]] - mesh.points[v]])
        spans = np.linalg.norm(ways, axis=1)
        curves[v] = 2 * np.linalg.norm(ways[1] / spans[1] - ways[0] / spans[0]) / spans.sum()
    given = field.reach, 0.72e-1, settings
    found = wanted(mesh.points, edges.every, field.bending(mesh.points)[1], curves, *given)
    assert mesh.sizes == pytest.approx(found, rel=1e-9)
    assert (found < wanted(mesh.points, edges.every, field.bending(mesh.points)[1], 0 * curves, *given) - 1e-9).any()
    lengths = np.linalg.norm(mesh.points[mesh.corners] - mesh.points[mesh.ends], axis=1)
    means = (mesh.sizes[mesh.corners] + mesh.sizes[mesh.ends]) / 2
    assert mesh.ratios == pytest.approx(lengths / means, rel=1e-12)


def test_vertices_go_to_the_centres_around_or_along_curves():
    mesh = opened()
    mesh.sizes[:] = np.random.default_rng(5).uniform(1, 2, len(mesh.points))
    corners, triangles = mesh.points[mesh.triangles], mesh.triangles
    weights = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weights /= mesh.sizes[triangles].mean(axis=1) ** 2
    total, share = np.zeros_like(mesh.points), np.zeros(len(mesh.points))
    for i in range(3):
        np.add.at(total, triangles[:, i], corners.mean(axis=1) * weights[:, None])
        np.add.at(share, triangles[:, i], weights)
    way = total / share[:, None] - mesh.points
    way -= (way * mesh.normals).sum(axis=1)[:, None] * mesh.normals
    inside, to = mesh.kinds == VertexKind.INSIDE, mesh.targets
    assert to[inside] == pytest.approx((mesh.points + way)[inside], abs=1e-12)
    for a, b in Edges(triangles, len(mesh.points)).rim.tolist():
        c = next(e for s, e in Edges(triangles, len(mesh.points)).rim.tolist() if s == b)
        assert to[b] == pytest.approx((mesh.points[a] + mesh.points[c]) / 4 + mesh.points[b] / 2)


def test_what_would_be_turned_goes_back():
    mesh = torus()
    before = mesh.points.copy()
    to = before + 0.2 * np.random.default_rng(6).normal(size=before.shape)
    least = np.minimum(mesh.cosines, 0.5)
    mesh.settle(to, mesh.normals.copy(), None)
    assert (mesh.cosines >= least - 1e-12).all()
    back = (mesh.points == before).all(axis=1)
    assert 0 < back.sum() < len(before)
    assert np.array_equal(mesh.points[~back], to[~back])


@pytest.mark.parametrize("make", [torus, opened])
@pytest.mark.parametrize("parts", [1, 2, 3, 5])
def test_triangles_are_cut_into_small_ones(make, parts):
    mesh = make()
    cut = mesh.cut(parts)
    check(cut)
    assert np.array_equal(cut.points[: len(mesh.points)], mesh.points)
    assert len(cut.labels) == parts**2 * len(mesh.labels)
    assert euler_characteristic(cut.triangles) == euler_characteristic(mesh.triangles)
    assert np.array_equal(np.bincount(cut.labels), parts**2 * np.bincount(mesh.labels))
    curves = [np.bincount(-1 - m.twins[m.twins < 0]) for m in (cut, mesh)]
    assert np.array_equal(curves[0], parts * curves[1])


def test_points_of_cut_triangles_are_near_the_surface():
    mesh = pas.Polynomial("x^2 + y^2 + z^2 - 1").surface((-2,) * 3, (2,) * 3).mesh(1e-1)
    units = mesh.points / np.linalg.norm(mesh.points, axis=1)[:, None]
    coarse = HalfEdges(Labelled.of(units, mesh.triangles, np.zeros(len(mesh.triangles), dtype=np.intp)), BENT)
    coarse.normals[:] = units
    assert np.linalg.norm(coarse.cut(5).points, axis=1) == pytest.approx(1, abs=2e-2)


@pytest.mark.parametrize("bent", range(64))
def test_ruled_faces_beside_bent_ones_become_fans(bent):
    """An octahedron whose faces are planes but for some, whose edges alone are cut: nothing is folded."""
    points = np.concatenate([np.eye(3), -np.eye(3)])
    triangles = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    labels = np.arange(8)
    faces = np.array([2 * (not bent >> k & 1) for k in range(6)] + [2, 2], dtype=np.int8)
    across = points[triangles].mean(axis=1)
    mesh = HalfEdges(Labelled.of(points, triangles, labels), faces)
    mesh.normals[:] = (across / np.linalg.norm(across, axis=1)[:, None])[mesh.face_of]
    cut = mesh.cut(4)
    check(cut)
    assert np.abs(np.abs(cut.points).sum(axis=1) - 1).max() < 1e-12
    corners = cut.points[cut.triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (area * across[cut.labels]).sum(axis=1).min() > 1e-3
    assert areas(cut) == pytest.approx(areas(mesh), abs=1e-12)


def test_edges_with_three_triangles_and_turned_ones_are_no_manifold():
    book, turned = np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)]), np.array([(0, 1, 2), (0, 1, 3)])
    for triangles in (book, turned):
        assert fans_of(triangles, 5)[0].tolist().count(-2) == len(triangles)
        with pytest.raises(ArithmeticError, match="does not have one or two triangles"):
            HalfEdges(Labelled.of(np.zeros((5, 3)), triangles, np.zeros(len(triangles), dtype=np.intp)), BENT)
    with pytest.raises(ValueError, match="numbers of points"):
        HalfEdges(Labelled.of(np.zeros((3, 3)), np.array([(0, 1, 3)]), np.zeros(1, dtype=np.intp)), BENT)
    with pytest.raises(ValueError, match="numbers of faces"):
        HalfEdges(Labelled.of(np.zeros((3, 3)), np.array([(0, 1, 2)]), np.array([len(BENT)])), BENT)
