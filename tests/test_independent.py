"""The independent checker: it agrees with the first, refutes what is broken, and never contradicts."""

from __future__ import annotations

import ast
import json
import random
from collections import defaultdict
from fractions import Fraction
from itertools import product
from math import factorial, prod

import pytest
from conftest import DATA, EQUAL, ROOT, UNEQUAL, pipes, solved
from flint import fmpq

import pas
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import RING as PLAIN
from pas.bernstein.forms import b_form, on_simplex
from pas.cli import main
from pas.errors import PasError
from pas.exchange.files import write_project
from pas.exchange.records import SURFACE
from pas.independent import checker, reading, signs
from pas.independent.checker import Finding, check_independently

COAXIAL = [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "-x - 1")]
ELBOW = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
THREE = [*ELBOW, ("x^2 + y^2 - 1", "z - 2")]
SPHERES = [("(x + 2)^2 + y^2 + z^2 - 4", "-x - 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")]
FOUR = [("y^2 + z^2 - 1", "x - 2"), ("y^2 + z^2 - 1", "-x - 2"), *[("x^2 + z^2 - 1", f"{s}y - 2") for s in ("", "-")]]
BOX = ((-2, -2, -2), (2, 2, 2))


def findings(record, folder) -> dict[str, Finding]:
    """The second checker's verdicts on a surface's record."""
    path = write_project(folder / "surface.pas.json", {"kind": "blend", "surface": record}, "tests")
    found = check_independently(path)
    assert len({f.claim for f in found}) == len(found)
    return {f.claim: f for f in found}


def first_statuses(record) -> dict[str, str]:
    """The first implementation's verdicts; a face between two patches may lie in several planes."""
    found = defaultdict(list)
    for verdict in SURFACE.read(record).certify().verdicts:
        found[verdict.claim].append(verdict.status.value)
    return {c: next((s for s in ("refuted", "undecided") if s in found[c]), "proved") for c in found}


def both(surface, folder) -> tuple[dict[str, str], dict[str, str]]:
    """Both verdicts on a surface or its record, by claim; they must not contradict one another."""
    record = surface if isinstance(surface, dict) else SURFACE.write(surface)
    second = findings(record, folder)
    first = first_statuses(record)
    assert second.keys() == first.keys() | {"region"}
    for claim, status in first.items():
        assert {status, second[claim].status} != {"proved", "refuted"}, second[claim]
    for finding in second.values():
        assert (len(finding.witness) in (1, 2)) == (finding.status == "refuted") or finding.status == "undecided"
    return first, {claim: finding.status for claim, finding in second.items()}


def all_proved(statuses) -> bool:
    return set(statuses.values()) == {"proved"}


def changed(surface, change) -> pas.PiecewiseSurface:
    """The surface with `change(number, polynomial)` for each patch."""
    polynomials = [change(i, p) for i, p in enumerate(surface.polynomials)]
    return pas.PiecewiseSurface.from_polynomials(surface.partition, surface.contacts, surface.order, polynomials)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("radii", [EQUAL, UNEQUAL])
@pytest.mark.parametrize("order", [1, 2, pytest.param(3, marks=pytest.mark.slow)])
def test_corners_are_proved_by_both(radii, order, tmp_path):
    first, second = both(solved(radii, order).surface, tmp_path)
    assert all_proved(first)
    assert all_proved(second)


def test_a_corner_elsewhere(tmp_path):
    """Far from the origin, of another size, and turned."""
    axes = ((1, 2, 2), (2, 1, -2), (2, -2, 1))
    turned = [pas.Pipe(axis=a, radius=1000, clip=2000, point=(7000, -5000, 1000)) for a in axes]
    first, second = both(pas.blend(turned, 1, energy=pas.ThinPlate()).surface, tmp_path)
    assert all_proved(first)
    assert all_proved(second)


