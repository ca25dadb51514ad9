"""Ideals, modules and spaces in the languages of other programs: there and back, and against these where they are."""

from __future__ import annotations

import shutil
import subprocess
from itertools import product

import pytest
import sympy
from conftest import pipes

import pas
from pas.algebra.systems import SYSTEMS, System

read, write = SYSTEMS["singular"].read, SYSTEMS["singular"].write

IDEALS = [
    pas.Ideal("x^2 + y^2 - 1/3", "x*y*z - 2/7*z^3", "1 - x"),
    pas.Ideal("-x^10*y", "12345678901234567890/7"),
    pas.Ideal("z"),
    pas.contact_ideal(pas.Pipe((1, 2, -2), "1/3", 1).contact, 2),
]
MODULES = [
    pas.Submodule(("x", "y^2/3", "0"), ("0", "z - 1", "x*y")),
    pas.Submodule(("1", "-1"), ("-z", "0"), ("0", "x - y")),
    pas.Submodule(*pas.syzygies(["x^2 - 1", "x*y", "z^3 - x"])),
]
EVERY = [*IDEALS, *MODULES]
NAMES = ["singular", "macaulay2"]


def test_every_registered_system_is_tested_here():
    assert list(SYSTEMS) == NAMES


@pytest.mark.parametrize(("system", "thing"), list(product(NAMES, EVERY)), ids=lambda v: str(v)[:20])
def test_there_and_back(system, thing):
    again = getattr(type(thing), f"from_{system}")(getattr(thing, f"to_{system}")())
    assert type(again) is type(thing) and again.generators == thing.generators


@pytest.mark.parametrize("thing", EVERY, ids=lambda v: str(v)[:20])
@pytest.mark.skipif(shutil.which("Singular") is None, reason="Singular is not installed")
@pytest.mark.parametrize("short", [0, 1])
def test_singular_reads_it_and_agrees(thing, short):
    """Its Groebner basis generates the same ideal or module, read from what it prints."""
    name = "I" if isinstance(thing, pas.Ideal) else "M"
    program = f"{thing.to_singular()}short = {short};\nstd({name});\nquit;\n"
    said = subprocess.run(["Singular", "-q"], input=program, text=True, capture_output=True, check=True).stdout
    assert type(thing).from_singular(said) == thing


@pytest.mark.slow  # it takes seconds to start
@pytest.mark.parametrize("thing", EVERY, ids=lambda v: str(v)[:20])
@pytest.mark.skipif(shutil.which("M2") is None, reason="Macaulay2 is not installed")
def test_macaulay2_reads_it_and_agrees(thing):
    name = "I" if isinstance(thing, pas.Ideal) else "M"
    kind = "ideal" if name == "I" else "image"
    for said in (f"toString {name}", f'"{kind} " | toString gens gb {name}'):
        program = f"{thing.to_macaulay2()}print({said}); exit 0"
        command = ["M2", "--silent", "--stop", "-q", "--no-prompts", "-e", program]
        result = subprocess.run(command, text=True, capture_output=True, check=True)
        assert type(thing).from_macaulay2(result.stdout) == thing


def test_what_singular_prints_is_read():
    """Its short form, its unit vectors, zeros at the end that it leaves away, and the name _ of results."""
    assert pas.Ideal.from_singular("I[1]=x2+y2-1/3\nI[2]=xyz-2/7z3\nI[3]=-x+1\n") == IDEALS[0]
    assert pas.Submodule.from_singular("_[1]=y2*gen(2)+3x*gen(1)\n_[2]=xy*gen(3)+z*gen(2)-gen(2)") == MODULES[0]
    assert pas.Submodule.from_singular("M[1]=[x]\nM[2]=[0,y]").generators == (("x", 0), (0, "y"))
    assert pas.Ideal.from_singular("ring r=0,(x,y,z),lp;\nideal J=x^2 , 3*y;").generators == ("x^2", "3*y")
    assert pas.Ideal.from_macaulay2("ideal(x^2+y^2-1,x*y-(2/7)*z^3)") == pas.Ideal("x^2+y^2-1", "x*y-2/7*z^3")


@pytest.mark.parametrize(
    ("reads", "text", "words"),
    [
        (pas.Ideal.from_singular, "poly f = x;", "no ideal and no module of Singular in 'poly f = x;'"),
        (pas.Ideal.from_singular, "ideal I = x, y +;", "'y [+]' is no polynomial in x, y and z"),
        (pas.Ideal.from_singular, "ring R = 0, (a, b), dp; ideal I = a;", "variables must be x, y and z, not a, b"),
        (pas.Ideal.from_singular, "ring R = 7, (x, y, z), dp; ideal I = x;", "characteristic must be 0, not 7"),
        (pas.Submodule.from_singular, "M[1]=x*gen(1)+y", "'[+]y' is no multiple of a unit vector"),
        (pas.Ideal.from_macaulay2, "matrix {{x}}", "no ideal and no module of Macaulay2"),
        (pas.Ideal.from_macaulay2, "R = QQ[u]; I = ideal(u)", "variables must be x, y and z, not u"),
        (pas.Ideal.from_macaulay2, "ideal(x,sin y)", "is no polynomial"),
        (pas.Submodule.from_macaulay2, "image matrix {{x,y},{z}}", "no ideal and no module of Macaulay2"),
        (pas.Ideal.from_singular, "module M = [x, y];", "an ideal has single polynomials for generators"),
    ],
)
def test_what_cannot_be_read_is_said(reads, text, words):
    with pytest.raises(ValueError, match=words):
        reads(text)


def test_spaces_and_syzygies():
    space = pas.solutions(pipes(), 1, 3)
    rows = pas.Submodule.from_singular(space.to_singular()).generators
    assert rows == space.basis
    assert [tuple(map(pas.Polynomial, row)) for row in space.to_sympy()] == list(space.basis)
    found = pas.syzygies(["x", "y", "z"])
    assert found == (("-y", "x", 0), (0, "-z", "y"), ("-z", 0, "x")) and isinstance(found, tuple)
    assert found._repr_latex_() == r"$\langle (-y, x, 0),\; (0, -z, y),\; (-z, 0, x) \rangle$"
    x, y, z = sympy.symbols("x y z")
    assert found.to_sympy() == [(-y, x, 0), (0, -z, y), (-z, 0, x)]
    with pytest.raises(ValueError, match="no generators to write"):
        pas.solutions(pipes(), 1, 1).to_singular()


def test_a_system_of_ones_own():
    """It is known by its name to all that has generators."""
    SYSTEMS.register(System("lines", lambda rows: "\n".join(str(row[0]) for row in rows), read))
    try:
        assert pas.Ideal("x", "y - 1").written("lines") == "x\ny - 1"
        assert pas.Ideal.of_rows(SYSTEMS["lines"].read(write((("x",),)))) == pas.Ideal("x")
    finally:
        del SYSTEMS._entries["lines"]
    with pytest.raises(ValueError, match="is 'singular' meant"):
        pas.Ideal("x").written("singula")


@pytest.mark.parametrize("thing", EVERY, ids=lambda v: str(v)[:20])
def test_latex_is_read(thing):
    """By matplotlib's reader of formulas, whole and shortened; the whole one has all digits."""
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    parser.parse(thing._repr_latex_())
    parser.parse(f"${thing.to_latex()}$")
    assert "ldots" not in thing.to_latex()
