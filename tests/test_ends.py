"""Where blends end, and what is said of ends that are unusual."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import pas
from pas.cli import main

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


@pytest.fixture(scope="module")
def elbow():
    return pas.blend([pas.Pipe(X, 1, 2), pas.Pipe((0, 3, 4), "3/4", "2/5", (0, 0, 0))], 1, energy=pas.ThinPlate())


def test_a_blend_says_where_it_ends(elbow):
    first, second = elbow.ends()
    center = np.array(elbow.surface.partition.center, dtype=float)
    assert first == pas.ContactEnd((2, 0, 0), (1, 0, 0), (1, 1), np.linalg.norm((2, 0, 0) - center))
    assert second.center == pytest.approx((0, 1.2, 1.6)) and second.direction == pytest.approx((0, 0.6, 0.8))
    assert second.radius == pytest.approx(0.75) and second.inner_radius is None
    assert second.distance == pytest.approx(np.linalg.norm((0, 1.2, 1.6) - center))


def test_flanges_go_where_the_solid_ends(elbow):
    ends = elbow.ends("1/2")
    assert ends[0].center == pytest.approx((2.5, 0, 0)) and ends[1].center == pytest.approx((0, 1.5, 2))
    solid = elbow.solid("1/2")
    for end in ends:
        inside, outside = (np.add(end.center, t * np.array(end.direction)) for t in (-1e-3, 1e-3))
        assert solid.contains(inside) and not solid.contains(outside)
    assert elbow.ends(["1/2", 0]) == (ends[0], elbow.ends()[1])
    with pytest.raises(ValueError, match="length must not be negative"):
        elbow.ends(-1)


def test_a_cone_is_wider_where_it_goes_on():
    blend = pas.blend([pas.Cone(X, 1, 2, "1/4"), pas.Pipe(Y, 1, 2)], 1, energy=pas.ThinPlate())
    assert [end.radius for end in blend.ends(1)] == pytest.approx([1.25, 1])
    assert blend.ends(1)[0].center == pytest.approx((3, 0, 0))


def test_curves_that_are_not_round_have_no_radius():
    oval = pas.ContactEnd.of(pas.EllipticPipe(X, [(0, 1, 0), (0, 0, "1/2")], 3), (1, 0, 0))
    assert oval.radius is None and oval.radii == pytest.approx((0.5, 1)) and oval.distance == pytest.approx(2)


def test_a_hollow_blend_says_how_wide_its_cavity_is(elbow):
    hollow = elbow.hollow("1/8", prove=False)
    assert [end.radius for end in hollow.ends()] == pytest.approx([1, 0.75])
    assert [end.inner_radius for end in hollow.ends()] == pytest.approx([0.875, 0.625])
    assert [end.center for end in hollow.ends()] == [end.center for end in elbow.ends()]


def test_an_opening_is_where_its_curve_is():
    foot = pas.blend([pas.Plate(Z, radius=2), pas.Pipe(Z, 1, clip=2)], 1)
    plate, pipe = foot.ends()
    assert plate.center == pytest.approx((0, 0, 0), abs=1e-9) and plate.direction == pytest.approx((0, 0, -1))
    assert plate.radius == pytest.approx(2) and pipe.center == pytest.approx((0, 0, 2))
    assert pipe.distance == pytest.approx(plate.distance + 2)


def test_struts_know_where_they_were_put():
    center = (1, 2, 3)
    for strut in pas.struts([(X, 1), ((-1, 2, 0), 1)], 1, center):
        end = pas.ContactEnd.of(strut, center)
        assert end.distance == pytest.approx(float(strut.clip) * np.linalg.norm([float(c) for c in strut.axis]))


def test_ends_that_are_far_out_and_radii_that_differ_much_are_told():
    with pytest.warns(UserWarning, match=r"contact 1 is 25.4 times as wide as contact 3: blend contact 3 with") as told:
        thin = pas.struts([(X, "127/5"), ((-1, 0, 0), "127/5"), (Z, 1)], 1)
    assert len(told) == 1 and told[0].filename == __file__
    with pytest.warns(UserWarning, match=r"from the centre, \S+ times the largest radius: give it a nearer clip"):
        pas.struts([(X, 1), ((5, 1, 0), 1)], 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(pas.struts([(X, 5), ((-1, 0, 0), 5), (Z, 1)], 1)) == len(thin)


def test_the_command_line_tells_as_well(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "reducer.toml"
    ends = (("[1, 0, 0]", 11), ("[-1, 0, 0]", 1))
    pipes = "".join(f"[[pipes]]\naxis = {axis}\nradius = {radius}\nclip = 'auto'\n" for axis, radius in ends)
    path.write_text(f"order = 1\n{pipes}[energy]\nkind = 'thin-plate'\n")
    assert main(["blend", str(path), "--no-picture", "--tolerance", "0.5"]) == 0
    written = capsys.readouterr()
    assert "pas: contact " in written.err and "times as wide as" in written.err
    assert "unusual " in written.out