@pytest.mark.parametrize(
    ("contacts", "box", "order"),
    [
        (COAXIAL, ((-1, -3, -3), (1, 3, 3)), 1),
        (COAXIAL, ((-1, -3, -3), (1, 3, 3)), 2),
        (ELBOW, BOX, 1),
        (THREE, BOX, 1),
        (SPHERES, ((-2, -3, -3), (1, 3, 3)), 2),
        (FOUR, BOX, 1),
    ],
)
@pytest.mark.sampled(2)
def test_single_cells_are_proved_by_both(contacts, box, order, tmp_path):
    if contacts is FOUR:
        space = pas.solutions(FOUR, order, partition=pas.SingleCell(*box))
        surface = space.fit(inside=[(0, 0, 0)], normalize=pas.ValueAt((0, 0, 0), -1)).surface
    else:
        surface = pas.blend(contacts, order, partition=pas.SingleCell(*box), energy=pas.ThinPlate()).surface
    first, second = both(surface, tmp_path)
    assert all_proved(first)
    assert all_proved(second)


@pytest.mark.parametrize("name", ["a", "b", "c", "proved"])
def test_published_corners(name, tmp_path):
    problem = pas.read_problem(ROOT / f"examples/corners/published_{name}.toml")
    blend = pas.blend(problem.contacts, problem.order, problem.degree, **problem.options)
    first, second = both(blend.surface, tmp_path)
    assert second["region"] == "proved"
    assert {c: s for c, s in second.items() if c != "region"} == first
    assert all_proved(second) == (name == "proved")


PUBLISHED = json.loads((DATA / "published.json").read_text())
HARD = {("coaxial", 2), ("perpendicular", 2), ("perpendicular", 3), ("perpendicular", 4)}
"""Singular along a curve: both give up, after a while."""


@pytest.mark.parametrize(
    ("name", "number"),
    [
        pytest.param(name, i, marks=pytest.mark.slow if (name, i) in HARD else ())
        for name in ("coaxial", "perpendicular")
        for i in range(len(PUBLISHED[name]["gens"]))
    ],
)
def test_published_generators(name, number, tmp_path):
    """Taken alone they are no blends, but for one."""
    contacts = [pas.Contact(*c) for c in (COAXIAL if name == "coaxial" else ELBOW)]
    cell = pas.SingleCell(*zip(*PUBLISHED[name]["box"], strict=True))
    polynomial = PUBLISHED[name]["gens"][number]
    first, second = both(pas.PiecewiseSurface.from_polynomials(cell, contacts, 1, [polynomial]), tmp_path)
    good = (name, number) == ("perpendicular", 1)
    assert all_proved(first) == all_proved(second) == good
    assert good or "refuted" in second.values()


# each rule broken alone


@pytest.fixture
def good() -> pas.PiecewiseSurface:
    """A corner proved by both."""
    return solved(EQUAL, 1).surface


@pytest.fixture(params=[1, 2])
def of_order(request) -> pas.PiecewiseSurface:
    """The corners of order 1 and 2, proved by both."""
    return solved(EQUAL, request.param).surface


def wrong(statuses) -> set[str]:
    """The claims that are not proved."""
    return {claim for claim, status in statuses.items() if status != "proved"}


def refuted(statuses) -> set[str]:
    """The claims that are refuted."""
    return {claim for claim, status in statuses.items() if status == "refuted"}


TINY = Fraction(1, 10**40)


@pytest.mark.parametrize("term", ["1", "x*y*z", "y^2"])
@pytest.mark.sampled(2)
def test_a_coefficient_off_by_little(of_order, term, tmp_path):
    bad = changed(of_order, lambda i, p: p + pas.Polynomial(term) * TINY if i == 0 else p)
    first, second = both(bad, tmp_path)
    k = of_order.order
    for statuses in (first, second):
        assert refuted(statuses) == {f"contact 1 GC^{k}", f"face 1|2 C^{k}", f"face 1|6 C^{k}"}
        assert wrong(statuses) - refuted(statuses) == {"enclosed"}  # since contact 1 is not even met with GC^0


@pytest.mark.parametrize("contact", [1, 2, 3])
@pytest.mark.sampled(2)
def test_a_contact_alone_is_broken(of_order, contact, tmp_path):
    cell, k = 2 * contact - 2, of_order.order
    planes = [f.plane for f in of_order.partition.interior_faces if cell in (f.first, f.second)]
    bump = (planes[0] * planes[1]) ** (k + 1) * TINY
    first, second = both(changed(of_order, lambda i, p: p + bump if i == cell else p), tmp_path)
    assert refuted(first) == refuted(second) == {f"contact {contact} GC^{k}"}


