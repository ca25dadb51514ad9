"""Tampered meshes of every kind of surface: none is certified as the surface, and the honest one is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from adversarial.mesh_tamperings import TAMPERINGS, cone_over, loops, octahedron, tampered, with_part
from conftest import EQUAL, read, solved

import pas
from pas.algebra.rational import to_floats

X, Z = (1, 0, 0), (0, 0, 1)
TORUS = "(x^2 + y^2 + z^2 + 8/9)^2 - 4*(x^2 + y^2)"
LOWER, UPPER = (-2.5, -2.75, -2.875), (2, 2.125, 2.25)

SURFACES = {
    "torus in a box": lambda: pas.Polynomial(TORUS).surface(LOWER, UPPER),
    "quadric through walls": lambda: pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4 + x/7").surface((-1,) * 3, (1,) * 3),
    "corner": lambda: solved(EQUAL, 1).surface,
    "foot": lambda: pas.blend([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 1).surface,
    "nozzle": lambda: pas.blend([pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1).surface,
}


@cache
def honest(name):
    """A surface and its mesh."""
    surface = SURFACES[name]()
    mesh = surface.mesh(2e-2 * float(np.ptp(surface.partition.points, axis=0).max()) / 2)
    return surface, np.array(mesh.points), np.array(mesh.triangles)


def is_certified(certificate):
    """Whether a certificate says that the mesh is the surface."""
    return certificate.holds and all(v.proved or v.measured for v in certificate.verdicts)


def false_certificates(name, numbers):
    """The tamperings of a surface's mesh after which it is still certified."""
    surface, points, triangles = honest(name)
    center = to_floats(surface.partition.center)
    wrong = []
    for tampering in TAMPERINGS:
        for seed in numbers:
            certificate = surface.certify_mesh(*tampered(tampering, points, triangles, center, seed))
            if is_certified(certificate):
                wrong.append((tampering, seed))
            topology = next((v for v in certificate.verdicts if "topology" in v.claim), None)
            changes = tampering not in MEASURED and (tampering != "lid" or loops(triangles))
            if changes and topology is not None and topology.proved:
                wrong.append((tampering, seed, "topology"))
    return wrong


MEASURED = ("moved_off", "moved_across", "exchanged", "larger")
"""After which a mesh has the topology that it had, perhaps, but not all vertices on the surface; so has one that is
closed after a lid."""


def test_there_are_fifteen_ways_and_more():
    assert len(TAMPERINGS) >= 15


@pytest.mark.parametrize("name", SURFACES)
def test_honest_meshes_are_certified(name):
    surface, points, triangles = honest(name)
    certificate = surface.certify_mesh(points, triangles)
    assert is_certified(certificate), str(certificate)


@pytest.mark.parametrize("name", SURFACES)
def test_no_tampered_mesh_is_certified(name):
    assert false_certificates(name, [1]) == []


