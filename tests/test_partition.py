"""Partitions and frames: exact geometry."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

import pas
from pas.algebra.affine import Frame
from pas.algebra.rational import to_fraction, vector


def test_six_tetrahedra_of_the_published_corner(facts):
    corner = pas.SixTetrahedra(legs=[("3/5", 0, 0), (0, "3/5", 0), (0, 0, "3/5")])
    assert len(corner.cells) == len(corner.interior_faces) == 6
    assert len(corner.outer_faces) == 12
    h1 = h2 = h3 = Fraction(3, 5)
    names = {"h1": h1, "h2": h2, "h3": h3}
    published = set()
    for text in facts["pi"]:
        plane = pas.Polynomial(re.sub("h[123]", lambda m: f"({names[m[0]]})", text))
        published.add(plane / plane.coefficients()[1, 0, 0])
    ours = {f.plane / f.plane.coefficients()[1, 0, 0] for f in corner.interior_faces}
    assert ours == published
    for number, face in ((0, "x - 3/5"), (2, "y - 3/5"), (4, "z - 3/5")):
        clip = pas.Polynomial(face)
        carried = [f.cell for f in corner.outer_faces if all(clip.at(p) == 0 for p in corner.corners(f.vertices))]
        assert carried == [number]


def test_outer_planes_point_outwards_and_interior_ones_pass_through_the_centre():
    corner = pas.SixTetrahedra((1, 2, "1/3"), [(3, 4, 0), (-4, 3, 0), (0, 0, "-2/7")])
    for face in corner.outer_faces:
        assert face.plane.at(corner.center) < 0
    for face in corner.interior_faces:
        assert face.plane.at(corner.center) == 0


def test_volume_and_location():
    corner = pas.SixTetrahedra()
    p = corner.points[np.array(corner.cells)]
    assert np.abs(np.linalg.det(p[:, 1:] - p[:, :1])).sum() / 6 == pytest.approx(6.0)
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.ones(4), (6, 100))
    for number in range(6):
        assert (corner.locate(weights[number] @ p[number]) == number).all()
    assert (corner.locate(np.array([[3.0, 0, 0], [-1.01, -1, -1]])) == -1).all()


def test_frame_is_exact_and_undone():
    frame = Frame.around(vector((1000, "1/3", -7)), [vector((1003, 0, -7))])
    assert to_fraction(frame.scale) == 2
    p = pas.Polynomial("x^2*y - z^3/5 + 1")
    assert frame.globalise(frame.localise(p)) == p
    point = vector(("1001", "2/3", "-13/2"))
    assert frame.localise(p).at(frame.local_point(point)) == p.at(point)
    points = np.array([[1001.0, 2 / 3, -6.5]])
    assert frame.global_points(frame.local_points(points)) == pytest.approx(points)


@pytest.mark.parametrize(
    ("legs", "words"),
    [
        ([(1, 0, 0), (0, 1, 0), (1, 1, 0)], "in one plane"),
        ([(1, 0, 0), (0, 0, 0), (0, 0, 1)], "in one plane"),
    ],
)
def test_flat_corners_are_refused(legs, words):
    with pytest.raises(pas.GeometryError, match=words):
        pas.SixTetrahedra(legs=legs)


def octahedron():
    """Eight cells around a centre, as indices into the centre and the six ends of the axes."""
    v = [vector(p) for p in ((0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    return v, [(0, a, b, c) for a in (1, 2) for b in (3, 4) for c in (5, 6)]


def test_other_partitions_around_a_centre():
    v, cells = octahedron()
    partition = pas.Partition(v, cells, v[0])
    assert len(partition.interior_faces) == 12
    assert len(partition.outer_faces) == 8


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda v, cells: (v, cells[:-1], v[0]), "not inside the region"),
        (lambda v, cells: ([*v[:6], vector((0, 0, 2))], cells, v[0]), "overlap"),
        (lambda v, cells: (v, [*cells, cells[0]], v[0]), "overlap"),
        (lambda v, cells: (v, cells, v[1]), "does not pass through its centre"),
        (lambda v, cells: ([*v[:6], vector((1, 1, 0))], cells, v[0]), "flat"),
    ],
)
def test_partitions_that_cannot_be(change, words):
    v, cells, center = change(*octahedron())
    with pytest.raises(pas.GeometryError, match=words):
        pas.Partition(v, cells, center)


def spiral(turns):
    """Cells around the z-axis, a quarter turn each, as many whole turns as are asked for."""
    n = 4 * turns
    ring = [((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0))[i % 4] for i in range(n)]
    cells = [(0, pole, 3 + i, 3 + (i + 1) % n) for i in range(n) for pole in (1, 2)]
    return [vector(p) for p in ((0, 0, 0), (0, 0, 1), (0, 0, -1), *ring)], cells


def test_cells_that_go_round_the_centre_twice():
    v, cells = spiral(1)
    assert len(pas.Partition(v, cells, v[0]).interior_faces) == 12
    for turns in (2, 3):
        v, cells = spiral(turns)
        with pytest.raises(pas.GeometryError, match="exactly once"):
            pas.Partition(v, cells, v[0])


@pytest.mark.parametrize("size", ["2", "1/7", "1e-17", "1e-120", "1e-400", "1e200", "1e400"])
def test_cells_inside_others_are_noticed_at_any_size(size):
    """Two octahedra, one in the other or crossing: what is smaller counts as much."""
    v, cells = octahedron()
    other = [vector([Fraction(size) * to_fraction(c) for c in p]) for p in v]
    assert len(pas.Partition(other, cells, other[0]).local.outer_faces) == 8
    with pytest.raises(pas.GeometryError, match="exactly once"):
        pas.Partition([*v, *other], [*cells, *(tuple(i + len(v) for i in c) for c in cells)], v[0])


@pytest.mark.parametrize("place", ["1/3", "1e-30"])
def test_a_centre_just_inside_is_seen_once(place):
    """Right behind a face, which then fills half of the view; floating point would lose it."""
    v, cells = octahedron()
    near = pas.SingleCell((0, 0, 0), (1, 1, 1), (place, place, "1/2"))
    assert near.local.center == vector((0, 0, 0))
    far = [vector([to_fraction(c) + (10**9 if i == 2 else 0) for i, c in enumerate(p)]) for p in v]
    assert pas.Partition(far, cells, far[0]).frame.scale == 1


def test_frames_of_any_size():
    for exponent in (-2000, -1074, -1, 0, 1, 1023, 2000):
        size = Fraction(2) ** exponent
        assert to_fraction(pas.SingleCell((0, 0, 0), (2 * size, 2 * size, 2 * size)).frame.scale) == size
        assert to_fraction(pas.Partition(*mesh_of_size(size)).frame.scale) == size / 2


def mesh_of_size(size):
    """One tetrahedron without a centre."""
    return [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)], [(0, 1, 2, 3)]


def test_the_count_of_rays_avoids_edges():
    """The ray that is tried first, (1, 2, 4), goes through a vertex of a second octahedron."""
    v, cells = octahedron()
    ends = [(1, 2, 4), (-1, -2, -4), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    other = [(0, 0, 0), *(tuple(3 * c for c in p) for p in ends)]
    assert len(pas.Partition(other, cells, other[0]).cells) == 8
    with pytest.raises(pas.GeometryError, match="exactly once"):
        pas.Partition([*v, *other], [*cells, *(tuple(i + len(v) for i in c) for c in cells)], v[0])