@pytest.mark.parametrize("face", range(6))
@pytest.mark.sampled(3)
def test_a_face_alone_is_broken(of_order, face, tmp_path):
    """Both sides of one plane through the axis get a multiple of it that the contacts do not feel."""
    k = of_order.order
    broken = of_order.partition.interior_faces[face]
    cell = next(c for c in (broken.first, broken.second) if c % 2)
    other = next(f for f in of_order.partition.interior_faces if f is not broken and cell in (f.first, f.second))
    bump = broken.plane**k * other.plane ** (k + 1) * TINY
    first, second = both(changed(of_order, lambda i, p: p + bump if i == cell else p), tmp_path)
    claim = f"face {min(broken.first, broken.second) + 1}|{max(broken.first, broken.second) + 1} C^{k}"
    assert wrong(second) == wrong(first) == {claim}
    assert first[claim] == second[claim] == "refuted"


def test_swapped_patches(good, tmp_path):
    patches = list(good.polynomials)
    patches[0], patches[2] = patches[2], patches[0]
    first, second = both(changed(good, lambda i, _: patches[i]), tmp_path)
    k = good.order
    for claim in (f"contact 1 GC^{k}", f"contact 2 GC^{k}", f"face 1|2 C^{k}"):
        assert first[claim] == second[claim] == "refuted"
    assert second[f"contact 3 GC^{k}"] == second[f"face 4|5 C^{k}"] == "proved"


def test_an_order_too_high(of_order, tmp_path):
    record = SURFACE.write(of_order) | {"order": of_order.order + 1}
    first, second = both(record, tmp_path)
    k = of_order.order + 1
    assert refuted(second) == refuted(first) == {c for c in second if c.startswith(("contact", "face"))}
    assert f"it is met with GC^{k - 1} only" in str(findings(record, tmp_path)[f"contact 1 GC^{k}"])


@pytest.mark.parametrize(("place", "radius"), [((0, "-1/4", 0), "1/50"), (("-3/4", "-3/4", "-3/4"), "1/20")])
@pytest.mark.sampled(2)
def test_a_second_sheet(good, place, radius, tmp_path):
    bubble = ball(map(Fraction, place), radius)
    bad = changed(good, lambda _, p: p * bubble)
    first, second = both(bad, tmp_path)
    assert wrong(second) == wrong(first) == {"one sheet"}
    witness = findings(SURFACE.write(bad), tmp_path)["one sheet"].witness
    values = [[p.at(w[:3]) for p in bad.polynomials] for w in witness]
    assert any(a * b < 0 for a, b in zip(*values, strict=True))  # the surface lies in between
    ends = [bubble.at(w[:3]) for w in witness]
    assert min(ends) < 0 < max(ends)  # and it is the bubble


@pytest.mark.parametrize("depth", ["1/1000", "1/10^12", "1/10^40"])
def test_a_bitten_wall(good, depth, tmp_path):
    """Just above the point Z1 the surface is cut off by a plane: no face and no contact feels the factor."""
    corner = max(good.partition.vertices, key=sum)
    plane = pas.Polynomial("x + y + z") - sum(map(Fraction, map(str, corner))) + pas.Polynomial(depth)
    first, second = both(changed(good, lambda _, p: p * -plane), tmp_path)
    assert second["enclosed"] == "refuted"
    assert all(second[c] == "proved" for c in second if c.startswith(("contact", "face", "region")))
    assert first["enclosed"] in ("refuted", "undecided")


def middle(points) -> list[Fraction]:
    return [sum(map(Fraction, map(str, column))) / len(points) for column in zip(*points, strict=True)]


def ball(center, radius) -> pas.Polynomial:
    terms = [(pas.Polynomial(v) - c) ** 2 for v, c in zip("xyz", center, strict=True)]
    return terms[0] + terms[1] + terms[2] - Fraction(radius) ** 2


@pytest.mark.parametrize("number", range(12))
@pytest.mark.sampled(3)
def test_each_outer_face_bitten_alone(good, number, tmp_path):
    """A hole in one wall or clip face is found on it."""
    face = good.partition.outer_faces[number]
    hole = ball(middle(good.partition.corners(face.vertices)), "1/50")
    surface = reading.Surface(SURFACE.write(changed(good, lambda _, p: p * hole)))
    finding = checker._enclosed(surface, [checker._contact(surface, i) for i in range(len(surface.contacts))])
    assert finding.status == "refuted"
    (witness,) = finding.witness
    assert hole.at(witness[:3]) <= 0
    assert face.plane.at(witness[:3]) == 0


