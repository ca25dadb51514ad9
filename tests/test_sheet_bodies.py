"""Solids of blends that are meshed from their surfaces' meshes, tubes and flat ends, beside their lattices' meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

import pas
from pas import solid
from pas.pipeline.blend import struts
from pas.solid.sheets import RuledEnd

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SKEW = (0.292372, 0.956305, 0)


def both(*axes):
    return [way for axis in axes for way in (axis, tuple(-c for c in axis))]


NODES = {
    "T": ([*((way, 1) for way in both(X)), (Y, "4/5")], 1),
    "T of a thin branch": ([*((way, 1) for way in both(X)), (Y, "1/2")], 1),
    "cross": ([(way, 1) for way in both(X, Y)], 1),
    "six-way": ([(way, 1) for way in both(X, Y, Z)], 1),
    "tetrahedral": ([((1, 1, 1), 1), ((1, -1, -1), 1), ((-1, 1, -1), 1), ((-1, -1, 1), 1)], 1),
    "bicycle": ([*((way, "17.45") for way in both(X)), (SKEW, "14.3")], 1),
    "cone": ([pas.Pipe(X, 1, 2), pas.Pipe(Y, 1, 2), pas.Cone(Z, 1, 2, slope="-1/8")], 1),
}

"""Contacts or struts, and the order."""

CASES = [pytest.param(name, marks=() if name in ("T", "cone") else pytest.mark.slow) for name in NODES]


@pytest.fixture(scope="module")
def blends():
    made = {}

    def of(name):
        if name not in made:
            items, order = NODES[name]
            made[name] = pas.blend(items if hasattr(items[0], "contact") else struts(items, order), order)
        return made[name]

    return of


def radius(blend):
    return max(contact.rim.radii[0] for contact in blend.surface.contacts)


def is_sound(mesh, body, tolerance, euler):
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, euler)
    assert mesh.deviation <= tolerance and {*mesh.names} <= {*body.faces}
    corners = mesh.points[mesh.triangles]
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((turned[:, None] * mesh.normals).sum(axis=2) > 0).all()
    for face in mesh.names:  # each face lies on its own polynomials
        rows = mesh.faces == mesh.names.index(face)
        if "blend" not in face:
            points = corners[rows].reshape(-1, 3)
            (polynomial,) = body.polynomials[face]
            away = np.abs(polynomial(points)) / np.linalg.norm(polynomial.gradient(points), axis=-1)
            assert away.max() < 1e-9 * np.ptp(points)
    return mesh


@pytest.mark.parametrize("name", CASES)
def test_nodes_are_bounded_by_their_sheets(name, blends):
    blend = blends(name)
    r, size = radius(blend), len(blend.surface.contacts)
    body = blend.solid(int(np.ceil(r)))
    assert body.sheets is not None
    for share in (1e-2, 1e-3):
        mesh = is_sound(body.mesh(share * r), body, share * r, 2)
    assert set(mesh.names) == set(body.faces) and len(mesh.names) == 1 + 2 * size
    assert mesh.volume == pytest.approx(body.volume(1e-2 * r), rel=2e-3)
    assert mesh.area == pytest.approx(body.area(1e-2 * r), rel=2e-3)


@pytest.mark.parametrize("name", CASES)
def test_hollow_nodes_are_bounded_by_their_sheets(name, blends):
    blend = blends(name)
    r, size = radius(blend), len(blend.surface.contacts)
    body = blend.hollow("1/8" if r < 10 else "17/8").solid(int(np.ceil(r)))
    assert body.sheets is not None
    mesh = is_sound(body.mesh(1e-2 * r), body, 1e-2 * r, 2 * (2 - size))
    assert len(mesh.names) == 2 * (1 + size) + size
    assert {f"inside of neighbour {size}", "inside of blend", f"neighbour {size} end"} <= {*mesh.names}
    assert body.volume(1e-2 * r) == pytest.approx(body.mesh(1e-3 * r).volume, rel=2e-2)


def test_the_lattice_says_the_same(blends):
    for body in (blends("cone").solid(1), blends("T").solid((1, 2, "1/2"))):
        lattice = replace(body, sheets=None)
        assert lattice.volume(1e-2) == pytest.approx(body.volume(1e-2), rel=1e-3)
        assert lattice.area(1e-2) == pytest.approx(body.area(1e-2), rel=1e-3)
        assert {*lattice.mesh(1e-2).names} == {*body.mesh(1e-2).names}


def test_each_neighbour_has_its_length(blends):
    blend = blends("T")
    planes = [contact.rim.plane for contact in blend.surface.contacts]
    body = blend.solid([1, 0, "5/2"])
    mesh = is_sound(body.mesh(1e-2), body, 1e-2, 2)
    heights = [plane(mesh.points) / np.linalg.norm(plane.gradient(np.zeros(3))) for plane in planes]
    assert [h.max() for h in heights] == pytest.approx([1, 0, 2.5], abs=1e-9)
    assert "neighbour 2" not in mesh.names and "neighbour 2 end" in mesh.names
    wall = blend.hollow("1/8").solid([1, 0, "5/2"])
    assert is_sound(wall.mesh(1e-2), wall, 1e-2, -2).volume < mesh.volume
    assert len(body.joints) == 2 and body.proved and wall.proved
    with pytest.raises(ValueError, match="one number, or 3, one for each neighbour, not 2"):
        blend.solid([1, 2])


def test_moved_bodies_keep_their_sheets(blends):
    body = blends("cone").solid(1)
    volume, kept = body.mesh(1e-2).volume, body.rotate(Z, 30).translate((1, 2, 3))
    for moved, times in ((kept, 1), (kept.mirror((1, 2, 0)), 1), (body.scale(2), 8), (body.scale((1, 2, 3)), 6)):
        mesh = is_sound(moved.mesh(2e-2), moved, 2e-2, 2)
        assert mesh.volume == pytest.approx(times * volume, rel=1e-2)


def test_qualities(blends):
    body = blends("T").solid(3)
    meshes = {quality: body.mesh(2e-2, quality=quality) for quality in ("angles", "balanced", "count")}
    for mesh in meshes.values():
        assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
        assert mesh.deviation <= 2e-2
    assert len(meshes["count"].triangles) <= len(meshes["balanced"].triangles) < len(meshes["angles"].triangles)
    assert np.median(meshes["angles"].smallest_angles) > 30


def test_set_operations_go_by_exact_faces(blends):
    body = blends("cone").solid(1)
    bore = solid.cylinder((0, 0, 0), (0, 5, 0), "1/2", "bore")
    flange = solid.cylinder((0, "11/4", 0), (0, 3, 0), 2, "flange")
    made = (body | flange) - bore
    assert made.sheets is None
    mesh = made.mesh(2e-2)
    assert mesh.is_closed and {"bore", "flange", "blend", "neighbour 1"} <= {*mesh.names}
    assert body.cap("y - 5/2", "cut").sheets is None and body.renamed("all").sheets is None


def test_what_is_no_tube_around_the_centre_has_none():
    """Its lines must be straight and meet in one point, and the centre must be inside, on the same nappe."""
    plane, center, one = pas.Polynomial("z - 2"), (fmpq(0),) * 3, fmpq(1)

    def found(surface):
        return RuledEnd.of(pas.Contact(surface, "z - 2"), plane, one, center)

    for good in ("x^2 + y^2 - 1", "x^2 + (y - 1/2)^2 - 1", "x^2 + 2*y^2 - (z + 1)^2/9", "x^2 + y^2 - (z - 5)^2/9"):
        tube = found(good)
        rim = tube.contact.rim.points()
        assert tube.off(rim) < 1e-12 and abs(tube.carried(rim)[:, 2] - 3).max() < 1e-12
        assert abs(tube.contact.surface(tube.carried(rim))).max() < 1e-12
    for wrong in ("x^2 + (y - 2)^2 - 1", "x^2 + y^2 - (z - 1)^2", "x^2 + y^2 - z", "x^2 + y^2 + (z - 2)^2 - 1"):
        assert found(wrong) is None


@pytest.mark.slow
def test_a_node_with_a_torus_has_a_lattice():
    contacts = [pas.Torus(Z, (2, 0, 0), "1/2", (-2, 2, 0)), pas.Cone((1, -1, 0), "1/2", 2, slope="1/8")]
    surface = pas.blend([*contacts, pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8")], 1)
    assert surface.solid("1/2").sheets is None
