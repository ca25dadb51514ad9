"""Short coefficients: reduced bases span the same space, and blends chosen in them are proved, or refused in words."""

from __future__ import annotations

from math import lcm

import pytest
from conftest import UNEQUAL, fair, pipes
from flint import fmpq_mat, fmpz_mat

import pas
from pas.algebra.matrices import short_basis


def digits(surface):
    return max(len(str(abs(c.numerator))) for p in surface.polynomials for c in p.coefficients().values())


@pytest.fixture(scope="module")
def corner():
    return fair(UNEQUAL, 1)


def test_short_bases_of_lattices():
    """All whole vectors in the plane of (2, 4, 0) and (0, 3, 9) are combinations of the two that are found."""
    found = short_basis(fmpz_mat([[2, 4, 0], [0, 3, 9]]))
    assert sorted(sorted(map(abs, map(int, row))) for row in found.tolist()) == [[0, 1, 2], [0, 1, 3]]
    many = fmpz_mat([[10**30 + 7 * i * j + i**5 + 3 * j**4 for j in range(6)] for i in range(1, 4)])
    short = short_basis(many)
    assert fmpq_mat(many).rref() == fmpq_mat(short).rref()  # one span
    assert short.snf()[2, 2] == 1  # no whole vector of the span is missed
    assert max(map(abs, short.entries())) < max(map(abs, many.entries()))


def test_a_reduced_space_is_the_same_space(corner):
    space = corner.space
    short = space.reduced()
    assert short.equals(space) and type(short) is pas.SolutionSpace
    whole = [c for m in short.patches for row in m.tolist() for c in row]
    assert all(c.q == 1 for c in whole) and max(len(str(abs(c.p))) for c in whole) <= 6
    assert max(len(str(abs(c.p))) for m in space.patches for row in m.tolist() for c in row) > 15
    again = short.reduced()  # is reduced already: its members are no longer
    longest = [max(abs(int(c.p)) for m in s.patches for c in m.tolist()[-1]) for s in (short, again)]
    assert longest[1] <= longest[0]
    empty = pas.solutions(pipes(), 1, 1).reduced()
    assert empty.dimension == 0


def test_corners_become_short(corner, tmp_path):
    short = corner.simplified()
    assert short.certificate.proved and short.surface.degree == corner.surface.degree
    assert digits(short.surface) <= 10 and digits(corner.surface) > 40
    assert short.energy == pytest.approx(corner.energy, rel=0.01)
    assert short.fairness.sharpness == pytest.approx(corner.fairness.sharpness, abs=0.01)
    coordinates = short.space.reduced().coordinates(short.surface.polynomials)
    assert max(len(str(c.numerator)) for c in coordinates) <= 6
    assert {p for c in coordinates for p in (2, 5) if c.denominator % p == 0} <= {2, 5}
    assert 10**9 % lcm(*(c.denominator for c in coordinates)) == 0
    assert short.space.member(short.coefficients).patches == short.surface.patches
    paths = corner.save(tmp_path / "long.pas.json"), short.save(tmp_path / "short.pas.json")
    assert paths[1].stat().st_size < 0.6 * paths[0].stat().st_size
    again = pas.load(paths[1])
    assert again.certificate.proved and again.coefficients == short.coefficients
    assert again.simplified(10**6).certificate.proved  # of files, too


@pytest.mark.slow
def test_nodes_openings_and_walls_become_short():
    node = pas.node([((1, 0, 0), 1), ((-1, 2, 0), 1)], 1)
    short = node.simplified()
    assert short.certificate.proved and digits(short.surface) < digits(node.surface) / 3
    foot = pas.blend([pas.Plate((0, 0, 1), radius=2), pas.Pipe((0, 0, 1), 1, clip="auto")], 1)
    assert foot.simplified(10**4).certificate.proved
    wall = node.hollow("1/8")
    assert wall.simplified().certificate.proved


def test_what_is_too_short_is_refused(corner):
    with pytest.raises(pas.NotProvedError, match=r"denominator 1 are too short: .*; 100 is enough$") as caught:
        corner.simplified(1)
    assert not caught.value.blend.certificate.proved
    assert corner.simplified(100).certificate.proved
    for wrong in (0, 10**10, -5):
        with pytest.raises(ValueError, match=r"denominator must be a whole number from 1 to 1000000000, not"):
            corner.simplified(wrong)
    with pytest.raises(TypeError, match="denominator must be"):
        corner.simplified("many")


def test_wishes_are_kept(corner):
    space = pas.solutions(pipes(UNEQUAL), 1, 4)
    through, inside = ("-3/10", "-3/10", "-3/10"), ("1/4", "1/4", "1/4")
    short = space.fit(through=[through], inside=[inside], energy=pas.ThinPlate()).simplified()
    assert short.certificate.proved
    assert any(p.at(through) == 0 for p in short.surface.polynomials)
    assert float(short.surface([[0.25, 0.25, 0.25]])[0]) < 0
    with pytest.raises(ValueError, match="fix at a number is lost"):
        space.fit(handles={(0, (4, 0, 0, 0)): -1}, energy=pas.ThinPlate(), prove=False, guard=False).simplified()
