"""Clips of every kind, and contacts of several curves: no verdict is false."""

from __future__ import annotations

import random

import numpy as np
import pytest
from clip_cases import Case, moved
from clip_families import BENT, FAMILIES
from conftest import EQUAL, solved

import pas
from pas import Polynomial, Status
from pas.algebra.rational import to_floats
from pas.blending.place import place
from pas.certify.free_curves import RegionCurve
from pas.certify.proofs import contact_verdict, enclosed_verdict
from pas.pipeline.bodies import body

BOX = pas.SingleCell((-1, -1, -1), (1, 1, 1))
PIPE = "y^2 + z^2 - 1/4"


def examine(case: Case) -> None:
    """That the verdicts are allowed and that a witness witnesses."""
    surface = case.surface()
    verdict, *others = (contact_verdict(surface, number) for number in range(len(surface.contacts)))
    assert verdict.status in case.allowed, str(verdict)
    if verdict.status is Status.REFUTED:
        assert verdict.witness is not None
        assert case.wrong is None or case.wrong(case.back(verdict.witness)), str(verdict)
    if case.enclosed is not None:
        enclosed = enclosed_verdict(surface, [verdict, *others])
        assert enclosed.status in case.enclosed, str(enclosed)


def hunt(make, seeds) -> None:
    for seed in seeds:
        rng = random.Random(f"{make.__name__} {seed}")
        case = make(rng, rng.choice((0, 1, 1, 2, 3)))
        if rng.random() < 0.7:
            case = moved(case, rng)
        try:
            examine(case)
        except Exception as error:
            raise AssertionError(f"{case.name}, seed {seed}, order {case.order}: {error}") from error


@pytest.mark.parametrize("make", FAMILIES, ids=lambda make: make.__name__)
def test_no_verdict_is_false(make):
    hunt(make, range(8))


@pytest.mark.slow
@pytest.mark.parametrize("make", FAMILIES, ids=lambda make: make.__name__)
def test_no_verdict_is_false_in_many(make):
    hunt(make, range(8, 420))


# --- several pieces, and what else depends on where a clip is ------------------------------------------


@pytest.fixture(scope="module")
def corner() -> pas.PiecewiseSurface:
    return solved(EQUAL, 1).surface


@pytest.mark.parametrize(
    ("factor", "status", "enclosed"),
    [
        ("1", Status.PROVED, Status.PROVED),
        ("x + 2", Status.PROVED, Status.PROVED),
        ("y^2 + 1", Status.PROVED, Status.PROVED),
        ("-1", Status.REFUTED, Status.PROVED),
        ("2*x - 3", Status.REFUTED, Status.PROVED),
        ("y", Status.REFUTED, Status.UNDECIDED),
        ("x", Status.UNDECIDED, Status.UNDECIDED),
        ("2*x + 1", Status.UNDECIDED, Status.UNDECIDED),
        ("x - 1", Status.UNDECIDED, Status.UNDECIDED),
    ],
)
def test_the_clip_of_a_corner_times_a_factor(corner, factor, status, enclosed):
    contact = corner.contacts[0]
    changed = (pas.Contact(contact.surface, contact.clip * Polynomial(factor)), *corner.contacts[1:])
    surface = pas.PiecewiseSurface(corner.partition, changed, corner.order, corner.patches)
    certificate = surface.certify()
    assert [v.status for v in certificate.contacts] == [status, Status.PROVED, Status.PROVED]
    assert all(v.proved for v in certificate.faces)
    assert certificate.enclosed.status is enclosed
    if status is Status.REFUTED:
        witness = np.array(certificate.contacts[0].witness)
        assert contact.surface(witness) == pytest.approx(0, abs=1e-9)
        assert Polynomial(factor)(witness) < 0


