"""Tetrahedra: checked before and after, tagged, and read back by libraries that did not write them."""

from __future__ import annotations

import builtins
from dataclasses import replace

import numpy as np
import pytest

import pas
from pas import solid
from pas.exchange import volume as module
from pas.exchange.volume import VolumeSettings, tetrahedralize, volume_mesh
from pas.mesh.mesh import Mesh
from pas.mesh.topology import is_closed_manifold
from pas.solid.assembly import assembly

trimesh = pytest.importorskip("trimesh")
pyvista = pytest.importorskip("pyvista")
pytest.importorskip("pytetwild")

COARSE = {"edge_length": 0.6, "tolerance": 0.02}
SPHERE = trimesh.creation.icosphere(subdivisions=2)


def globe(center=(0, 0, 0), radius=1.0, name="ball") -> Mesh:
    return Mesh.from_triangles(radius * SPHERE.vertices + center, SPHERE.faces, name)


def cube() -> Mesh:
    """The unit cube with six named faces."""
    box = trimesh.creation.box()
    names = ("x-", "x+", "y-", "y+", "z-", "z+")
    axes = np.abs(box.face_normals).argmax(axis=1)
    faces = 2 * axes + (box.face_normals[np.arange(12), axes] > 0)
    mesh = Mesh.from_triangles(box.vertices, box.faces)
    return replace(mesh, faces=faces.astype(np.intp), names=names)


@pytest.fixture(scope="module")
def filled():
    return volume_mesh(globe(), **COARSE)


@pytest.fixture(scope="module")
def filled_pair():
    return volume_mesh(assembly({"big one": cube(), "small": globe((3, 0, 0), 0.5)}), **COARSE)


def test_a_ball_is_filled(filled):
    assert filled.volume == pytest.approx(globe().volume, rel=0.02)
    assert (filled.volumes > 0).all()
    assert filled.region_names == ("solid",)
    assert not filled.regions.any() and not filled.faces.any()
    assert np.array_equal(np.unique(filled.tetrahedra), np.arange(len(filled.points)))
    surface = Mesh.from_triangles(filled.points, filled.boundary)
    assert surface.volume == pytest.approx(filled.volume, rel=1e-12)
    assert surface.euler_characteristic == 2
    away = np.abs(np.linalg.norm(filled.points[np.unique(filled.boundary)], axis=1) - 1)
    assert away.max() < 0.02 + (1 - np.linalg.norm(SPHERE.triangles_center, axis=1).min())


@pytest.mark.slow
def test_edges_have_at_most_about_the_length_asked_for(filled):
    assert len(volume_mesh(globe(), edge_length=0.2, tolerance=0.02).tetrahedra) > 2 * len(filled.tetrahedra)


