"""Rational patches: exactly on their surfaces; STEP files of them, by the words of the format and read back."""

from __future__ import annotations

import builtins
import re
from itertools import combinations

import numpy as np
import pytest

import pas
from pas import solid
from pas.exchange.formats import step as module
from pas.exchange.rational import ball_patches, cone_patches, cylinder_patches, torus_patches
from pas.exchange.write import write_step
from pas.parametric.patches import RationalPatch

AXIS, START, END = (1, -2, "1/2"), (1, 2, 3), (2, 0, "7/2")
CASES = {
    "ball": (ball_patches((1, 2, 3), "3/2"), solid.ball((1, 2, 3), "3/2"), 8, 4 * np.pi * 9 / 4),
    "cylinder": (cylinder_patches(START, END, 2, ends=False), solid.cylinder(START, END, 2), 4, None),
    "cone": (cone_patches(START, END, 2, "1/3", ends=False), solid.cone(START, END, 2, "1/3"), 4, None),
    "apex": (cone_patches((0, 0, 0), (0, 0, 2), 1, ends=False), solid.cone((0, 0, 0), (0, 0, 2), 1), 4, None),
    "torus": (torus_patches(START, AXIS, 3, "1/2"), solid.torus(START, AXIS, 3, "1/2"), 16, 6 * np.pi**2),
}
GRID = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 7), indexing="ij")
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(20)


def jets(patch, u, v, step=1e-6):
    """Points and normals by central differences."""
    du = (patch(u + step, v) - patch(u - step, v)) / (2 * step)
    dv = (patch(u, v + step) - patch(u, v - step)) / (2 * step)
    return patch(u, v), np.cross(du, dv)


@pytest.mark.parametrize("name", CASES)
def test_patches_are_on_their_surface_with_outward_normals(name):
    patches, shape, number, area = CASES[name]
    assert len(patches) == number
    polynomial, total = shape.polynomials[shape.faces[0]][0], 0.0
    u, v = np.meshgrid((GAUSS + 1) / 2, (GAUSS + 1) / 2, indexing="ij")
    for patch in patches:
        points, slopes = patch(*GRID), np.linalg.norm(polynomial.gradient(patch(0.3, 0.3)))
        assert np.abs(polynomial(points)).max() < 1e-12 * slopes
        inner, normals = jets(patch, u, v)
        assert (np.einsum("ijx,ijx->ij", normals, polynomial.gradient(inner)) > 0).all()
        total += np.einsum("i,j,ij->", WEIGHTS, WEIGHTS, np.linalg.norm(normals, axis=-1)) / 4
    if area is not None:
        assert total == pytest.approx(area, rel=1e-8)


@pytest.mark.parametrize("name", ["ball", "torus", "cylinder"])
def test_neighbours_share_their_curves(name):
    sides: dict[bytes, list[np.ndarray]] = {}
    for patch in CASES[name][0]:
        for points, weights in [
            *((patch.points[i], patch.weights[i]) for i in (0, -1)),
            *((patch.points[:, i], patch.weights[:, i]) for i in (0, -1)),
        ]:
            rows = points + 0.0
            if np.ptp(rows, axis=0).max() == 0:
                continue
            if (rows[0] > rows[-1]).tolist() > (rows[-1] > rows[0]).tolist():
                rows, weights = rows[::-1], weights[::-1]  # noqa: PLW2901
            sides.setdefault(rows.tobytes(), []).append(weights / weights[0])
    times = [len(found) for found in sides.values()]
    assert set(times) == ({2} if name != "cylinder" else {1, 2})
    for found in sides.values():
        for a, b in combinations(found, 2):
            assert np.array_equal(a, b)


