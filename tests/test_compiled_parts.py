"""Parts of meshing and of proofs of meshes in compiled code: what they should be."""

from __future__ import annotations

from math import factorial, prod

import numpy as np
import pytest
from conftest import EQUAL, solved
from halving import halving

import pas
from pas.algebra.monomials import homogeneous_exponents
from pas.bernstein.search import Fate
from pas.bernstein.simplices import Simplices, bisection, edges, means, raised
from pas.certify.graph_proofs import crossed
from pas.certify.local_mesh import isolated
from pas.mesh import topology
from pas.mesh.topology import Edges, is_manifold, piece_count, same_places
from pas.surface.lattice import Subdivision, eighths, risings
from pas.surface.local_field import LocalField

TORUS = "(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"
BOWL = "x^2 + 2*y^2 - z^2 - 1/4 + x/7"


def same(found):
    """Whether two sequences of arrays and numbers are the same bits."""
    assert len(found[0]) == len(found[1]) > 0
    return all(np.array_equal(a, b) for a, b in zip(*found, strict=True))


def values(forms, degree, weights):
    """Those of B-forms (T, m) at barycentric coordinates (N, v), (T, N)."""
    indices = homogeneous_exponents(degree, weights.shape[1])
    basis = [factorial(degree) / prod(map(factorial, a)) * np.prod(weights ** np.array(a), axis=1) for a in indices]
    return forms @ np.array(basis)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 6, 9])
def test_eighths_have_the_values_of_the_whole(degree):
    rng = np.random.default_rng(degree)
    corners, parts = eighths(degree)
    forms = rng.normal(size=(3, len(homogeneous_exponents(degree, 4))))
    weights = rng.dirichlet(np.ones(4), size=20)
    for part, own in zip(corners, parts(forms), strict=True):
        assert values(own, degree, weights) == pytest.approx(values(forms, degree, weights @ part / 2), abs=1e-13)


@pytest.mark.parametrize("vertices", [2, 3, 4])
@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 6])
def test_bisections_are_those_by_matrices(degree, vertices):
    forms = np.random.default_rng(degree).normal(size=(4, len(homogeneous_exponents(degree, vertices))))
    for edge, cut in enumerate(bisection(degree, vertices)):
        for matrix, own in zip(halving(degree, vertices, edge), cut(forms), strict=True):
            assert own == pytest.approx(forms @ matrix.T, abs=1e-14)
    assert len(bisection(degree, vertices)) == len(edges(vertices))


def test_means_of_whole_numbers_are_exact():
    forms = np.random.default_rng(1).integers(-1000, 1000, size=(2, 35)).astype(float) * 2.0**20
    cut = means(4, [[(2, 0, 0, 0), (1, 1, 0, 0), (1, 0, 1, 0), (1, 0, 0, 1)]])
    assert (cut(forms) == np.round(cut(forms))).all()
    assert (cut(forms)[0, :, 0] == forms[:, 0]).all()


