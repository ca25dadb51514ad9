"""The command line as a user runs it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from conftest import EQUAL, ROOT, solved

from pas import __version__
from pas.cli import main
from pas.cli.common import EXIT_CODES as EXPLAINED
from pas.exchange.picture_options import STYLES
from pas.network.network import Network

PROBLEM = ROOT / "examples/corners/equal_gc1.toml"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with what `pas blend` wrote."""
    folder = tmp_path_factory.mktemp("made") / "new"
    assert main(["blend", str(PROBLEM), "-o", str(folder), "--tolerance", "0.01"]) == 0
    return folder


def run(capsys, *arguments):
    code = main([str(a) for a in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_blend_writes_three_files(made):
    assert sorted(p.name for p in made.iterdir()) == ["equal_gc1.pas.json", "equal_gc1.png", "equal_gc1.stl"]


def test_blend_prints_a_summary_and_progress(tmp_path, capsys, monkeypatch):
    for name in ("FIRST_REPORT", "REPORT_EVERY"):  # stages are told after the first second only
        monkeypatch.setattr(f"pas.limits.{name}", 0.0)
    code, out, err = run(capsys, "blend", PROBLEM, "-o", tmp_path, "--no-picture", "--tolerance", "0.01")
    assert code == 0
    for words in (
        "six tetrahedra",
        "GC^1",
        "degree",
        "dimension",
        "energy",
        "triangles",
        "seconds in all: ",
        "one sheet",
    ):
        assert words in out
    assert str(tmp_path / "equal_gc1.stl") in out
    assert "solve (degree 3)" in err
    shares = [int(share) for share in re.findall(r" \((\d+)%\), \d+ s$", err, re.M)]
    assert len(set(shares)) > 5 and shares == sorted(shares) and shares[-1] < 100
    assert "mesh" in err
    assert not (tmp_path / "equal_gc1.png").exists()


def test_order_and_degree_override_the_file(tmp_path, capsys):
    code, out, _ = run(
        capsys, "blend", PROBLEM, "-o", tmp_path, "--order", 2, "--degree", 5, "--no-picture", "--tolerance", 0.02
    )
    assert code == 0
    assert "GC^2" in out
    record = json.loads((tmp_path / "equal_gc1.pas.json").read_text())
    assert record["content"]["surface"]["degree"] == 5


def test_check_proves_again(made, capsys):
    code, out, _ = run(capsys, "check", made / "equal_gc1.pas.json")
    assert code == 0
    assert "all proved" in out


def test_check_fails_what_is_wrong(made, tmp_path, capsys):
    record = json.loads((made / "equal_gc1.pas.json").read_text())
    record["content"]["surface"]["patches"][2][0][3] = "5"
    wrong = tmp_path / "wrong.pas.json"
    wrong.write_text(json.dumps(record))
    code, _, err = run(capsys, "check", wrong)
    assert code == 2
    assert "checksum" in err
    code, out, _ = run(capsys, "check", wrong, "--edited")
    assert code == 1
    assert "refuted" in out


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "vtp", "glb"])
def test_meshes_are_read_by_others(made, tmp_path, capsys, suffix):
    import pyvista
    import trimesh

    path = tmp_path / f"a.{suffix}"
    code, out, _ = run(capsys, "mesh", made / "equal_gc1.pas.json", "-o", path, "--tolerance", "0.01")
    assert code == 0
    assert "triangles" in out
    if suffix == "vtp":
        mesh = pyvista.read(path)
        triangles, vertices = mesh.n_cells, mesh.n_points
        assert mesh.point_data.active_normals is not None
    else:
        mesh = trimesh.load(path, force="mesh")
        triangles, vertices = len(mesh.faces), len(mesh.vertices)
        assert mesh.euler_number == -1
    assert triangles > 500
    assert vertices < triangles