def test_faces_are_tagged(filled_pair):
    assert filled_pair.names[:6] == tuple(f"big one: {side}" for side in ("x-", "x+", "y-", "y+", "z-", "z+"))
    surface = Mesh.from_triangles(filled_pair.points, filled_pair.boundary)
    normals = surface.normals[:, 0]
    corners = filled_pair.points[filled_pair.boundary]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    for number in range(6):
        here = filled_pair.faces == number
        direction = np.zeros(3)
        direction[number // 2] = 1 if number % 2 else -1
        assert areas[here].sum() == pytest.approx(1, rel=0.05)
        assert areas[here] @ normals[here] @ direction == pytest.approx(1, rel=0.05)


def test_a_solid_is_filled_as_its_mesh():
    part = solid.box((0, 0, 0), (1, 1, 1)) - solid.ball((1, 1, 1), "1/2", face="dent")
    filled = volume_mesh(part, edge_length=0.3, tolerance=0.05)
    assert filled.volume == pytest.approx(1 - np.pi / 48, rel=0.02)
    assert set(filled.names) == set(part.faces)
    dent = filled.points[np.unique(filled.boundary[filled.faces == filled.names.index("dent")])]
    assert np.abs(np.linalg.norm(dent - 1, axis=1) - 0.5).max() < 0.15


def test_cavities_stay_empty():
    inner = globe(radius=0.5)
    shell = Mesh.from_triangles(
        np.concatenate([SPHERE.vertices, inner.points]),
        np.concatenate([SPHERE.faces, inner.triangles[:, ::-1] + len(SPHERE.vertices)]),
    )
    filled = volume_mesh(shell, **COARSE)
    assert filled.volume == pytest.approx(shell.volume, rel=0.02)
    assert Mesh.from_triangles(filled.points, filled.boundary).components == 2


def plate(thickness):
    box = trimesh.creation.box((1, 1, thickness))
    return Mesh.from_triangles(box.vertices, box.faces, "plate")


def test_a_crash_is_an_error():
    """fTetWild dies of an empty mesh."""
    with pytest.raises(pas.GeometryError, match=r"fTetWild crashed \(SIG.*set a smaller tolerance"):
        tetrahedralize(np.empty((0, 3)), np.empty((0, 3)), {})


def test_plates_thinner_than_the_envelope_are_refused():
    """fTetWild dies or finds nothing, as it happens."""
    with pytest.raises(pas.GeometryError, match=r"fTetWild (crashed|found none).*set a smaller tolerance"):
        volume_mesh(plate(1e-3), edge_length=0.3)


def test_settings_are_taken_and_nothing_is_left_in_the_folder(tmp_path, monkeypatch, capfd):
    """fTetWild writes a file of its own where it works."""
    monkeypatch.chdir(tmp_path)
    rough = volume_mesh(globe(), **COARSE, settings=VolumeSettings(coarsen=True, stop_energy=50, threads=1))
    assert rough.volume == pytest.approx(globe().volume, rel=0.02)
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")


def test_what_fails_in_the_other_process_is_an_error():
    with pytest.raises(pas.GeometryError, match=r"fTetWild failed: .*nonsense"):
        tetrahedralize(SPHERE.vertices, SPHERE.faces, {"nonsense": 1})


def test_parts_are_regions(filled_pair):
    assert filled_pair.region_names == ("big one", "small")
    volumes = filled_pair.region_volumes
    assert volumes["big one"] == pytest.approx(1, rel=0.02)
    assert volumes["small"] == pytest.approx(globe().volume / 8, rel=0.02)
    assert filled_pair.names[0] == "big one: x-" and filled_pair.names[-1] == "small: ball"
    assert is_closed_manifold(filled_pair.boundary)
    x = filled_pair.points[filled_pair.tetrahedra].mean(axis=1)[:, 0]
    assert np.array_equal(filled_pair.regions, (x > 1.5).astype(int))
    x = filled_pair.points[filled_pair.boundary].mean(axis=1)[:, 0]
    assert np.array_equal(filled_pair.faces == 6, x > 1.5)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_very_small_and_very_large(scale):
    """fTetWild itself crashes on the small one."""
    filled = volume_mesh(globe(radius=scale), edge_length=0.6 * scale, tolerance=0.02 * scale)
    assert filled.volume == pytest.approx(globe().volume * scale**3, rel=0.02)


@pytest.mark.slow
def test_far_from_the_origin():
    far = globe((1e6, -2e6, 3e6))
    filled = volume_mesh(far, **COARSE)
    assert filled.volume == pytest.approx(globe().volume, rel=0.02)
    assert np.abs(filled.points - (1e6, -2e6, 3e6)).max() < 1.05


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_files_are_read_by_meshio(filled_pair, tmp_path, suffix):
    meshio = pytest.importorskip("meshio")
    again = meshio.read(filled_pair.write(tmp_path / f"a{suffix}"))
    np.testing.assert_allclose(again.points, filled_pair.points, rtol=0, atol=1e-15)
    blocks = {block.type: i for i, block in enumerate(again.cells)}
    assert np.array_equal(again.cells[blocks["tetra"]].data, filled_pair.tetrahedra)
    assert np.array_equal(again.cells[blocks["triangle"]].data, filled_pair.boundary)
    if suffix == ".vtu":
        assert np.array_equal(again.cell_data["region"][blocks["tetra"]], filled_pair.regions)
        assert np.array_equal(again.cell_data["face"][blocks["triangle"]], filled_pair.faces)
        assert (again.cell_data["face"][blocks["tetra"]] == -1).all()
        assert bytes(again.field_data["face names"]).decode().split("\n") == list(filled_pair.names)
        assert bytes(again.field_data["region names"]).decode().split("\n") == ["big one", "small"]
        return
    tags = again.cell_data["gmsh:physical"]
    assert np.array_equal(tags[blocks["triangle"]], filled_pair.faces + 1)
    assert np.array_equal(tags[blocks["tetra"]], filled_pair.regions + 8)
    assert again.field_data["big one: x-"].tolist() == [1, 2]
    assert again.field_data["small: ball"].tolist() == [7, 2]
    assert again.field_data["small"].tolist() == [9, 3]


def test_vtu_is_read_by_vtk(filled, tmp_path):
    again = pyvista.read(filled.write(tmp_path / "a.vtu"))
    sizes = again.compute_cell_sizes()["Volume"]
    assert sizes.sum() == pytest.approx(filled.volume, rel=1e-12)
    assert sizes.min() >= 0
    assert again.n_cells == len(filled.tetrahedra) + len(filled.boundary)


def test_msh_is_what_its_format_says(filled_pair, tmp_path):
    """Read by the words of the format, since meshio wrote it."""
    lines = filled_pair.write(tmp_path / "a.msh").read_text().splitlines()
    section = {name: lines.index(f"${name}") + 1 for name in ("MeshFormat", "PhysicalNames", "Nodes", "Elements")}
    assert lines[section["MeshFormat"]] == "2.2 0 8"
    start = section["PhysicalNames"]
    assert lines[start] == "9" and lines[start + 1] == '2 1 "big one: x-"' and lines[start + 9] == '3 9 "small"'
    start, count = section["Nodes"], int(lines[section["Nodes"]])
    nodes = np.array([line.split() for line in lines[start + 1 : start + 1 + count]], dtype=float)
    assert np.array_equal(nodes[:, 0], np.arange(1, count + 1))
    start, count = section["Elements"], int(lines[section["Elements"]])
    rows = [list(map(int, line.split())) for line in lines[start + 1 : start + 1 + count]]
    triangles = np.array([row for row in rows if row[1] == 2])
    tetrahedra = np.array([row for row in rows if row[1] == 4])
    assert np.array_equal(triangles[:, 3], filled_pair.faces + 1)
    assert module.signed_volumes(nodes[:, 1:], tetrahedra[:, -4:] - 1).sum() == pytest.approx(filled_pair.volume)


def test_gmsh_names_are_different_and_quotable(filled, tmp_path):
    meshio = pytest.importorskip("meshio")
    named = replace(filled, names=('a "b"\nc',), region_names=("a 'b' c",))
    assert meshio.read(named.write(tmp_path / "a.msh")).field_data.keys() == {"a 'b' c", "a 'b' c 2"}


def broken(change) -> Mesh:
    mesh = globe()
    points, triangles = change(mesh.points.copy(), mesh.triangles.copy())
    return replace(mesh, points=points, triangles=triangles, faces=np.zeros(len(triangles), dtype=np.intp))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda p, t: (p, t[1:]), "is open or no manifold"),
        (lambda p, t: (p, t[:1]), "is open or no manifold"),
        (lambda p, t: (p, t[:0]), "has no triangles"),
        (lambda p, t: (np.where(np.arange(len(p))[:, None] == t[0, 0], np.nan, p), t), "not finite"),
        (lambda p, t: (p, t[:, ::-1]), "inside out"),
        (lambda p, t: (p * (1, 1, 0), t), "inside out or flat"),
        (lambda p, t: (p, np.concatenate([t, t[:, ::-1]])), "no manifold"),
    ],
)
def test_bad_meshes_are_refused(change, words):
    with pytest.raises(pas.GeometryError, match=words):
        volume_mesh(broken(change), **COARSE)
    with pytest.raises(pas.GeometryError, match="'bad'"):
        volume_mesh(assembly(bad=broken(change)), **COARSE)


