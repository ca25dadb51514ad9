"""`pas solve`: all solutions of a problem file, in four formats."""

from __future__ import annotations

import json
import runpy

import pytest
import sympy

from pas.cli import main

COAXIAL = """order = 1
[partition]
kind = "single cell"
[[contacts]]
surface = "y^2 + z^2 - 1"
clip = "x - 1"
[[contacts]]
surface = "y^2 + z^2 - 4"
clip = "x + 1"
"""
CORNER = "order = 1\n" + "".join(
    f'[[pipes]]\naxis = {axis}\nradius = "1/3"\nclip = 1\n' for axis in ("[1,0,0]", "[0,1,0]", "[0,0,1]")
)
X, Y, Z = sympy.symbols("x y z")


@pytest.fixture
def problem(tmp_path):
    path = tmp_path / "coaxial.toml"
    path.write_text(COAXIAL)
    return path


def test_text(problem, capsys):
    assert main(["solve", str(problem)]) == 0
    out = capsys.readouterr().out
    assert "degree     3; tried before: 1 (dimension 0), 2 (dimension 0)" in out
    assert "dimension  2" in out
    assert "generators of the ideal of all solutions" in out
    assert "regular along all contacts" in out


def test_json_holds_members(problem, capsys):
    assert main(["solve", str(problem), "--json", "--degree", "4"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["order"], data["degree"], data["dimension"], data["regular"]) == (1, 4, 9, True)
    ideal = sympy.groebner([Y**2 + Z**2 - 1, (X - 1) ** 2], X, Y, Z, order="grevlex")
    for (text,) in data["basis"] + [g["polynomials"] for g in data["generators"]]:
        assert ideal.contains(sympy.sympify(text.replace("^", "**")))


def test_sympy_output_is_a_program(problem, capsys, tmp_path):
    assert main(["solve", str(problem), "--sympy"]) == 0
    program = tmp_path / "solutions.py"
    program.write_text(capsys.readouterr().out)
    found = runpy.run_path(str(program))
    assert (found["degree"], found["dimension"], len(found["basis"])) == (3, 2, 2)
    assert all(isinstance(c, sympy.Rational) for (g,) in found["generators"] for c in sympy.Poly(g, X, Y, Z).coeffs())


def test_latex(problem, capsys):
    assert main(["solve", str(problem), "--latex"]) == 0
    out = capsys.readouterr().out
    assert out.count(r"\begin{align*}") == out.count(r"\end{align*}") == 1
    assert "b_{1} &=" in out


@pytest.mark.parametrize("method", ["linear", "normal-form", "intersection", "syzygy"])
def test_methods(problem, method, capsys):
    assert main(["solve", str(problem), "--method", method, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["dimension"] == 2


def test_an_empty_space_is_an_answer(problem, capsys):
    assert main(["solve", str(problem), "--degree", "2"]) == 0
    assert "no solutions" in capsys.readouterr().out


def test_a_corner(tmp_path, capsys):
    path = tmp_path / "corner.toml"
    path.write_text(CORNER)
    assert main(["solve", str(path)]) == 0
    out = capsys.readouterr().out
    assert "b3, piece 6:" in out
    assert "generators of the module of all solutions: asked for with --generators" in out
    assert main(["solve", str(path), "--generators", "--method", "syzygy", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [g["degree"] for g in data["generators"]].count(3) == data["dimension"] == 3
    assert data["generators"][0]["regular"] == [False] * 3


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--method", "magic"], 2, "method must be one of"),
        (["--degree", "0"], 2, "degree must be a whole number from 1 to 12"),
        (["--seconds", "1e-9"], 1, "gave up after 1e-09 s"),
        (["--order", "-1"], 2, "order must be a whole number from 0 to 8"),
    ],
)
def test_errors(problem, arguments, code, words, capsys):
    assert main(["solve", str(problem), *arguments]) == code
    err = capsys.readouterr().err
    assert words in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('kind = "octagon"', "line 3: .* there is no partition 'octagon'; there are 'six tetrahedra', 'single cell'"),
        (
            'kind = "single cell"\nlegs = [[1,0,0],[0,1,0],[0,0,1]]',
            "line 4: .*'legs' does not belong to the partition 'single cell'",
        ),
        ('kind = "single cell"\nlower = [0, 0, 0]', "needs both lower and upper"),
        ("lower = [0, 0, 0]", "'lower' does not belong to the partition 'six tetrahedra'"),
        ("center = [0, 0, 0]", "needs 'legs'"),
    ],
)
def test_bad_partitions(tmp_path, table, words, capsys):
    import re

    path = tmp_path / "bad.toml"
    path.write_text(COAXIAL.replace('kind = "single cell"', table))
    assert main(["solve", str(path)]) == 2
    assert re.search(words, capsys.readouterr().err)
