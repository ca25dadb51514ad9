"""Blends that were found before: recognised up to exact similarities, moved exactly, and kept from harm."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest
from flint import fmpq_mat

import pas
from pas.fairing.wishes import Wishes
from pas.pipeline.search import Search
from pas.pipeline.session import USUAL, key_of, open_session, similarities

CORNER = [pas.Pipe((1, 0, 0), "1/2", 1), pas.Pipe((0, 1, 0), "1/3", 1), pas.Pipe((0, 0, 1), "1/4", 1)]
ELBOW = [pas.Pipe((1, 0, 0), 1, 2), pas.Pipe((0, 1, 0), "3/4", 2)]


@pytest.fixture(autouse=True)
def session():
    """A session of the usual size."""
    with pas.Session() as session:
        yield session


@pytest.fixture
def solved(monkeypatch):
    """The number of times that something was solved."""
    times = []
    on_layout = Search.on_layout
    monkeypatch.setattr(Search, "on_layout", lambda self, *args: times.append(1) or on_layout(self, *args))
    return times


def rotations():
    """The 24 rotations of a cube, as matrices of whole numbers."""
    for order, signs in product(permutations(range(3)), product((1, -1), repeat=3)):
        matrix = np.zeros((3, 3), dtype=int)
        matrix[range(3), order] = signs
        if round(np.linalg.det(matrix)) == 1:
            yield matrix


def turned(pipe, matrix, offset=(0, 0, 0), scale=1):
    point = [scale * sum(int(m) * p for m, p in zip(row, pipe.point, strict=True)) + o for row, o in
             zip(matrix, offset, strict=True)]  # fmt: skip
    axis = [scale * sum(int(m) * a for m, a in zip(row, pipe.axis, strict=True)) for row in matrix]
    return pas.Pipe(axis, pipe.radius * scale, pipe.clip, point)


def blended(contacts, order=1, **options):
    return pas.blend(contacts, order, degree="lowest", **options)


def same(one, other, map_):
    """Whether the values of two surfaces agree at points and their images, up to the scale."""
    points = np.random.default_rng(0).uniform(-0.9, 0.9, (2000, 3))
    first, second = one.surface(points), other.surface(map_(points))
    inside = np.isfinite(first)
    assert inside.sum() > 200
    return np.allclose(first[inside], second[inside], rtol=1e-9, atol=1e-12)


def test_a_lattice_of_turned_nodes_is_solved_once(solved, session):
    first = blended(CORNER)
    assert len(solved) == 1
    for number, matrix in enumerate(rotations()):
        offset = (10 * number, -number, 3)
        contacts = [turned(pipe, matrix, offset) for pipe in CORNER]
        again = blended(contacts[number % 3 :] + contacts[: number % 3])
        assert len(solved) == 1, number
        assert again.certificate.proved
        assert same(first, again, lambda p, m=matrix, o=offset: p @ m.T + o)
    assert len(session) == 1


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "change",
    [
        lambda p: p.rotate((1, 2, 3), 35, (1, 1, 1)).translate((5, 6, "1/7")),
        lambda p: turned(p, np.eye(3, dtype=int), (1, 2, 3), scale=7),
        lambda p: turned(p, np.diag([-1, 1, 1])),  # a reflection
        lambda p: pas.Contact(p.contact.surface * 3, p.contact.clip * -2),
    ],
    ids=["turned", "scaled", "reflected", "multiplied"],
)
@pytest.mark.parametrize("nodes", [ELBOW, CORNER], ids=["elbow", "corner"])
def test_what_was_carried_over_holds(nodes, change, solved):
    blended(nodes)
    times = len(solved)
    contacts = [change(pipe) for pipe in reversed(nodes)]
    again = blended(contacts)
    assert len(solved) == times
    anew = again.surface.certify()
    assert anew.proved
    assert [v.claim for v in anew.verdicts] == [v.claim for v in again.certificate.verdicts]
    assert {v.status for v in again.certificate.verdicts} == {pas.Status.PROVED}
    for ours, given in zip(again.surface.contacts, contacts, strict=True):
        assert ours.surface == given.contact.surface
    assert len(again.coefficients) == again.dimension


def test_a_saved_one_is_read_again(tmp_path):
    blended(ELBOW)
    again = blended([pipe.rotate((1, 1, 0), 30) for pipe in ELBOW])
    loaded = pas.load(again.save(tmp_path / "a.pas.json"))
    assert loaded.surface.patches == again.surface.patches
    assert loaded.certificate.proved


@pytest.mark.parametrize("field", ["tension", "gauge", "straight"])
def test_blends_of_other_energies_are_kept_apart(field):
    keys = {key_of(Wishes(energy=pas.CurvatureVariation(**{field: number}))) for number in (2, 3)}
    assert len(keys) == 2


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "contacts, options",
    [
        (ELBOW, {"order": 2}),
        (ELBOW, {"partition": "planes"}),
        (ELBOW, {"tension": 1}),
        (ELBOW, {"energy": pas.ThinPlate()}),
        (ELBOW, {"inside": [(0, 0, 0)]}),
        ([ELBOW[0], pas.Pipe((0, 1, 0), "3/4", "5/2")], {}),
        ([ELBOW[0], pas.Pipe((0, 1, 0), "2/3", 2)], {}),
        ([pas.Pipe((1, 0, 0), "3/4", 2), pas.Pipe((1, 5, 0), 1, 2)], {}),
    ],
)
def test_what_differs_is_not_found(contacts, options, session):
    blended(ELBOW)
    options = dict(options)
    order, partition = options.pop("order", 1), options.pop("partition", None)
    key = key_of(Wishes(**options), order, "lowest", partition)
    assert key is None or session.find([c.contact for c in contacts], key) is None
    assert session.find([c.contact for c in ELBOW], key_of(Wishes(), 1, "lowest", None)) is not None


def test_a_contact_turned_inside_out_is_another_one(session):
    contacts = [pipe.contact for pipe in CORNER]
    blended(contacts)
    key = key_of(Wishes(), 1, "lowest", None)
    assert session.find(contacts, key) is not None
    assert session.find([pas.Contact(-contacts[0].surface, contacts[0].clip), *contacts[1:]], key) is None


def test_verdicts_on_contacts_follow_them(session):
    contacts = [pipe.contact for pipe in CORNER]
    blended(contacts)
    match = session.find([contacts[2], contacts[0], contacts[1]], key_of(Wishes(), 1, "lowest", None))
    assert match.numbers == (2, 0, 1)
    certificate = match.found.certificate
    marked = tuple(replace(v, reason=f"reason {i}") for i, v in enumerate(certificate.contacts))
    moved = replace(match, found=replace(match.found, certificate=replace(certificate, contacts=marked))).certificate
    assert [v.reason for v in moved.contacts] == ["reason 2", "reason 0", "reason 1"]
    assert [v.claim for v in moved.contacts] == [v.claim for v in certificate.contacts]


def test_nothing_that_is_handed_out_can_harm_what_is_kept():
    first = blended(ELBOW)
    whole = first.surface.patches
    for victim in (first, blended(ELBOW)):
        victim.surface.patches = tuple(-p for p in whole)
        victim.surface.degree = 9
        victim.surface.partition.vertices = ()
        victim.surface.partition.cells = ()
        victim.surface.placed.contacts = ()
        victim.timings["spent"] = -1.0
        vars(victim.surface).pop("certificate", None)
    again = blended(ELBOW)
    assert again.surface.patches == whole
    assert again.surface.degree != 9
    assert "spent" not in again.timings
    assert again.surface.certify().proved


def test_what_is_not_proved_or_unwanted_is_not_kept(session):
    blended(ELBOW, prove=False)
    assert len(session) == 0
    with pas.Session(1) as other:
        blended(ELBOW)
        blended(CORNER)
        assert len(other) == 1 and open_session() is other
    assert len(session) == 0 and open_session() is session
    for wrong, error in ((-1, ValueError), (1.5, TypeError), ("many", TypeError)):
        with pytest.raises(error, match="most"):
            pas.Session(wrong)


def test_nothing_is_kept_without_a_session(solved, session):
    def twice():
        assert open_session() is None
        blended(ELBOW)
        blended(ELBOW)

    with ThreadPoolExecutor(1) as pool:  # where none is open
        pool.submit(twice).result()
    assert len(solved) == 2 and len(session) == 0


def test_the_former_name_opens_a_session_without_end():
    def kept():
        pas.keep_blends()
        most = open_session().most
        pas.keep_blends(0)
        return most, open_session()

    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(kept).result() == (USUAL, None)


def test_several_threads_may_ask(session):
    blended(ELBOW)

    def moved(i):
        with session:
            return blended([p.translate((i, 0, 0)) for p in ELBOW])

    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(moved, range(12)))
    assert all(blend.certificate.proved and set(blend.timings) == {"repeated"} for blend in made)
    assert len(session) == 1


@pytest.mark.parametrize("contacts", [CORNER, ELBOW, [pas.Pipe((0, 0, 1), 1, 2), pas.Pipe((0, 0, -1), 2, 2)]])
def test_similarities_are_exact(contacts):
    before = [c.contact.rim for c in contacts]
    moved = [c.rotate((1, 3, -2), 77).translate((1, 2, 3)) for c in contacts]
    found = list(similarities(before, [c.contact.rim for c in reversed(moved)]))
    assert found
    for map_, scale in found:
        matrix = fmpq_mat([list(row) for row in map_.matrix])
        unit = fmpq_mat(3, 3, [scale**2 * (i == j) for i in range(3) for j in range(3)])
        assert matrix * matrix.transpose() == unit
    axes = [(c.axis[0] - c.axis[1], c.axis[0] + c.axis[1], c.axis[2]) for c in contacts]
    root2 = [pas.Pipe(axis, c.radius, c.clip) for axis, c in zip(axes, contacts, strict=True)]
    if contacts is ELBOW:  # a scale of the root of 2 in the plane of the elbow
        assert not list(similarities(before, [c.contact.rim for c in root2]))