def test_tetrahedra_are_cut_where_zeros_may_be():
    surface = pas.Polynomial(TORUS).surface((-2,) * 3, (2,) * 3)
    cells = Subdivision(surface.mesher.cell_field)
    whole = np.abs(np.linalg.det(cells.points[:, 1:] - cells.points[:, :1])).min()
    for _ in range(3):
        cells.halve()
    places, hidden = cells.bent()
    assert len(cells.keys) > 500 and not hidden
    assert 0 < len(places) < len(cells.keys)
    volumes = np.abs(np.linalg.det(cells.points[:, 1:] - cells.points[:, :1]))
    assert volumes.min() == pytest.approx(whole / 8**3)
    points, values, tetrahedra = cells.lattice
    corners = values[tetrahedra]
    assert (corners.min(axis=1) < 0).all() and (corners.max(axis=1) > 0).all()
    assert values == pytest.approx(surface.mesher.cell_field.values(points), abs=1e-12)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_risings_are_products_with_the_mean_gradient(degree):
    rng = np.random.default_rng(degree)
    corners, forms = rng.normal(size=(50, 4, 3)), rng.normal(size=(50, len(homogeneous_exponents(degree, 4))))
    up = raised(degree, 4)
    steps = forms[:, up[:, 1:]] - forms[:, up[:, :1]]
    gradients = steps @ np.linalg.inv(corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    mean, least, size = risings(forms, corners, degree)
    factor = (mean * gradients.mean(axis=1)).sum(axis=1) / (gradients.mean(axis=1) ** 2).sum(axis=1)
    assert (factor > 0).all()
    assert mean == pytest.approx(factor[:, None] * gradients.mean(axis=1), rel=1e-9, abs=1e-9)
    along = np.einsum("tmx,tx->tm", gradients, gradients.mean(axis=1)).min(axis=1)
    squares = (gradients**2).sum(axis=2).max(axis=1)
    assert least / size == pytest.approx(along / squares, rel=1e-9)


def test_parts_that_are_kept_hold_all_critical_points():
    stage = pas.Polynomial(BOWL).surface((-1,) * 3, (1,) * 3).framed
    found = [isolated(forms / stage.size, at, stage.cell_forms[1]) for forms, at in stage.strata]
    assert not any(len(some.open) for some in found)
    solid, _, _, ends = (some.kept.corners for some in found)
    assert len(ends) == 8  # the corners of the box
    critical = (np.array([-1 / 14, 0, 0]) - stage.origin) / stage.scale
    assert ((solid.min(axis=1) <= critical) & (critical <= solid.max(axis=1))).all(axis=1).any()
    assert np.abs(solid - critical).max() <= 0.5


@pytest.mark.parametrize("vertices", [2, 3, 4])
@pytest.mark.parametrize("degree", [2, 5])
def test_simplices_are_halved_and_dropped_or_kept_as_by_matrices(degree, vertices):
    """Halves along which the derivative in one direction is surely positive are dropped."""
    rng, indices, bound = np.random.default_rng(degree), np.array(homogeneous_exponents(degree, vertices)), 0.05
    forms, corners = 0.2 * rng.normal(size=(400, len(indices))), rng.normal(size=(400, vertices, 3))
    forms += 0.3 * rng.normal(size=(400, vertices)) @ indices.T / degree + 0.3 * rng.normal(size=(400, 1))
    parts, halves = Simplices.of([forms], corners, bound / 2).halved(), ([], [])
    fates, bound = parts.rising(), parts.bound
    for form, simplex in zip(forms, corners, strict=True):
        spans = [np.linalg.norm(simplex[a] - simplex[b]) for a, b in edges(vertices)]
        longest = int(np.argmax(spans))
        a, b = edges(vertices)[longest]
        for moved, matrix in zip((b, a), halving(degree, vertices, longest), strict=True):
            part, places, up = matrix @ form, simplex.copy(), raised(degree, vertices)
            places[moved] = (simplex[a] + simplex[b]) / 2
            ways, steps = places[1:] - places[0], part[up[:, 1:]] - part[up[:, :1]]
            direction = np.linalg.solve(ways @ ways.T, steps.mean(axis=0))
            if (steps @ direction).min() <= 2 * bound * np.abs(direction).sum():
                halves[int(max(part.min(), -part.max()) > bound)].append((part, places))
    kept = fates == Fate.KEEP
    for chosen, expected in zip((~kept & (fates != Fate.SETTLED), kept), halves, strict=True):
        own, at = parts.table[chosen], parts.corners[chosen]
        assert 10 < len(own) == len(expected) < 700
        assert own == pytest.approx(np.array([part for part, _ in expected]), abs=1e-12)
        assert np.array_equal(at, [places for _, places in expected])


def test_places_where_nothing_but_rounding_is_left_are_not_cut_further():
    stage = pas.Polynomial("z - x^2 - y^2").surface((-1,) * 3, (1,) * 3).framed  # tangential to four edges of the box
    places = [(1, 0, 1), (-1, 0, 1), (0, 1, 1), (0, -1, 1)]

    found = [isolated(forms / stage.size, at, stage.cell_forms[1]) for forms, at in stage.strata]
    _, _, sides, ends = (some.open.corners for some in found)
    off = np.linalg.norm(stage.frame.global_points(sides.mean(axis=1))[:, None] - places, axis=2)
    assert not len(ends)
    assert off.min(axis=1).max() < 1e-6
    assert off.min(axis=0).max() < 1e-6
    assert sum(some.examined for some in found) < 1000  # 20,000 when they are


def test_windings_are_those_of_the_inside():
    mesh = pas.Polynomial(TORUS).surface((-2,) * 3, (2,) * 3).mesh(2e-2)
    rng = np.random.default_rng(5)
    ends = np.concatenate([rng.uniform(-2, 2, (200, 3)), mesh.points[:20]])
    origin = np.array([0.01, 0.02, 0.03])
    times, known = crossed(mesh.points, mesh.triangles, origin, ends)
    inside = heights(ends[:200]) < 0
    sure = known[:200] & (np.abs(heights(ends[:200])) > 0.3)
    assert known[:200].sum() > 190
    assert 5 < inside[sure].sum() < sure.sum() - 100
    assert (times[:200][sure] == -inside[sure].astype(int)).all()
    assert not known[200:].any()  # vertices are on the mesh


def heights(points):
    """The values (N,) of the torus' function."""
    x, y, z = points.T
    return (x * x + y * y + z * z + 3 / 4) ** 2 - 4 * (x * x + y * y)


STRIP = np.array([(0, 1, 2), (1, 3, 2), (2, 3, 4)])


@pytest.mark.parametrize(
    ("triangles", "good", "pieces"),
    [
        (STRIP, True, 1),
        (np.array([(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)]), True, 1),
        (np.array([(0, 1, 2), (2, 3, 4)]), False, 1),  # two fans
        (np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)]), False, 1),  # three triangles
        (np.concatenate([STRIP, STRIP + 7]), True, 2),
        (np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 5, 6), (0, 6, 7)]), False, 1),
        (np.empty((0, 3), dtype=int), False, 0),
    ],
)
def test_manifolds_and_pieces(triangles, good, pieces):
    assert (is_manifold(triangles), piece_count(triangles)) == (good, pieces)


