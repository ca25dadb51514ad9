"""Every kind of shape does what every shape does: the table of kinds is gone through, and nothing is left out."""

from __future__ import annotations

import inspect
import json
import re
from dataclasses import fields, replace
from fractions import Fraction
from functools import cache
from html import escape

import numpy as np
import pytest
from conftest import DATA, EQUAL, ROOT, solved
from flint import fmpq

import pas
from pas import network, solid
from pas.cli import main
from pas.exchange import files as container
from pas.exchange.schema import Table
from pas.mesh.quality import Quality
from pas.shape import KINDS, Kind, Shape, kind_of
from pas.verdicts import Findings, Status, Verdict, Verdicts

SQUARE = ((-1, 1), (0, 1))
SECTIONS = {"quadric": "x^2 + y^2 - 1", "plane": "z - 3"}, {"quadric": "x^2 + z^2 - 1", "plane": "y - 3"}


def _neck():
    data = pas.BlendingData([pas.elliptic_cylinder(1, 1), pas.elliptic_cylinder(2, 2)], values=[0, 1])
    neck = pas.hermite_blend(data, 1)
    return pas.ParametricBlend(neck.data, neck.order, neck.surface.with_domain(SQUARE))


def _through_sphere():
    ends = [pas.boundary_from(table) for table in SECTIONS]
    joined = pas.blend_through_sphere(ends, ("1/10", 0, 0), "3/2")
    first, *others = joined.blends
    return pas.SphereBlend(
        joined.center, joined.radius, joined.circles, joined.angles, (first.with_shape(l1="1/3"), *others)
    )


def _pot():
    """A small stand-in for the teapot, which is tested elsewhere: another closed solid, and its parts."""
    from pas.designs.teapot import Teapot

    bowl, lid = solid.box((0, 0, 0), (2, 2, 1)), solid.box((0, 0, 1), (2, 2, "3/2"))
    return Teapot("paper", bowl | lid, bowl, lid)


def _ball():
    """A mesh that says nothing of its distance from a surface, as one from a file."""
    return replace(solid.ball((3, 0, 0), 1).mesh(0.1), deviation=None)


def bend():
    """Two struts at a right angle."""
    return network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1), (0, 2)], "1/8", "1/8")


SAMPLES = {
    "blend": lambda: solved(EQUAL, 1),
    "hollow blend": lambda: solved(EQUAL, 1).hollow("1/10"),
    "surface": lambda: solved(EQUAL, 1).surface,
    "solid": lambda: solid.cylinder((0, 0, 0), (0, 0, 1), 1) - solid.ball((0, 0, 0), "1/2"),
    "part": lambda: solid.assembly(ball=(solid.ball((0, 0, 0), 1), "#102030"))["ball"],
    "assembly": lambda: solid.assembly(ball=solid.ball((0, 0, 0), 1), dust=(_ball(), "#102030")),
    "teapot": _pot,
    "parametric surface": lambda: pas.torus(2, 1).with_domain(((-1, 1), (-1, 1))),
    "parametric blend": _neck,
    "generatrix blend": lambda: pas.generatrix_blend(*map(pas.boundary_from, SECTIONS)),
    "sphere blend": _through_sphere,
    "rational patch": lambda: pas.bezier_patches(pas.torus(2, 1), SQUARE)[0],
    "mesh": lambda: _ball(),
    "network": lambda: bend().blend(1, "lowest"),
    "layout": lambda: pas.Layout(
        [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, -1, -1)], [(0, 1, 2), (1, 0, 3), (2, 1, 3), (0, 2, 3)], ("1/3", 0, 2)
    ),
}
"""One shape of each kind: a new kind needs one here."""

TOLERANCE = 0.05


@cache
def sample(name):
    return SAMPLES[name]()


every_kind = pytest.mark.parametrize("name", list(KINDS))


def test_every_kind_has_a_sample():
    assert set(SAMPLES) == set(KINDS)


