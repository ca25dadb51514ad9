"""Files for other programs: one verb, every registered format, and one from outside the package."""

from __future__ import annotations

import runpy

import numpy as np
import pytest
import trimesh
from conftest import EQUAL, ROOT, solved

import pas
from pas import solid
from pas.cli import main
from pas.exchange.formats import FORMATS, UNITS, Format, suffixes_of
from pas.exchange.parts import TRIANGLES

HOLDS = {"triangles", "faces", "cells", "tetrahedra", "measures"}


@pytest.fixture(scope="module")
def shapes():
    ball, blend = solid.ball((0, 0, 0), 1), solved(EQUAL, 1)
    return {
        "solid": ball,
        "mesh": ball.mesh(0.1),
        "assembly": solid.assembly(ball=ball, box=solid.box((2, 2, 2), (3, 3, 3))),
        "blend": blend,
        "surface": blend.surface,
        "parametric": pas.torus(2, 1, angle=True),
        "several": [ball, pas.torus(2, 1, angle=True)],
    }


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_format_says_what_it_is(suffix):
    form = FORMATS[suffix]
    assert isinstance(form, Format) and form.content.noun in HOLDS
    assert suffix.startswith(".") and suffix == suffix.lower() and suffix in (form.name, ".stp")
    module = __import__(form.write.__module__, fromlist=["x"])
    assert module.__doc__ and form.write.__doc__


@pytest.mark.parametrize("suffix", suffixes_of("triangles"))
def test_one_verb_writes_everything(shapes, suffix, tmp_path):
    if suffix == ".3mf":
        pytest.importorskip("lib3mf")
    for name, shape in shapes.items():
        path = tmp_path / f"{name}{suffix}"
        tolerance = None if name == "mesh" else 0.1
        edged = FORMATS[suffix].bodies and name in ("blend", "surface")
        if edged:
            body = {"blend": r"the body .*, as in shape\.solid\(\)\.write\('blend\.", "surface": "close it"}[name]
            with pytest.raises(
                ValueError, match=f"the surface of '{name}' has edges; .*{body}.*, or .* with open=True"
            ):
                pas.write(shape, path, tolerance=tolerance)
            assert not path.exists()
        assert pas.write(shape, path, tolerance=tolerance, unit="inch", open=edged) == path
        assert path.stat().st_size > 500


def test_the_cells_of_a_surface_are_written_by_the_same_verb(shapes, tmp_path):
    import pyvista

    grid = pyvista.read(pas.write(shapes["surface"], tmp_path / "cells.vtu"))
    assert grid.n_cells == len(shapes["surface"].cells)
    with pytest.raises(TypeError, match="must be a mesh, a solid"):
        pas.write("ball", tmp_path / "a.vtu")


@pytest.mark.sampled(2)
@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_solids_are_filled_for_formats_of_tetrahedra(suffix, tmp_path):
    pytest.importorskip("pytetwild")
    import pyvista

    path = pas.write(solid.box((0, 0, 0), (1, 1, 1)), tmp_path / f"box{suffix}", tolerance=0.01)
    grid = pyvista.read(path).extract_cells_by_type(pyvista.CellType.TETRA)
    assert grid.volume == pytest.approx(1, rel=2e-3)


def test_misuse_is_refused_in_words(shapes, tmp_path):
    ball, mesh = shapes["solid"], shapes["mesh"]
    cases = [
        ((ball, "a.dwg"), {}, ValueError, r"cannot write a shape as 'a.dwg'; the suffix must be one of \.stl"),
        ((ball, "a.stl"), {"sew": 1}, ValueError, r"sew says nothing of triangles, which \.stl files hold"),
        ((ball, "a.stl"), {"domain": ((0, 1), (0, 1))}, ValueError, "domain is that of a parametric surface"),
        ((ball, "a.stl"), {"unit": "mile"}, ValueError, f"unit must be one of {', '.join(UNITS)}"),
        ((ball, "a.step"), {"sew": 1}, ValueError, "sew says nothing of solids, of which all faces are joined"),
        ((mesh, "a.stl"), {"tolerance": 1}, ValueError, "a mesh has them behind it"),
        ((42, "a.stl"), {}, TypeError, "must be a mesh, a solid, an assembly, a surface or a blend, not 42"),
        (([], "a.stl"), {}, ValueError, "at least one shape"),
    ]
    for (thing, name), options, error, words in cases:
        with pytest.raises(error, match=words):
            pas.write(thing, tmp_path / name, **options)
    assert not list(tmp_path.iterdir())


def test_a_tolerance_reaches_the_mesh(tmp_path):
    torus = pas.torus(2, 1, angle=True)
    sizes = [pas.write(torus, tmp_path / f"{t}.stl", tolerance=t).stat().st_size for t in (0.1, 0.01)]
    assert (sizes[1] - 84) // 50 == len(torus.mesh(0.01).triangles) > (sizes[0] - 84) // 50
    half = pas.write(torus, tmp_path / "half.stl", tolerance=0.1, domain=((0, np.pi), None), open=True)
    assert half.stat().st_size < sizes[0]


def test_smooth_meshes_have_their_normals_in_ply_files(tmp_path):
    torus = pas.torus(2, 1, angle=True)
    again = trimesh.load_mesh(pas.write(torus, tmp_path / "a.ply", tolerance=0.05), process=False)
    raw = again.metadata["_ply_raw"]["vertex"]["data"]
    normals = np.stack([raw[c].ravel() for c in ("nx", "ny", "nz")], axis=1)
    assert np.array_equal(normals, torus.mesh(0.05).point_normals)
    box = pas.write(solid.box((0, 0, 0), (1, 1, 1)), tmp_path / "b.ply").read_bytes()
    assert b"property double nx" not in box


