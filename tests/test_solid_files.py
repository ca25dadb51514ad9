"""Triangle files of solids and assemblies, read back by libraries that did not write them."""

from __future__ import annotations

import builtins
import json
import struct

import numpy as np
import pytest

import pas
from pas import solid
from pas.exchange.formats import suffixes_of
from pas.exchange.write import write_solid
from pas.mesh.mesh import Mesh
from pas.solid.assembly import COLORS, assembly

trimesh = pytest.importorskip("trimesh")
pyvista = pytest.importorskip("pyvista")

TOLERANCE = 0.05
BLUE = "#112a80"


SUFFIXES = suffixes_of("triangles")


@pytest.fixture(scope="module")
def cut_box() -> Mesh:
    """A box without a corner, its faces named."""
    return (solid.box((0, 0, 0), (1, 1, 1)) - solid.ball((1, 1, 1), "1/2", face="dent")).mesh(TOLERANCE)


@pytest.fixture(scope="module")
def ball() -> solid.Solid:
    return solid.ball((0, 0, 0), 1)


@pytest.fixture(scope="module")
def globe() -> Mesh:
    sphere = trimesh.creation.icosphere(subdivisions=2)
    return Mesh.from_triangles(sphere.vertices + (3, 0, 0), sphere.faces, "ball")


@pytest.fixture(scope="module")
def parts(cut_box, globe):
    return assembly({"the body": cut_box, "globe": (globe, BLUE)})


def written(shape, tmp_path, suffix, **options):
    return write_solid(shape, tmp_path / f"thing{suffix}", **options)


def volume(mesh) -> float:
    mesh = mesh.copy()
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    assert mesh.is_watertight
    return mesh.volume


def test_every_suffix_is_tested():
    assert SUFFIXES == (".stl", ".obj", ".ply", ".3mf", ".glb", ".vtp")


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".3mf", ".glb"])
def test_a_mesh_comes_back_closed_with_its_triangles(cut_box, tmp_path, suffix):
    again = trimesh.load_mesh(written(cut_box, tmp_path, suffix))
    assert len(again.faces) == len(cut_box.triangles)
    assert volume(again) == pytest.approx(cut_box.volume, rel=1e-6)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_solids_are_meshed_with_the_tolerance(ball, tmp_path, suffix):
    path = written(ball, tmp_path, suffix, tolerance=0.1)
    again = pyvista.read(path).n_cells if suffix == ".vtp" else len(trimesh.load_mesh(path).faces)
    assert again == len(ball.mesh(0.1).triangles)


@pytest.mark.parametrize("suffix", [".obj", ".3mf", ".glb"])
def test_parts_stay_apart(parts, tmp_path, suffix):
    options = {"split_objects": True} if suffix == ".obj" else {}
    scene = trimesh.load_scene(written(parts, tmp_path, suffix), **options)
    found = {name: (len(m.faces), volume(m)) for name, m in scene.geometry.items()}
    title = "the_body" if suffix == ".obj" else "the body"
    expected = {title if n == "the body" else n: m for n, m in parts.meshes().items()}
    if suffix == ".obj":
        largest = sorted(expected, key=lambda name: -expected[name].volume)
        found = dict(zip(largest, sorted(found.values(), key=lambda pair: -pair[1]), strict=True))
    assert set(found) == set(expected)
    for name, mesh in expected.items():
        assert found[name] == (len(mesh.triangles), pytest.approx(mesh.volume, rel=1e-6))


@pytest.mark.parametrize("suffix", [".stl", ".ply"])
def test_other_formats_put_parts_together(parts, tmp_path, suffix):
    again = trimesh.load_mesh(written(parts, tmp_path, suffix))
    meshes = parts.meshes().values()
    assert len(again.faces) == sum(len(m.triangles) for m in meshes)
    assert volume(again) == pytest.approx(sum(m.volume for m in meshes), rel=1e-6)
    assert again.body_count == 2