def test_every_shape_has_a_kind():
    def below(cls):
        return {cls, *(c for s in cls.__subclasses__() for c in below(s))}

    for cls in below(Shape) - {Shape}:
        if cls.__module__.startswith("pas.") and hasattr(cls, "kind"):  # what others build on has none
            assert issubclass(cls, KINDS[cls.kind].type), cls


@every_kind
def test_names_and_types_agree(name):
    kind, shape = KINDS[name], sample(name)
    assert kind.name == name == type(shape).kind
    assert kind_of(shape) is kind
    assert type(shape) is kind.type
    assert (kind.type.__doc__ or "").strip()


@every_kind
def test_a_file_gives_the_same_shape(name, tmp_path):
    shape = sample(name)
    path = shape.save(tmp_path / "a.pas.json")
    assert json.loads(path.read_text())["content"]["kind"] == name
    again = pas.load(path)
    assert type(again) is type(shape)
    assert str(again).replace(", as its file tells", "") == str(shape)
    assert pas.save(again, tmp_path / "b.pas.json").read_bytes() == path.read_bytes()
    assert again.certificate.verdicts == shape.certificate.verdicts


def test_how_near_a_mesh_is_to_its_surface_is_not_believed(tmp_path):
    mesh = pas.torus(2, 1).with_domain(SQUARE).mesh(0.01)
    assert mesh.proved
    assert "within" in str(mesh.certificate)
    again = pas.load(mesh.save(tmp_path / "a.pas.json"))
    assert (again.points == mesh.points).all()
    assert (again.parameters == mesh.parameters).all()
    assert again.deviation is None
    assert not again.proved
    assert "within" not in str(again.certificate)


@every_kind
def test_damaged_contents_are_refused_with_the_place(name, tmp_path):
    path = sample(name).save(tmp_path / "a.pas.json")
    whole = json.loads(path.read_text())
    changes = [lambda content: content.update(surplus=1)]
    keys = [*KINDS[name].form.needs, *["verdicts"] * KINDS[name].kept]
    changes += [lambda content, k=key: content.pop(k) for key in keys]
    changes += [lambda content, k=key: content.update({k: {"no": "such"}}) for key in keys]
    for change in changes:
        record = json.loads(json.dumps(whole))
        change(record["content"])
        record["sha256"] = container.checksum(record["content"])
        path.write_text(json.dumps(record))
        with pytest.raises(pas.ProjectFileError, match=r"^a\.pas\.json: the content cannot be understood: "):
            pas.load(path)


@every_kind
def test_the_certificate_speaks_the_one_protocol(name):
    certificate = sample(name).certificate
    assert isinstance(certificate, Verdicts)
    assert all(isinstance(verdict, Verdict) for verdict in certificate.verdicts)
    assert certificate.proved in (True, False)
    assert certificate.holds or not certificate.proved
    assert not (certificate.holds and certificate.failed)
    assert str(certificate) and "<table>" in certificate._repr_html_()
    json.dumps(certificate.to_record())
    assert sample(name).certificate.verdicts == certificate.verdicts


@pytest.mark.sampled(7)
@every_kind
def test_it_meshes_draws_and_writes(name, tmp_path):
    shape, tolerance = sample(name), TOLERANCE
    mesh = shape.mesh(tolerance)
    assert isinstance(mesh, pas.Mesh)
    assert len(mesh.triangles) > 10
    options = {"mesh": mesh, "size": (120, 90)} if KINDS[name].parts is None else {"tolerance": tolerance}
    for style in (pas.Style.PLAIN, pas.Style.ZEBRA):
        path = shape.draw(tmp_path / f"{style.value}.png", style=style, **(options | {"size": (120, 90)}))
        assert path.read_bytes()[:4] == b"\x89PNG"
    four = pas.draw(shape, tmp_path / "four.png", four_views=True, cut=True, exploded=True, **options)
    assert four.exists()
    written = shape.write(tmp_path / "a.stl", open=True, **({} if name == "mesh" else {"tolerance": tolerance}))
    assert (written.stat().st_size - 84) % 50 == 0
    assert written.stat().st_size == 84 + 50 * len(mesh.triangles)