@pytest.mark.sampled(3)
@pytest.mark.parametrize("number", range(6))
def test_a_bubble_in_each_cell(good, number, tmp_path):
    cell = good.partition.cells[number]
    bubble = ball(middle(good.partition.corners(cell)), "1/20")
    surface = reading.Surface(SURFACE.write(changed(good, lambda i, p: p * bubble if i == number else p)))
    finding = checker._one_sheet(surface, checker._region(surface))
    assert finding.status == "refuted"
    assert min(bubble.at(w[:3]) for w in finding.witness) < 0 < max(bubble.at(w[:3]) for w in finding.witness)


def test_a_bitten_clip_face(good, tmp_path):
    hole = ball((1, Fraction(1, 2), Fraction(2, 5)), "1/20")
    bad = changed(good, lambda _, p: p * hole)
    first, second = both(bad, tmp_path)
    assert first["enclosed"] == second["enclosed"] == "refuted"
    (witness,) = findings(SURFACE.write(bad), tmp_path)["enclosed"].witness
    assert witness[0] == 1
    assert hole.at(witness[:3]) <= 0


def test_inside_out(good, tmp_path):
    first, second = both(changed(good, lambda _, p: -p), tmp_path)
    assert wrong(second) == wrong(first) == {c for c in second if c.startswith(("contact", "one", "enclosed"))}


def test_alpha_of_changing_sign(good, tmp_path):
    first, second = both(changed(good, lambda _, p: p * pas.Polynomial("1/10 - y - z/3")), tmp_path)
    assert first[f"contact 1 GC^{good.order}"] == second[f"contact 1 GC^{good.order}"] == "refuted"


@pytest.mark.parametrize("number", range(3))
def test_a_reversed_clip(good, number, tmp_path):
    record = SURFACE.write(good)
    record["contacts"][number]["clip"] = f"-({record['contacts'][number]['clip']})"
    found = findings(record, tmp_path)
    assert wrong({c: f.status for c, f in found.items()}) == {f"contact {number + 1} GC^{good.order}"}
    finding = found[f"contact {number + 1} GC^{good.order}"]
    assert finding.status == "refuted"
    assert pas.Polynomial(record["contacts"][number]["clip"]).at(finding.witness[0][:3]) > 0


def test_the_centre_is_outside_the_surface(good, tmp_path):
    first, second = both(changed(good, lambda _, p: p + 100), tmp_path)
    assert first["one sheet"] == second["one sheet"] == "refuted"


# the region


def as_tetrahedra(surface) -> dict:
    """The record of a surface on the same cells, without the partition's own kind."""
    record = SURFACE.write(surface)
    cells = surface.partition.cells
    partition = pas.Partition(surface.partition.vertices, cells, surface.partition.center)
    record["partition"] = SURFACE.write(
        pas.PiecewiseSurface(partition, surface.contacts, surface.order, surface.patches)
    )["partition"]
    return record


def test_general_tetrahedra(good, tmp_path):
    first, second = both(as_tetrahedra(good), tmp_path)
    assert all_proved(first)
    assert all_proved(second)


def test_without_a_centre(good, tmp_path):
    record = as_tetrahedra(good)
    record["partition"]["center"] = None
    first, second = both(record, tmp_path)
    assert wrong(second) == {"region", "one sheet"}
    assert wrong(first) == {"one sheet"}