def test_places_that_are_the_same():
    points = np.random.default_rng(2).integers(-2, 3, size=(400, 3)) * 0.1
    points[::7] *= -1  # zeros of either sign
    first, place = same_places(points)
    assert np.array_equal(points[first][place], points)
    assert len(first) == len(np.unique(points + 0.0, axis=0))


def test_points_of_simple_fractions_have_keys_of_their_own(monkeypatch):
    """All that is known of them are the first bits of their doubles; where keys are the same, all rows are sorted."""
    points = np.stack(np.meshgrid(*[np.arange(-8, 9) / 8] * 3), axis=-1).reshape(-1, 3)
    made = []
    monkeypatch.setattr(topology, "first_with", lambda keys, at: made.append(keys) or (None, None))
    same_places(points)
    assert len(np.unique(made[0])) == len(points)


def noisy(field, mesh, scale=0.02):
    """A mesh's points in a field's coordinates, and the same moved off the surface."""
    local = field.frame.local_points(mesh.points)
    return local, local + np.random.default_rng(4).normal(scale=scale, size=local.shape)


def off_rim(field, curve, point):
    """How far one point is from a curve on which a surface ends, in its plane or on a line of two planes."""
    if not isinstance(curve, np.ndarray):
        return curve.distances(point[None])[0]
    value, *slope = field.jets(point[None])[0]
    across = np.linalg.qr(curve[:, :3].T)[0]
    return abs(value) / np.linalg.norm(slope - across @ (across.T @ slope))


@pytest.mark.parametrize("name", ["corner", "torus"])
def test_points_are_drawn_towards_a_surface_and_onto_its_rims(name):
    surface = solved(EQUAL, 2).surface if name == "corner" else pas.Polynomial(TORUS).surface((-2,) * 3, (2,) * 3)
    field = surface.mesher.radial_field if name == "corner" else surface.mesher.cell_field
    local, points = noisy(field, surface.mesh(2e-2))
    still = np.arange(len(points)) % 5 == 0
    rim = np.arange(len(points)) % len(field.rims)
    drawn, _ = field.nearer(points, still, 1)
    assert np.array_equal(drawn[still], points[still])
    assert (field.distances(drawn)[~still] < 0.2 * field.distances(points)[~still] + 1e-10).mean() > 0.95
    assert np.abs(field.distances(field.closed(local + 1e-4, field.jets(local + 1e-4))[0])).max() < 1e-12
    each = [off_rim(field, field.rims[k], point) for k, point in zip(rim.tolist(), points, strict=True)]
    assert field.rim_distances(points, rim) == pytest.approx(each, rel=1e-9)
    assert field.rim_distances(points, rim).max() > 1e-3