@every_kind
@pytest.mark.sampled(3)
def test_it_has_the_box_of_its_mesh(name):
    shape = sample(name)
    points = shape.mesh().points
    assert np.array_equal(shape.bounding_box, [points.min(axis=0), points.max(axis=0)])


@every_kind
def test_it_prints_shortly(name):
    shape = sample(name)
    assert 3 < len(repr(shape)) < 300
    assert "array(" not in repr(shape)
    assert str(shape)
    assert KINDS[name].text(shape)


@every_kind
@pytest.mark.sampled(7)
def test_notebooks_show_a_table_and_a_picture(name, monkeypatch):
    shape = sample(name)
    html = shape._repr_html_()
    assert "<table>" in html
    assert "data:image/png;base64," in html
    monkeypatch.setattr("pas.render.plotting.LIBRARIES", {"libnothing.so.9": "libnothing9"})
    monkeypatch.setattr("sys.platform", "linux")
    assert "no picture: pictures need OpenGL" in shape._repr_html_()
    monkeypatch.setattr("sys.platform", "darwin")  # which brings its own
    assert "data:image/png;base64," in shape._repr_html_()


JOINED = {
    "solid with joints": lambda: solved(EQUAL, 1).solid(),
    "assembly with joints": lambda: solid.assembly(node=solved(EQUAL, 1).solid()),
}


@pytest.mark.parametrize("name", [*KINDS, *JOINED])
def test_notebooks_show_each_verdict_once(name, monkeypatch):
    monkeypatch.setattr("pas.render.drawing._embedded", lambda _: "")
    shape = JOINED[name]() if name in JOINED else sample(name)
    text, _, table = shape._repr_html_().partition("<table>")
    assert "verdicts proved" not in text and "joints" not in text
    for verdict in shape.certificate.verdicts:
        row = f"<td>{escape(verdict.claim)}</td><td>{verdict.status.value}</td><td>{escape(verdict.reason)}</td>"
        assert table.count(row) == 1 and escape(verdict.reason) not in text


@every_kind
def test_a_window_needs_a_screen(name, monkeypatch):
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(pas.MissingLibraryError, match="a window needs a screen"):
        sample(name).show()


def test_a_window_is_opened_where_there_is_a_screen(monkeypatch):
    import pyvista

    shown = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(pyvista.Plotter, "show", lambda self: shown.append(self))
    pas.show(sample("mesh"))
    assert len(shown) == 1
    shown[0].close()


@pytest.mark.sampled(15)
@every_kind
def test_the_commands_take_it(name, tmp_path, capsys):
    project, tolerance = sample(name).save(tmp_path / "a.pas.json"), str(TOLERANCE)
    holds = sample(name).certificate.holds
    assert main(["check", str(project), "--json"]) == (0 if holds else 1)
    told = json.loads(capsys.readouterr().out)
    assert (told["holds"], len(told["verdicts"])) == (holds, len(sample(name).certificate.verdicts))
    finer = [] if name == "mesh" else ["--tolerance", tolerance]
    commands = [
        ["mesh", str(project), "-o", str(tmp_path / "a.obj"), *finer],
        ["write", str(project), str(tmp_path / "b.glb"), *finer],
        ["convert", str(project), str(tmp_path / "c.ply"), *finer],
        ["render", str(project), "-o", str(tmp_path / "d.png"), "--tolerance", tolerance],
    ]
    for command in commands:
        assert main([*command, "--json"]) == 0, capsys.readouterr().err
        (written,) = json.loads(capsys.readouterr().out)["written"]
        assert (tmp_path / written).stat().st_size > 100


