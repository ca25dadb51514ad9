"""Lattices of solids: fine only where they must be, fitting together, and none of the boundary lost."""

from functools import reduce

import numpy as np
import pytest

import pas
from pas import solid
from pas.errors import MeshError
from pas.mesh.faces import BoundaryCrossings
from pas.mesh.octree import BASE, QUIET, Octree
from pas.mesh.projection import cosines
from pas.mesh.topology import is_closed_manifold
from pas.solid.functions import Pieces
from pas.solid.taylor import TaylorForms
from pas.surface.geometry import derivative_batch

BALL = solid.ball((0, 0, 0), 1)
CUP = BALL - solid.ball((0, 0, 1), "1/2")


def octree(shape, parts=12):
    return Octree(shape.field, float(np.ptp(shape.field.box, axis=0).max()) / parts)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(6))
def test_tetrahedra_fit_together_wherever_cubes_are_halved(seed):
    rng = np.random.default_rng(seed)
    shape = (BALL, CUP, solid.box((0, 0, 0), (1, 2, "1/3")))[seed % 3]
    lattice = octree(shape)
    crossings = BoundaryCrossings(shape.field, *lattice.tetrahedra())
    for _ in range(4):
        lattice = lattice.refined(crossings.nodes[crossings.edges[rng.integers(len(crossings.edges), size=3), 0]])
        crossings = BoundaryCrossings(shape.field, *lattice.tetrahedra())
        assert is_closed_manifold(crossings.triangles)
        assert crossings.shape == (1, 2)
    points, tets = lattice.tetrahedra()
    corners = points[tets]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    sizes = np.round(np.log2(volume / volume.max()))
    assert volume.min() > 0
    assert len(np.unique(sizes)) > 4  # graded
    faces = np.sort(tets[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3), axis=1)
    assert np.unique(faces, axis=0, return_counts=True)[1].max() == 2


def test_tetrahedra_overlap_nowhere():
    lattice = octree(CUP).refined(np.array([[0.9, 0.0, 0.0]])).refined(np.array([[0.9, 0.01, 0.0]]))
    points, tets = lattice.tetrahedra()
    corners = points[tets]
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    for p in np.array([0.9, 0.0, 0.0]) + 0.2 * np.random.default_rng(0).random((40, 3)) - 0.1:
        weights = np.einsum("tij,tj->ti", inverse, p - corners[:, 0])
        inside = (weights > 1e-9).all(axis=1) & (weights.sum(axis=1) < 1 - 1e-9)
        assert inside.sum() <= 1


def test_one_sheet_is_proved_and_two_are_not():
    assert octree(BALL, 25).open_share == 0
    assert octree(solid.torus((0, 0, 0), (0, 0, 1), 1, "1/2"), 25).open_share == 0
    thin = octree(BALL - solid.ball((0, 0, 0), "24/25"), 25)
    assert thin.open_share > 0.5
    finer = thin.refined().refined()
    assert finer.levels == BASE + 2


@pytest.mark.slow
def test_only_thin_places_are_refined():
    shape = BALL - solid.ball((0, 0, "3/10"), "69/100")  # the wall is 1/100 thick at the top, 61/100 at the bottom
    mesh = shape.mesh(3e-2)
    assert (mesh.components, mesh.euler_characteristic) == (2, 4)
    sides = mesh.points[mesh.triangles] - mesh.points[np.roll(mesh.triangles, 1, axis=1)]
    length = np.sqrt((sides**2).sum(axis=2)).mean(axis=1)
    height = mesh.points[mesh.triangles].mean(axis=1)[:, 2]
    assert length[height > 0.95].mean() < 0.4 * length[height < 0].mean()


def test_where_patches_share_a_wall_inside_nothing_is_crossed():
    shape = solid.patch("left", "x^2+y^2+z^2-1", "-x") | solid.patch("right", "x^2+y^2+z^2-1", "x")
    center = shape.field.evaluator.local(np.zeros((1, 3)))
    assert not shape.field.crossed(center, 0.2)[0]
    assert shape.field.crossed(shape.field.evaluator.local(np.array([[0.0, 1.0, 0.0]])), 0.2)[0]


def test_faces_turn_at_most_as_much_as_is_said():
    rng = np.random.default_rng(1)
    texts = ("x", "x*y - z", "x^2 + y^2 - z", "x^4 - 3*x*y*z + z^3 - 1/2")
    polynomials = [pas.Polynomial(t) for t in texts]
    bank, jets = TaylorForms(polynomials), derivative_batch([p.dense(max(p.degree, 0)) for p in polynomials], (0, 1))
    centers, half = rng.uniform(-1, 1, (50, 3)), np.array([[0.1, 0.2, 0.05]])
    gradients, changes = bank.slopes(np.arange(4), centers, half)
    inside = centers + half * rng.uniform(-1, 1, (50, 3))
    for k in range(4):
        there = jets(inside, np.full(50, k))[:, 1:]
        assert (np.abs(there - gradients[k]) <= changes[k] + 1e-12).all()
    assert np.abs(changes[0]).max() == 0
    assert np.abs(jets(centers, np.full(50, 2))[:, 1:] - gradients[2]).max() < 1e-14