def test_simple_numbers_are_exact():
    patch = ball_patches((0, 0, 0), 1)[4]
    assert patch.points[:, 0].tolist() == [[1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert patch.weights.tolist() == [[1, 1, 2], [1, 1, 2], [2, 2, 4]]
    assert patch.degrees == (2, 2)
    assert np.array_equal(patch(0.5, 0), [0.6, 0.8, 0.0])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: RationalPatch(np.zeros((2, 2, 2)), np.ones((2, 2))), r"must have shapes \(m\+1, n\+1, 3\)"),
        (
            lambda: RationalPatch(np.zeros((1, 2, 3)), np.ones((1, 2))),
            "degrees must be from 1 to the number of control points",
        ),
        (lambda: RationalPatch(np.zeros((2, 2, 3)), np.zeros((2, 2))), "weights finite and positive"),
        (lambda: RationalPatch(np.full((2, 2, 3), np.nan), np.ones((2, 2))), "points must be finite"),
        (lambda: ball_patches((0, 0, 0), 0), "radius must be positive"),
        (lambda: cone_patches((0, 0, 0), (0, 0, 0), 1), "start and end must be different"),
        (lambda: cone_patches((0, 0, 0), (0, 0, 1), 0), "radius must be positive and end_radius not negative"),
        (lambda: torus_patches((0, 0, 0), (0, 0, 1), 1, 1), "minor must be smaller than major"),
        (lambda: torus_patches((0, 0, 0), (0, 0, 0), 2, 1), "axis must not be the zero vector"),
    ],
)
def test_patches_are_checked(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_open_cascade_is_asked_for(tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name.startswith("OCP"):
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(pas.MissingLibraryError, match=r"pip install 'pas\[step\]'"):
        write_step(ball_patches((0, 0, 0), 1), tmp_path / "a.step")
    assert not list(tmp_path.iterdir())


def test_arguments_are_checked(tmp_path):
    patches = ball_patches((0, 0, 0), 1)
    with pytest.raises(ValueError, match=r"'a\.iges'; the suffix must be one of \.step, \.stp"):
        write_step(patches, tmp_path / "a.iges")
    with pytest.raises(ValueError, match="unit must be one of micrometer"):
        write_step(patches, tmp_path / "a.step", unit="mile")
    with pytest.raises(ValueError, match="sew must be a positive number"):
        write_step(patches, tmp_path / "a.step", sew=0)
    with pytest.raises(ValueError, match="at least one patch"):
        write_step([], tmp_path / "a.step")
    with pytest.raises(TypeError, match="or rational patches in the place of <Solid"):
        write_step([solid.ball((0, 0, 0), 1)], tmp_path / "a.step")
    assert not list(tmp_path.iterdir())


@pytest.fixture
def ocp():
    return pytest.importorskip("OCP")


def read_back(path):
    """The shape of a file, its faces' (points, weights), and whether it is valid."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    with module._quiet():
        reader = STEPControl_Reader()
        reader.ReadFile(str(path))
        reader.TransferRoots()
    shape, faces = reader.OneShape(), []
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        surface = BRep_Tool.Surface_s(TopoDS.Face(explorer.Current()))
        rows, columns = range(1, surface.NbUPoles() + 1), range(1, surface.NbVPoles() + 1)
        poles = [[surface.Pole(i, j) for j in columns] for i in rows]
        points = np.array([[(p.X(), p.Y(), p.Z()) for p in row] for row in poles])
        faces.append((points, np.array([[surface.Weight(i, j) for j in columns] for i in rows])))
        explorer.Next()
    return shape, faces, BRepCheck_Analyzer(shape).IsValid()


def measures(shape):
    """Volume and area."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, volume)
    BRepGProp.SurfaceProperties_s(shape, area)
    return volume.Mass(), area.Mass()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.sampled(2)
def test_patches_come_back_exactly(ocp, tmp_path, name):
    patches = CASES[name][0]
    _, faces, valid = read_back(write_step(patches, tmp_path / "a.step"))
    assert valid and len(faces) == len(patches)
    for patch, (points, weights) in zip(patches, faces, strict=True):
        assert np.array_equal(points, patch.points)
        np.testing.assert_allclose(weights / weights[0, 0], patch.weights / patch.weights[0, 0], rtol=1e-13)


def test_the_text_has_every_control_point_and_weight(ocp, tmp_path):
    """Without the reader of those who wrote it."""
    patches = CASES["torus"][0]
    text = "".join(write_step(patches, tmp_path / "a.step").read_text().split())
    found = {tuple(map(float, row.split(","))) for row in re.findall(r"CARTESIAN_POINT\('',\(([^)]*)\)\)", text)}
    assert {tuple(p) for patch in patches for p in (patch.points + 0.0).reshape(-1, 3).tolist()} <= found
    surfaces = re.findall(r"RATIONAL_B_SPLINE_SURFACE\(\((\(.*?\))\)\)", text)
    assert len(surfaces) == len(patches)
    weights = np.array([[row.split(",") for row in re.findall(r"\(([^()]*)\)", s)] for s in surfaces], dtype=float)
    assert np.array_equal(weights, [p.weights for p in patches])


def test_higher_degrees_come_back(ocp, tmp_path):
    random = np.random.default_rng(1)
    points = np.stack([*np.meshgrid(range(5), range(8), indexing="ij"), random.random((5, 8))], axis=-1)
    patch = RationalPatch(points, random.uniform(0.5, 2, (5, 8)))
    _, faces, valid = read_back(write_step([patch], tmp_path / "a.stp"))
    assert valid
    assert np.array_equal(faces[0][0], points)
    np.testing.assert_allclose(faces[0][1] / faces[0][1][0, 0], patch.weights / patch.weights[0, 0], rtol=1e-13)


def test_closed_surfaces_are_sewn_to_solids(ocp, tmp_path):
    from OCP.TopAbs import TopAbs_ShapeEnum

    cases = [
        (ball_patches((1, 2, 3), 2), 32 / 3 * np.pi, 16 * np.pi),
        (cylinder_patches((0, 0, 0), (0, 3, 4), 1), 5 * np.pi, 12 * np.pi),
        (cone_patches((0, 0, 0), (0, 0, 4), 3), 12 * np.pi, 24 * np.pi),
        (torus_patches((0, 0, 0), (1, 1, 1), 3, 1), 6 * np.pi**2, 12 * np.pi**2),
    ]
    for patches, volume, area in cases:
        shape, faces, valid = read_back(write_step(patches, tmp_path / "a.step", sew=1e-6))
        assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
        assert valid and len(faces) == len(patches)
        assert measures(shape) == (pytest.approx(volume, rel=1e-6), pytest.approx(area, rel=1e-6))


def test_the_file_says_what_the_format_wants(ocp, tmp_path, capfd):
    patches = cylinder_patches((0, 0, 0), (0, 0, 2.125), 1, ends=False)
    for unit, words in (("millimeter", r"SI_UNIT\(\.MILLI\.,\.METRE\.\)"), ("inch", "CONVERSION_BASED_UNIT")):
        text = write_step(patches, tmp_path / "the part.step", unit=unit).read_text()
        assert text.startswith("ISO-10303-21;") and text.rstrip().endswith("END-ISO-10303-21;")
        assert re.search(words, text)
        assert "2.1250000000000000E+00" in text
        assert len(re.findall("RATIONAL_B_SPLINE_SURFACE|RATIONAL_BEZIER", text)) >= 4
        assert len(re.findall("ADVANCED_FACE", text)) == 4
        assert re.search(r"PRODUCT\('the part", text)
        assert len(re.findall(r"= PRODUCT\(", text)) == 1
    assert capfd.readouterr().out == ""
    assert [p.name for p in tmp_path.iterdir()] == ["the part.step"]


def test_nothing_is_left_half_written(ocp, tmp_path):
    before = write_step(ball_patches((0, 0, 0), 1), tmp_path / "a.step").read_bytes()
    point = RationalPatch(np.ones((2, 2, 3)), np.ones((2, 2)))
    with pytest.raises(pas.GeometryError, match=r"patches\[8\] is a single point"):
        write_step([*ball_patches((0, 0, 0), 1), point], tmp_path / "a.step")
    assert (tmp_path / "a.step").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.step"]