def test_stl_has_the_normals_of_its_facets(globe, tmp_path):
    again = trimesh.load_mesh(written(globe, tmp_path, ".stl"), process=False)
    data = np.frombuffer((tmp_path / "thing.stl").read_bytes()[84:], dtype="<u1").reshape(-1, 50)
    normals = np.frombuffer(data[:, :12].tobytes(), dtype="<f4").reshape(-1, 3)
    np.testing.assert_allclose(normals, again.face_normals, atol=1e-5)


def test_obj_has_groups_normals_and_colours(parts, cut_box, tmp_path):
    path = written(parts, tmp_path, ".obj")
    lines = path.read_text().splitlines()
    assert [line for line in lines if line.startswith("o ")] == ["o the_body", "o globe"]
    groups = [line[2:] for line in lines if line.startswith("g ")]
    assert groups[0] == "the_body:_box_x-"
    assert "the_body:_dent" in groups and groups[-1] == "globe:_ball"
    data = pyvista.read(path)
    counts = [int((cut_box.faces == i).sum()) for i in range(len(cut_box.names))]
    group_ids = np.unique(np.asarray(data["GroupIds"]), return_counts=True)[1]
    assert set(counts) <= set(group_ids.tolist())
    colors = trimesh.load_mesh(path, process=False).visual.vertex_colors[:, :3]
    assert np.unique(colors, axis=0).tolist() == [[0x11, 0x2A, 0x80], [0xE8, 0xA3, 0x3D]]
    assert list(tmp_path.iterdir()) == [path]


def test_names_that_obj_would_confuse_stay_different(globe, tmp_path):
    path = written(assembly({"a b": globe, "a_b": globe, " ": globe}), tmp_path, ".obj")
    titles = [line for line in path.read_text().splitlines() if line.startswith("o ")]
    assert titles == ["o a_b", "o a_b_2", "o unnamed"]


def test_ply_has_colours_faces_and_parts(parts, cut_box, tmp_path):
    path = written(parts, tmp_path, ".ply")
    raw = trimesh.load_mesh(path, process=False).metadata["_ply_raw"]["face"]["data"]
    first = len(cut_box.triangles)
    assert np.array_equal(raw["face"].ravel()[:first], cut_box.faces)
    assert (raw["face"].ravel()[first:] == len(cut_box.names)).all()
    assert raw["part"].ravel().tolist() == [0] * first + [1] * (len(raw["part"]) - first)
    again = pyvista.read(path)
    assert np.unique(again.point_data["RGB"], axis=0).tolist() == [[0x11, 0x2A, 0x80], [0xE8, 0xA3, 0x3D]]
    assert np.unique(again.cell_data["RGB"][:first], axis=0).tolist() == [[0xE8, 0xA3, 0x3D]]
    header = path.read_bytes().split(b"end_header")[0].decode("ascii").splitlines()
    assert "comment part 0: the body" in header
    assert f"comment face {len(cut_box.names)}: globe: ball" in header


def test_ply_keeps_double_precision(globe, tmp_path):
    far = Mesh.from_triangles(globe.points + 1e6, globe.triangles)
    again = trimesh.load_mesh(written(far, tmp_path, ".ply"), process=False)
    assert np.array_equal(again.vertices, far.points)


def test_3mf_has_names_colours_and_the_unit(parts, tmp_path):
    lib3mf = pytest.importorskip("lib3mf")
    pytest.importorskip("lxml")
    path = written(parts, tmp_path, ".3mf", unit="inch")
    assert trimesh.load_scene(path).units == "inch"
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.Inch
    objects, found = model.GetMeshObjects(), {}
    while objects.MoveNext():
        item = objects.GetCurrentMeshObject()
        assert item.IsManifoldAndOriented()
        resource, number, present = item.GetObjectLevelProperty()
        assert present
        color = model.GetColorGroupByID(resource).GetColor(number)
        found[item.GetName()] = f"#{color.Red:02x}{color.Green:02x}{color.Blue:02x}"
    assert found == {"the body": COLORS[0], "globe": BLUE}
    assert model.GetBuildItems().Count() == 2


