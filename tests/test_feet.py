"""Branches on straight runs: feet, the choice between a foot and a node, and headers of several feet."""

from dataclasses import replace
from fractions import Fraction
from math import cos, radians, sin

import numpy as np
import pytest
from conftest import read
from test_sheet_bodies import is_sound

import pas
from pas.mesh.quality import Quality
from pas.solid.runs import RunSide

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
RUN = pas.Pipe(X, 1, "auto")
HALVES = [(X, 1), ((-1, 0, 0), 1)]


def leaning(angle, digits=6):
    """A direction at so many degrees to the run, in decimals."""
    return (f"{cos(radians(angle)):.{digits}f}", 0, f"{sin(radians(angle)):.{digits}f}")


def concave(blend):
    """The largest concave curvature at the vertices of a mesh, in 1 / unit."""
    points, evaluator = blend.mesh(1e-2).points, pas.Evaluator(blend.surface)
    slopes = evaluator.gradients(points)
    sizes = np.linalg.norm(slopes, axis=1)[:, None, None]
    normals = slopes[:, :, None] / sizes
    across = np.eye(3) - normals @ normals.transpose(0, 2, 1)
    return -np.linalg.eigvalsh(across @ evaluator.hessians(points) @ across / sizes).min()


@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    ("angle", "radius", "bend"),
    [
        (90, "3/10", 1.34),
        (90, "1/2", 1.28),
        (90, "7/10", 1.15),
        (90, "17/20", 0.98),
        (75, "3/10", 1.69),
        (75, "1/2", 1.51),
        (75, "7/10", 1.32),
        (85, "4/5", 1.07),
    ],
)
def test_feet_bend_as_measured(angle, radius, bend):
    """Of nodes these are 1.88, 2.23, 1.92, 1.68 at 90 degrees, and 2.45, 2.23, 1.91 at 75."""
    foot = pas.foot(RUN, pas.Pipe(Z if angle == 90 else leaning(angle), radius, "auto"))
    assert foot.certificate.proved and not foot.fairness.beyond(foot.limits)
    assert foot.surface.degree == 6
    assert concave(foot) == pytest.approx(bend, rel=0.05)


def test_the_cylinder_of_the_run_is_exact_and_met_with_contact():
    foot = pas.foot(RUN, pas.Pipe(leaning(80), "1/2", "auto"))
    opening = foot.surface.contacts[0]
    assert opening.surface == pas.Polynomial("y^2 + z^2 - 1")
    assert foot.certificate.proved
    assert str(foot.certificate).splitlines()[0].startswith("contact 1 GC^1  proved    in <f, h^2> exactly")


@pytest.mark.slow
def test_a_foot_moves_and_scales_with_its_pipes():
    """In the model's units and about any axis: the cylinder, the contacts and the fillet scale."""
    one = pas.foot(RUN, pas.Pipe(Z, "1/2", "auto"))
    run = pas.Pipe((0, 3, 0), "25.4", "auto", (7, 0, "1/3"))
    far = pas.foot(run, pas.Pipe((-2, 0, 0), "12.7", "auto", (7, 5, "1/3")))
    assert far.surface.degree == one.surface.degree
    assert concave(far) == pytest.approx(concave(one) / 25.4, rel=0.05)
    assert far.fairness.sharpness == pytest.approx(one.fairness.sharpness, rel=0.01)
    assert far.surface.contacts[0].surface.at((7, 0, "25.4")) != 0
    assert far.surface.contacts[0].surface.at((Fraction(7) + Fraction("25.4"), 11, "1/3")) == 0


def test_a_branch_is_ended_by_its_clip_which_counts_from_its_point():
    up = pas.foot(RUN, pas.Pipe(Z, "1/2", 3))
    down = pas.foot(RUN, pas.Pipe((0, 0, -1), "1/2", 1, (0, 0, 4)))
    assert up.surface.contacts[1].clip.at((0, 0, 3)) == 0 == down.surface.contacts[1].clip.at((0, 0, 3))
    assert up.surface.polynomials == down.surface.polynomials