def broken_region(record, how) -> None:
    partition = record["partition"]
    if how == "a cell is missing":
        partition["cells"].pop()
        partition["pieces"].pop()
        record["patches"].pop()
    elif how == "the centre is outside":
        partition["center"] = ["5", "5", "5"]
    elif how == "the centre is beside the interior faces":
        partition["center"] = ["1/100", "0", "0"]
    elif how == "the centre is on the boundary":
        partition["center"] = partition["vertices"][0]
    elif how == "a cell is flat":
        partition["vertices"].append(
            [str(sum(Fraction(partition["vertices"][v][i]) for v in (0, 1))) for i in range(3)]
        )
        partition["cells"][0] = [0, 1, 2, 8]
    elif how == "a cell is there twice":
        partition["cells"].append(partition["cells"][0])
        partition["pieces"].append([6])
        record["patches"].append(record["patches"][0])
    elif how == "a cell lies on another":
        partition["cells"][1] = [0, 1, 2, 7]  # beyond V6 and V1, over the last cell
    elif "twice around" in how:
        axis, ring = partition["vertices"][:2], partition["vertices"][2:]
        second = ring if "same points" in how else [[str(2 * Fraction(c)) for c in point] for point in ring]
        partition["vertices"] = [*axis, *ring, *second]
        partition["cells"] = [[0, 1, 2 + (i - 1) % 12, 2 + i] for i in range(12)]
        partition["pieces"] = [[i] for i in range(12)]
        record["patches"] *= 2


BROKEN = [
    "a cell is missing",
    "the centre is outside",
    "the centre is beside the interior faces",
    "the centre is on the boundary",
    "a cell is flat",
    "a cell is there twice",
    "a cell lies on another",
    "twice around",
    "twice around by the same points",
]


@pytest.mark.parametrize("how", BROKEN)
def test_broken_regions(good, how, tmp_path):
    record = as_tetrahedra(good)
    broken_region(record, how)
    with pytest.raises(PasError):
        SURFACE.read(record)
    found = findings(record, tmp_path)
    assert found["region"].status == "refuted"
    assert found["one sheet"].status != "proved"


VERTICES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 2), (0, 0, -1), (1, 1, 0)]


@pytest.mark.parametrize(
    ("cells", "status"),
    [
        ([(0, 1, 2, 3), (0, 1, 2, 5)], "undecided"),  # a good mesh, but without a centre to look from
        ([(0, 1, 2, 3), (0, 1, 2, 4)], "refuted"),  # on the same side
        ([(0, 1, 2, 3), (0, 1, 2, 6)], "refuted"),  # flat
        ([(0, 1, 2, 3), (0, 1, 2, 5), (0, 1, 2, 4)], "refuted"),  # three at a face
    ],
)
def test_cells_without_a_centre(cells, status, tmp_path):
    partition = {"kind": "tetrahedra", "center": None, "vertices": VERTICES, "cells": cells}
    partition["pieces"] = [[i] for i in range(len(cells))]
    record = {"order": 1, "degree": 0, "contacts": [], "patches": [[[0, 0, 0, "1"]]] * len(cells)}
    record["partition"] = partition
    assert findings(record, tmp_path)["region"].status == status


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_random_corners_broken_at_random(seed, tmp_path):
    """A bubble, a coefficient off by little, and a plane as a factor, of corners drawn at random."""
    generator = random.Random(seed)
    radii, clips = ([Fraction(generator.randint(*r), 20) for _ in range(3)] for r in ((1, 4), (10, 40)))
    try:
        surface = pas.blend(pipes(radii, clips), generator.choice((1, 1, 2)), energy=pas.ThinPlate()).surface
    except pas.GeometryError:
        pytest.skip("a circle does not fit its face")
    first, second = both(surface, tmp_path)
    assert all_proved(first)
    assert all_proved(second)
    place = [Fraction(generator.randint(-20, 20), 20) for _ in range(3)]
    bubble = ball(place, Fraction(1, 10 ** generator.randint(1, 6)))
    both(changed(surface, lambda _, p: p * bubble), tmp_path)
    cell, term = generator.randrange(6), pas.Polynomial(generator.choice(["1", "x", "y^2", "x*y*z", "z^3"]))
    tiny = term * Fraction(generator.choice((-1, 1)), 10 ** generator.randint(1, 60))
    _, second = both(changed(surface, lambda i, p: p + tiny if i == cell else p), tmp_path)
    assert refuted(second) >= {c for c in second if c.startswith("face") and str(cell + 1) in c.split()[1].split("|")}
    plane = (
        pas.Polynomial("x") + pas.Polynomial("y") * generator.randint(-3, 3) + Fraction(generator.randint(-30, 30), 10)
    )
    both(changed(surface, lambda _, p: p * plane), tmp_path)


# what is not served, or served by the second only