def test_ranges_in_boxes_hold_all_values_and_see_that_blends_touch_their_walls():
    rng = np.random.default_rng(2)
    texts = (
        "z - 1/3",
        "x*y - z",
        "(z - 1/5)^2*(x^2 + y^2) + z^4/50",
        "x^6 - 3*x*y*z + z^3 - 1/2",
        "(x - 1/10)^3 + y^5",
    )
    bank = TaylorForms([pas.Polynomial(t) for t in texts])
    centers, halves = rng.uniform(-1, 1, (400, 3)), rng.uniform(0.05, 0.3, (400, 3))
    yes, no = bank.taylor(centers, halves)
    for shift in rng.uniform(-1, 1, (200, 3)):
        values = bank.values(centers + shift * halves, np.arange(len(bank)))
        assert not (yes & (values > 0)).any()
        assert not (no & (values <= 0)).any()
    beside = np.array([[1.0, 0.3, 0.31]])  # where the third would have a double zero just below, but for a little
    assert bank.taylor(beside, np.full((1, 3), 0.1))[1][2, 0]


def test_pieces_turn_at_most_as_much_as_is_said():
    vertices = [(0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, 0, 1)]
    partition = pas.Partition(vertices, [(0, 1, 3, 4), (0, 2, 3, 4)])
    left = pas.Polynomial("x^2 + y^2 + z^2 - 1/4")
    pieces = Pieces(partition, [left, left + pas.Polynomial("3*x")])
    centers, halves = np.array([[0.02, 0.1, 0.1], [0.3, 0.1, 0.1]]), np.full((2, 3), 0.05)
    gradients, changes = pieces.slopes(centers, halves)
    for p in (centers + halves, centers - halves, centers + halves * [1, -1, 1]):
        assert (np.abs(pieces.jets(p)[:, 1:] - gradients) <= changes + 1e-12).all()
    assert changes[0, 0] > 1.5 / 2  # both pieces are met, over the power of two that scales them
    assert changes[1] == pytest.approx(np.full(3, 0.1 / 2))


def test_flat_faces_have_few_triangles():
    assert len(solid.box((0, 0, 0), (1, 2, 3)).mesh(1e-3).triangles) == 12
    drilled = solid.box((0, 0, 0), (1, 2, 3)) - solid.box(("1/3", "1/3", -1), ("2/3", 1, 4))
    mesh = drilled.mesh(1e-3)
    assert (mesh.is_closed, mesh.euler_characteristic) == (True, 0)
    assert mesh.volume == pytest.approx(6 - 2 / 3)
    assert len(mesh.triangles) < 500


def test_thin_things_are_found():
    needle = solid.cylinder((0, 0, 0), (0, 0, 1), "3/1000")
    mesh = needle.mesh(1e-4)
    assert (mesh.components, mesh.euler_characteristic) == (1, 2)
    assert mesh.volume == pytest.approx(np.pi * 9e-6, rel=5e-2)
    plate = solid.box((0, 0, 0), (1, 1, "1/100"))
    assert plate.mesh().volume == pytest.approx(1e-2)
    spiked = BALL | solid.cylinder((0, 0, 0), (0, 0, "7/5"), "1/60")
    mesh = spiked.mesh(1e-3)
    assert mesh.points[:, 2].max() == pytest.approx(1.4)
    assert (mesh.components, mesh.euler_characteristic) == (1, 2)


def test_nothing_is_folded_after_refinement():
    first = solid.cylinder((-2, 0, 0), (2, 0, 0), 1)
    both = first & solid.cylinder((0, -2, 0), (0, 2, 0), 1)  # the curves between the faces cross in two points
    for tolerance in (1e-3, 2e-4):
        assert cosines(both.face_mesh(tolerance).mesh, both.field).min() > 0.5
    assert both.area(2e-4) == pytest.approx(16, rel=1e-6)


@pytest.mark.parametrize("parts", [18, 20, 22, 25])
def test_merging_crossings_keeps_the_topology_and_most_merge(parts):
    ring = solid.torus((0, 0, 0), (0, 0, 1), 1, "1/20")  # such lattices show it as beads
    plate = solid.box((-1, -1, "-1/20"), (1, 1, "1/20")) - solid.cylinder((0, 0, -1), (0, 0, 1), "1/20")
    for shape in (ring, plate):
        crossings = BoundaryCrossings(shape.field, *octree(shape, parts).tetrahedra())
        points, triangles, _ = crossings._merged()
        assert is_closed_manifold(triangles)
        assert len(points) - len(triangles) // 2 == crossings.shape[1]
    assert len(points) < 0.85 * len(crossings.edges)


def test_what_is_too_thin_is_refused_soon():
    bowl = BALL.cap("z") - solid.ball((0, 0, 0), "999/1000")
    with pytest.raises(MeshError, match="too thin for its size"):
        bowl.mesh()


def test_all_of_many_holes_are_shown():
    holes = [solid.cylinder((x, y, -1), (x, y, 1), "1/50") for x in (-0.5, 0, 0.5) for y in (-0.5, 0, 0.5)]
    plate = solid.box((-1, -1, "-1/20"), (1, 1, "1/20")) - reduce(lambda a, b: a | b, holes)
    mesh = plate.mesh(1e-3)
    assert (mesh.components, mesh.euler_characteristic) == (1, 2 - 2 * 9)
    assert octree(plate).refined(least=QUIET).levels > BASE