HOLLOW = {
    "hollow foot": lambda: read("hollow_foot"),
    "hollow node": lambda: pas.node([(X, 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], 1).hollow("1/8"),
}


@cache
def wall(name):
    """A hollow blend's mesh."""
    return HOLLOW[name]().mesh(1e-1)


@pytest.mark.parametrize("name", HOLLOW)
def test_honest_walls_are_certified(name):
    certificate = wall(name).certificate
    assert is_certified(certificate), str(certificate)
    assert sum("ring" in v.claim and v.proved for v in certificate.verdicts) == len(wall(name).ends)


def walls_wrongly_certified(name, numbers):
    """Of tamperings of one face each: those after which the mesh of a wall is still certified."""
    mesh, wrong = wall(name), []
    center = to_floats(mesh.sheets[0].partition.center)
    for tampering in TAMPERINGS:
        for seed in numbers:
            face = seed % len(mesh.names)
            own = mesh.faces == face
            before = mesh.triangles[own]
            if face > 1 and tampering in ("moved_off", "moved_across", "exchanged", "larger"):
                before = np.concatenate([before, mesh.triangles[mesh.faces == 0]])
                own |= mesh.faces == 0
            points, changed = tampered(tampering, mesh.points, before, center, seed)
            triangles = np.concatenate([mesh.triangles[~own], changed])
            faces = np.concatenate([mesh.faces[~own], np.full(len(changed), face)])
            if face > 1 and len(before) == len(changed):
                faces = np.concatenate([mesh.faces[~own], mesh.faces[own]])
            normals = np.zeros((len(triangles), 3, 3))
            if is_certified(
                replace(mesh, points=points, triangles=triangles, faces=faces, normals=normals).certificate
            ):
                wrong.append((tampering, seed))
    return wrong


@pytest.mark.parametrize("name", HOLLOW)
def test_no_tampered_wall_is_certified(name):
    assert walls_wrongly_certified(name, (0, 3)) == []


def broken_walls():
    """Walls of a foot with one fault each: a bubble in the inner sheet or of its own, a ring turned, a dent in one."""
    mesh = wall("hollow foot")
    center = np.array(to_floats(mesh.sheets[0].partition.center))

    def changed(points, triangles, faces):
        return replace(mesh, points=points, triangles=triangles, faces=faces, normals=np.zeros((len(triangles), 3, 3)))

    vertex = mesh.points[mesh.triangles[mesh.faces == 1][0, 0]]
    points, triangles = with_part((mesh.points, mesh.triangles), octahedron(center + 1.1 * (vertex - center), 0.01))
    for face in (1, len(mesh.names)):
        more = np.full(len(triangles) - len(mesh.triangles), face)
        yield changed(points, triangles, np.concatenate([mesh.faces, more]))
    number = next(i for i, end in enumerate(mesh.ends) if end.surface.degree == 1)  # a plane end
    ring = np.flatnonzero(mesh.faces == 2 + number)[0]
    a, b, c = mesh.triangles[ring].tolist()
    tip = len(mesh.points)
    dent = mesh.points[[a, b, c]].mean(axis=0) + 0.01 * mesh.ends[number].axis
    fan = [(a, b, tip), (b, c, tip), (c, a, tip)]
    triangles = np.concatenate([np.delete(mesh.triangles, ring, axis=0), fan])
    faces = np.concatenate([np.delete(mesh.faces, ring), [2 + number] * 3])
    yield changed(np.concatenate([mesh.points, [dent]]), triangles, faces)
    beside = 2 * mesh.points[a] - mesh.points[[b, c]].mean(axis=0)
    yield changed(np.concatenate([mesh.points, [beside]]), triangles, faces)


def test_each_rule_of_walls_is_needed():
    found = [wrong.certificate for wrong in broken_walls()]
    assert [is_certified(certificate) for certificate in found] == [False] * 4
    assert "a vertex is not in the end" in str(found[2]) and "may be turned" in str(found[3])


@pytest.mark.slow
@pytest.mark.parametrize("name", HOLLOW)
@pytest.mark.parametrize("block", range(4))
def test_no_tampered_wall_of_many_is_certified(name, block):
    assert walls_wrongly_certified(name, range(10 * block, 10 * block + 10)) == []


@pytest.mark.parametrize("name", ["corner", "foot", "nozzle"])
@pytest.mark.parametrize("radius", [0.1, 0.6, 0.92, 0.95, 0.98, 1.01, 1.3, 2.0, 40.0])
def test_closed_spheres_around_the_centre_are_seen(name, radius):
    """However large: as seen from the centre they cover every direction once more."""
    surface, points, triangles = honest(name)
    center = np.array(to_floats(surface.partition.center))
    radius *= np.linalg.norm(points - center, axis=1).max()
    more = with_part((points, triangles), octahedron(center, radius))
    certificate = surface.certify_mesh(*more)
    assert not any(v.proved for v in certificate.verdicts if "topology" in v.claim)


@pytest.mark.parametrize("name", ["corner", "foot", "nozzle"])
def test_ends_that_are_covered_twice_are_seen(name):
    """One lid goes on from the mesh, another one ends on the contact's curve."""
    surface, points, triangles = honest(name)
    center, covered = np.array(to_floats(surface.partition.center)), 0
    for loop in loops(triangles):
        tip, size = center + 0.9 * (points[loop].mean(axis=0) - center), len(points)
        lid = np.array(cone_over(points, loop, size))
        more = np.concatenate([points, [tip]])
        if (np.linalg.det(more[lid] - center) <= 0).any():  # of an opening, which leads away from its curve
            continue
        number = np.arange(size + 1)
        number[[*loop, size]] = size + 1 + np.arange(len(loop) + 1)
        found = surface.certify_mesh(
            np.concatenate([more, more[[*loop, size]]]), np.concatenate([triangles, lid, number[lid]])
        )
        assert not any(v.proved for v in found.verdicts if "topology" in v.claim)
        covered += 1
    assert covered


def test_vertices_outside_the_region_are_not_on_the_surface():
    """Of several pieces, where there is no value outside."""
    surface, points, triangles = honest("foot")
    whole = surface.partition
    partition = pas.OpenRegion(whole.vertices, whole.cells, whole.center)
    patches = surface.patches * len(whole.cells)
    parts = pas.PiecewiseSurface(partition, surface.contacts, surface.order, patches, surface.degree)
    rim = {vertex for loop in loops(triangles) for vertex in loop}
    inner = max(set(triangles.ravel().tolist()) - rim, key=lambda vertex: np.hypot(*points[vertex, :2]))
    center = np.array(to_floats(whole.center))
    points = points.copy()
    points[inner] = center + 2 * (points[inner] - center)
    assert np.isnan(parts(points[inner]))
    found = next(v for v in parts.certify_mesh(points, triangles).verdicts if "vertices" in v.claim)
    assert found.status is pas.Status.FAILS_MEASURED and "outside" in found.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("block", range(4))
def test_no_tampered_mesh_of_many_is_certified(name, block):
    assert false_certificates(name, range(2 + 10 * block, 12 + 10 * block)) == []