def test_curved_and_reducible_clips_are_undecided(tmp_path):
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    for clip in ("x - 1 + 3*(y^2 - 1)", "(x - 1)*(2*x - 1)", "(x - 1)^2"):
        contact = pas.Contact("y^2 + z^2 - 1/4", clip)
        surface = pas.PiecewiseSurface.from_polynomials(cell, [contact], 1, ["(y^2 + z^2 - 1/4)*(7/2 - x)"])
        found = findings(SURFACE.write(surface), tmp_path)
        assert found["contact 1 GC^1"].status == found["enclosed"].status == "undecided"


def test_a_contact_met_in_the_region_only(tmp_path):
    """Two circles in the clip plane: the one in the region is met, the other, elsewhere, is not."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    contact = pas.Contact("(y^2 + z^2 - 1/4)*((y - 5)^2 + z^2 - 1)", "x - 1")
    meets = "(y^2 + z^2 - 1/4)*(2 - x) + (x - 1)^2/9"
    for polynomial, status in ((meets, "proved"), (f"{meets} + (x - 1)/10^40", "refuted")):
        surface = pas.PiecewiseSurface.from_polynomials(cell, [contact], 1, [polynomial])
        assert findings(SURFACE.write(surface), tmp_path)["contact 1 GC^1"].status == status


def test_a_clip_plane_that_comes_into_the_region_again(tmp_path):
    """V3 is pulled beyond the plane of the first clip, where the contact has another part that would be cut."""
    partition = SURFACE.write(solved(EQUAL, 1).surface)["partition"]
    cells = pas.SixTetrahedra(partition["center"], partition["legs"])
    vertices = [*cells.vertices[:4], ("3/2", "7/2", "5/2"), *cells.vertices[5:]]
    whole = pas.Partition(vertices, cells.cells, (0, 0, 0), [range(6)])
    for other, status in (("(x - 1)^2 + (y - 21/10)^2 + (z - 16/10)^2 - 1/100", "undecided"), ("x + 9", "proved")):
        contact = pas.Contact(f"(y^2 + z^2 - 1/9)*({other})", "x - 1")
        surface = pas.PiecewiseSurface.from_polynomials(whole, [contact], 1, [contact.surface])
        assert findings(SURFACE.write(surface), tmp_path)["contact 1 GC^1"].status == status


def test_a_curve_that_crosses_itself_is_not_regular(tmp_path):
    """The figure of eight, with alpha = 1 all along it; and two circles in its place."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    for offset, status in (("0", "undecided"), ("1/300", "proved")):
        contact = pas.Contact(f"(y^2 + z^2)^2 - (y^2 - z^2)/4 + {offset}", "x - 1")
        surface = pas.PiecewiseSurface.from_polynomials(cell, [contact], 1, [contact.surface])
        assert findings(SURFACE.write(surface), tmp_path)["contact 1 GC^1"].status == status


def test_a_curve_that_leaves_its_clip_face(tmp_path):
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    contact = pas.Contact("y^2 + (z - 3/4)^2 - 1/4", "x - 1")
    surface = pas.PiecewiseSurface.from_polynomials(cell, [contact], 1, [contact.surface])
    finding = findings(SURFACE.write(surface), tmp_path)["contact 1 GC^1"]
    assert finding.status == "refuted"
    assert contact.surface.at(finding.witness[0][:3]) <= 0
    assert finding.witness[0][:1] == (1,)


def test_a_cone_that_leaves_through_the_walls(tmp_path):
    """It is met on its clip face, and on no other face is it asked for."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    contact = pas.Contact("y^2 + z^2 - (3/2 - x)^2", "x - 1")
    polynomial = contact.surface * pas.Polynomial("2 - x") + pas.Polynomial("(x - 1)^2/9")
    first, second = both(pas.PiecewiseSurface.from_polynomials(cell, [contact], 1, [polynomial]), tmp_path)
    assert first["contact 1 GC^1"] == second["contact 1 GC^1"] == "proved"
    assert first["enclosed"] == second["enclosed"] == "refuted"


def test_two_contacts_in_one_clip_plane(tmp_path):
    """Each is the way out of the other: alpha of one changes its sign within the other, and nothing is wrong."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    pair = ("(y - 1/2)^2 + z^2 - 1/16", "(y + 1/2)^2 + z^2 - 1/16")
    contacts = [pas.Contact(f, f"{s}x - 1") for f in pair for s in ("", "-")]
    surface = pas.PiecewiseSurface.from_polynomials(cell, contacts, 1, [f"({pair[0]})*({pair[1]})"])
    found = findings(SURFACE.write(surface), tmp_path)
    assert {c for c in found if found[c].status == "proved"} == found.keys() - {"one sheet"}