@pytest.mark.sampled(24)
@pytest.mark.parametrize(
    "style", [[], ["--zebra"], ["--highlights"], ["--curvature"], ["--combs"], *(["--style", name] for name in STYLES)]
)
def test_render(made, tmp_path, capsys, style):
    path = tmp_path / "a.png"
    code, out, _ = run(capsys, "render", made / "equal_gc1.pas.json", "-o", path, "--tolerance", "0.05", *style)
    assert code == 0
    assert path.read_bytes()[:4] == b"\x89PNG"
    assert str(path) in out


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["blend", "none.toml"], 2, "No such file or directory: none.toml"),
        (["blend", PROBLEM, "--order", "-1"], 2, "order must be a whole number from 0 to 8"),
        (["blend", PROBLEM, "--degree", "2"], 1, "lowest degree with solutions is 3"),
        (["blend", PROBLEM, "--tolerance", "0"], 2, "tolerance must be a positive number"),
        (["blend", PROBLEM, "-o", PROBLEM], 2, "is not a folder"),
        (["check", PROBLEM], 2, "is a problem file; make a project of it with `pas blend`"),
        (["mesh", "MADE", "-o", "a.step"], 2, "the suffix must be one of .stl, .obj, .ply"),
        (["mesh", "MADE", "-o", "none/a.stl"], 2, "the folder none of a.stl does not exist"),
        (["render", "MADE", "-o", "a.jpg"], 2, "the suffix must be one of .png, .gif"),
    ],
)
def test_errors_are_one_sentence(made, tmp_path, capsys, monkeypatch, arguments, code, words):
    monkeypatch.chdir(tmp_path)
    arguments = [made / "equal_gc1.pas.json" if a == "MADE" else a for a in arguments]
    result, _, err = run(capsys, *arguments)
    assert result == code
    assert err.splitlines()[-1].startswith("pas: ")
    assert words in err.splitlines()[-1]
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["network", "classes", "cubic", "--radius", "-1/8"], "radius must be positive, not -1/8"),
        (["network", "classes", "cubic", "--cell-size", "-1e-3"], "pas: --cell-size must be positive, not -1/1000"),
        (["network", "classes", "cubic", "--cell-size", "wide"], "pas: --cell-size is not a rational number: 'wide'"),
        (["check", "MADE", "--seconds", "-3"], "pas: seconds must be a positive number, not -3.0"),
        (["network", "classes", "cubic", "--cells", "-4,4,2"], "--cells must be one whole number or three"),
        (["teapot", "--lid-height", "-7/5"], "for heights from 13/10 to 8/5"),
        (["blend", PROBLEM, "--tension", "-.5"], "tension must not be negative"),
        (["render", "MADE", "-o", "a.png", "--view", "-1,0"], "view must be three numbers, not 2"),
        (["convert", "MADE", "a.3mf", "--length", "-1/2"], "length must not be negative, not '-1/2'"),
        (["network", "classes", "cubic", "--order", "1.5"], "argument --order: must be a whole number, not '1.5'"),
        (["check", "MADE", "--seconds", "soon"], "argument --seconds: must be a number, not 'soon'"),
        (["check", "MADE", "-1/8"], "unrecognized arguments: -1/8"),
        (["network", "classes", "cubic", "--radius", "-o"], "argument --radius: expected one argument"),
    ],
)
def test_negative_numbers_are_values_of_options(made, tmp_path, capsys, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    try:
        code, _, err = run(capsys, *(made / "equal_gc1.pas.json" if a == "MADE" else a for a in arguments))
    except SystemExit as ended:
        code, err = ended.code, capsys.readouterr().err
    assert code == 2
    assert words in err.splitlines()[-1]


@pytest.mark.parametrize(
    "arguments",
    [
        ["teapot", "--unit", "furlong"],
        ["teapot", "--tolerance", "-1/10"],
        ["teapot", "--scale", "0"],
        ["network", "build", "cubic", "-o", "a.stl", "--unit", "furlong"],
    ],
)
def test_wrong_values_are_told_before_the_work(tmp_path, capsys, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(import_module("pas.designs.teapot"), "teapot", None)
    monkeypatch.setattr(Network, "blend", None)
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert re.fullmatch(r"pas: (unit|tolerance|scale) must be .*\n", err)


def test_debug_shows_the_traceback(capsys):
    _, _, err = run(capsys, "check", PROBLEM, "--debug")
    assert "Traceback" in err


def test_module_version_and_help(capsys):
    done = subprocess.run(
        [sys.executable, "-m", "pas", "--version", "--verbose"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith(f"pas {__version__}\n") and "\npython-flint " in done.stdout
    with pytest.raises(SystemExit):
        main(["blend", "--help"])
    assert "[[pipes]]" in capsys.readouterr().out
    assert main([]) == 2
    assert "commands" in capsys.readouterr().out


def test_unprovable_problems_write_what_they_found(tmp_path, capsys):
    code, out, _ = run(
        capsys, "blend", ROOT / "examples/corners/published_c.toml", "-o", tmp_path, "--no-picture", "--tolerance", 0.01
    )
    assert code == 1  # nothing was asked to be proved, but this is wrong
    assert "refuted" in out
    assert sorted(p.name for p in tmp_path.iterdir()) == ["published_c.pas.json", "published_c.stl"]


REFUTED, PROVED = "corners/published_c", "corners/published_proved"
TWISTED, QUADRICS = "parametric/generatrix/helicoid_twisted", "parametric/generatrix/quadrics"
EXIT_CODES = [
    # problem, its `prove`, and the exit codes of `blend`, `check`, `check --independent`
    (REFUTED, "", 1, 1, 1),
    (PROVED, "", 0, 0, 0),
    ("corners/undecided", "false", 0, 1, 1),
    ("parametric/wavy_pipes", "", 0, 1, None),
    ("parametric/example_1", "", 1, 1, None),
    ("parametric/example_1", "false", 1, 1, None),
    (QUADRICS, "true", 1, 0, None),
    (QUADRICS, "", 0, 0, None),
    (QUADRICS, "false", 0, 0, None),
    *(pytest.param(TWISTED, prove, 1, 1, None, marks=pytest.mark.slow) for prove in ("", "true", "false")),
]
UNDECIDED = """order = 1
degree = 4
guard = false
contacts = [
    { surface = "y^2 + z^2 - 1", clip = "x^2 + y^2 + z^2 - 4" },
    { surface = "x^2 + z^2 - 1/2", clip = "x^2 + y^2 + z^2 - 4" },
]
partition = { kind = "single cell", lower = [-2, -2, -2], upper = [2, 2, 2] }
normalize = { kind = "value-at", point = [0, 0, 0], value = -1 }
"""
"""Two pipes that end at a sphere."""


@pytest.mark.parametrize(("name", "prove", "made", "checked", "again"), EXIT_CODES)
@pytest.mark.sampled(3)
def test_exit_codes_follow_one_rule(name, prove, made, checked, again, tmp_path, capsys):
    text = UNDECIDED if name.endswith("undecided") else (ROOT / f"examples/{name}.toml").read_text()
    file = tmp_path / f"{Path(name).name}.toml"
    file.write_text(f"prove = {prove}\n{text}" if prove else text)
    code, out, _ = run(capsys, "blend", file, "-o", tmp_path, "--no-picture", "--tolerance", 0.1, "--json")
    said = {verdict["status"] for verdict in json.loads(out)["verdicts"]}
    assert code == made
    assert code == 1 or not said & {"refuted", "fails, measured"}
    project = file.with_suffix(".pas.json")
    assert run(capsys, "check", project)[0] == checked
    if again is not None:
        assert run(capsys, "check", project, "--independent")[0] == again
    if name != REFUTED:
        return
    for command in (["mesh", project, "-o"], ["render", project, "-o"], ["write", project]):  # which print no verdicts
        suffix = {"mesh": ".obj", "render": ".png", "write": ".glb"}[command[0]]
        assert run(capsys, *command, file.with_suffix(suffix), "--tolerance", 0.1)[0] == 0


@pytest.mark.parametrize(("joined", "wanted"), [(True, 0), (False, 1)])
def test_the_teapot_fails_where_nothing_is_proved_of_it(joined, wanted, tmp_path, capsys, monkeypatch):
    from pas import solid
    from pas.designs.teapot import Teapot

    body, other = solved(EQUAL, 1).solid(), solid.box((3, 0, 0), (4, 1, 1))
    pot = Teapot("paper", body if joined else other, body, other)
    monkeypatch.setattr(sys.modules[Teapot.__module__], "teapot", lambda *_, **__: pot)
    assert run(capsys, "teapot", "-o", tmp_path, "--tolerance", 0.1)[0] == wanted


def test_help_says_what_exit_codes_mean(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    assert EXPLAINED in capsys.readouterr().out


@pytest.mark.parametrize(
    ("path", "command", "wanted"),
    [
        ("corners/published_proved", "parametric", 0),
        ("parametric/example_1", "blend", 1),
        ("parametric/generatrix/quadrics", "blend", 0),
    ],
)
def test_both_commands_take_every_problem(command, path, wanted, tmp_path, capsys):
    file = ROOT / f"examples/{path}.toml"
    arguments = [command, file, "-o", tmp_path, "--no-picture", "--tolerance", 0.1, "--json"]
    code, out, _ = run(capsys, *arguments)
    told = json.loads(out)
    assert (code, told["holds"], told["name"]) == (wanted, wanted == 0, file.stem)
    assert told["proved"] == all(verdict["status"] == "proved" for verdict in told["verdicts"])
    assert told["triangles"] > 100
    assert sorted(told["written"]) == sorted(str(p) for p in tmp_path.iterdir())


def test_a_corner_may_say_how_it_is_drawn(tmp_path):
    import pas

    path = tmp_path / "corner.toml"
    path.write_text(PROBLEM.read_text() + '\n[picture]\nstyle = "zebra"\nview = [1, 1, "1/2"]\n')
    problem = pas.read_problem(path)
    assert (problem.picture.name, problem.picture.view) == ("zebra", (1, 1, 0.5))


@pytest.mark.parametrize(("text", "said"), [("1/0", "not '1/0'"), ("nan", "not 'nan'"), ("a", "not 'a'")])
def test_numbers_of_options_are_decimals_or_fractions(made, tmp_path, capsys, text, said):
    arguments = ["mesh", made / "equal_gc1.pas.json", "-o", tmp_path / "a.stl", "--json", "--tolerance"]
    fraction, decimal = (json.loads(run(capsys, *arguments, value)[1]) for value in ("1/40", "0.025"))
    assert fraction["triangles"] == decimal["triangles"]
    with pytest.raises(SystemExit):
        run(capsys, *arguments, text)
    assert f"argument --tolerance: must be a number, as 0.01 or 1/100, {said}\n" in capsys.readouterr().err


def test_the_mesh_of_a_blend_is_by_default_a_thousandth_of_its_size(made, tmp_path, capsys):
    _, out, _ = run(capsys, "mesh", made / "equal_gc1.pas.json", "-o", tmp_path / "a.stl", "--json")
    _, solved, _ = run(capsys, "blend", PROBLEM, "-o", tmp_path, "--no-picture", "--json")
    assert json.loads(out)["triangles"] == json.loads(solved)["triangles"] > 500