@pytest.mark.parametrize(
    ("branch", "error", "words"),
    [
        (
            pas.Pipe(Z, "1/2", "auto", (0, "1/4", 0)),
            pas.GeometryError,
            r"must meet .*, and misses it by 0\.25$",
        ),
        (pas.Pipe(X, "1/2", "auto", (0, 2, 0)), pas.GeometryError, "goes along the run"),
        (pas.Pipe(Z, 1, "auto"), pas.GeometryError, "must be thinner than the run: its radius is 1, that of the run 1"),
        (pas.Cone(Z, "1/2", 2, "1/8"), TypeError, "branch must be a pas.Pipe"),
    ],
)
def test_what_is_no_foot_is_refused(branch, error, words):
    with pytest.raises(error, match=words):
        pas.foot(RUN, branch)


@pytest.mark.sampled(9)
@pytest.mark.parametrize(
    ("items", "order", "reason"),
    [
        ([*HALVES, (Z, "1/2")], 1, "foot, 90 degrees, 0.5 of the run's radius: the run stays exact"),
        ([(Z, "1/2", 4), *HALVES], 1, "foot, 90 degrees, 0.5 of"),
        ([*HALVES, (leaning(76), "7/10")], 1, "foot, 76 degrees, 0.7 of"),
        ([*HALVES, (Z, "1/2")], 2, "node: with GC^2 a foot bends sharper"),
        ([*HALVES, (leaning(70), "1/2")], 1, "node: the branch leans by 20 degrees, a foot by 15 at the most"),
        ([*HALVES, (Z, "9/10")], 1, "node: the branch has 0.9 of the run's radius, a foot 0.85 at the most"),
        ([(X, 1, "3/2"), HALVES[1], (Z, "1/2")], 1, "node: the foot would reach 1.56.* beyond its clip at 1.5"),
        ([(X, 1), (Y, 1), (Z, "1/2")], 1, "node: a foot needs a run of two pipes"),
        ([*HALVES, (Z, 1)], 1, "node: a foot needs a run of two pipes"),
    ],
)
def test_a_junction_is_the_better_one_and_says_which(items, order, reason):
    found = pas.junction(items, order)
    assert found.certificate.proved
    line = next(line for line in str(found).splitlines() if line.startswith("junction"))
    assert line.split(maxsplit=1)[1].startswith(reason.split(".*")[0]) and reason.split(".*")[-1] in line
    assert any(join.opening for join in found.surface.joins) == reason.startswith("foot")


def test_a_node_stays_a_node():
    asked = pas.junction([*HALVES, (Z, "1/2")], partition="fan")
    assert not any(join.opening for join in asked.surface.joins)
    assert asked.reason == "node: a partition is given"


@pytest.fixture(scope="module")
def feet():
    places = [(Z, 0), (Y, 4), ((0, 0, -1), 0)]
    return [pas.foot(RUN, pas.Pipe(axis, "1/2", "auto", (place, 0, 0))) for axis, place in places]


@pytest.mark.slow
def test_a_header_is_one_solid_with_proved_joints(feet):
    header = pas.header(RUN, feet, (-3, 7), 1)
    assert header.proved and len(header.verdicts) == 2 * len(feet)
    assert header.faces[:6] == ("run", "run start", "run end", "foot 1", "branch 1", "branch 1 end")
    mesh = is_sound(header.mesh(5e-2), header, 5e-2, 2)
    assert {*header.faces} == {*mesh.names}
    one = pas.header(RUN, feet[1:2], (-3, 7), 1)
    beyond, single = (solid.volume(5e-2) - 10 * np.pi for solid in (header, one))
    assert beyond == pytest.approx(3 * single, rel=0.05)


@pytest.mark.parametrize(("axis", "radius"), [(Z, "17/20"), (leaning(77, 4), "1/2")])
@pytest.mark.sampled(2)
def test_a_foot_takes_the_place_of_the_run_where_it_dips_below_it(axis, radius):
    """A thick one lies a little inside the cylinder near the ends of its opening: there is no edge there."""
    header = pas.header(RUN, [pas.foot(RUN, pas.Pipe(axis, radius, "auto"))], (-5, 5), 1)
    mesh = header.sheets.mesh(1e-2, Quality.BALANCED)
    assert header.proved and is_sound(mesh, header, 1e-2, 2).volume > 10 * np.pi


def test_the_branches_of_a_header_may_end_at_their_clips(feet):
    header = pas.header(RUN, feet[:1], (-2, 2), 0)
    assert header.faces == ("run", "run start", "run end", "foot 1", "branch 1 end") and header.proved


