"""Patterns: copies of shapes as one, moved exactly, with names that tell them apart."""

from __future__ import annotations

import numpy as np
import pytest

import pas
from pas import solid
from pas.designs.teapot import Teapot
from pas.solid.truths import CompiledTree

PEG = solid.cylinder((3, 0, -1), (3, 0, 2), "1/4", face="hole")


def test_patterns_of_solids_are_unions_of_images():
    row = PEG.pattern(3, (0, 1, 0))
    assert row.faces == (
        "hole",
        "hole start",
        "hole end",
        *(f"hole{e} #{k}" for k in (2, 3) for e in ("", " start", " end")),
    )
    manual = PEG.renamed("x") | PEG.translate(0, 1, 0).renamed("x") | PEG.translate(0, 2, 0).renamed("x")
    assert row.renamed("x").tree == manual.tree
    for names in ("", {row.faces[0]: ""}, {row.faces[0]: 3}):
        with pytest.raises(ValueError, match="the name of a face must be a text that is not empty, not "):
            row.renamed(names)
    ring = PEG.circular_pattern(4, (0, 0, 1))
    points = np.array([(3, 0, 0), (0, 3, 0), (-3, 0, 0), (0, -3, 0), (2, 2, 0)], dtype=float)
    assert ring.contains(points).tolist() == [True] * 4 + [False]
    centers = [
        tuple(-p.gradient(np.zeros(3))[:2] / 2)
        for n, (p,) in ring.polynomials.items()
        if "start" not in n and "end" not in n
    ]
    np.testing.assert_array_equal(centers, [(3, 0), (0, 3), (-3, 0), (0, -3)])
    plate = solid.box((-4, -4, 0), (4, 4, 1)) - ring
    mesh = plate.mesh(0.05)
    assert mesh.is_closed and mesh.euler_characteristic == 2 - 2 * 4
    assert {f"hole #{k}" for k in (2, 3, 4)} | {"hole"} <= set(mesh.names)


def test_copies_keep_their_joints():
    pill = solid.rounded_rectangle(4, 2, "1/2").extrude(1)
    found = pill.circular_pattern(2, (0, 0, 1), step=180).pattern(2, (0, 5, 0))
    assert len(found.joints) == 4 * len(pill.joints)
    assert found.proved
    assert {j.first for j in found.joints} >= {"side 1", "side 1 #2", "side 1 #3", "side 1 #4"}


def test_names_in_patterns_of_patterns_are_distinct():
    """Numbers go on, for each name by itself, whatever is patterned."""
    hole = solid.cylinder((3, 0, -1), (3, 0, 2), "1/4", face="hole").renamed("hole")
    both = hole | hole.translate(1, 0, 0).renamed("slot #1")
    grid = both.pattern(3, (0, 1, 0)).pattern(2, (5, 0, 0)).pattern(2, (0, 9, 0))
    expected = {f"{name}{number}" for name in ("hole", "slot #1") for number in ("", *(f" #{k}" for k in range(2, 13)))}
    assert {*grid.faces} == expected
    assert {*hole.mesh(0.1).pattern(2, (2, 0, 0)).pattern(2, (5, 0, 0)).names} == {
        "hole",
        *(f"hole #{k}" for k in (2, 3, 4)),
    }
    round_ = solid.circle((1, 1), "1/4", face="a").pattern(2, (2, 0)).pattern(2, (0, 2))
    assert round_.extrude(1).faces[:4] == ("a", "a #2", "a #3", "a #4")
    parts = solid.assembly(bolt=hole).pattern(2, (0, 1, 0)).pattern(2, (0, 3, 0)).parts
    assert [*parts] == ["bolt", "bolt #2", "bolt #3", "bolt #4"]
    assert [round(part.bounding_box.mean(axis=0)[1]) for part in parts.values()] == [0, 1, 3, 4]


def test_one_copy_is_the_shape():
    assert PEG.pattern(1, (1, 0, 0)).tree == PEG.tree
    assert PEG.pattern(1, (1, 0, 0)).faces == PEG.faces


def test_patterns_of_other_shapes():
    hole = solid.circle((1, 1), "1/4")
    plate = solid.rectangle(8, 2) - hole.pattern(3, (2, 0))
    body = plate.extrude(1)
    assert body.faces[4:7] == ("circle", "circle #2", "circle #3")
    assert body.volume() == pytest.approx(16 - 3 * np.pi / 16, rel=1e-4)
    flower = solid.circle((1, 0), 1).circular_pattern(3)
    assert flower.contains([(1.5, 0), (-0.75, 1.3), (-0.75, -1.3), (-1.5, 0)]).tolist() == [True] * 3 + [False]
    parts = solid.assembly(bolt=(PEG, "#112a80")).circular_pattern(3, (0, 0, 1))
    assert [*parts.parts] == ["bolt", "bolt #2", "bolt #3"] and parts["bolt #3"].color == "#112a80"
    mesh = solid.box((0, 0, 0), (1, 1, 1)).mesh().pattern(2, ("1/2", 0, 0))
    assert mesh.volume == pytest.approx(1.5) and "box x+ #2" in mesh.names
    pot = Teapot("paper", PEG, PEG, PEG).scale(2)
    assert (pot.style, pot.lid.tree, pot.pot.tree) == ("paper", PEG.scale(2).tree, PEG.scale(2).tree)
    assert parts["bolt"].pattern(2, (1, 0, 0)).shape.faces[3] == "hole #2"


@pytest.mark.parametrize(
    ("make", "error", "sentence"),
    [
        (lambda: PEG.pattern(0, (1, 0, 0)), ValueError, "count must be a whole number from 1 to 10000, not 0"),
        (lambda: PEG.pattern(2.5, (1, 0, 0)), TypeError, "count must be a whole number"),
        (lambda: PEG.circular_pattern(3, (0, 0, 0)), ValueError, "axis must not be the zero vector"),
        (lambda: pas.torus(2, 1, angle=True).pattern(2, (1, 0, 0)), TypeError, "a pattern is of solids, meshes"),
    ],
)
def test_patterns_that_cannot_be(make, error, sentence):
    with pytest.raises(error, match=sentence):
        make()


def test_names_of_many_pins_on_one_plane_are_not_asked_for_one_by_one(monkeypatch):
    """In each piece of the mesh all names are asked for together, and then those that may be there."""
    pins, asked, known = PEG.pattern(6, (1, 0, 0)).pattern(6, (0, 1, 0)), [], CompiledTree.relevant
    monkeypatch.setattr(CompiledTree, "relevant", lambda *a: (asked.append(None), known(*a))[1])
    mesh = pins.mesh()
    assert mesh.components == 36 and {*mesh.names} == {*pins.faces}
    assert len(asked) < 5 * len(mesh.names)