def test_a_surface_that_touches_its_contact_is_undecided(tmp_path):
    """A factor that no factorisation tells apart from the curve: honest, not wrong."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    surface = pas.PiecewiseSurface.from_polynomials(
        cell, [pas.Contact("(y^2 + z^2 - 1/4)^2", "x - 1")], 0, ["y^2 + z^2 - 1/4"]
    )
    found = findings(SURFACE.write(surface), tmp_path)
    assert found["contact 1 GC^0"].status == "undecided"


# the arithmetic

SEGMENT = [(fmpq(0), fmpq(0), fmpq(0), fmpq(1)), (fmpq(1), fmpq(0), fmpq(0), fmpq(1))]
AT_0, AT_1 = signs.RING.gens()[:2]
"""The barycentric coordinates of the segment from x = 0 to x = 1."""

ANY = AT_0 + AT_1
"""1 there."""

NEAR = [fmpq(79, 128), fmpq(159, 256)]
"""On both sides of where x^2 + x = 1."""


@pytest.mark.parametrize(
    ("value", "zero", "status", "where"),
    [
        (AT_0 + 2 * AT_1, None, "proved", []),
        (AT_0, None, "refuted", [1]),
        (AT_0 - 1000 * AT_1, None, "refuted", [1]),
        (3 * AT_0 * AT_0 - 4 * AT_0 * AT_1 + 3 * AT_1 * AT_1, None, "proved", []),
        (AT_1 - AT_0, AT_1, "refuted", [0]),
        (AT_0 - AT_1, AT_1, "proved", []),
        (AT_0 - AT_1, AT_0 - 2 * AT_1, "proved", []),
        (AT_1 - AT_0, AT_0 - 2 * AT_1, "refuted", [fmpq(1, 4), fmpq(3, 8)]),
        (AT_0 - 3 * AT_1 + ANY / 10**30, 3 * AT_1 - AT_0, "proved", []),  # any multiple may be added
        (AT_0 - 3 * AT_1, 3 * AT_1 - AT_0, "undecided", []),
        (AT_0 * AT_1 - 3 * AT_0**2 + AT_1**2 / 2, AT_0 * ANY - AT_1**2, "refuted", NEAR),
        (AT_1, AT_1, "undecided", []),  # zero where it matters is not refuted: see the docstring
        (signs.ZERO, signs.ONE, "proved", []),
        (signs.ZERO, None, "refuted", [0]),
    ],
)
def test_a_claim_is_decided_where_it_matters_only(value, zero, status, where):
    found, witness = signs.positive([signs.Query(SEGMENT, value, zero)], 900)
    assert found == status
    if status != "undecided":
        assert sorted(p[0] for p in witness) == where


def random_fraction(generator: random.Random) -> fmpq:
    return fmpq(generator.choice((-1, 1)) * generator.randint(1, 12), generator.randint(1, 6))


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("degree", [0, 1, 2, 5])
def test_forms_and_halves(dimension, degree):
    """B-coefficients are those of the first implementation, times a number; halves are forms on the halves."""
    generator, size = random.Random(10 * degree + dimension), dimension + 1
    corners = [tuple(random_fraction(generator) for _ in range(3)) for _ in range(size)]
    exponents = [e for e in product(range(degree + 1), repeat=3) if sum(e) <= degree]
    plain = PLAIN.from_dict({e: random_fraction(generator) for e in exponents})
    whole = signs.RING.from_dict({(*e, degree - sum(e)): c for e, c in plain.to_dict().items()})

    def compared(form, points):
        """The ratios of a form and the first implementation's on a simplex, where either is not zero."""
        order = {e: k for k, e in enumerate(homogeneous_exponents(degree, size))}
        first = b_form(on_simplex(plain, points), degree, dimension)
        found = {e[:size]: c * prod(map(factorial, e)) for e, c in form.to_dict().items()}
        pairs = [(found.get(e, 0), first[k]) for e, k in order.items()]
        return {fmpq(v) / w if w else None for v, w in pairs if v or w}

    places = tuple((*p, fmpq(1)) for p in corners)
    form = signs._whole(signs.on_simplex(whole, places))
    (scale,) = compared(form, corners)
    assert scale > 0
    for points, (half,) in signs._halves(places, [form]):
        assert sum(p not in places for p in points) == 1
        assert compared(half, [p[:3] for p in points]) == {scale * 2**degree}
    least, most = signs._range(form, size)
    coefficients = [form.to_dict().get((*e, *[0] * (4 - size)), 0) for e in homogeneous_exponents(degree, size)]
    assert (least, most) == (min(coefficients), max(coefficients))