def test_glb_has_materials_normals_and_the_unit(parts, globe, tmp_path):
    path = written(parts, tmp_path, ".glb", unit="meter")
    raw = path.read_bytes()
    tree = json.loads(raw[20 : 20 + struct.unpack("<I", raw[12:16])[0]])
    assert {"the body", "globe"} <= {node.get("name") for node in tree["nodes"]}
    assert tree["scenes"][0]["extras"] == {"unit": "meter"}
    color = tree["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"]
    screen = [12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in color[:3]]
    assert [round(255 * c) for c in screen] == [0x11, 0x2A, 0x80]
    again = trimesh.load_scene(path, process=False).geometry["globe"]
    assert again.visual.material.name == "globe"
    np.testing.assert_allclose(again.vertex_normals, globe.shading[2], atol=1e-6)
    assert pyvista.read(path).combine().n_cells == sum(len(m.triangles) for m in parts.meshes().values())


def test_a_part_may_be_named_as_the_scene(globe, tmp_path):
    names = {"root", "world", "root_"}
    scene = trimesh.load_scene(written(assembly(dict.fromkeys(names, globe)), tmp_path, ".glb"))
    assert set(scene.geometry) == names
    assert scene.to_mesh().volume == pytest.approx(3 * globe.volume, rel=1e-6)


def test_vtp_has_face_names_and_normals(parts, cut_box, tmp_path):
    data = pyvista.read(written(parts, tmp_path, ".vtp"))
    names = data.field_data["face names"].tolist()
    assert names == [f"the body: {n}" for n in cut_box.names] + ["globe: ball"]
    assert np.array_equal(data["face"][: len(cut_box.triangles)], cut_box.faces)
    assert data.field_data["part names"].tolist() == ["the body", "globe"]
    assert np.unique(data["part"]).tolist() == [0, 1]
    assert np.unique(data["color"], axis=0).tolist() == [[0x11, 0x2A, 0x80], [0xE8, 0xA3, 0x3D]]
    np.testing.assert_allclose(np.linalg.norm(data.point_data["Normals"], axis=1), 1, atol=1e-12)
    assert data.clean().volume == pytest.approx(sum(m.volume for m in parts.meshes().values()), rel=1e-9)
    single = pyvista.read(write_solid(cut_box, tmp_path / "single.vtp"))
    assert single.field_data["face names"].tolist() == list(cut_box.names)
    assert single.field_data["part names"].tolist() == ["single"]


def test_suffixes_units_and_shapes_are_checked(globe, tmp_path):
    with pytest.raises(ValueError, match=r"'a\.iges'; the suffix must be one of \.stl, .*\.vtp"):
        write_solid(globe, tmp_path / "a.iges")
    with pytest.raises(ValueError, match=r"unit must be one of micrometer, .*, not 'mile'"):
        write_solid(globe, tmp_path / "a.stl", unit="mile")
    with pytest.raises(TypeError, match="must be a mesh, a solid, an assembly, a surface or a blend"):
        write_solid("globe", tmp_path / "a.stl")
    with pytest.raises(ValueError, match="does not exist"):
        write_solid(globe, tmp_path / "none" / "a.stl")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nothing_is_left_half_written(globe, tmp_path, suffix, monkeypatch):
    before = written(globe, tmp_path, suffix).read_bytes()
    empty = solid.ball((0, 0, 0), 1) & solid.ball((5, 0, 0), 1)
    with pytest.raises(pas.PasError):
        written(assembly(globe=globe, empty=empty), tmp_path, suffix)
    assert [p.name for p in tmp_path.iterdir()] == [f"thing{suffix}"]
    assert (tmp_path / f"thing{suffix}").read_bytes() == before


def test_lib3mf_is_asked_for(globe, tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name == "lib3mf":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(pas.MissingLibraryError, match="pip install lib3mf"):
        written(globe, tmp_path, ".3mf")
    assert not list(tmp_path.iterdir())
