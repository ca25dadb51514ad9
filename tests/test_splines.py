"""Splines on meshes: known dimensions, exact smoothness, and two constructions that agree."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations, product
from math import comb
from random import Random

import pytest
import sympy
from conftest import EQUAL, UNEQUAL, pipes
from flint import fmpq_mat

import pas
from pas.blending.net import Net
from pas.blending.place import place
from pas.blending.solving import solve_along_tree
from pas.blending.space import Space
from pas.surface.placed import PlacedContacts


def freudenthal(cubes: int, seed: int = 0, boundary: bool = False) -> pas.Partition:
    """cubes^3 unit cubes of six tetrahedra, inner vertices (or all) moved by small rationals."""
    random = Random(seed)
    numbers, vertices = {}, []
    for corner in product(range(cubes + 1), repeat=3):
        numbers[corner] = len(vertices)
        move = seed and (boundary or all(0 < c < cubes for c in corner))
        shift = [Fraction(random.randint(-3, 3), random.randint(10, 20)) if move else 0 for _ in range(3)]
        vertices.append([c + s for c, s in zip(corner, shift, strict=True)])
    cells = []
    for base in product(range(cubes), repeat=3):
        for order in permutations(range(3)):
            corner = list(base)
            cell = [numbers[tuple(corner)]]
            for axis in order:
                corner[axis] += 1
                cell.append(numbers[tuple(corner)])
            cells.append(cell)
    return pas.Partition(vertices, cells)


def alfeld() -> pas.Partition:
    """A tetrahedron cut into four around an inner point."""
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), ("1/5", "2/7", "1/4")]
    return pas.Partition(points, [(1, 2, 3, 4), (0, 2, 3, 4), (0, 1, 3, 4), (0, 1, 2, 4)], center=points[4])


def by_conditions(partition, order, degree) -> Space:
    placed = PlacedContacts(partition, (), order)
    return Space(placed, degree, solve_along_tree(placed, degree))


def by_net(partition, order, degree) -> Space:
    placed = PlacedContacts(partition, (), order)
    return Space(placed, degree, Net(placed, degree).solve())


def smooth(space) -> bool:
    """pi^(k+1) divides the difference of the patches across every face, for every member."""
    for member in space.basis:
        for face in space.partition.interior_faces:
            difference = member[face.second].raw - member[face.first].raw
            if not divmod(difference, face.plane.raw ** (space.order + 1))[1].is_zero():
                return False
    return True


@pytest.mark.parametrize("degree", [*range(1, 6), pytest.param(6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.sampled(2)
def test_both_constructions_agree_on_the_alfeld_split(order, degree):
    partition = alfeld()
    net, conditions = by_net(partition, order, degree), by_conditions(partition, order, degree)
    assert net.equals(conditions)
    assert smooth(net)
    # the dimension by one plain linear system on all coefficients, in sympy
    if degree <= 3:
        assert net.dimension == plain_dimension(partition, order, degree)


def plain_dimension(partition, order, degree) -> int:
    x, y, z = sympy.symbols("x y z")
    monomials = [x**a * y**b * z**c for a, b, c in product(range(degree + 1), repeat=3) if a + b + c <= degree]
    size, rows = len(monomials), []
    for face in partition.interior_faces:
        power = sympy.expand(face.plane.to_sympy() ** (order + 1))
        remainders = [_remainder(m, power, (x, y, z)) for m in monomials]
        for e in {e for r in remainders for e in r}:
            row = [0] * (size * len(partition.pieces))
            for j, r in enumerate(remainders):
                value = r.get(e, 0)
                row[face.first * size + j], row[face.second * size + j] = value, -value
            rows.append(row)
    table = fmpq_mat([[_rational(v) for v in row] for row in rows])
    return size * len(partition.pieces) - table.rank()


def _remainder(polynomial, divisor, symbols):
    # sympy.div divides recursively, which leaves x*y as it is modulo 7*y - 8*z
    _, rest = sympy.reduced(polynomial, [divisor], *symbols, order="grevlex", domain=sympy.QQ)
    return {} if rest == 0 else sympy.Poly(rest, *symbols).as_dict()


def _rational(value):
    from pas.algebra.rational import rational

    return rational(sympy.Rational(value))


@pytest.mark.parametrize("degree", range(1, 5))
def test_continuous_splines_are_as_many_as_domain_points(degree):
    """Order 0: one B-coefficient for each of V + (n-1) E + C(n-1,2) F + C(n-1,3) T points."""
    partition = freudenthal(2, seed=3)
    edges = {pair for cell in partition.cells for pair in (tuple(sorted((a, b))) for a in cell for b in cell if a < b)}
    triangles = len(partition.inner_triangles) + len(partition.outer_faces)
    expected = (
        len(partition.vertices)
        + (degree - 1) * len(edges)
        + comb(degree - 1, 2) * triangles
        + comb(degree - 1, 3) * len(partition.cells)
    )
    assert by_net(partition, 0, degree).dimension == expected


@pytest.mark.parametrize(("seed", "boundary"), [(4, True), (0, False), pytest.param(4, False, marks=pytest.mark.slow)])
@pytest.mark.sampled(2)
def test_both_constructions_agree_on_meshes(seed, boundary):
    partition = freudenthal(2, seed, boundary)
    for order, degree in ((1, 2), (2, 2)) if boundary else ((1, 2), (1, 3), (2, 3)):
        net = by_net(partition, order, degree)
        assert net.equals(by_conditions(partition, order, degree))
        assert smooth(net)


@pytest.mark.slow
def test_quartics_on_a_jittered_mesh_by_the_public_way():
    """48 cells go to the net of B-coefficients; polynomials are among the solutions."""
    partition = freudenthal(2, seed=5)
    space = pas.solutions([], 1, 4, partition)
    assert space.dimension == 217
    assert ["x^4 - 3*x*y*z + 1/7"] * 48 in space
    assert ["x^5"] * 48 not in space
    few = space.subspace(fmpq_mat(3, 217, [int(j == 40 * i) for i in range(3) for j in range(217)]))
    assert smooth(few)
    assert len(space.determining_set()) == 217


def test_pieces_of_several_cells_are_one_polynomial():
    whole = freudenthal(1)
    halves = pas.Partition(whole.vertices, whole.cells, pieces=[(0, 1, 2), (3, 4, 5)])
    space = by_net(halves, 1, 3)
    assert space.equals(by_conditions(halves, 1, 3))
    assert len(space.basis[0]) == 2
    single = pas.Partition(whole.vertices, whole.cells, pieces=[range(6)])
    assert by_net(single, 1, 3).dimension == 20


@pytest.mark.sampled(2)
@pytest.mark.parametrize("radii", [EQUAL, UNEQUAL])
@pytest.mark.parametrize(("order", "degree"), [(1, 3), (1, 4), (2, 4), (2, 5), (3, 5)])
def test_contacts_on_the_net(radii, order, degree):
    placed = place(pipes(radii), order)
    space = Space(placed, degree, Net(placed, degree).solve())
    assert space.equals(pas.solutions(pipes(radii), order, degree))


@pytest.mark.slow
@pytest.mark.parametrize(("boundary", "dimension"), [(False, 424), (True, 409)])
def test_quartics_on_162_jittered_tetrahedra(boundary, dimension):
    """The rank is confirmed modulo a prime, so the basis is complete; members are smooth exactly."""
    partition = freudenthal(3, seed=1, boundary=boundary)
    space = pas.solutions([], 1, 4, partition)
    assert space.dimension == dimension
    few = space.subspace(fmpq_mat(4, dimension, [int(j == 100 * i) for i in range(4) for j in range(dimension)]))
    assert smooth(few)
