"""Walls of a few hundredths of the size, open or not: sound, as thick as asked, and refused in one sentence."""

from __future__ import annotations

import re
from math import pi

import numpy as np
import pytest
from conftest import UNEQUAL, fair
from test_printing import intersecting

import pas
from pas import solid
from pas.mesh.closed import triangulate_faces
from pas.mesh.hollowed import too_thick
from pas.mesh.topology import is_closed_manifold
from pas.solid.shell import shelled

BALL = solid.ball((0, 0, 0), 1, "ball")
BOX = solid.box((0, 0, 0), (1, 1, 1))
BOWL = BALL & solid.patch("lid", "z")
PIPE = solid.cylinder((0, 0, -1), (0, 0, 1), 1, face="tin")
ANGLE = solid.box((0, 0, 0), (2, 2, 1)) - solid.box((1, 1, -1), (3, 3, 3), face="cut")
NOTCH = solid.box((0, 0, 0), (2, 2, 2)) - solid.box((1, 1, 1), (3, 3, 3), face="cut")
T = 0.01

OPEN = {  # open faces, thickness, Euler characteristic, volume of the wall
    "bowl": (BOWL, ["lid"], T, 2, 2 / 3 * pi * (1 - (1 - T) ** 3)),
    "tray": (BOX, ["box z+"], T / 2, 2, 1 - (1 - T) ** 2 * (1 - T / 2)),
    "two sides open": (BOX, ["box z+", "box x+"], T / 2, 2, 1 - (1 - T) * (1 - T / 2) ** 2),
    "pipe": (PIPE, ["tin start", "tin end"], T, 0, 2 * pi * (1 - (1 - T) ** 2)),
    "angle": (ANGLE, ["box z+", "box z-"], T, 0, 8 * T - 5 * T**2 + (1 - pi / 4) * T**2),
    "angle, closed": (ANGLE, [], T, 4, None),
    "notch": (NOTCH, ["box z-"], T, 2, None),
}


def thicknesses(mesh, names, most=150):
    """How thick the wall is below the middles of some of a mesh's outer triangles, along rays."""
    rows = np.flatnonzero(np.isin(mesh.faces, [mesh.names.index(name) for name in names]))
    rows = rows[np.linspace(0, len(rows) - 1, most).astype(int)]
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    result = []
    for row in rows:
        start, along = (a[row] + b[row] + c[row]) / 3, -np.cross(b[row] - a[row], c[row] - a[row])
        along /= np.linalg.norm(along)
        p = np.cross(along, c - a)  # Moeller and Trumbore 1997
        size = ((b - a) * p).sum(axis=1)
        size[np.abs(size) < 1e-300] = np.nan
        q = np.cross(start - a, b - a)
        u, v, t = ((start - a) * p).sum(axis=1) / size, q @ along / size, ((c - a) * q).sum(axis=1) / size
        result.append(t[(u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-9)].min())
    return np.array(result)


@pytest.mark.sampled(16)
@pytest.mark.parametrize("name", OPEN)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_thin_walls(name, tolerance):
    shape, faces, thickness, characteristic, volume = OPEN[name]
    hollow = shape.shell(thickness, open=faces)
    mesh = hollow.mesh(tolerance)
    assert is_closed_manifold(mesh.triangles)
    assert mesh.volume > 0
    assert (mesh.components, mesh.euler_characteristic) == (1 if faces else 2, characteristic)
    assert mesh.deviation <= min(tolerance, thickness / 3)
    assert len(intersecting(mesh.points, mesh.triangles)) == 0
    assert set(mesh.names) == {*shape.mesh(1e-2).names, *(n for n in hollow.faces if n.startswith("inside of"))}
    assert np.abs(hollow.value(mesh.points)).max() < 1e-9
    if volume is not None:
        assert mesh.volume == pytest.approx(volume, rel=0.15 if tolerance > 2e-3 else 0.05)


@pytest.mark.parametrize("name", ["bowl", "pipe", "angle"])
@pytest.mark.sampled(3)
def test_rays_through_a_thin_wall(name):
    shape, faces, thickness, *_ = OPEN[name]
    mesh = shape.shell(thickness, open=faces).mesh(1e-3)
    outer = [n for n in mesh.names if n not in faces and not n.startswith("inside")]
    found = thicknesses(mesh, outer)
    assert len(found) > 20
    assert np.median(found) == pytest.approx(thickness, rel=0.1)
    assert found.min() > thickness - 2 * mesh.deviation - 1e-9


@pytest.mark.slow
def test_a_blend_as_a_thin_pipe():
    body = fair(UNEQUAL, 1).solid("1/2")
    ends = [f"neighbour {i} end" for i in (1, 2, 3)]
    mesh = body.shell(0.04, open=ends).mesh(2e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, -2)
    assert mesh.deviation < 0.04 / 3
    assert len(intersecting(mesh.points, mesh.triangles)) == 0
    rims = [mesh.face_areas[end] for end in ends]
    radii = [float(pas.Polynomial(str(r)).dense(0)[0]) for r in ("1/3", "1/4", "2/5")]
    assert sorted(rims) == pytest.approx(sorted(pi * (r**2 - (r - 0.04) ** 2) for r in radii), rel=0.2)


def test_a_shell_of_a_shell_is_moved_with_it():
    shape = BOWL.shell(0.02, open=["lid"]).scale("1/2").rotate((1, 1, 0), 30).translate((1, 2, 3))
    mesh = shape.mesh(1e-3)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
    assert mesh.volume == pytest.approx(pi / 12 * (1 - 0.98**3), rel=2e-2)


def test_no_face_is_nearer_than_the_nearest_corner_of_grooves():
    """Curves of grooves end in concave corners: their continuation inside the solid is no face."""
    near = shelled(NOTCH, 0.1, (), 0.05).parts[-1]
    functions = [part.function for part in (near.parts if hasattr(near, "parts") else [near])]
    points = 1 - np.array([[0.05, 0.05, 0.05], [0.09, 0.06, 0.02], [0.03, 0.08, 0.06]])
    values = np.max([-f.jets(points)[:, 0] for f in functions], axis=0)
    assert values == pytest.approx(0.1 - np.linalg.norm(1 - points, axis=1), abs=1e-12)


def test_a_wall_thicker_than_its_face_is_round_says_so():
    egg = BALL.scale((1, "1/3", "1/3"))
    words = r"0\.3 thick, but near \(-?[01]\.?\d*, \S+, \S+\) the face 'ball' has a radius of curvature of 0\.111"
    thick, thin = egg.shell(0.3).field.wall(), egg.shell(0.1).field.wall()
    mesh = triangulate_faces(thick.solid, 1e-3).mesh
    assert re.match("the shell is " + words, too_thick(mesh, thick))
    assert not too_thick(mesh, thin)


@pytest.mark.slow
def test_a_wall_that_folds_over_is_refused():
    with pytest.raises(pas.MeshError, match=r"a thickness below 0\.11 works"):
        BALL.scale((1, "1/3", "1/3")).shell(0.3).mesh()
