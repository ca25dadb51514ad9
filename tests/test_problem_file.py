"""Problem files: what they say, and errors with the line."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import ROOT

import pas
from pas.mesh.quality import Quality
from pas.settings import QUALITIES

PROBLEM = """\
order = 2

[[pipes]]
axis = [1, 0, 0]
radius = "1/3"
clip = 1

[[pipes]]
axis = [0, 1, 0]
radius = 0.25
clip = 1

[[contacts]]
surface = "x^2 + y^2 - 4/25"
clip = "z - 1"

[points]
inside = [[0, 0, "1/2"]]
"""


def read(tmp_path: Path, text: str):
    path = tmp_path / "problem.toml"
    path.write_text(text)
    return pas.read_problem(path)


def test_a_problem(tmp_path):
    problem = read(tmp_path, PROBLEM)
    assert problem.name == "problem"
    assert problem.contacts == (
        pas.Pipe((1, 0, 0), "1/3", 1),
        pas.Pipe((0, 1, 0), "1/4", 1),  # 0.25 as the decimal written
        pas.Contact("x^2+y^2-4/25", "z-1"),
    )
    assert (problem.order, problem.degree, problem.mesh.tolerance) == (2, None, None)
    assert problem.wishes == pas.Wishes(inside=[[0, 0, "1/2"]])
    assert problem.wishes.energy is None  # the usual one


def test_everything_else(tmp_path):
    text = (
        'name = "other"\ndegree = 4\ntolerance = 1e-2\nprove = false\nguard = false\n'
        + PROBLEM
        + 'handles = [[[0, [1, 2, 1, 0]], "1/3"]]\ncoefficients = { 0 = "1/2", 3 = 2 }\n'
        + "near_weight = 7\n[partition]\ncenter = [0, 0, 0]\nlegs = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
        + '[energy]\nlower = [0, 0, 0]\nupper = ["1/2", 1, 1]\npiece = 3\n'
        + '[normalize]\nkind = "value-at"\npoint = [0, 0, 0]\nvalue = -0.1\n'
    )
    problem = read(tmp_path, text)
    assert (problem.name, problem.degree, problem.mesh.tolerance, problem.wishes.prove, problem.wishes.guard) == (
        "other",
        4,
        0.01,
        False,
        False,
    )
    assert problem.wishes.handles == pas.Wishes(handles={(0, (1, 2, 1, 0)): "1/3"}).handles
    assert problem.wishes.coefficients == pas.Wishes(coefficients={0: "1/2", 3: 2}).coefficients
    assert problem.wishes.energy == pas.ThinPlate(pas.Box((0, 0, 0), ("1/2", 1, 1)), 3)
    assert problem.wishes.normalize == pas.ValueAt((0, 0, 0), "-1/10")
    assert problem.partition.legs == pas.SixTetrahedra().legs


@pytest.mark.parametrize("path", sorted((ROOT / "examples/corners").glob("*.toml")), ids=lambda p: p.stem)
def test_the_examples_are_read(path):
    assert len(pas.read_problem(path).contacts) == (2 if path.stem.startswith("elbow") else 3)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("order = 2", "order = ", 1, "invalid value"),
        ("order = 2", "order = 2\norder = 3", 2, "cannot overwrite"),
        ('radius = "1/3"', 'radius = "1/3', 5, "illegal character|expected"),
        ("order = 2", 'order = 2\nname = "../a"', 2, "name must be a plain file name"),
        ("order = 2", "ordr = 2", 1, "unknown key 'ordr' in the file; is 'order' meant"),
        ("order = 2\n", "", None, "the file has no 'order'"),
        ("order = 2", 'order = "2"', 1, "order must be a whole number from 0 to 8 .*, not '2'"),
        ("order = 2", "order = 2.5", 1, "order must be a whole number from 0 to 8 .*, not 2.5"),
        ("order = 2", "order = true", 1, "order must be a whole number"),
        ("clip = 1\n\n[[contacts]]", "clp = 1\n\n[[contacts]]", 11, r"unknown key 'clp' in \[pipes\]"),
        ("clip = 1\n\n[[contacts]]", "\n[[contacts]]", 8, r"\[pipes\] has no 'clip'"),
        ("radius = 0.25", "radius = 0", 10, "pipe 2: radius must be positive"),
        ("radius = 0.25", "radius = nan", 10, "pipe 2: radius must be finite, not nan"),
        ("axis = [0, 1, 0]", "axis = [0, 1]", 9, "pipe 2: axis must be three numbers"),
        ("axis = [0, 1, 0]", "axis = [0, 0, 0]", 9, "pipe 2: axis must not be the zero vector"),
        ('clip = "z - 1"', 'clip = "w - 1"', 15, "contact 1: clip: .*variable 'w'"),
        ('clip = "z - 1"', 'clip = "x^2 + y^2 - 4/25"', 15, "common factor"),
        ("[points]", "[pints]", 17, "unknown key 'pints'"),
        ("[points]\ninside", "[points]\ninsde", 18, "unknown key 'insde'"),
        ("[points]", "[[points]]", 17, "points must be a table"),
        ("[points]", '[normalize]\nkind = "mean"\n[points]', 18, "kind must be one of mean-alpha"),
        (
            "[points]",
            '[energy]\nkind = "bending"\n[points]',
            18,
            "kind: there is no energy 'bending'; there",
        ),
        ("[points]", "[energy]\nlower = [0, 0, 0]\n[points]", 18, "both lower and upper"),
        ("[points]", "[energy]\nlower = [0, 0, 0]\nupper = [0, 1, 1]\n[points]", 18, "must be below the upper"),
        ("[points]", "[partition]\nlegs = [[1, 0, 0]]\n[points]", 18, "legs must be three vectors"),
    ],
)
def test_errors_have_lines(tmp_path, old, new, line, words):
    assert old in PROBLEM
    with pytest.raises(pas.ProblemFileError, match=words) as caught:
        read(tmp_path, PROBLEM.replace(old, new, 1))
    assert caught.value.line == line
    assert "problem.toml" in str(caught.value)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(FileNotFoundError):
        pas.read_problem(tmp_path / "none.toml")
    with pytest.raises(pas.ProblemFileError, match="gives no contacts: none of \\[\\[pipes\\]\\]"):
        read(tmp_path, "order = 1\n")
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(pas.ProblemFileError, match="UTF-8"):
        pas.read_problem(tmp_path / "b.toml")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('quality = "good"', "quality must be one of 'angles', 'balanced', 'count', not 'good'"),
        ("max_triangles = 0", "max_triangles must be at least 1, not 0"),
    ],
)
def test_settings_of_meshes_are_checked_before_anything_is_solved(tmp_path, line, said):
    with pytest.raises(pas.ProblemFileError, match=rf"line \d+: {said}"):
        read(tmp_path, f"{PROBLEM}\n[mesh]\n{line}\n")


def test_qualities_have_the_names_that_settings_know():
    assert tuple(quality.value for quality in Quality) == QUALITIES