def test_a_bubble_counts_where_the_surface_is_used():
    """A clip through the region leaves one side of it in use; a bubble beyond it refutes nothing."""
    pipe, clip, box = Polynomial("y^2 + z^2 - 1/4"), Polynomial("x - 1/2"), pas.SingleCell((-1, -1, -1), (1, 1, 1))
    for middle, status in (("3/4", Status.UNDECIDED), ("-3/4", Status.REFUTED)):
        bubble = Polynomial(f"(x - {middle})^2 + (y - 3/4)^2 + z^2 - 1/100")
        surface = pas.PiecewiseSurface.from_polynomials(box, [pas.Contact(pipe, clip)], 1, [pipe * bubble])
        certificate = surface.certify()
        assert certificate.contacts[0].proved
        assert certificate.one_sheet.status is status
        # the pipe itself reaches the wall x = -1, in use
        assert certificate.enclosed.status is Status.REFUTED
        assert certificate.enclosed.witness[0] < 0


def test_one_sheet_needs_a_centre_in_use():
    pipe, box = Polynomial("y^2 + z^2 - 1/4"), pas.SingleCell((-1, -1, -1), (1, 1, 1))
    for sign, status in ((1, Status.UNDECIDED), (-1, Status.REFUTED)):
        clip = pas.Contact(pipe, Polynomial("1/2 - x") * sign)
        surface = pas.PiecewiseSurface.from_polynomials(box, [clip], 1, [pipe + 1])
        assert surface.certify().one_sheet.status is status


@pytest.mark.parametrize(("factor", "side"), [("x", -1), ("-x", 1), ("-1", None)])
def test_the_clip_of_each_side_is_asked_for_its_sign(factor, side):
    clip = pas.Contact(PIPE, f"(x - 1)*(x + 1)*({factor})")
    verdict = contact_verdict(pas.PiecewiseSurface.from_polynomials(BOX, [clip], 1, [PIPE]), 0)
    assert verdict.status is Status.REFUTED
    assert "the clip is positive on the region's side" in verdict.reason
    assert side is None or verdict.witness[0] == side


@pytest.mark.parametrize(
    ("surface", "status"), [("1", Status.PROVED), ("(y - 1)^2 + (z - 9/4)^2 - 1/50", Status.UNDECIDED)]
)
def test_a_cell_that_touches_a_clip_plane_from_outside(surface, status):
    """The third cell has an edge in the plane x = 0, beside the clip face; the second curve crosses it."""
    points = (*BENT[:4], ("-1/2", 2, "1/2"), (0, 2, 3))
    mesh = pas.Partition(points, [(0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5)], pieces=[(0, 1, 2)])
    f = Polynomial(f"(y^2 + (z + 1/5)^2 - 1/25)*({surface})")
    blend = pas.PiecewiseSurface.from_polynomials(mesh, [pas.Contact(f, "x")], 1, [f])
    assert contact_verdict(blend, 0).status is status


def test_a_parallelogram_proves_a_point_of_a_curve():
    curve = RegionCurve(Polynomial("x + y^2"), Polynomial("y + z*x"), BOX)
    at = np.array([0.0, 0.0, 0.3])
    enclosure = curve.enclosure(at, 2.0**-20)
    assert all(BOX.locate(np.array([to_floats(c) for c in enclosure.corners])) >= 0)
    assert (enclosure.sign(Polynomial("z").raw), enclosure.sign(Polynomial("x").raw)) == (1, 0)
    assert all(e.sign(Polynomial("x^2 + y^2 - 1/1000000").raw) < 0 for e in curve.enclosures())
    for off in ([1e-3, -3e-4, 0.3], [-1e-6, 1e-3, 0.3], [0, 0, 1.5], [0, 0, 1 + 1e-9]):
        assert curve.enclosure(np.array(off), 2.0**-20) is None


# --- placing ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize("factor", ["1", "x + 2", "2*x - 1", "x + 1", "1 + y^2"])
def test_clips_are_turned_towards_their_faces(sign, factor):
    """A factor that is negative at the centre turns the clip there, but not at its face."""
    (contact,) = place([(PIPE, f"{sign}(x - 1)*({factor})")], 1, BOX).contacts
    assert contact.clip == Polynomial(f"(x - 1)*({factor})")
    space = pas.solutions([(PIPE, f"{sign}(x - 1)*({factor})")], 1, 3, BOX)
    if factor == "2*x - 1":
        with pytest.raises(ValueError, match="the clip of contact 1 passes through the region, so"):
            space.fit()


