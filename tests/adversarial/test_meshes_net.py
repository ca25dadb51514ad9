"""Tampered meshes of every kind of surface: none is certified as the surface, and the honest one is."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from adversarial.mesh_tamperings import TAMPERINGS, loops, octahedron, tampered, with_part
from conftest import EQUAL, solved

import pas
from pas.algebra.rational import to_floats
from pas.surface.mesh_proofs import certify_mesh

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
    return certificate.holds and all(v.proved for v in certificate.verdicts if "topology" in v.claim)


def false_certificates(name, numbers):
    """The tamperings of a surface's mesh after which it is still certified."""
    surface, points, triangles = honest(name)
    center = to_floats(surface.partition.center)
    wrong = []
    for tampering in TAMPERINGS:
        for seed in numbers:
            certificate = certify_mesh(surface, *tampered(tampering, points, triangles, center, seed))
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
    certificate = certify_mesh(*honest(name))
    assert is_certified(certificate), str(certificate)


@pytest.mark.parametrize("name", SURFACES)
def test_no_tampered_mesh_is_certified(name):
    assert false_certificates(name, range(2)) == []


@pytest.mark.parametrize("name", ["foot", "nozzle"])
@pytest.mark.parametrize("radius", [0.1, 0.6, 0.92, 0.95, 0.98, 1.01, 1.3, 2.0, 40.0])
def test_closed_spheres_around_the_centre_are_seen(name, radius):
    """However large: as seen from the centre they cover every direction once more."""
    surface, points, triangles = honest(name)
    center = np.array(to_floats(surface.partition.center))
    radius *= np.linalg.norm(points - center, axis=1).max()
    more = with_part((points, triangles), octahedron(center, radius))
    certificate = certify_mesh(surface, *more)
    assert not any(v.proved for v in certificate.verdicts if "topology" in v.claim)


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
    found = next(v for v in certify_mesh(parts, points, triangles).verdicts if "vertices" in v.claim)
    assert found.status is pas.Status.FAILS_MEASURED and "outside" in found.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("block", range(4))
def test_no_tampered_mesh_of_many_is_certified(name, block):
    assert false_certificates(name, range(2 + 10 * block, 12 + 10 * block)) == []
