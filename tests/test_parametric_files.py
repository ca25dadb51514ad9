"""Files of parametric surfaces and blends: exact round trips, meshes, problem files, the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pas
from pas.cli import main
from pas.exchange.files import checksum
from pas.parametric.blends import blend_by, method_of

FIRST = pas.ParametricSurface("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1")
SECOND = pas.ParametricSurface("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1")
THIRD = pas.ParametricSurface("t", "1/3*h*t^2 + 1/7", "5/(t^2 + h^2 + 2) + h")
DATA = pas.BlendingData([FIRST, SECOND])
TEXT = """\
order = 1
[[surfaces]]
x = "(1 - t^2)/(1 + t^2)"
y = "2*t/(1 + t^2)"
z = "h - 1"
[[surfaces]]
x = "2*(1 - t^2)/(1 + t^2)"
y = "4*t/(1 + t^2)"
z = "h + 1"
[domain]
t = [-1, 1]
"""
SURFACES = {
    "exact": THIRD,
    "other names and a domain": pas.ParametricSurface("u + 1/3", "v^2", "u/v", ("u", "v"), ((0, None), (1, "10/3"))),
    "of high degree": pas.ParametricSurface("(t + h)^40", "(t^59 + 1)/(h^60 + 2)", "1"),
    "sines": pas.helicoid("1/3").with_domain(((-1, "1/10"), (0, 2))),
    "moved sines": pas.helicoid().moved([[0, 1, 0], [1, 0, "1/3"], [0, 0, 2]], (1, "-2/7", 3)),
    "numbers": pas.ParametricSurface("exp(t)", 1, "1/3"),
}


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces_come_back(tmp_path, name):
    surface = SURFACES[name]
    found = pas.load(pas.save_parametric(surface, tmp_path / "a.pas.json"))
    assert isinstance(found, pas.ParametricSurface)
    assert (found.parameters, found.ends, found.is_exact) == (surface.parameters, surface.ends, surface.is_exact)
    assert found.domain == surface.domain
    if surface.is_exact:
        assert found.components == surface.components
        assert str(found) == str(surface)
    points = np.random.default_rng(1).uniform(0.0, 0.1, (50, 2)) + (0, 1)
    assert np.allclose(found(points), surface(points), rtol=1e-14, atol=1e-14)
    again = pas.save_parametric(found, tmp_path / "b.pas.json")
    assert again.read_bytes() == (tmp_path / "a.pas.json").read_bytes()


BLENDS = {
    "hermite": pas.hermite_blend(DATA, 3),
    "at values": pas.hermite_blend(pas.BlendingData([FIRST, THIRD, SECOND], ["-1/3", 0, "22/7"]), 1),
    "weighted": pas.weighted_blend(DATA, 2, balance="1/3", exponent=4),
    "normalized": pas.weighted_blend(
        pas.BlendingData([FIRST, THIRD, SECOND]), 1, ["1/2", "1/3", "2/3"], normalized=True
    ),
    "on a domain": pas.ParametricBlend(DATA, 1, pas.hermite_blend(DATA, 1).surface.with_domain(((0, 1), (0, 1)))),
    "a member": pas.ParametricBlend(
        DATA, 1, pas.hermite_blend(DATA, 1).all_solutions().member("t", "1/(1 + t^2)", "h")
    ),
    "sines": pas.hermite_blend(pas.BlendingData([pas.helicoid(), FIRST]), 1),
}


@pytest.mark.parametrize("name", BLENDS)
@pytest.mark.sampled(2)
def test_blends_come_back(tmp_path, name):
    blend = BLENDS[name]
    certificate = blend.prove(((0, 1), (0, 1))) if name == "hermite" else None
    path = pas.save_parametric(blend, tmp_path / "a.pas.json", certificate)
    found = pas.load(path)
    assert isinstance(found, pas.ParametricBlend)
    assert (found.order, found.weights, found.data.values) == (blend.order, blend.weights, blend.data.values)
    assert (found.surface.domain, found.surface.ends) == (blend.surface.domain, blend.surface.ends)
    if blend.surface.is_exact:
        assert found.surface.components == blend.surface.components
        assert all(v.proved for v in found.prove(effort=1).contacts)
    points = np.random.default_rng(1).random((50, 2))
    assert np.allclose(found.surface(points), blend.surface(points), rtol=1e-12, atol=1e-12)
    assert pas.save_parametric(found, tmp_path / "b.pas.json", certificate).read_bytes() == path.read_bytes()
    verdicts = json.loads(path.read_text())["content"]["verdicts"]
    assert verdicts is None if certificate is None else [v["status"] for v in verdicts] == ["proved"] * 3


def test_what_cannot_be_saved(tmp_path):
    callable_one = pas.ParametricSurface("t", "h", lambda t, h: np.sin(t))
    given = pas.ParametricSurface("sin(t)", "h", "0", derivatives={(1, 0): lambda t, h: (t, h, h)})
    for surface in (callable_one, given, callable_one.moved(offset=(1, 2, 3))):
        with pytest.raises(ValueError, match="without expressions cannot be saved"):
            pas.save_parametric(surface, tmp_path / "a.pas.json")
    other = pas.ParametricBlend(BLENDS["sines"].data, 1, pas.helicoid(2).with_domain(((-1, 1), (0, 1))))
    with pytest.raises(ValueError, match="not what the method 'hermite' makes"):
        pas.save_parametric(other, tmp_path / "a.pas.json")
    with pytest.raises(ValueError, match=r"the suffix must be .pas.json"):
        pas.save_parametric(FIRST, tmp_path / "a.json")
    with pytest.raises(TypeError, match="must be a mesh, a solid, an assembly, a surface or a blend"):
        pas.save_parametric(DATA, tmp_path / "a.pas.json")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.pop("order"),
        lambda content: content.update(method="magic"),
        lambda content: content.update(options={"speed": 3}),
        lambda content: content["surfaces"][0]["components"].pop(),
        lambda content: content["surfaces"].pop(),
        lambda content: content.update(values=[0, 0]),
    ],
)
def test_damaged_files_are_refused(tmp_path, change):
    path = pas.save_parametric(BLENDS["hermite"], tmp_path / "a.pas.json")
    record = json.loads(path.read_text())
    change(record["content"])
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match="does not match its checksum"):
        pas.load(path)
    record["sha256"] = checksum(record["content"])
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match="cannot be understood"):
        pas.load(path)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "vtp", "glb"])
@pytest.mark.sampled(3)
def test_meshes_are_written(tmp_path, suffix):
    import pyvista
    import trimesh

    surface = pas.torus(2, 1, angle=True)
    mesh = surface.mesh(0.01)
    path = pas.write_mesh(surface, tmp_path / f"a.{suffix}", tolerance=0.01)
    if suffix == "vtp":
        data = pyvista.read(path)
        assert np.array_equal(data.points, mesh.points)
        assert np.array_equal(data.point_data["parameters"], mesh.parameters)
        return
    read = trimesh.load_mesh(path) if suffix != "glb" else trimesh.load_scene(path).to_mesh()
    read.merge_vertices(merge_norm=True)
    assert len(read.faces) == len(mesh.triangles)
    assert read.is_watertight
    assert abs(read.volume) == pytest.approx(4 * np.pi**2, rel=0.01)
    (tmp_path / "again").mkdir()
    bound = pas.write_mesh(mesh, tmp_path / "again" / f"a.{suffix}")
    assert bound.read_bytes() == path.read_bytes()


def test_mesh_writing_is_checked(tmp_path):
    mesh = pas.plane().mesh(1, ((0, 1), (0, 1)))
    with pytest.raises(ValueError, match="tolerance and domain are for surfaces"):
        pas.write_mesh(mesh, tmp_path / "a.stl", tolerance=1)
    with pytest.raises(TypeError, match="must be a mesh, a solid"):
        pas.write_mesh("mesh", tmp_path / "a.stl")
    with pytest.raises(TypeError, match=r"STEP files hold solids, or rational patches, and .* write its triangles"):
        pas.write_mesh(mesh, tmp_path / "a.step")
    with pytest.raises(ValueError, match="domain of t is infinite"):
        pas.write_mesh(pas.hermite_blend(DATA, 1), tmp_path / "a.stl")
    assert not list(tmp_path.iterdir())


def test_methods_have_names():
    for name, options in (
        ("hermite", {}),
        ("weighted", {"balance": ["1/3", "2/3"], "normalized": True, "exponent": 5}),
    ):
        made = blend_by(name, DATA, 2, options)
        assert method_of(made) == (name, options)
    with pytest.raises(ValueError, match="method must be one of 'hermite', 'weighted'"):
        blend_by("magic", DATA, 2, {})
    with pytest.raises(ValueError, match="'balance' is no option of the method 'hermite'"):
        blend_by("hermite", DATA, 2, {"balance": 1})


def problem(tmp_path, text, name="case"):
    path = tmp_path / f"{name}.toml"
    path.write_text(text)
    return path


def test_problem_files_are_read(tmp_path):
    more = 'method = "weighted"\nbalance = 0.3\nnormalized = true\nvalues = ["-1/2", 2]\ntolerance = 0.02\n'
    picture = '[picture]\nstyle = "plain"\nview = [1, 0, "1/2"]\n'
    found = pas.read_parametric_problem(problem(tmp_path, more + TEXT + picture))
    assert (found.name, found.order, found.mesh.tolerance, found.picture.name, found.picture.view) == (
        "case",
        1,
        0.02,
        "plain",
        (1, 0, 0.5),
    )
    assert found.domain == ((-1.0, 1.0), (-0.5, 2.0))
    blend = found.blend()
    assert [str(u) for u in blend.weights.balance] == ["3/10", "7/10"]
    assert blend.weights.normalized


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("order = 1\n", ""), "has no 'order'"),
        (("order = 1\n", "order = true\n"), "line 1: order must be a whole number"),
        (("order = 1\n", 'order = 1\nmethod = "magic"\n'), "line 2: method must be one of 'hermite', 'weighted'"),
        (("order = 1\n", "order = 1\nbalance = 0.5\n"), "line 2: balance is no option of the method 'hermite'"),
        (("order = 1\n", "order = 1\nspeed = 2\n"), "line 2: unknown key 'speed'"),
        (("order = 1\n", 'order = 1\nmethod = "weighted"\nnormalized = 1\n'), "line 3: normalized must be true"),
        (("order = 1\n", "order = 1\nvalues = [0, 0]\n"), "line 2: .* are both 0"),
        (("order = 1\n", "order = 1\nvalues = [0]\n"), "line 2: there are 2 surfaces but 1 values"),
        (("order = 1\n", 'order = 1\nparameters = ["t"]\n'), "line 2: parameters must be two names"),
        (("order = 1\n", 'order = 1\nname = "a/b"\n'), "line 2: name must be a plain file name"),
        (("h - 1", "h - w"), "line 5: surface 1: component z: .* variable 'w'"),
        (("h + 1", "h +"), "line 9: surface 2: component z: cannot read"),
        (('z = "h + 1"\n', ""), "line 6: .surfaces. has no 'z'"),
        (("t = [-1, 1]", "t = [1, -1]"), "line 11: the domain of t must be an interval"),
        (("t = [-1, 1]", "w = [-1, 1]"), "line 10: .domain. must be a table with intervals of t and h"),
        (("[domain]", '[picture]\nstyle = "loud"\n[domain]'), "line 11: there is no style of pictures 'loud'"),
        (("[domain]", "[picture]\nview = [0, 0, 0]\n[domain]"), "line 11: view must not be the zero vector"),
        (("[[surfaces]]", "[[surfaces]"), "line 2: "),
    ],
)  # fmt: skip
def test_problem_files_are_checked(tmp_path, capsys, change, words):
    path = problem(tmp_path, TEXT.replace(*change, 1))
    with pytest.raises(pas.ProblemFileError, match=words):
        pas.read_parametric_problem(path)
    assert main(["parametric", str(path), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith("pas: case.toml")
    assert not (tmp_path / "out").exists()


def test_the_command_writes_three_files(tmp_path, capsys):
    file = problem(tmp_path, TEXT + "\n[picture]\nsize = [80, 60]\n")
    assert main(["parametric", str(file), "-o", str(tmp_path / "out"), "--tolerance", "0.05"]) == 0
    out = capsys.readouterr().out
    assert out.count(": proved;") == 3
    assert "(proved)" in out
    project = tmp_path / "out/case.pas.json"
    assert sorted(p.name for p in project.parent.iterdir()) == ["case.pas.json", "case.png", "case.stl"]
    assert main(["check", str(project)]) == 0
    assert "all proved" in capsys.readouterr().out
    assert main(["mesh", str(project), "-o", str(tmp_path / "a.obj"), "--tolerance", "0.1"]) == 0
    assert "within" in capsys.readouterr().out
    assert main(["render", str(project), "-o", str(tmp_path / "a.png"), "--curvature"]) == 0
    assert main(["convert", str(project), str(tmp_path / "a.3mf")]) == 2
    assert "a.3mf would be taken for a closed body, and the surface of 'a' has edges" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "arguments", "code", "words"),
    [
        (("[domain]\nt = [-1, 1]", ""), (), 2, "domain of t is infinite"),
        (("h - 1", "1/(t - 3*h + 1/7)"), (), 2, "has a pole"),
        (("", ""), ("--order", "-1"), 2, "order must be a whole number"),
        (("", ""), ("--tolerance", "0"), 2, "tolerance must be a positive number"),
    ],
)
def test_failures_leave_nothing(tmp_path, capsys, change, arguments, code, words):
    path = problem(tmp_path, TEXT.replace(*change))
    assert main(["parametric", str(path), "-o", str(tmp_path / "out"), *arguments]) == code
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_refuted_proof_is_an_exit_code(tmp_path, capsys):
    apex = TEXT.replace("(1 - t^2)/(1 + t^2)", "h*(1 - t^2)/(1 + t^2)", 1).replace(
        "2*t/(1 + t^2)", "h*2*t/(1 + t^2)", 1
    )
    arguments = ["-o", str(tmp_path), "--no-picture"]
    assert main(["parametric", str(problem(tmp_path, apex)), *arguments]) == 1
    assert "refuted; the normal vanishes" in capsys.readouterr().out
    assert main(["parametric", str(problem(tmp_path, "prove = false\n" + apex)), *arguments]) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: c.update(order=True), "content.order must be a whole number, not True"),
        (lambda c: c.update(order=2001), "order must be a whole number from 0 to 8"),
        (lambda c: c.update(options={"exponent": 10**6}), "no option of the method 'hermite'"),
        (lambda c: c["components"][0][0].append([10**6, 0, "1"]), "must have exponents >= 0 of sum up to 200"),
        (lambda c: c["components"][0][0].append(c["components"][0][0][0]), "stands twice"),
        (lambda c: c["surfaces"][0].pop("components"), "must be a surface: a table with components or expressions"),
        (lambda c: c["surfaces"].extend(c["surfaces"] * 20), "a blend meets from 2 to 32 surfaces"),
        (lambda c: c.update(domain=[["0"], ["0", "1"]]), r"content.domain\[0\] must be a list of 2 entries, not of 1"),
        (lambda c: c.update(verdicts=[{"claim": "all"}]), r"content.verdicts\[0\] has no 'status'"),
    ],
)
def test_records_are_checked_with_the_place(tmp_path, change, words):
    path = pas.save_parametric(BLENDS["hermite"], tmp_path / "a.pas.json")
    record = json.loads(path.read_text())
    change(record["content"])
    record["sha256"] = checksum(record["content"])
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match=rf"^a\.pas\.json: the content cannot be understood: .*{words}"):
        pas.load(path)


def test_stored_verdicts_of_blends_are_not_believed(tmp_path):
    """The components of a blend win over its method, and are proved anew whatever the file says of them."""
    blend = BLENDS["on a domain"]
    path = pas.save_parametric(blend, tmp_path / "a.pas.json", blend.certificate)
    record = json.loads(path.read_text())
    record["content"]["components"][2][0].append([0, 9, "1"])
    record["sha256"] = checksum(record["content"])
    path.write_text(json.dumps(record))
    found = pas.load(path)
    assert blend.certificate.proved and not found.certificate.proved
    assert main(["check", str(path)]) == 1
    with pytest.raises(ValueError, match="certificate must be that of the blend"):
        pas.save_parametric(found, tmp_path / "b.pas.json", blend.certificate)