def test_clips_are_turned_without_a_centre():
    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    mesh = pas.Partition(corners, [(0, 1, 2, 3)])
    for sign in ("", "-"):
        (contact,) = place([("(y - 1/4)^2 + (z - 1/4)^2 - 1/100", f"{sign}x")], 1, mesh).contacts
        assert contact.clip == Polynomial("-x")


@pytest.mark.parametrize(
    ("surface", "clip", "words"),
    [
        (PIPE, "(x - 1)^3", "plane of its clip face is a multiple factor of its clip"),
        (PIPE, "(x - 1)*y", "not negative on the region's side of its face at"),
        (PIPE, "(x - 1)*(y + 1/8)", "not negative on the region's side of its face at"),
        ("(x - 1)^2 + (y - 1)^2 + z^2 - 1/4", "-(x - 1)*(y - 1)", "not closed inside its face"),
    ],
)
def test_clips_that_cannot_be_placed(surface, clip, words):
    with pytest.raises(pas.GeometryError, match=words):
        pas.solutions([(surface, clip)], 1, 3, BOX)


def test_a_clip_that_passes_through_other_pieces_is_refused():
    f = "(y^2 + (z + 1/5)^2 - 1/25)*((y - 9/10)^2 + (z - 7/20)^2 - 1/100)"
    cells = ((0, 1, 2, 3), (1, 2, 3, 4))
    with pytest.raises(pas.GeometryError, match=r"cuts its surface inside the region, too, around .* give the plane"):
        place([(f, "x")], 1, pas.Partition(BENT, cells))
    assert place([(f, "x")], 1, pas.Partition(BENT, cells, pieces=[(0, 1)]))
    with pytest.raises(pas.GeometryError, match=r"no outer face of the partition \(tetrahedra\) is a face of its clip"):
        place([(f, "x^2 + y - 1")], 1, pas.Partition(BENT, cells))


def test_an_elbow_with_reducible_clips_is_proved_and_becomes_a_body():
    elbow = [("y^2 + z^2 - 1", "(x - 2)*(x + 5)"), ("x^2 + z^2 - 1", "(y - 2)*(z^2 + 1)")]
    region = pas.SingleCell((-2, -2, -2), (2, 2, 2))
    plain = pas.blend(
        [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")], 1, partition=region, energy=pas.ThinPlate()
    )
    surface = pas.PiecewiseSurface.from_polynomials(
        region, [pas.Contact(*c) for c in elbow], 1, plain.surface.polynomials
    )
    assert surface.certify().proved
    solid = body(surface, 1)
    assert solid.proved
    assert solid.contains([[2.5, 0, 0], [3.5, 0, 0], [0, 2.5, 0]]).tolist() == [True, False, True]
    reversed_clips = [pas.Contact(f, -Polynomial(h)) for f, h in elbow]
    turned = pas.PiecewiseSurface.from_polynomials(region, reversed_clips, 1, plain.surface.polynomials)
    assert [v.status for v in turned.certify().contacts] == [Status.REFUTED] * 2
    inside = pas.PiecewiseSurface.from_polynomials(
        region, [pas.Contact("y^2 + z^2 - 1", "x - 1")], 1, ["y^2 + z^2 - 1"]
    )
    with pytest.raises(pas.GeometryError, match="neighbour 1 ends in x - 1 = 0, which is no side of the region"):
        body(inside)


def test_a_node_with_a_contact_on_every_side():
    six = [(f"{a}^2 + {b}^2 - 1", f"{c} {sign} 2") for a, b, c in ("yzx", "xzy", "xyz") for sign in "+-"]
    blend = pas.blend(six, 1, 6, pas.SingleCell((-2, -2, -2), (2, 2, 2)), energy=pas.ThinPlate())
    assert blend.certificate.proved
    assert blend.surface.walls == ()
    assert blend.surface.mesh(0.1).euler_characteristic == 2 - 6