@pytest.mark.slow
def test_a_hollow_header_has_a_bore_through_run_and_branches(feet):
    hollow = [feet[0].hollow("1/8")]
    header = pas.header(RUN, hollow, (-2, 2), "1/2")
    inside = [(0, 0, 0), (-1.9, 0, 0.8), (0, 0, 2.5), (0, 0.3, 2.5)]
    assert not header.contains(inside).any()
    assert header.contains([(-1.9, 0, 0.95), (1.9, 0.95, 0), (0, 0.45, 2.5)]).all()
    mesh = is_sound(header.mesh(2e-2), header, 2e-2, -2)
    assert {*header.faces} - {*mesh.names} == {f"inside of {end} end" for end in ("branch 1", "run")} | {
        "inside of run start"
    }
    row = header | header.translate((4, 0, 0))
    assert [(link.number, link.other_number) for link in row.sheets.links] == [(1, 0)]
    assert is_sound(row.mesh(5e-2), row, 5e-2, -4).volume == pytest.approx(2 * mesh.volume, rel=5e-2)


def test_feet_of_a_header_are_apart(feet):
    """A plane is between two of them along the run, across it, and not between one and itself."""
    for two, apart in ((feet[:2], True), (feet[::2], True), (feet[:1] * 2, False)):
        sides = [pas.header(RUN, [foot], (-3, 7), 1).sheets.sides[0] for foot in two]
        both = RunSide("run", sides[0].ends, sum((s.feet for s in sides), ()), sum((s.openings for s in sides), ()))
        assert both.apart == apart


@pytest.mark.slow
def test_the_lattice_says_the_same_of_a_hollow_header(feet):
    wall = feet[0].hollow("1/8")
    header = pas.header(RUN, [wall], (-2, 2), "1/2")
    assert wall.certificate.proved and header.proved
    lattice = replace(header, sheets=None)
    assert header.volume(5e-2) == pytest.approx(lattice.volume(5e-2), rel=1e-3)
    assert header.area(5e-2) == pytest.approx(lattice.area(5e-2), rel=1e-3)


@pytest.mark.slow
def test_a_hollow_header_of_three_feet_is_bounded_by_sheets(feet):
    header = pas.header(RUN, [foot.hollow("1/8") for foot in feet], (-3, 7), 1)
    assert header.sheets is not None
    for tolerance in (5e-2, 1e-2, 1e-3):
        mesh = is_sound(header.mesh(tolerance), header, tolerance, 2 * (2 - 5))
    assert header.volume(1e-2) == pytest.approx(mesh.volume, rel=1e-3)


@pytest.mark.slow
def test_branches_that_meet_have_no_sheets():
    """They lean towards one another, and cross where they are long enough: no plane is between the feet then."""
    branches = [pas.Pipe((sign, 0, 4), "1/4", "auto", (-2 * sign, 0, 0)) for sign in (1, -1)]
    feet = [pas.foot(RUN, branch) for branch in branches]
    short, long = (pas.header(RUN, feet, (-4, 4), length) for length in (1, 6))
    assert is_sound(short.sheets.mesh(5e-2, Quality.BALANCED), short, 5e-2, 2) is not None
    assert long.sheets.mesh(5e-2, Quality.BALANCED) is None


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda feet: (RUN, feet, (-1, 7)), pas.GeometryError, r"foot 1 goes from -1\.562 to 1\.562 along the run"),
        (
            lambda feet: (pas.Pipe(X, 2, 1), feet, (-3, 7)),
            pas.GeometryError,
            "foot 1 is no blend of one opening in this",
        ),
        (lambda feet: (RUN, [feet[0], feet[0]], (-3, 7)), pas.GeometryError, "openings of feet 1 and 2 meet; move"),
        (lambda feet: (RUN, feet, (7, -3)), ValueError, "ends must be a smaller and a larger number"),
        (lambda feet: (RUN, [], (-3, 7)), TypeError, "a header is made of a pas.Pipe and feet on it"),
        (lambda feet: (RUN, [feet[0], read("hollow_foot")], (-3, 7)), ValueError, "must be all full or all hollow"),
        (lambda feet: (RUN, [1], (-3, 7)), TypeError, "a header is made of a pas.Pipe and feet on it"),
    ],
)
def test_headers_that_cannot_be_are_refused(feet, make, error, words):
    with pytest.raises(error, match=words):
        pas.header(*make(feet))


def test_the_sentence_on_a_piece_around_an_opening_names_the_header(feet):
    with pytest.raises(pas.GeometryError, match=r"take 0\.\d+ instead; of a straight run pas\.header gives"):
        feet[0].solid(1)