@every_kind
def test_a_tolerance_is_read_as_other_lengths_are(name):
    shape = sample(name)
    for given in ("1/20", Fraction(1, 20), fmpq(1, 20), np.float64(TOLERANCE)):
        assert np.array_equal(shape.mesh(given).points, shape.mesh(TOLERANCE).points)
    for wrong, error in {"1/0": ValueError, "thin": ValueError, 0: ValueError, b"1": TypeError}.items():
        with pytest.raises(error, match="tolerance must be a positive number, not "):
            shape.draw("a.png", tolerance=wrong) if name == "mesh" else shape.mesh(wrong)  # which is as it is


@every_kind
def test_arrays_of_meshes_cannot_be_written_to(name):
    mesh = sample(name).mesh(TOLERANCE)
    arrays = [a for a in (getattr(mesh, field.name) for field in fields(mesh)) if isinstance(a, np.ndarray)]
    assert len(arrays) >= 4 and not any(array.flags.writeable for array in arrays)


@pytest.mark.parametrize("verb", ["save", "draw", "show", "kind_of"])
@pytest.mark.parametrize("thing", [None, "torus", 3, object()], ids=lambda t: type(t).__name__)
def test_what_is_no_shape_is_refused(verb, thing, tmp_path):
    verbs = {
        "save": lambda: pas.save(thing, tmp_path / "a.pas.json"),
        "draw": lambda: pas.draw(thing, tmp_path / "a.png"),
        "show": lambda: pas.show(thing),
        "kind_of": lambda: kind_of(thing),
    }
    with pytest.raises(TypeError, match="must be a mesh, a solid, an assembly, a surface or a blend"):
        verbs[verb]()
    assert not list(tmp_path.iterdir())


def test_options_of_pictures_are_checked(tmp_path):
    with pytest.raises(TypeError, match="no option 'stile'; is 'style' meant"):
        sample("mesh").draw(tmp_path / "a.png", stile=pas.Style.ZEBRA)
    with pytest.raises(ValueError, match="tolerance must be a positive number"):
        sample("solid").draw(tmp_path / "a.png", tolerance=0)


def test_every_setting_of_a_picture_is_a_keyword():
    from pas.exchange.picture_options import PictureOptions

    assert set(PictureOptions.__annotations__) == {field.name for field in fields(pas.Picture)}


VERSION_1 = sorted((DATA / "version1").glob("*.pas.json"))


@pytest.mark.parametrize("path", VERSION_1, ids=lambda p: p.name.split(".")[0])
def test_files_of_the_first_version_are_read(path, tmp_path):
    record = json.loads(path.read_text())
    assert (record["version"], record["written_by"]) == (1, "pas 0.1.0")
    shape = pas.load(path)
    kind = record["content"]["kind"]
    assert type(shape) is KINDS[kind].type
    kept = record["content"] | {"verdicts": None, "certificate": None}
    again = json.loads(shape.save(tmp_path / "again.pas.json").read_text())["content"]
    assert_kept(kept, again | {"verdicts": None, "certificate": None})
    assert shape.certificate.holds or kind == "assembly"


def assert_kept(old, new):
    """All that an older file said stands in a newer one, which may say more."""
    if isinstance(old, dict):
        assert old.keys() <= new.keys()
        for key, value in old.items():
            assert_kept(value, new[key])
    else:
        assert new == old


WRITTEN = sorted((DATA / "written").glob("*.pas.json"))
"""A file of each kind as it was written once, which must not be written otherwise."""


def test_a_file_of_every_kind_is_there():
    assert {json.loads(path.read_text())["content"]["kind"] for path in WRITTEN} == set(KINDS)


@pytest.mark.parametrize("path", WRITTEN, ids=lambda p: p.name.split(".")[0])
def test_files_are_written_as_before(path, tmp_path):
    """Line by line, but for the head and the last digits of what is measured."""
    written = [file.read_text().splitlines()[5:] for file in (path, pas.load(path).save(tmp_path / "again.pas.json"))]
    assert len(written[0]) == len(written[1])
    for old, new in zip(*written, strict=True):
        assert new == old or measured(new) == pytest.approx(measured(old), rel=1e-9)