@pytest.fixture
def off():
    """The example's format, taken out again afterwards."""
    yield runpy.run_path(str(ROOT / "examples/extensions/off.py"))
    del FORMATS._entries[".off"]


def test_a_format_from_outside(off, shapes, tmp_path):
    for name, shape in shapes.items():
        path = pas.write(shape, tmp_path / f"{name}.off", tolerance=None if name == "mesh" else 0.1)
        again = trimesh.load_mesh(path)
        assert len(again.faces) > 10 and (again.is_watertight or name in ("blend", "surface"))
    ball = trimesh.load_mesh(pas.write_solid(shapes["solid"], tmp_path / "b.off", tolerance=0.01), process=False)
    assert np.array_equal(ball.vertices, shapes["solid"].mesh(0.01).points)
    assert pas.write_mesh(shapes["mesh"], tmp_path / "c.off").exists()
    with pytest.raises(ValueError, match=r"there is a file format '\.off' already"):
        FORMATS.register(Format(".off", TRIANGLES, off["write_off"]))


@pytest.mark.parametrize(("unit", "millimeters"), [("in", 25.4), ("Inches", 25.4), ("cm", 10), ("mm", 1), (None, 1)])
def test_numbers_of_stl_files_are_millimeters(unit, millimeters, tmp_path):
    ball = solid.ball((0, 0, 0), 1)
    written = trimesh.load_mesh(pas.write(ball, tmp_path / "a.stl", tolerance=0.1, unit=unit))
    assert written.extents == pytest.approx(np.ptp(ball.mesh(0.1).points, axis=0) * millimeters, rel=1e-6)
    assert written.is_watertight and written.volume > 0


@pytest.mark.parametrize(
    ("unit", "meters", "told"), [("feet", 0.3048, "meter"), ("mm", 1e-3, "meter"), (None, 1, "mill")]
)
def test_numbers_of_glb_files_are_meters(unit, meters, told, tmp_path):
    ball = solid.ball((0, 0, 0), 1)
    path = pas.write(solid.assembly(ball=ball), tmp_path / "a.glb", tolerance=0.1, unit=unit)
    assert trimesh.load(path).extents == pytest.approx(np.ptp(ball.mesh(0.1).points, axis=0) * meters, rel=1e-6)
    assert trimesh.load(path).metadata["unit"].startswith(told)


def test_formats_that_tell_a_unit_keep_the_numbers_and_others_refuse_one(shapes, tmp_path):
    ball = solid.ball((0, 0, 0), 1)
    text = pas.write(ball, tmp_path / "a.obj", tolerance=0.1, unit="micron").read_text()
    assert text.startswith("# unit: micrometer\n")
    assert trimesh.load_mesh(tmp_path / "a.obj").extents == pytest.approx(np.ptp(ball.mesh(0.1).points, axis=0))
    with pytest.raises(ValueError, match=r"\.vtu files have no unit; leave out unit='inch', and scale the shape"):
        pas.write(shapes["surface"], tmp_path / "a.vtu", unit="in")


def test_files_hold_the_mesh_that_was_made_before(shapes, tmp_path, monkeypatch):
    meshes = {name: shapes[name].mesh(0.07) for name in ("solid", "blend", "surface", "parametric")}
    for module, maker in (("solid.solid", "triangulate_faces"), ("parametric.surface", "CellMesher")):
        monkeypatch.delattr(f"pas.{module}.{maker}")
    monkeypatch.delattr("pas.surface.meshing.Mesher.mesh")
    for name, mesh in meshes.items():
        for suffix in (".stl", ".obj"):
            path = pas.write(shapes[name], tmp_path / f"{name}{suffix}", tolerance=0.07, open=True)
            assert len(trimesh.load_mesh(path, process=False).faces) == len(mesh.triangles)
        with pytest.raises((NameError, AttributeError)):
            shapes[name].mesh(0.08)
    with pytest.raises(ValueError, match="read-only"):
        meshes["blend"].points[0] = 0


def test_an_open_surface_in_a_3mf_file_is_called_one(shapes, tmp_path):
    lib3mf = pytest.importorskip("lib3mf")
    path = pas.write([shapes["mesh"], shapes["surface"]], tmp_path / "a.3mf", open=True)
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(path))
    objects = model.GetMeshObjects()
    types = [objects.GetCurrentMeshObject().GetType() for _ in range(2) if objects.MoveNext()]
    assert types == [lib3mf.ObjectType.Model, lib3mf.ObjectType.Surface]


def test_commands_write_surfaces_where_that_is_what_they_say(shapes, tmp_path, capsys):
    project = str(shapes["blend"].save(tmp_path / "a.pas.json"))
    assert main(["write", project, str(tmp_path / "a.stl"), "--tolerance", "0.1"]) == 2
    assert "as in shape.solid().write('a.stl'), or write the bare surface with open=True" in capsys.readouterr().err
    assert main(["write", project, str(tmp_path / "a.stl"), "--tolerance", "0.1", "--open"]) == 0
    assert main(["mesh", project, "-o", str(tmp_path / "b.stl"), "--tolerance", "0.1"]) == 0
    assert main(["convert", project, str(tmp_path / "c.stl"), "--tolerance", "0.1"]) == 0
    assert [trimesh.load_mesh(tmp_path / f"{n}.stl").is_watertight for n in "abc"] == [False, False, True]