def test_no_floating_point():
    """No float anywhere, and nothing of the first implementation but polynomials and how files are read."""
    allowed = {f"pas.{n}" for n in ("algebra.inputs", "algebra.polynomial", "algebra.rational", "errors", "limits")}
    allowed |= {f"pas.exchange.{n}" for n in ("files", "schema")}
    for path in (ROOT / "pas/independent").glob("*.py"):
        tree = ast.parse(path.read_text())
        annotations = {
            n for a in ast.walk(tree) if isinstance(a, ast.arg) and a.annotation for n in ast.walk(a.annotation)
        }
        for node in set(ast.walk(tree)) - annotations:  # the time limit is a float
            assert not (isinstance(node, ast.Constant) and isinstance(node.value, float))
            assert not (isinstance(node, ast.Name) and node.id in ("float", "round"))
            if isinstance(node, ast.ImportFrom) and node.module.startswith("pas"):
                assert node.module in allowed or node.module.startswith("pas.independent")
            names = [node.module] if isinstance(node, ast.ImportFrom) else []
            names += [a.name for a in node.names] if isinstance(node, ast.Import) else []
            assert not {n.split(".")[0] for n in names} & {"numpy", "scipy", "sympy", "decimal", "mpmath"}


# the command


def test_the_command(good, tmp_path, capsys):
    path = tmp_path / "corner.pas.json"
    solved(EQUAL, good.order).save(path)
    assert main(["check", str(path), "--independent"]) == 0
    assert "all proved" in capsys.readouterr().out
    assert main(["check", str(path), "--independent", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["proved"] is True
    assert len(told["verdicts"]) == 12
    assert main(["check", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verdicts"][0]["claim"] == f"contact 1 GC^{good.order}"
    record = json.loads(path.read_text())
    record["content"]["surface"]["patches"][0][0][3] += "1"
    path.write_text(json.dumps(record))
    assert main(["check", str(path), "--independent"]) == 2
    assert "checksum" in capsys.readouterr().err
    assert main(["check", str(path), "--independent", "--edited", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    refuted = [v for v in told["verdicts"] if v["status"] == "refuted"]
    assert refuted
    assert all(isinstance(Fraction(c), Fraction) for v in refuted for point in v["witness"] for c in point)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"order": -1}, "order"),
        ({"order": True}, "order"),
        ({"order": "1"}, "order"),
        ({"order": 2001}, "order"),
        ({"patches": []}, "cannot be understood"),
        ({"partition": {"kind": "cone", "center": None}}, "no partition"),
        ({"contacts": [{"surface": "x", "clip": "x*y"}]}, "curve"),
        ({"partition": None}, "cannot be understood"),
        ({"patches": [[[0, 0, 0, "1/0"]]] * 6}, "cannot be understood"),
        ({"patches": [[[0, 0, -1, "1"]]] * 6}, "cannot be understood"),
        ({"patches": [[[0, 0, 0, "1"], [0, 0, 0, "-1"]]] * 6}, "stands twice"),
        ({"patches": [[[0, 9, 50, "1"]]] * 6}, "may be of degree 16"),
    ],
)
def test_files_that_make_no_sense(good, change, words, tmp_path):
    path = write_project(tmp_path / "bad.pas.json", {"surface": SURFACE.write(good) | change}, "tests")
    with pytest.raises(pas.ProjectFileError, match=words):
        check_independently(path)


def test_other_things_are_refused(tmp_path):
    path = write_project(tmp_path / "other.pas.json", {"kind": "solid"}, "tests")
    with pytest.raises(pas.ProjectFileError, match="reads blends"):
        check_independently(path)
