"""Clips that the program places, and what is said where clips are too near."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

import pas
from pas.blending.place import place
from pas.contacts.contact import CONTACTS
from pas.contacts.endless import Endless
from pas.exchange.problem import read_problem
from pas.layouts.nodes import ContactNode, center_of

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
OBLIQUE = (-1, 2, 0)

ENDLESS = {
    "pipes": {"axis": X, "radius": 1, "clip": "auto"},
    "cones": {"axis": X, "radius": 1, "clip": "auto", "slope": "1/4"},
    "elliptic_pipes": {"axis": X, "semiaxes": [(0, 1, 0), (0, 0, "1/2")], "clip": "auto"},
    "hyperboloids": {"axis": X, "semiaxes": [(0, 1, 0), (0, 0, "1/2")], "clip": "auto", "conjugate": 4},
}
"""One contact along x, with an open end, of each kind that may have one."""

every_endless = pytest.mark.parametrize("table", ENDLESS)


def pipe(axis, radius, clip="auto", point=(0, 0, 0)):
    return pas.Pipe(axis, radius, clip, point)


def octants():
    rays = [X, Y, Z, (-1, 0, 0), (0, -1, 0), (0, 0, -1)]
    return pas.Layout(rays, [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])


def test_every_kind_that_may_end_anywhere_has_a_sample():
    assert set(ENDLESS) == {table for table, kind in CONTACTS.items() if issubclass(kind, Endless)}


@every_endless
def test_an_open_end_is_said_where_an_end_is_needed(table):
    item = CONTACTS[table](**ENDLESS[table])
    assert "clipped where there is room" in str(item)
    for needed in (lambda: item.contact, lambda: item.rim, lambda: pas.contact_ideal(item, 1)):
        with pytest.raises(pas.GeometryError, match=r'"auto", so it has no end before pas\.blend.*clipped\(number\)'):
            needed()


@every_endless
def test_ends_move_along_one_surface(table):
    item = CONTACTS[table](**ENDLESS[table])
    near, far = item.clipped(2), item.clipped(2).clipped("7/2")
    assert near.contact.surface == far.contact.surface == item.clipped(1).contact.surface
    assert far == item.clipped("7/2")
    moved = item.rotate(Z, 90).translate((0, 0, 1))
    assert moved.clipped(3) == item.clipped(3).rotate(Z, 90).translate((0, 0, 1))
    for clip in (0.5, 2.0):
        rim = item.clipped(clip).rim
        assert np.linalg.norm(rim.points(64) - (clip, 0, 0), axis=1).max() == pytest.approx(item.width(clip))


@every_endless
@pytest.mark.parametrize("order", [1, 2])
def test_open_ends_are_placed_with_room(table, order):
    item = CONTACTS[table](**ENDLESS[table])
    placed = place([item, pipe(OBLIQUE, 1), pipe((0, -1, 3), "3/4")], order)
    discs = ContactNode.of(placed.contacts).discs
    for a, b in combinations(discs, 2):
        assert a.angle + b.angle <= 0.6 * np.arccos(a.direction @ b.direction) + 1e-9
    assert placed.contacts[0].surface == item.clipped(1).contact.surface


@pytest.mark.parametrize("slope", ["-1/2", "-1/8"])
@pytest.mark.sampled(2)
def test_cones_that_narrow_end_before_their_tips(slope):
    blend = pas.blend([pas.Cone((1, 0, 0), 1, "auto", slope), pas.Pipe((0, 1, 0), 1, "auto")], 1)
    assert blend.certificate.proved and not blend.fairness.beyond(blend.limits)


def test_struts_are_the_same_mechanism():
    struts = pas.struts([(X, 1), (OBLIQUE, 1), ((0, -1, 3), "3/4")], 2)
    placed = place([pipe(X, 1), pipe(OBLIQUE, 1), pipe((0, -1, 3), "3/4")], 2)
    assert [c.clip.primitive() for c in placed.contacts] == [p.contact.clip.primitive() for p in struts]


@pytest.mark.parametrize(("wide", "distances"), [("127/5", (30.3, 40.6)), (5, (6.0, 8.0)), (1, (2.0, 2.0))])
def test_a_thin_branch_sends_no_clip_far_out(wide, distances):
    run, back, branch = pas.struts([(X, wide), ((-1, 0, 0), wide), (Z, 1)], 1)
    assert run.clip == back.clip
    assert float(run.clip) == pytest.approx(distances[0], rel=0.03)
    assert float(branch.clip) == pytest.approx(distances[1], rel=0.03)


def test_clips_that_are_given_stay_and_are_kept_apart_from():
    near, far = (place([pipe(X, 1), pipe((1, 2, 0), 1, clip)], 1).contacts for clip in (1, 3))
    assert near[1].clip == pipe((1, 2, 0), 1, 1).contact.clip
    assert far[1].clip == pipe((1, 2, 0), 1, 3).contact.clip
    # what takes up more of the angle leaves less of it
    assert ContactNode.of(near).discs[0].distance > ContactNode.of(far).discs[0].distance + 0.5


def test_axes_away_from_the_origin_and_from_one_another():
    here = place([pipe(X, 1), pipe(OBLIQUE, 1)], 1)
    there = place([pipe(X, 1, point=(105, 7, -3)), pipe(OBLIQUE, 1, point=(100, 7, -3))], 1)
    moved = [contact.translate((100, 7, -3)) for contact in here.contacts]
    assert [c.clip.primitive() for c in there.contacts] == [c.clip.primitive() for c in moved]
    skew = place([pipe(X, 1, point=(0, 0, "1/10")), pipe(OBLIQUE, 1)], 1)
    assert len(skew.contacts) == 2


def test_pipes_in_one_line():
    first, second = place([pipe(X, 1), pipe((-1, 0, 0), 1)], 1).contacts
    assert first.clip.at((0, 0, 0)) == second.clip.at((0, 0, 0)) < 0
    assert len(place([pipe(X, 1), pipe((-1, 0, 0), "1/2", 3)], 1).contacts) == 2


def test_the_six_tetrahedra_are_served():
    placed = place([pipe(axis, 1) for axis in (X, Y, Z)], 2, "six tetrahedra")
    assert placed.partition.title == "six tetrahedra"


def test_a_blend_says_where_its_clips_are(tmp_path):
    blend = pas.blend([pipe(X, 1), pipe(OBLIQUE, 1)], 1, energy=pas.ThinPlate())
    assert blend.certificate.proved
    planes = [disc.unit @ disc.middle for disc in ContactNode.of(blend.surface.contacts).discs]
    assert all(f"{distance:.4g} from the centre" in str(blend) for distance in planes)
    again = pas.load(blend.save(tmp_path / "node.pas.json"))
    assert again.surface.contacts == blend.surface.contacts
    assert "auto" not in (tmp_path / "node.pas.json").read_text()


def test_open_ends_in_problem_files(tmp_path):
    path = tmp_path / "elbow.toml"
    text = "order = 1\ndegree = 4\n[[pipes]]\naxis = [1, 0, 0]\nradius = 1\nclip = 'auto'\n"
    path.write_text(text + "[[cones]]\naxis = [-1, 2, 0]\nradius = 1\nclip = 'auto'\nslope = '1/10'\n")
    problem = read_problem(path)
    assert [item.ends for item in problem.contacts] == [False, False]
    assert pas.solutions(problem.contacts, 1, 4).dimension > 0
    path.write_text(text.replace("'auto'", "'atuo'"))
    with pytest.raises(pas.ProblemFileError, match=r"line 6: pipe 1: clip must be .* or .auto., not 'atuo'"):
        read_problem(path)


@pytest.mark.parametrize(
    ("items", "partition", "error", "words"),
    [
        ([pipe(X, 1)], None, pas.GeometryError, "joins two contacts or more, and here is one"),
        ([pipe(X, 1), 3], None, TypeError, r"contacts\[1\] must be a Pipe"),
        ([pipe(X, 1), pipe((20, 1, 0), 1)], None, pas.GeometryError, "directions 1 and 2 are 2.86 degrees apart"),
        ([pipe(X, 1), pipe(Y, 1)], "fans", ValueError, "there is no partition 'fans'"),
        (
            [pipe(Y, 1, 2), pipe(X, 1)],
            pas.SingleCell((-3, -3, -3), (3, 3, 3)),
            pas.GeometryError,
            'contact 2 has the clip "auto".*its clip must be a number',
        ),
        (
            [pas.Cone(X, 1, "auto", 1), pas.Cone(Y, 1, "auto", 1)],
            None,
            pas.GeometryError,
            "contact 1: wherever along its axis it ends, it is not apart from the other contacts",
        ),
        ([pipe(X, 1), ("x^2 - z^2 - 1", "y - 2")], None, pas.GeometryError, "contact 2: .* not closed"),
    ],
)
def test_what_cannot_be_placed(items, partition, error, words):
    with pytest.raises(error, match=words):
        pas.blend(items, 1, partition=partition)


CROWDED = {
    "two": ([pipe(X, 1, 2), pipe((2, 2, 1), 1, "2/3")], None),
    "five": ([pipe(axis, 1, 1) for axis in (X, Y, Z, (-1, -1, -1), (1, -1, -2))], None),
    "three": ([pipe(axis, 1, 1) for axis in (X, Y, (1, 1, 1))], None),
    "by name": ([pipe(X, 1, 1), pipe((1, 1, 0), 1, 1), pipe(Z, 1, 1)], "fan"),
    "a cone": ([pas.Cone(X, 1, 1, "1/5"), pipe((1, 2, 0), 1, "1/2")], None),
    "one's own layout": ([pipe((1, 1, 1), 1, "1/2"), pipe((-1, -1, 1), "1/2", "1/2")], octants()),
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "five")) for n in CROWDED])
@pytest.mark.sampled(3)
def test_the_least_clips_that_are_said_to_leave_room_do(name):
    items, partition = CROWDED[name]
    with pytest.raises(pas.GeometryError, match='clip="auto" finds such') as failure:
        place(items, 1, partition)
    said = re.search(r"at least (.*) and (\S+) from the centre \((\S+) times", str(failure.value))
    factor = Fraction(said[3])
    moved = place([item.clipped(Fraction(str(item.clip)) * factor) for item in items], 1, partition)
    center = center_of([contact.rim for contact in moved.contacts])
    distances = [f"{disc.distance:.4g}" for disc in ContactNode.of(moved.contacts, center).discs]
    assert distances == [*said[1].split(", "), said[2]]
    less = factor * Fraction(9, 10)  # where room begins it comes and goes within some per cent
    assert less > 1
    with pytest.raises(pas.GeometryError):
        place([item.clipped(Fraction(str(item.clip)) * less) for item in items], 1, partition)


def test_directions_that_are_too_close_for_any_clips():
    with pytest.raises(pas.GeometryError, match=r"are seen 1\.43 degrees apart") as failure:
        place([pipe(X, 1, 2), pipe((40, 1, 0), 1, "1/20")], 1)
    assert "times as far" not in str(failure.value)


def test_an_open_end_is_no_half_made_contact():
    assert "clip='auto'" in repr(pipe(X, 1))
    assert pipe(X, 1) == pipe(X, 1) != pipe(X, 1, 2)
    with pytest.raises(ValueError, match="clip is not a rational number: 'auto'"):
        pas.Sphere(X, 1, "auto")


def test_ends_are_placed_before_a_blend_is_looked_for_among_those_kept():
    pipes = [pas.Pipe((1, 0, 0), 1, "auto"), pas.Pipe((-1, 2, 0), 1, "auto")]
    with pas.Session():
        first = pas.blend(pipes, 1, degree="lowest")
        again = pas.blend(pipes[::-1], 1, degree="lowest")
    assert first.certificate.proved
    assert again.certificate.proved
    assert [c.clip for c in again.surface.contacts] == [c.clip for c in first.surface.contacts][::-1]
    for wrong, words in ((5, "contacts must be a list"), ([1, 2], r"contacts\[0\]")):
        with pytest.raises(TypeError, match=words):
            pas.blend(wrong, 1)