def measured(line):
    """The number with a point of a line of JSON; raises `ValueError` where there is none."""
    return float(re.fullmatch(r'\s*(?:"\w+": )?(-?\d+\.\d+(?:e-?\d+)?),?', line)[1])


def test_every_kind_of_the_first_version_is_there():
    kinds = {json.loads(path.read_text())["content"]["kind"] for path in VERSION_1}
    assert kinds == {
        "blend", "solid", "assembly", "parametric surface", "parametric blend", "generatrix blend",
    }  # fmt: skip


class Point(Shape):
    """The shortest kind of one's own, as a user writes it: a small ball about a point."""

    kind = "point"

    def __init__(self, x):
        self.x = x

    @property
    def certificate(self):
        return Findings((Verdict(Status.PROVED, "a point", "it is one"),))

    def mesh(self, tolerance=None):
        return solid.ball((self.x, 0, 0), "1/10").mesh(tolerance)

    def __str__(self):
        return f"the point {self.x}"


def test_a_kind_of_ones_own(tmp_path, monkeypatch):
    from pas.exchange.schema import WHOLE
    from pas.render.scene import solid_layers

    monkeypatch.setattr(KINDS, "_entries", dict(KINDS._entries))
    KINDS.register(Kind("point", Point, Table({"x": WHOLE}, make=Point), solid_layers))
    path = Point(3).save(tmp_path / "a.pas.json")
    assert pas.load(path).x == 3
    assert Point(3).draw(tmp_path / "a.png", tolerance=0.01, size=(80, 60)).exists()
    assert Point(3).write(tmp_path / "a.stl", tolerance=0.01).exists()
    assert main(["check", str(path)]) == 0
    with pytest.raises(ValueError, match="there is a kind of shape 'point' already"):
        KINDS.register(KINDS["point"])
    with pytest.raises(ValueError, match="no kind of shape 'poimt'; is 'point' meant"):
        _ = KINDS["poimt"]


@pytest.mark.parametrize("path", sorted(ROOT.glob("examples/**/*.toml")), ids=lambda p: p.stem)
def test_one_reader_takes_every_problem(path):
    from pas.exchange.problem import PROBLEMS, Problem

    problem = pas.read_problem(path)
    assert isinstance(problem, Problem)
    assert problem.name
    assert problem.picture.name in [style.value for style in pas.Style]
    assert sum(kind.fits(__import__("tomllib").loads(path.read_text())) for kind in PROBLEMS.values()) == 1
    assert problem.changed(tolerance=None) == problem
    changed = problem.changed(tolerance=0.125)
    assert (changed.mesh.tolerance, changed.name, changed.picture) == (0.125, problem.name, problem.picture)
    assert changed != problem


@every_kind
def test_meshes_of_every_kind_take_a_quality(name):
    shape = sample(name)
    assert inspect.signature(shape.mesh).parameters["quality"].default in (Quality.BALANCED, "balanced")
    tolerance = None if KINDS[name].meshed else TOLERANCE
    angles, usual, count = (shape.mesh(tolerance, quality=q) for q in ("angles", "balanced", "count"))
    assert usual.points.tobytes() == shape.mesh(tolerance, quality=Quality.BALANCED).points.tobytes()
    assert len(count.triangles) <= len(usual.triangles)
    if name not in ("hollow blend", "part", "assembly", "teapot"):  # flat faces have good angles with few triangles
        assert angles.smallest_angles.min() >= usual.smallest_angles.min() - 1e-9
    for mesh in (angles, count):
        assert mesh.is_manifold
        assert (mesh.deviation or 0.0) <= TOLERANCE
        assert mesh.euler_characteristic == usual.euler_characteristic
    with pytest.raises(ValueError, match="quality must be one of 'angles', 'balanced', 'count', not 'good'"):
        shape.mesh(tolerance, quality="good")
