"""Meshes by compiled code and by numpy: the same bits, on every machine; numpy serves where there is no compiler."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas import solid
from pas.algebra.kernels import VARIABLE
from pas.algebra.monomials import count
from pas.algebra.tables import PieceTables
from pas.mesh.coarsen import collapsed
from pas.mesh.octree import Octree
from pas.mesh.radial import Edges, flipped
from pas.mesh.topology import distinct, numbered, pinched
from pas.solid.jets import Jets

TANGLE = "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5"


def bits(mesh):
    """What tells meshes apart."""
    return hashlib.sha256(mesh.points.tobytes() + mesh.triangles.tobytes() + mesh.point_normals.tobytes()).hexdigest()


CASES = {
    "corner": lambda: solved(EQUAL, 2).surface.mesh(5e-3),
    "tangle": lambda: pas.Polynomial(TANGLE).surface((-3,) * 3, (3,) * 3).mesh(2e-2),
    "through walls": lambda: pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4 + x/7").surface((-1,) * 3, (1,) * 3).mesh(1e-2),
}


@pytest.mark.parametrize("name", CASES)
def test_meshes_are_the_same_bits_by_numpy_and_compiled(monkeypatch, name):
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        mesh = CASES[name]()
        assert mesh.certificate.holds
        found.append((bits(mesh), mesh.certificate.distance))
    assert found[0][0] == found[1][0]
    assert found[0][1] == pytest.approx(found[1][1], rel=1e-9)


BITS = f"""
import hashlib, pas
mesh = pas.Polynomial("{TANGLE}").surface((-3,) * 3, (3,) * 3).mesh(3e-2)
print(hashlib.sha256(mesh.points.tobytes() + mesh.triangles.tobytes()).hexdigest())
"""


def test_meshes_in_boxes_are_the_same_bits_on_every_machine():
    found = set()
    for machine, kernel in (("Haswell", "numpy"), ("SkylakeX", "compiled"), ("Zen", "numpy")):
        environment = {**os.environ, "OPENBLAS_CORETYPE": machine, VARIABLE: kernel}
        done = subprocess.run([sys.executable, "-c", BITS], env=environment, capture_output=True, text=True, check=True)
        found.add(done.stdout)
    assert len(found) == 1


def test_rough_meshes_are_changed_alike(monkeypatch):
    mesh = pas.Polynomial(TANGLE).surface((-3,) * 3, (3,) * 3).mesh(5e-2)
    rng = np.random.default_rng(3)
    points = mesh.points + rng.normal(scale=0.05, size=mesh.points.shape)
    rim, fixed = np.full(len(points), -1), np.zeros(len(points), dtype=bool)
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        triangles = flipped(points, mesh.triangles, mesh.point_normals)
        left, smaller = collapsed(
            points, Edges(triangles, len(points)), mesh.point_normals, rim, fixed, np.full(len(points), 0.6)
        )
        edges = Edges(triangles[10:], len(points))
        found.append([triangles, left, smaller, edges.every, edges.owners])
    assert not np.array_equal(found[0][0], mesh.triangles)
    assert len(found[0][1]) < 0.9 * len(points)
    assert all(np.array_equal(a, b) for a, b in zip(*found, strict=True))


@pytest.mark.parametrize("kernel", ["numpy", "compiled"])
def test_flips_make_no_edge_between_opposite_sides(monkeypatch, kernel):
    """Of a thin strip across its ridge: the shorter diagonal is taken where its ends look the same way, roughly."""
    monkeypatch.setenv(VARIABLE, kernel)
    points = np.array([[-3.0, 0, 0], [3, 0, 0], [0, -1, 0], [0, 1, 0]])
    triangles = np.array([[0, 1, 3], [1, 0, 2]])
    for lean, taken in ((0.5, True), (0.9, True), (1.1, False), (2.0, False)):
        normals = np.array([[0, 0, 1], [0, 0, 1], [0, -lean, 1], [0, lean, 1]])
        normals /= np.sqrt((normals * normals).sum(axis=1))[:, None]
        assert ((flipped(points, triangles, normals) != triangles).any()) == taken


@pytest.mark.parametrize("kernel", ["numpy", "compiled"])
@pytest.mark.parametrize("number", [3, 40])
def test_tables_of_pieces(monkeypatch, kernel, number):
    monkeypatch.setenv(VARIABLE, kernel)
    rng = np.random.default_rng(4)
    coefficients = rng.normal(size=(number, 2, count(2)))
    coefficients[:, 1, count(1) :] = 0
    points, pieces = rng.uniform(-1, 1, (200, 3)), rng.integers(number, size=200)
    values = PieceTables(coefficients, (2, 1))(points, pieces)
    x, y, z = points.T
    monomials = np.stack([np.ones(200), x, y, z, x * x, x * y, x * z, y * y, y * z, z * z])
    assert values == pytest.approx(np.einsum("nkc,cn->kn", coefficients[pieces], monomials), abs=1e-14)
    assert PieceTables(coefficients[:, 1:], (1,))(points[:0], pieces[:0]).shape == (1, 0)


@pytest.mark.parametrize("number", [4, 60])
def test_jets_of_many_polynomials_are_the_same_bits(monkeypatch, number):
    rng = np.random.default_rng(number)
    texts = ["x - {}", "x^2 + {}*y*z - 1", "7", "x^5 - {}*x*y^2*z + z^3", "y^5 - {}*x^4"]
    jets = Jets([pas.Polynomial(texts[k % 5].format(k + 1)) for k in range(number)])
    points, numbers = rng.uniform(-1, 1, (300, 3)), rng.integers(number, size=300)
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        found.append(jets(points, numbers))
    assert np.array_equal(*found)
    assert jets(points[:0], numbers[:0]).shape == Jets([])(points[:0], numbers[:0]).shape == (0, 4)
    step = 1e-6 * np.eye(3)[:, None]
    slopes = [jets(points + s, numbers)[:, 0] for s in step]
    assert pytest.approx((np.array(slopes) - found[0][:, 0]) / 1e-6, rel=1e-3, abs=1e-3) == found[0][:, 1:].T


SOLIDS = {
    "cylinders crossing": lambda: (
        solid.cylinder((-2, 0, 0), (2, 0, 0), "1/2", "a") | solid.cylinder((0, -2, 0), (0, 2, 0), "1/2", "b")
    ),
    "hollow ball in a corner": lambda: solid.ball((0, 0, 0), 1) - solid.box((0, 0, 0), (2, 2, 2)),
    "thin bowl": lambda: (solid.ball((0, 0, 0), 1) & solid.patch("lid", "z")).shell(0.01, open=["lid"]),
    "thin angle": lambda: (solid.box((0, 0, 0), (2, 2, 1)) - solid.box((1, 1, -1), (3, 3, 3), face="cut")).shell(
        0.02, open=["box z+"]
    ),
    "two cones": lambda: solid.cone((0, 0, 0), (0, 0, 1), 1, 0, "a") | solid.cone((0, 0, 0), (0, 0, -1), 1, 0, "b"),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_meshes_of_solids_are_the_same_bits_by_numpy_and_compiled(monkeypatch, name):
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        mesh = SOLIDS[name]().mesh(1e-2)
        assert mesh.is_closed
        found.append(hashlib.sha256(mesh.points.tobytes() + mesh.triangles.tobytes()).hexdigest())
    assert found[0] == found[1]


def test_tetrahedra_of_uneven_octrees_are_alike(monkeypatch):
    field = SOLIDS["hollow ball in a corner"]().field
    octree = Octree(field, 0.15).refined(np.array([[0.1, 0.2, 0.3], [0.9, 0.0, 0.0]]))
    octree = octree.refined(np.array([[0.12, 0.2, 0.28]])).refined(field.box)
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        found.append(octree.tetrahedra())
    assert len(found[0][1]) > 6 * octree.count
    assert all(np.array_equal(a, b) for a, b in zip(*found, strict=True))


@pytest.mark.parametrize("kernel", ["numpy", "compiled"])
@pytest.mark.parametrize("number, largest", [(0, 1), (1, 5), (3000, 100), (5000, 1 << 54)])
def test_distinct_numbers(monkeypatch, kernel, number, largest):
    monkeypatch.setenv(VARIABLE, kernel)
    keys = np.random.default_rng(6).integers(0, largest, size=number)
    found, place = numbered(keys)
    assert (np.diff(found) > 0).all()
    assert np.array_equal(found[place], keys)
    assert np.array_equal(np.unique(place), np.arange(len(found)))
    assert np.array_equal(distinct(keys), found)


def spoilt(triangles, how, rng):
    """A closed surface with holes, a vertex that is two, triangles twice, or two surfaces through one vertex."""
    if how == "holes":
        return np.delete(triangles, rng.integers(0, len(triangles), 3), axis=0)
    if how == "twice":
        return np.concatenate([triangles, triangles[rng.integers(0, len(triangles), 2)]])
    if how == "two":
        triangles = np.concatenate([triangles, triangles + triangles.max() + 1])
    a, b = 0, int(triangles.max())
    return np.where(triangles == a, b, triangles) if how in ("two", "vertex") else triangles


@pytest.mark.parametrize("how, number", [("", 0), ("holes", 9), ("vertex", 1), ("two", 1), ("twice", 6)])
def test_where_surfaces_are_no_manifolds(monkeypatch, how, number):
    rng = np.random.default_rng(2)
    triangles = spoilt(pas.Polynomial(TANGLE).surface((-3,) * 3, (3,) * 3).mesh(0.2).triangles, how, rng)
    among = rng.random(triangles.max() + 5) < 0.5
    found = []
    for kernel in ("numpy", "compiled"):
        monkeypatch.setenv(VARIABLE, kernel)
        found.append((pinched(triangles), pinched(triangles, among)))
    assert len(found[0][0]) == number
    assert all(np.array_equal(a, b) for a, b in zip(*found, strict=True))
    assert set(found[0][1].tolist()) <= set(np.flatnonzero(among).tolist())