def test_meshes_that_cut_themselves_are_refused():
    other = globe((1, 0, 0))
    both = Mesh.from_triangles(
        np.concatenate([SPHERE.vertices, other.points]),
        np.concatenate([SPHERE.faces, other.triangles + len(SPHERE.vertices)]),
    )
    with pytest.raises(pas.GeometryError, match=r"but their mesh encloses 8\.09.*it cuts itself"):
        volume_mesh(both, **COARSE)


def flipped(points, tetrahedra):
    return points, tetrahedra[:, [1, 0, 2, 3]]


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (flipped, None),
        (lambda p, t: (p, np.concatenate([t[:1, [1, 0, 2, 3]], t[1:]])), r"1 of \d+ are inverted"),
        (lambda p, t: (p, np.concatenate([t[:1, [0, 0, 2, 3]], t[1:]])), r"1 of \d+ are flat"),
        (lambda p, t: (p, t[:0]), "fTetWild found none"),
        (lambda p, t: (p, t[:-100]), "but their mesh encloses"),
        (lambda p, t: (p * np.where(p[:, :1] > 0, np.nan, 1), t), "not finite"),
    ],
)
def test_bad_tetrahedra_are_refused(filled, damage, words, monkeypatch):
    diagonal = np.linalg.norm(np.ptp(globe().points, axis=0))
    monkeypatch.setattr(module, "_tetrahedra", lambda *a: damage(filled.points / diagonal, filled.tetrahedra))
    if words is None:
        assert (volume_mesh(globe(), **COARSE).volumes > 0).all()
        return
    with pytest.raises(pas.GeometryError, match=words):
        volume_mesh(globe(), **COARSE)


