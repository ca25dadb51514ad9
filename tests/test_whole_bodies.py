"""A body is what is joined to the blend: no far side of a torus, no other nappe, and nothing that is not proved."""

from __future__ import annotations

import numpy as np
import pytest
from flint import fmpq

import pas
from pas.algebra.rational import to_floats
from pas.pipeline.neighbours import kuhn, proved

X, Z = (1, 0, 0), (0, 0, 1)


def tapering():
    return [
        pas.Pipe((0, 1, 0), "1/2", 2),
        pas.Cone((1, -1, 0), "1/2", 2, slope="1/8"),
        pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8"),
    ]


@pytest.fixture(scope="module")
def bent():
    """A bent pipe, which is a torus, and two cones."""
    contacts = [
        pas.Torus(Z, (2, 0, 0), "1/2", (-2, 2, 0)),
        pas.Cone((1, -1, 0), "1/2", 2, slope="1/8"),
        pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8"),
    ]
    return pas.blend(contacts, 1)


@pytest.mark.parametrize("length", ["1/2", 1])
def test_the_far_side_of_a_torus_is_no_part_of_a_body(bent, length):
    body = bent.solid(length)
    assert body.proved and not body.contains([(-4, 2.1, 0), (-4, 2.4, 0.1)]).any()
    assert body.contains([(0, 2.1, 0), (0, 2.2, 0.2), (0, 0, 0)]).all()
    mesh = body.mesh(5e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)


def test_a_piece_that_is_not_proved_to_be_one_is_refused(bent):
    """Within twice its major radius the tube turns round and comes back."""
    with pytest.raises(pas.GeometryError, match=r"neighbour 1 is not proved to go on in one piece for 4 beyond"):
        bent.solid(4)


def test_the_other_nappe_of_a_cone_is_no_part_of_a_body(bent):
    """The third contact tapers by an eighth of its axis' unit: from 1/2 to 0 within four of them."""
    with pytest.raises(
        pas.GeometryError, match=r"neighbour 3 comes back within 7 of its clip; take a length below 5\.657"
    ):
        pas.blend(tapering(), 1).solid(7)
    assert pas.blend(tapering(), 1).solid(5).proved


def test_six_tetrahedra_fill_a_frustum():
    corners = ((-1, -1), (-1, 1), (1, 1), (1, -1))
    quads = [[tuple(fmpq(c) for c in (s * x, s * y, s)) for x, y in corners] for s in (1, 3)]
    tetrahedra = [np.array([to_floats(p) for p in t]) for t in kuhn(quads)]
    volumes = [abs(np.linalg.det(t[1:] - t[0])) / 6 for t in tetrahedra]
    assert sum(volumes) == pytest.approx(4 * (27 - 1) / 3) and min(volumes) > 0


def test_claims_on_simplices_are_decided():
    triangle = [tuple(map(fmpq, p)) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    f = pas.Polynomial("x + y + 1/10")
    assert proved((f, ()), [triangle]) and not proved((f - pas.Polynomial("1/5"), ()), [triangle])
    assert proved((f - pas.Polynomial("1/5"), (pas.Polynomial("1/5 - x"),)), [triangle])
