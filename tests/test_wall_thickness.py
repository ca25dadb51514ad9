"""How thick walls are proved to be: slices that hold zeros, bounds below the least distance and above it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import sqrt

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas.bernstein.forms import corner_points, nearby_forms
from pas.bernstein.simplices import Simplices
from pas.certify.thickness import apart, close, nearest_pairs, slices, thicker_than
from pas.piecewise import PiecewiseSurface
from pas.verdicts import Status

BOX = (-2, -2, -2), (2, 2, 2)


def surface(f, box=BOX, middle=(0, 0, 0)):
    """The zeros of one polynomial in a box."""
    return PiecewiseSurface.from_polynomials(pas.SingleCell(*box, center=middle), (), 1, [f])


BALL = surface("x^2 + y^2 + z^2 - 1")
ASIDE = surface("(x - 1/10)^2 + y^2 + z^2 - 9/4")
"""0.4 apart, at (-1, 0, 0)."""


def tetrahedra(f, corners, *clips):
    """Tetrahedra (N, 4, 3) of whole numbers with the forms of a polynomial and of clips on each."""
    exact = [tuple(tuple(fmpq(int(c)) for c in v) for v in simplex) for simplex in corners]
    raws = [pas.Polynomial(p).raw for p in (f, *clips)]
    found = [nearby_forms([raw] * len(exact), exact, int(raw.total_degree())) for raw in raws]
    return Simplices.of([form for form, _ in found], corner_points(exact), max(error for _, error in found))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("f", ["x^2 + y^2 + z^2 - 5", "10 - x^2 - y^2", "x*y - z^2 + 1", "z^3 - 3*x*y + y"])
def test_slices_hold_all_zeros(f):
    generator = np.random.default_rng(1)
    corners = generator.integers(-3, 4, (60, 4, 3))
    corners = corners[np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) > 0]
    batch = tetrahedra(f, corners).halved().halved()
    found, there = slices(batch)
    polynomial, seen = pas.Polynomial(f), 0
    shares = generator.dirichlet(np.ones(4), (len(batch), 2, 40))  # ends of chords of each, a zero on which is sought
    low, high = (shares[:, i] @ batch.corners for i in range(2))
    turned = polynomial(low) > 0
    low, high = np.where(turned[..., None], high, low), np.where(turned[..., None], low, high)
    for number in range(len(batch)):
        a, b = low[number], high[number]
        changing = (polynomial(a) < 0) & (polynomial(b) > 0)
        a, b = a[changing], b[changing]
        for _ in range(50):
            inside = (polynomial((a + b) / 2) < 0)[:, None]
            a, b = np.where(inside, (a + b) / 2, a), np.where(inside, b, (a + b) / 2)
        seen += len(a)
        assert there[number] or not len(a)
        for n in (*generator.normal(size=(6, 3)), found.normals[number], -found.normals[number]):
            assert (a @ n <= (found.corners[number] @ n).max() + 1e-9 * np.linalg.norm(n)).all()
    assert seen > 100


def test_an_edge_holds_a_zero_only_where_the_sign_changes():
    found, there = slices(tetrahedra("x^2 + y^2 + z^2 - 1", [[(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]]))
    assert there.all() and found.crossed.tolist() == [[True, True, True, False, False, False]]
    found, there = slices(tetrahedra("(2*x - 1)^2 + 4*y^2 + z", [[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]]))
    assert there.all() and not found.crossed.any()  # positive all along, which the coefficients do not show


def test_an_edge_along_which_a_surface_runs_counts_as_a_whole():
    corner = [[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]]
    found, there = slices(tetrahedra("y + z + (x - 1/2)/10^8", corner))
    assert there.all() and found.corners[..., 0].max() >= 1 / 2
    found, there = slices(tetrahedra("y + 2*z - 1/2 + x/10^8", corner))
    assert there.all() and (found.corners[..., 1:].sum(axis=2) > 1 / 5).all()  # none of the edge from (0, 0, 0) along x


@pytest.mark.parametrize("clip, there, crossed", [("x - 3", True, 3), ("x - 1", True, 0), ("x + 1", False, 0)])
def test_zeros_beyond_a_clip_do_not_count(clip, there, crossed):
    corner = [[(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]]
    found, seen = slices(tetrahedra("x^2 + y^2 + z^2 - 1", corner, clip))
    assert seen.tolist() == [there] and found.crossed.sum() == crossed


@pytest.mark.parametrize("length", [1 / 8, 1, 8])
def test_how_long_directions_are_does_not_matter(length):
    corner = [[(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4)]]
    low, high = (slices(tetrahedra(f, corner))[0] for f in ("z - 1", "z - 3/2"))
    low, high = (replace(side, normals=length * np.array([[0.0, 0, 1]])) for side in (low, high))
    pair = np.array([0]), np.array([0])
    assert apart(low, high, pair, 0.499).all() and not apart(low, high, pair, 0.501).any()


@pytest.mark.parametrize("halvings", [0, 3])
def test_slices_that_are_parted_from_all_others_are_settled(halvings):
    generator = np.random.default_rng(2)
    sides = []
    for f in ("x + y/3 - 2", "x^2 + y^2 + z^2 - 2"):
        batch = tetrahedra(f, generator.integers(-2, 3, (30, 4, 3)) + [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3]])
        for _ in range(halvings):
            batch = batch.halved()
        found, there = slices(batch)
        sides.append(found.select(there))
    every = np.divmod(np.arange(len(sides[0]) * len(sides[1])), len(sides[1]))
    for distance in (0.01, 0.1, 1.0):
        table = ~apart(*sides, every, distance).reshape(len(sides[0]), len(sides[1]))
        found = close(*sides, nearest_pairs(*sides), distance)
        assert all((found[i] == table.any(axis=1 - i)).all() for i in range(2))
        assert distance == 1 or not all(map(np.all, found))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "bound, status",
    [
        ("1/10", Status.PROVED),
        ("39/100", Status.PROVED),
        ("41/100", Status.REFUTED),
        ("1/2", Status.REFUTED),
        (1, Status.REFUTED),
        (4, Status.REFUTED),
    ],
)
def test_the_gap_between_spheres(bound, status):
    verdict = thicker_than(BALL, ASIDE, fmpq(*map(int, str(bound).split("/"))))
    assert verdict.status is status
    assert verdict.claim == f"a wall thicker than {bound}"
    if bound == "41/100":
        point = np.array(verdict.witness)
        assert np.linalg.norm(point) == pytest.approx(1, abs=0.02)
        assert 1.5 - np.linalg.norm(point - [0.1, 0, 0]) < 0.43


def test_surfaces_that_cross_or_touch_have_no_thickness():
    across = surface("(x - 3/5)^2 + y^2 + z^2 - 9/4")
    assert thicker_than(BALL, across, fmpq(1, 100)).status is Status.REFUTED


@pytest.mark.parametrize("box", [((-2, -3, -2), (4, 2, 5))])
def test_regions_of_unlike_cells(box):
    """Cells of one surface are halved more often before they are as small as the wall is thick."""
    wide = surface("(x - 1/10)^2 + y^2 + z^2 - 9/4", box)
    assert thicker_than(BALL, wide, fmpq(3, 8)).proved
    assert thicker_than(BALL, wide, fmpq(9, 20)).status is Status.REFUTED
    small = surface("x^2 + y^2 + z^2 - 1", ((-1, "-6/5", "-3/2"), ("8/5", 1, "7/5")), ("1/5", 0, 0))
    assert thicker_than(small, wide, fmpq(9, 20)).status is Status.REFUTED


def test_flat_surfaces():
    plane = surface("z + x/10 - 1")
    other = surface("z + x/10 - 3/2")
    least = 0.5 / sqrt(1.01)  # 0.4975
    assert thicker_than(plane, other, fmpq(497, 1000)).proved
    assert thicker_than(plane, other, fmpq(498, 1000)).status is Status.REFUTED
    assert 0.497 < least < 0.498


@cache
def elbow():
    return read("thick_elbow")


@pytest.mark.slow
def test_a_hollow_bend_is_thicker_than_four_fifths():
    wall = elbow()
    verdict = wall.thicker_than("3/10")
    assert verdict.proved and verdict.claim == "a wall thicker than 3/10"
    assert wall.wall.distance > 0.3
    assert wall.thicker_than("9/20").status is Status.REFUTED


@pytest.mark.parametrize("bound", [0, "-1/8"])
def test_a_bound_is_positive(bound):
    with pytest.raises(ValueError, match="bound must be positive"):
        elbow().thicker_than(bound)


def test_a_wall_around_an_opening_is_bounded_up_to_its_cone():
    wall = read("hollow_nozzle")
    verdict = wall.thicker_than("1/20")
    assert verdict.proved and verdict.claim == "a wall thicker than 1/20"
    assert wall.thicker_than("1/4").status is Status.REFUTED