def test_boundaries_that_touch_are_refused(monkeypatch):
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0)], dtype=float)
    pair = np.array([(0, 1, 2, 3), (0, 4, 5, 3)])
    assert (module.signed_volumes(points, pair) > 0).all()
    with pytest.raises(pas.GeometryError, match="do not end in a closed manifold"):
        module._boundary(pair, "the tetrahedra")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"edge_length": 0}, "edge_length must be a positive number, not 0"),
        ({"tolerance": float("nan")}, "tolerance must be a positive number, not nan"),
        ({"volume_tolerance": 1}, "volume_tolerance must be between 0 and 1"),
        ({"edge_length": 1e-4}, r"edge_length 0.0001 would give about 3e\+13 tetrahedra in 'solid'"),
    ],
)
def test_numbers_are_checked(options, words):
    with pytest.raises(ValueError, match=words):
        volume_mesh(globe(), **options)


def test_settings_are_checked():
    with pytest.raises(ValueError, match="stop_energy must be at least 3"):
        VolumeSettings(stop_energy=2)
    with pytest.raises(ValueError, match="threads must be a whole number"):
        VolumeSettings(threads=-1)
    with pytest.raises(TypeError, match="must be a mesh, a solid, an assembly, a surface or a blend"):
        volume_mesh(SPHERE)


def test_suffixes_are_checked_and_nothing_is_left_half_written(filled, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"'a\.stl'; the suffix must be one of \.vtu, \.msh"):
        filled.write(tmp_path / "a.stl")
    damaged = replace(filled, regions=filled.regions[:-1])
    for suffix in (".vtu", ".msh"):
        with pytest.raises(ValueError):
            damaged.write(tmp_path / f"a{suffix}")
    assert not list(tmp_path.iterdir())


def test_pytetwild_is_asked_for(monkeypatch):
    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name == "pytetwild":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(pas.MissingLibraryError, match="pip install pytetwild"):
        volume_mesh(globe(), **COARSE)