@pytest.mark.parametrize("share", [0.5, 1.2])
def test_points_that_are_not_near_are_drawn_along_rays(share):
    """A step along the gradient alone would leave some of them off by more than a tenth of it."""
    surface = solved(EQUAL, 2).surface
    field = surface.mesher.radial_field
    points = share * field.frame.local_points(surface.mesh(2e-2).points)
    drawn, _ = field.nearer(points, np.zeros(len(points), dtype=bool), 1)
    assert (field.distances(drawn) < 0.11 * np.linalg.norm(drawn - points, axis=1)).all()


def test_pieces_by_rays_and_pieces_of_cells_give_the_same_field():
    surface = solved(EQUAL, 2).surface
    fields = surface.mesher.radial_field, LocalField(surface)
    local, points = noisy(fields[0], surface.mesh(2e-2), 1e-3)
    still = np.arange(len(points)) % 5 == 0
    looked = [
        [
            *field.nearer(points, still, 2),
            *field.closed(points, field.jets(points)),
            field.distances(points),
            *field.bending(local),
        ]
        for field in fields
    ]
    for one, other in zip(*looked, strict=True):
        assert one == pytest.approx(other, rel=1e-7, abs=1e-9)


def test_points_belong_to_the_cell_in_which_they_are_deepest():
    surface = solved(EQUAL, 2).surface
    field, local = LocalField(surface), surface.local
    points = np.random.default_rng(8).uniform(-1.5, 1.5, (500, 3))
    assert field.pieces(points).tolist() == local.piece_of[local.locate(points, tolerance=np.inf)].tolist()
    jets = surface.evaluator.batch(0, 1)(points, field.pieces(points))
    assert np.array_equal(field.jets(points), jets)
    rims = np.arange(len(points)) % len(field.rims)
    for rim, point in zip(rims.tolist(), field.on_rims(points, rims), strict=True):
        planes = field.rims[rim]
        assert np.abs(planes[:, :3] @ point - planes[:, 3]).max() < 1e-12


def test_rays_from_the_centre_and_its_skeleton_meet_the_surface():
    surface = solved(EQUAL, 2).surface
    field = surface.mesher.radial_field
    local = field.frame.local_points(surface.mesh(2e-2).points)
    noise = np.random.default_rng(5).normal(size=local.shape)
    on_skeleton = np.array([ring.middle / 2 for ring in field.rims]) + 1e-6 * noise[: len(field.rims)]
    points = np.concatenate([*(local + scale * noise for scale in (1e-4, 0.02, 0.2)), on_skeleton])
    first = surface.mesher.first
    inner = np.delete(first.points, Edges(first.triangles, len(first.points)).rim, axis=0)
    met, near, around = field.met(points), field.near(points), field._around(points, points)
    assert field.once(inner)
    assert not field.once(points)
    assert 0 < (met != near).any(axis=1).sum() < len(points) / 2  # some graze the surface
    assert 0 < (around == points).all(axis=1).sum() < len(points) / 2  # some do not meet it nearby
    assert np.abs(field.distances(near[: 2 * len(local)])).max() < 1e-7
    assert field.met(inner) == pytest.approx(halved_rays(field, inner), abs=1e-9)


def halved_rays(field, points):
    """Where f changes its sign on rays from the centre to the region's boundary, by halving them: (N, 3)."""
    low, high = np.zeros(len(points)), field.leaving(points)[0]
    for _ in range(50):
        middle = (low + high) / 2
        inside = field.values(middle[:, None] * points) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return low[:, None] * points


def test_rays_leave_a_region_through_the_face_that_they_meet():
    surface = solved(EQUAL, 2).surface
    points = np.random.default_rng(7).normal(size=(300, 3))
    corners = [surface.local.points[list(face.vertices)] for face in surface.local.outer_faces]
    weights = np.array([np.linalg.solve(own.T, points.T) for own in corners])
    held = weights.min(axis=1).argmax(axis=0)
    leave, pieces = surface.mesher.radial_field.leaving(points)
    assert leave == pytest.approx(1 / weights.sum(axis=1)[held, np.arange(len(points))], rel=1e-12)
    assert pieces.tolist() == [surface.local.outer_faces[face].piece for face in held]
