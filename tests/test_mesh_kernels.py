"""What the compiled functions make of meshes: the same bits on every machine, and what their docstrings say."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas import solid
from pas.algebra.evaluation import PolynomialBatch
from pas.algebra.monomials import count
from pas.mesh.octree import Octree
from pas.mesh.topology import distinct, numbered, pinched
from pas.surface.geometry import derivative_batch

TANGLE = "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5"


CASES = {
    "corner": lambda: (solved(EQUAL, 2).surface, 5e-3),
    "tangle": lambda: (pas.Polynomial(TANGLE).surface((-3,) * 3, (3,) * 3), 2e-2),
    "through walls": lambda: (pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4 + x/7").surface((-1,) * 3, (1,) * 3), 1e-2),
}


@pytest.mark.parametrize("name", CASES)
def test_meshes_are_proved(name):
    surface, tolerance = CASES[name]()
    mesh = surface.mesh(tolerance)
    assert mesh.certificate.holds
    assert 0 < mesh.deviation <= tolerance
    assert mesh.certificate.distance < 2 * tolerance


BITS = f"""
import hashlib, pas
mesh = pas.Polynomial("{TANGLE}").surface((-3,) * 3, (3,) * 3).mesh(3e-2)
print(hashlib.sha256(mesh.points.tobytes() + mesh.triangles.tobytes()).hexdigest())
"""


def test_meshes_in_boxes_are_the_same_bits_on_every_machine():
    found = []
    for machine in ("Haswell", "Zen"):
        environment = {**os.environ, "OPENBLAS_CORETYPE": machine}
        done = subprocess.run(
            [sys.executable, "-c", BITS], env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode != -signal.SIGILL:  # this processor cannot run some kernels
            assert done.returncode == 0, done.stderr[-2000:]
            found.append(done.stdout)
    assert len(found) > 1 and len({*found}) == 1


@pytest.mark.parametrize("number", [3, 40])
def test_tables_of_pieces(number):
    rng = np.random.default_rng(4)
    coefficients = rng.normal(size=(number, 2, count(2)))
    coefficients[:, 1, count(1) :] = 0
    points, pieces = rng.uniform(-1, 1, (200, 3)), rng.integers(number, size=200)
    batch = PolynomialBatch.of([[value, slope[: count(1)]] for value, slope in coefficients], 2)
    values = batch(points, pieces).T
    x, y, z = points.T
    monomials = np.stack([np.ones(200), x, y, z, x * x, x * y, x * z, y * y, y * z, z * z])
    assert values == pytest.approx(np.einsum("nkc,cn->kn", coefficients[pieces], monomials), abs=1e-14)
    assert batch(points[:0], pieces[:0]).shape == (0, 2)
    assert np.isnan(batch(points[:1], np.array([-1]))).all()


@pytest.mark.parametrize("number", [4, 60])
def test_jets_of_many_polynomials_are_values_and_slopes(number):
    rng = np.random.default_rng(number)
    texts = ["x - {}", "x^2 + {}*y*z - 1", "7", "x^5 - {}*x*y^2*z + z^3", "y^5 - {}*x^4"]
    polynomials = [pas.Polynomial(texts[k % 5].format(k + 1)) for k in range(number)]
    jets = derivative_batch([p.dense(max(p.degree, 0)) for p in polynomials], (0, 1))
    points, numbers = rng.uniform(-1, 1, (300, 3)), rng.integers(number, size=300)
    found = jets(points, numbers)
    wanted = [float(polynomials[k].at([Fraction(c) for c in p.tolist()])) for k, p in zip(numbers, points, strict=True)]
    assert found[:, 0] == pytest.approx(wanted, rel=1e-13, abs=1e-13)
    assert jets(points[:0], numbers[:0]).shape == derivative_batch([], (0, 1))(points[:0], numbers[:0]).shape == (0, 4)
    step = 1e-6 * np.eye(3)[:, None]
    slopes = [jets(points + s, numbers)[:, 0] for s in step]
    assert pytest.approx((np.array(slopes) - found[:, 0]) / 1e-6, rel=1e-3, abs=1e-3) == found[:, 1:].T


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


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SOLIDS)
def test_meshes_of_solids_are_closed(name):
    mesh = SOLIDS[name]().mesh(1e-2)
    assert mesh.is_closed and mesh.deviation <= 1e-2
    assert mesh.volume > 0


def test_tetrahedra_of_uneven_octrees_fill_their_cubes():
    field = SOLIDS["hollow ball in a corner"]().field
    octree = Octree(field, 0.15).refined(np.array([[0.1, 0.2, 0.3], [0.9, 0.0, 0.0]]))
    octree = octree.refined(np.array([[0.12, 0.2, 0.28]])).refined(field.box)
    points, tetrahedra = octree.tetrahedra()
    assert len(tetrahedra) > 6 * octree.count
    assert np.array_equal(np.unique(tetrahedra), np.arange(len(points)))
    corners = points[tetrahedra]
    volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    assert volumes.min() > 0
    cubes = [(octree.size / 2**level) ** 3 * len(each) for level, (each, _) in enumerate(octree._leaves)]
    assert volumes.sum() == pytest.approx(sum(cubes))


@pytest.mark.parametrize("number, largest", [(0, 1), (1, 5), (3000, 100), (5000, 1 << 54)])
def test_distinct_numbers(number, largest):
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


def not_fans(triangles):
    """The vertices whose triangles are not one closed fan, by walking about each."""
    links: dict[int, list[tuple[int, int]]] = {}
    for a, b, c in triangles.tolist():
        for v, u, w in ((a, b, c), (b, c, a), (c, a, b)):
            links.setdefault(v, []).append((u, w))
    open_ = {v for v, sides in links.items() if set(Counter(u for side in sides for u in side).values()) != {2}}
    pinched_ = set()
    for v in set(links) - open_:
        met, left = {links[v][0][0]}, list(links[v])
        while reached := [side for side in left if met & {*side}]:
            met |= {u for side in reached for u in side}
            left = [side for side in left if side not in reached]
        if left:
            pinched_.add(v)
    return open_, pinched_


@pytest.mark.parametrize("how, number", [("", 0), ("holes", 9), ("vertex", 1), ("two", 1), ("twice", 6)])
def test_where_surfaces_are_no_manifolds(how, number):
    rng = np.random.default_rng(2)
    triangles = spoilt(pas.Polynomial(TANGLE).surface((-3,) * 3, (3,) * 3).mesh(0.2).triangles, how, rng)
    among = rng.random(triangles.max() + 5) < 0.5
    open_, apart = not_fans(triangles)
    assert set(pinched(triangles).tolist()) == (open_ or apart)
    assert len(pinched(triangles)) == number
    chosen = set(np.flatnonzero(among).tolist())
    assert set(pinched(triangles, among).tolist()) == (open_ & chosen or apart & chosen)
