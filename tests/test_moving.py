"""Moving meshes and assemblies as solids are moved, and what is said where operations are asked for that are none."""

import operator

import numpy as np
import pytest

import pas
from pas import solid

BALL, BOX = solid.ball((0, 0, 0), 1), solid.box((2, 0, 0), (3, 2, 1))
PAIR = solid.assembly(ball=BALL, box=(BOX, "#112233"))
MOVES = {
    "translate": ((1, 2, 3),),
    "rotate": ((0, 0, 1), 90),
    "scale": (("1/2", 2, 3),),
    "mirror": ((1, 1, 0), (1, 0, 0)),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("move", MOVES)
def test_assemblies_move_as_their_solids_and_their_meshes_do(move):
    moved, mesh = getattr(PAIR, move)(*MOVES[move]), PAIR.mesh(0.05)
    alone = [getattr(part, move)(*MOVES[move]) for part in (BALL, BOX)]
    boxes = np.array([s.bounding_box for s in alone])
    assert np.array_equal(moved.bounding_box, [boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
    assert [p.color for p in moved.parts.values()] == [p.color for p in PAIR.parts.values()]
    turned = getattr(mesh, move)(*MOVES[move])
    assert turned.is_closed and turned.names == mesh.names
    assert turned.volume == pytest.approx(mesh.volume * (3 if move == "scale" else 1))
    assert turned.bounding_box == pytest.approx(moved.bounding_box, abs=0.2)
    facets = np.cross(*(turned.points[turned.triangles[:, i]] - turned.points[turned.triangles[:, 0]] for i in (1, 2)))
    assert np.all(np.einsum("tx,tcx->tc", facets, turned.normals) > 0)
    assert np.linalg.norm(turned.normals, axis=2) == pytest.approx(1)


def test_an_assembly_of_meshes_moves_with_its_tight_box():
    tight = solid.assembly(ball=BALL.mesh(0.01)).scale(2).translate(1, 0, 0)
    assert tight.bounding_box == pytest.approx(np.array([[-1, -2, -2], [3, 2, 2]]), abs=0.05)
    assert PAIR.bounding_box == pytest.approx(
        np.array([[-1, -1, -1], [3, 2, 1]]), abs=2.1e-3
    )  # of the ball: 1e-3 of its size


def test_a_moved_mesh_is_as_far_from_the_moved_surface_as_it_may_be():
    torus = pas.torus(2, "1/2").mesh(0.05, domain=((-1, 1), (-1, 1)))
    moved = torus.scale((1, 2, 3))
    assert moved.proved and torus.deviation * 3 < moved.deviation < torus.deviation * 3.0001
    assert moved.point_normals.shape == torus.point_normals.shape


def test_solids_are_given_one_by_one_or_in_a_sequence():
    assert solid.union(BALL, BOX).tree == solid.union([BALL, BOX]).tree == (BALL | BOX).tree
    assert solid.intersection(BALL, BOX).tree == solid.intersection([BALL, BOX]).tree
    assert solid.union(BALL) is BALL
    assert np.array_equal(BALL.translate(1, 2, "3").box, BALL.translate((1, 2, 3)).box)


def test_scaling_takes_three_factors_one_by_one_and_a_centre_by_name_or_after_the_factor():
    assert np.array_equal(BOX.scale(2, 3, "1/2").box, BOX.scale((2, 3, "1/2")).box)
    assert np.array_equal(BOX.scale(2, (2, 0, 0)).box, BOX.scale(2, center=(2, 0, 0)).box)
    assert np.array_equal(BOX.scale(2, 2, 2, center=(2, 0, 0)).box, BOX.scale(2, (2, 0, 0)).box)


def test_files_that_are_no_projects_are_not_called_truncated(tmp_path):
    for name, text, words in (
        ("a.toml", "order = 1", "is a problem file; read it with pas.read_problem"),
        ("a.txt", "ply 1.0", r"not a project file of pas \(.pas.json\), which shape.save writes"),
        ("a.pas.json", '{"format": ', "the file was truncated or edited"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(pas.ProjectFileError, match=words):
            pas.load(tmp_path / name)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: BALL + BOX, TypeError, r"shapes cannot be added by \+ or sum: a \| b is the union"),
        (lambda: sum([BALL, BOX]), TypeError, r"solid\.union\(a, b, \.\.\.\) that of several"),
        (lambda: BALL - 3, TypeError, "take two solids or two meshes, not a solid and 3"),
        (lambda: BALL.mesh() | None, TypeError, "take two solids or two meshes, not a mesh and None"),
        (
            lambda: solid.union([BALL, 3]),
            TypeError,
            r"union takes solids, as in union\(a, b\) or union\(\[a, b\]\), not 3",
        ),
        (lambda: solid.union([3, BALL]), TypeError, "union takes solids, .* not 3"),
        (lambda: solid.intersection(7), TypeError, "intersection takes solids, .* not 7"),
        (lambda: solid.union([]), ValueError, "at least one solid"),
        (lambda: solid.intersection(), ValueError, "at least one solid"),
        (lambda: solid.assembly([BALL, BOX]), TypeError, r"have names, as in assembly\(pot=a, lid=b\) .* has none"),
        (lambda: solid.assembly(BALL, BOX), TypeError, "the parts of an assembly have names"),
        (lambda: BALL.translate(1, 2), ValueError, "offset must be three numbers, not 2"),
        (lambda: solid.tube(lambda t: (t, 0, 0), 1, (0, 1)), TypeError, r"three formulas in t, such as \('cos\(t\)'"),
        (lambda: solid.tube(("t", "0"), 1, (0, 1)), ValueError, "curve must be three formulas in t"),
        (
            lambda: solid.tube(("t", "0", "0"), 1, (0,)),
            ValueError,
            r"interval must be two rising numbers, .*, not \(0,\)",
        ),
        (
            lambda: solid.tube(("t", "0", "0"), "1 + t", (0, 1)),
            ValueError,
            r"radius .* varies is pas\.tube\(\.\.\.\)\.solid\(\)",
        ),
        (
            lambda: solid.tube(("t", "0", "0"), abs, (0, 1)),
            TypeError,
            r"radius .* varies is pas\.tube\(\.\.\.\)\.solid\(\)",
        ),
        (
            lambda: BALL | pas.torus(),
            TypeError,
            "make a solid of the parametric surface first, as shape.solid",
        ),
        (
            lambda: pas.torus() | BALL,
            TypeError,
            "take two solids or two meshes, not a parametric surface and a solid; make",
        ),
        (lambda: PAIR - BALL, TypeError, r"not an assembly and a solid; make a solid of the assembly first"),
        (lambda: BALL.mesh(0.3) & PAIR, TypeError, "not a mesh and an assembly; take the mesh of the assembly first"),
        (lambda: None | BALL, TypeError, "take two solids or two meshes, not a solid and None"),
        (lambda: BALL.scale(1, 2), TypeError, "center must be three numbers"),
        (lambda: BALL.scale(1, 2, -2), ValueError, r"the factor must be positive, not \(1, 2, -2\)"),
        (
            lambda: pas.tube(lambda t: t, 1, (0, 1, 0), (0, 0, 1)),
            TypeError,
            "center must be three expressions in t, such",
        ),
        (lambda: solid.tube(("t", 0, 0), 1, (0, None)), TypeError, "an end of the interval must be a number"),
        (
            lambda: pas.torus().write("a.stl"),
            ValueError,
            r"with angle=True to go round the whole turn; of others, .* give a finite one, such as domain=",
        ),
        (lambda: BALL.mesh(1).write("a.step"), TypeError, "STEP files hold solids, or rational patches, and <Mesh"),
        (lambda: pas.load("a.step"), pas.ProjectFileError, r"a\.step: \.step files are written and not read"),
        (lambda: solid.assembly(a=pas.torus()), TypeError, "the part 'a' must be .*; of a surface take its mesh"),
        (lambda: solid.tube(("t", "0", "0"), 1, 3), TypeError, "interval must be two rising numbers, .*, not 3"),
    ],
)
def test_what_is_no_operation_is_said_in_a_sentence(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_what_moves_or_turns_nothing_is_said_in_a_sentence():
    ball = pas.solid.ball((0, 0, 0), 1)
    for shape in (ball, ball.mesh(0.5)):
        with pytest.raises(
            TypeError, match=r"takes an axis and degrees, as in shape.rotate\(\(0, 0, 1\), 90\), not 90"
        ):
            shape.rotate(90)
    with pytest.raises(TypeError, match=r"~ of a solid is unbounded, .* as in solid.box\(...\) - a"):
        operator.invert(ball)
