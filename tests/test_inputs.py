"""How large inputs may be: every door by which orders, degrees, numbers, polynomials, tolerances and texts come in."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from functools import reduce

import numpy as np
import pytest
import sympy
from conftest import EQUAL, pipes, solved
from flint import fmpq

import pas
from pas import cli, solid
from pas.algebra import inputs
from pas.algebra.rational import exact, rational
from pas.algebra.rational_function import RationalFunction
from pas.exchange import files as container

WRONG_ORDERS = [-1, 9, 2001, True, False, 0.5, 1.0, "1", None, [1], 10**5000]
SENTENCE = r"^order must be a whole number from 0 to 8 \(0 for continuous, 1 for GC\^1, \.\.\.\), not "
PIPE = pas.Pipe((1, 0, 0), 1, 1)
DATA = pas.BlendingData([pas.elliptic_cylinder(1, 1), pas.elliptic_cylinder(2, 2)])
ORDER_DOORS = {
    "blend": lambda k: pas.blend(pipes(), k),
    "solutions": lambda k: pas.solutions(pipes(), k),
    "existence": lambda k: pas.existence([("y^2 + z^2 - r^2", "x - 1")], k, 2, ("r",)),
    "normal forms": lambda k: pas.normal_form_system([PIPE], k, 2),
    "contact ideal": lambda k: pas.contact_ideal(PIPE, k),
    "surface": lambda k: pas.PiecewiseSurface(pas.SixTetrahedra(), [], k, [pas.Polynomial("x")] * 6),
    "joint": lambda k: solid.patch("a", "x").joined("a", "a", ("x", "y"), k),
    "hermite": lambda k: pas.hermite_blend(DATA, k),
    "weights": lambda k: pas.weighted_blend(DATA, k),
    "criterion": lambda k: pas.has_polynomial_solution(DATA, k),
    "basis": lambda k: pas.hermite_basis([0, 1], k),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("door", ORDER_DOORS)
@pytest.mark.parametrize("order", WRONG_ORDERS, ids=lambda k: inputs.shown(k)[:9])
def test_orders_are_checked_at_every_door(door, order):
    error = ValueError if isinstance(order, int) and not isinstance(order, bool) else TypeError
    with pytest.raises(error, match=SENTENCE):
        ORDER_DOORS[door](order)


def test_whole_numbers_of_numpy_are_orders():
    ideal = pas.contact_ideal(PIPE, np.int64(1))
    assert ideal == pas.contact_ideal(PIPE, 1)


@pytest.mark.parametrize("degree", [0, -1, 13, 50, True, 2.0, "3"])
def test_degrees_of_blends(degree):
    error = ValueError if type(degree) is int else TypeError
    for call in (pas.blend, pas.solutions):
        with pytest.raises(error, match=r"^degree must be a whole number from 1 to 12, not "):
            call(pipes(), 1, degree)


@pytest.mark.parametrize("degree", [2, 17, 50, 2001, True, 3.5, "4"])
def test_degrees_of_surfaces(degree):
    surface = solved(EQUAL, 1).surface
    with pytest.raises((ValueError, TypeError), match=r"^degree must be a whole number from 3 to 16 \(not below"):
        pas.PiecewiseSurface(surface.partition, surface.contacts, 1, surface.patches, degree)
    with pytest.raises(ValueError, match="patches of a surface may be of degree 16, and one is of 20"):
        pas.PiecewiseSurface.from_polynomials(pas.SingleCell(), [], 1, ["x^20"])


def changed(tmp_path, change):
    """A project file of a corner with other content and a right checksum."""
    path = solved(EQUAL, 1).save(tmp_path / "corner.pas.json")
    record = json.loads(path.read_text())
    change(record["content"])
    record["sha256"] = container.checksum(record["content"])
    path.write_text(json.dumps(record))
    return path


@pytest.mark.parametrize("order", [-1, 2001, True, 0.5, "1", None])
def test_orders_of_project_files(tmp_path, order, capsys):
    path = changed(tmp_path, lambda content: content["surface"].update(order=order))
    with pytest.raises(pas.ProjectFileError, match=r"corner\.pas\.json: .*order must be a whole number"):
        pas.load(path)
    assert cli.main(["check", str(path)]) == 2
    assert capsys.readouterr().err.startswith("pas: corner.pas.json: ")


@pytest.mark.parametrize("order", ["-1", "2001", "true", "0.5", '"1"'])
def test_orders_of_problem_files(tmp_path, order):
    path = tmp_path / "a.toml"
    path.write_text(f'order = {order}\n[[contacts]]\nsurface = "x^2 + y^2 - 1"\nclip = "z - 1"\n')
    with pytest.raises(pas.ProblemFileError, match=r"a\.toml, line 1: order must be a whole number from 0 to 8"):
        pas.read_problem(path)
    path.write_text(f'order = {order}\n[[surfaces]]\nx = "t"\ny = "h"\nz = "0"\n' * 1)
    with pytest.raises(pas.ProblemFileError):
        pas.read_parametric_problem(path)


@pytest.mark.parametrize("value", [0.1, np.float64(0.1), np.float32(0.1), "0.1", "1e-1", ".1", Fraction(1, 10)])
def test_floats_are_the_decimals_they_print_as(value):
    assert rational(value) == fmpq(1, 10)
    assert pas.Pipe((1, 0, 0), value, 1).radius == fmpq(1, 10)
    assert pas.Polynomial({(1, 0, 0): value}) == pas.Polynomial("x/10")
    assert solid.ball((0, 0, value), value).polynomials["ball"][0] == pas.Polynomial("x^2 + y^2 + (z - 1/10)^2 - 1/100")
    assert pas.Polynomial("x").at((value, 0, 0)) == Fraction(1, 10)


def test_floats_in_expressions_and_intervals():
    t = sympy.Symbol("t")
    assert RationalFunction(0.1 * t) == RationalFunction("t/10")
    surface = pas.ParametricSurface("t", "h", 0.1, domain=((0.1, 0.7), (0, 1)))
    assert surface.z == RationalFunction("1/10")
    assert pas.iso_curve(surface, t="1/10").components[0] == RationalFunction("1/10", ("h", ""))


@pytest.mark.parametrize("value", [5e-324, 2.0**-1074, 1.7976931348623157e308, 1 / 3, -2.5e-8, 1e22, 123456789.0])
def test_every_double_is_taken_and_given_back(value):
    assert float(Fraction(str(rational(value)))) == value
    assert rational(value) == rational(repr(value))
    assert exact(value) == fmpq(*value.as_integer_ratio())


@pytest.mark.parametrize(
    "value", [float("nan"), float("inf"), "nan", "inf", "", "1/0", "1e1001", "1e99999999", "9" * 100_001]
)
def test_numbers_that_are_none_or_too_long(value):
    with pytest.raises(ValueError, match=r"^radius ") as caught:
        rational(value, "radius")
    assert len(str(caught.value)) < 200


def test_long_numbers_that_are_written_out_are_taken():
    assert rational("7" * 5000) == fmpq(int("7" * 4000)) * fmpq(10) ** 1000 + fmpq(int("7" * 1000))
    assert rational("1/" + "7" * 5000) == 1 / rational("7" * 5000)


HUGE = {
    "tower": ("((((9^60)^60)^60)^60)", "has numbers of more than 1000 digits"),
    "exponent": ("1e99999999*x", "an exponent beyond 1000"),
    "power": ("x^1000000", "must be a whole number from 0 to 60"),
    "product": ("x^60*y", "of degree 61, above 60"),
    "powers": ("((x + y)^50)^50", "of degree 2500, above 60"),
    "sum": ("+".join(["x"] * 50_000), "a sum has more than 3000 terms"),
    "digits": ("9" * 100_001, "a number may have 100000"),
    "products": ("*".join(["1e1000"] * 250), "numbers of more than 200000 digits"),
    "quotients": ("/".join(["1e1000"] * 250), "numbers of more than 200000 digits"),
    "text": ("x" * 200_001, "200001 characters; an expression may have 200000"),
    "brackets": ("(" * 500 + "x" + ")" * 500, "nested more than 90 deep"),
}


@pytest.mark.parametrize("name", HUGE)
def test_polynomials_that_are_too_large(name):
    text, words = HUGE[name]
    with pytest.raises(ValueError, match=words) as caught:
        pas.Polynomial(text)
    assert len(str(caught.value)) < 400
    with pytest.raises(ValueError, match="cannot read the expression"):
        RationalFunction(text.replace("x", "t").replace("y", "h"))


def test_powers_and_exponents_of_scripts():
    with pytest.raises(ValueError, match="it is of degree 1000000, above 200"):
        pas.Polynomial("x") ** 10**6
    with pytest.raises(ValueError, match="numbers of more than 1000 digits"):
        pas.Polynomial(3) ** 10**6
    with pytest.raises(ValueError, match=r"\(1000000, 0, 0\) are of degree 1000000, above 60"):
        pas.Polynomial({(10**6, 0, 0): 1})
    with pytest.raises(ValueError, match="whole numbers >= 0"):
        pas.Polynomial({(True, 0, 0): 1})
    with pytest.raises(ValueError, match="has powers above 60"):
        pas.Polynomial((sympy.Symbol("x") + 1) ** 10**6)
    large = pas.Polynomial("x^60") * pas.Polynomial("y^60 + 1")
    assert pickle.loads(pickle.dumps(large)) == large
    assert (pas.Polynomial(-1) ** 10**6).at((0, 0, 0)) == 1


def test_a_power_of_many_letters_is_refused_before_it_is_worked_out():
    names = tuple("abcdefgh")
    with pytest.raises(ValueError, match="more than 100000 terms"):
        pas.existence([(f"({'+'.join(('x', 'y', 'z', *names))})^30", "x - 1")], 1, 2, names)


MESHES = {
    "surface": lambda tolerance: solved(EQUAL, 1).surface.mesh(tolerance),
    "solid": lambda tolerance: solid.ball((0, 0, 0), 1).mesh(tolerance),
    "parametric": lambda tolerance: pas.elliptic_cylinder(1, 1).mesh(tolerance, ((-1, 1), (0, 1))),
}


@pytest.mark.parametrize("kind", MESHES)
@pytest.mark.parametrize("tolerance", [1e-300, 1e-9, 0, -1, float("nan"), float("inf"), True, "thin", 10**400])
def test_tolerances(kind, tolerance):
    error = TypeError if isinstance(tolerance, bool) else ValueError
    with pytest.raises(error, match=r"^tolerance must be "):
        MESHES[kind](tolerance)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[" * 20_000, "nested more than 200 deep"),
        ('{"format": "pas-project", "version": 1, "content": ' + "[" * 300 + "]" * 300 + "}", "has no content"),
        (
            '{"format": "pas-project", "version": 1, "content": {"a": ' + "[" * 300 + "]" * 300 + "}}",
            "nested more than",
        ),
        ('{"format": "pas-project", "version": true, "content": {}}', "version must be a whole number from 1 to 1"),
        ('{"a": NaN}', "NaN is no finite number"),
        ('{"a": [Infinity]}', "Infinity is no finite number"),
        ('{"a": 1e999}', "1e999 is no finite number"),
        ('{"a": 1, "a": 2}', "the key 'a' stands twice"),
        ('{"a": ' + "9" * 5000 + "}", "a whole number of 5000 digits"),
        ('{"a": "\\ud800"}', "half a character"),
        ('{"a": 1}\0', "not readable as JSON at line 1"),
        ("\xff", "not a project file|not readable"),
    ],
)
def test_json_is_read_strictly(tmp_path, text, words):
    path = tmp_path / "a.pas.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(pas.ProjectFileError, match=rf"^a\.pas\.json: .*{words}"):
        pas.load(path)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a = " + "[" * 20_000, None, "nested more than 200 deep"),
        ("order = 1\nbasis = " + "[" * 300 + "]" * 300, None, "nested more than 200 deep"),
        (
            "order = 1\n[[pipes]]\naxis = [1, 0, 0]\nradius = 1e99999999\nclip = 1",
            4,
            "'1e99999999' has an exponent beyond",
        ),
        ("order = 1\ndegree = " + "9" * 5000, 2, "more than 4300 digits"),
        ("order = 1\ntolerance = 1e400", 2, "tolerance must be a positive number, not inf"),
        ("order = 1\ntolerance = true", 2, "tolerance must be a positive number, not True"),
        ("order = 1\ndegree = 50", 2, "degree must be a whole number from 1 to 12, not 50"),
        ('order = 1\nname = "a\\u0000b"', 2, "plain file name"),
        ('order = 1\nname = ".."', 2, "plain file name"),
        ("order = 1\nbasis = 3\n[[contacts]]\nsurface = 'x'\nclip = 'y'", 2, "basis must be a list of members"),
        ("order = 1979-05-27\n", 1, "order must be a whole number"),
        ("\ufefforder = -1", 1, "order must be a whole number"),
    ],
)
def test_toml_is_read_within_limits(tmp_path, text, line, words):
    path = tmp_path / "a.toml"
    text += '\n[[contacts]]\nsurface = "x^2 + y^2 - 1"\nclip = "z - 1"\n' if "[[" not in text else ""
    path.write_text(text, encoding="utf-8")
    with pytest.raises(pas.ProblemFileError, match=words) as caught:
        pas.read_problem(path)
    assert caught.value.line == line
    assert len(str(caught.value)) < 300


def test_files_of_any_size_are_not_read_to_their_end(tmp_path, monkeypatch):
    monkeypatch.setattr(container, "MOST_BYTES", 1 << 20)
    for read, name in ((pas.load, "a.pas.json"), (pas.read_problem, "a.toml")):
        (tmp_path / name).write_bytes(b" " * (1 << 22) + b" ")
        with pytest.raises((pas.ProjectFileError, pas.ProblemFileError), match=rf"{name}: is larger than [14] MB"):
            read(tmp_path / name)


def test_what_could_not_be_read_again_is_not_written(tmp_path):
    deep = {"x": reduce(lambda inner, _: [inner], range(200), 1)}
    with pytest.raises(ValueError, match="nested more than 199 deep"):
        container.write_project(tmp_path / "a.pas.json", deep, "test")
    with pytest.raises(ValueError, match="numbers that are not finite"):
        replace(solved(EQUAL, 1), energy=float("nan")).save(tmp_path / "a.pas.json")
    assert not list(tmp_path.iterdir())


def test_long_coefficients_and_formulas_come_back(tmp_path):
    """Beyond 4300 digits Python writes no integer and reads none; formulas beyond some length are kept as terms."""
    blend = solved(EQUAL, 1)
    known = blend.surface
    patches = [p * rational("1/" + "7" * 5000) for p in known.patches]
    long = pas.Polynomial({(1, 0, 0): 1, (0, 0, 0): rational("1/" + "7" * 5000)})
    contacts = [pas.Contact(long, "y - 1"), *known.contacts[1:]]
    for parts in ((known.contacts, 1, patches), (contacts, 1, known.patches)):
        surface = pas.PiecewiseSurface(known.partition, *parts)
        again = pas.load(replace(blend, surface=surface).save(tmp_path / "a.pas.json"))
        assert again.surface.patches == surface.patches
        assert again.surface.contacts == surface.contacts


def test_the_exact_library_does_not_end_the_process():
    """As in a process of 2 GB, where what is refused now would have ended it."""
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (2 << 30,) * 2)\n"
        "import pas\n"
        "for make in (lambda: pas.Polynomial('((((9^60)^60)^60)^60)'), lambda: pas.Pipe((1, 0, 0), '1e99999999', 1),\n"
        "             lambda: pas.Polynomial({(10**6, 10**6, 0): 1})(__import__('numpy').zeros(3)),\n"
        "             lambda: pas.contact_ideal(('x^2 + y^2 - 1', 'z'), 2001)):\n"
        "    try:\n        make()\n    except ValueError as error:\n        print('refused')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (done.stdout.split(), done.returncode) == (["refused"] * 4, 0), done.stderr


@pytest.mark.parametrize("polynomial", ["1e302*x - 1", "x + 1e-302*y - 1"])
def test_functions_that_doubles_cannot_hold_bound_no_solid(polynomial):
    with pytest.raises(ValueError, match=r"^the face 'a' has coefficients more than 1e300 times as large as others"):
        solid.patch("a", polynomial)
    assert solid.patch("a", "1e299*x - 1").faces == ("a",)


@pytest.mark.parametrize("piece", [-1, 6, True, "0", 0.0])
def test_pieces_of_energies(piece):
    with pytest.raises((TypeError, ValueError), match=r"^piece must be a whole number from 0 to "):
        box = pas.Box((0, 0, 0), (1, 1, 1))
        pas.blend(pipes(EQUAL), 1, 3, energy=pas.ThinPlate(box, piece), prove=False)
