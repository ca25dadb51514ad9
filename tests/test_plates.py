"""Blends out of plates and other openings: contacts along cones, on regions that are open there."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas.algebra.rational import to_floats
from pas.blending.place import place, with_ends
from pas.certify.contact_proofs import cofactor
from pas.contacts.cones import apex
from pas.independent.checker import check_independently

X, Z = (1, 0, 0), (0, 0, 1)
UPRIGHT = [pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)]
CASES = {
    "upright": UPRIGHT,
    "leaning": [pas.Plate(Z, "5/2"), pas.Pipe((1, 0, 3), 1, 2)],
    "oblique": [pas.Plate((1, 2, 2), 6, point=(1, "1/2", 0)), pas.Pipe((1, 2, 2), 1, 2, (1, "1/2", 0))],
    "ellipse": [pas.Plate(Z, semiaxes=[(3, 0, 0), (0, 2, 0)]), pas.Pipe(Z, 1, 2)],
    "plate second": UPRIGHT[::-1],
}
OPENINGS = {
    "nozzle": [pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)],
    "boss": [pas.Opening("x^2 + y^2 + z^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)],
    "on a torus": [
        pas.Opening(pas.Torus(Z, (4, 0, 0), 1).contact.surface, X, "3/5", ("7/2", 0, 0)),
        pas.Pipe(X, "1/3", 6),
    ],
}


@pytest.fixture(scope="module")
def blends():
    """A function that solves each once; the usual one is read from a file."""
    return cache(lambda name: read("hollow_foot").outer if name == "upright" else pas.blend(CASES[name], 1))


@pytest.fixture(scope="module")
def second():
    return pas.blend(UPRIGHT, 2)


def single(items, order, degree):
    return pas.solutions(items, order, degree, pas.SingleCell()).dimension


@pytest.mark.parametrize(("order", "degree", "dimension"), [(1, 4, 9), (1, 5, 22), (2, 4, 5), (2, 5, 14), (2, 6, 30)])
def test_the_cone_through_the_edge_has_the_same_solutions(order, degree, dimension):
    assert pas.solutions(UPRIGHT, order, degree).dimension == dimension == single(UPRIGHT, order, degree)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.sampled(4)
def test_proved(blends, name, tmp_path):
    blend = blends(name)
    assert blend.certificate.proved and not blend.fairness.beyond(blend.limits)
    assert type(blend.surface.partition) is pas.OpenRegion
    path = tmp_path / "plate.pas.json"
    pas.save(blend, path)
    assert all(finding.proved for finding in check_independently(path))
    again = pas.load(path)
    assert again.certificate.proved and again.surface.polynomials == blend.surface.polynomials


def test_second_order(second):
    """beta of degree 0 in `alpha f + beta q^3`: nothing lower than degree 6 leaves the plate."""
    assert second.surface.degree == 6 and second.certificate.proved
    assert pas.solutions(UPRIGHT, 2, 5).regular is False
    assert second.fairness.hollowness < 1.5 and second.fairness.bulge == 0


def test_it_touches_the_plate_and_stays_above(blends):
    surface = blends("upright").surface
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    edge = np.stack([2 * np.cos(angles), 2 * np.sin(angles), 0 * angles], axis=1)
    assert np.abs(surface(edge)).max() < 1e-12
    gradients = surface.gradient(edge)
    assert np.abs(gradients[:, :2]).max() < 1e-12 and gradients[:, 2].min() > 0
    inside = edge * np.array([0.97, 0.97, 0])
    assert surface(inside).max() < 0 < surface(inside + np.array([0, 0, 0.1])).min()


def changed(surface, change):
    polynomials = [p + pas.Polynomial(change) for p in surface.polynomials]
    partition = surface.partition
    degree = max(surface.degree, *(p.degree for p in polynomials))
    return pas.PiecewiseSurface.from_polynomials(partition, surface.contacts, surface.order, polynomials, degree)


@pytest.mark.parametrize(
    ("change", "reached"),
    [
        ("(x^2 + y^2 - 1)*(z - 2)^2/1000", "not in"),  # the pipe is met, the plate is not
        ("z*(x^2 + y^2 - 1)*(x^2 + y^2 - 4*(z + 1)^2)/1000", "proved"),  # both are
    ],
)
def test_members_that_were_changed(blends, change, reached, tmp_path):
    surface = changed(blends("upright").surface, change)
    verdict = surface.certificate.contacts[0]
    assert verdict.proved == (reached == "proved")
    assert reached in (verdict.status.value, *verdict.reason.split(" <")[0:1]) or reached in verdict.reason
    record = replace(blends("upright"), surface=surface)
    pas.save(record, tmp_path / "changed.pas.json")
    found = check_independently(tmp_path / "changed.pas.json")[1]
    assert found.proved == verdict.proved


def test_alpha_that_is_negative_is_refuted(blends):
    surface = blends("upright").surface
    wrong = pas.PiecewiseSurface(surface.partition, surface.contacts, 1, [-p for p in surface.patches], surface.degree)
    verdict = wrong.certificate.contacts[0]
    assert verdict.status.value == "refuted" and "alpha" in verdict.reason
    assert not wrong.certificate.enclosed.proved


def test_a_cone_that_is_wider_than_the_region(blends):
    surface = blends("upright").surface
    wider = pas.Contact("z", "x^2 + y^2 - 5*(z + 1)^2")
    other = pas.PiecewiseSurface(surface.partition, [wider, surface.contacts[1]], 0, surface.patches, surface.degree)
    verdict = other.certificate.contacts[0]
    assert not verdict.proved and "sides of the region" in verdict.reason
    assert not other.certificate.enclosed.proved


def test_the_cofactor_is_exact(blends):
    surface = blends("leaning").surface
    join = surface.joins[0]
    alpha = cofactor(surface.patches[0], join.contact, 1)
    rest = surface.patches[0] - alpha * join.contact.surface
    quotient, remainder = divmod(rest.raw, join.contact.clip.raw**2)
    assert remainder.is_zero() and quotient.total_degree() <= surface.degree - 4


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_meshes(blends, name):
    surface = blends(name).surface
    mesh = surface.mesh(1e-2)
    chain, topology, vertices, near = mesh.certificate.verdicts
    assert chain.proved and near.proved and vertices.status.value == "holds, measured"
    if name == "leaning":  # the centre sees the pipe at a grazing angle
        assert topology.proved or "not seen from the centre" in topology.reason
    else:
        assert topology.proved


def test_meshes_that_are_another_surface(second):
    mesh = second.surface.mesh(5e-2)
    whole = second.surface.framed
    points, triangles = np.array(mesh.points), np.array(mesh.triangles)

    def verdicts(points, triangles):

        return whole.function.certify_mesh(points, triangles).verdicts

    assert verdicts(points, triangles)[1].proved
    assert not verdicts(points, triangles[1:])[1].proved  # a hole inside
    assert not verdicts(points, triangles[:, ::-1])[1].proved  # turned inside out
    top = np.flatnonzero(np.abs(points[:, 2] - 2) < 1e-9)
    top = top[np.argsort(np.arctan2(points[top, 1], points[top, 0]))]
    lid = [(a, b, len(points)) for a, b in zip(top, np.roll(top, -1), strict=True)]
    capped = np.concatenate([points, [(0, 0, 2.3)]]), np.concatenate([triangles, lid])
    assert "one loop on each" in verdicts(*capped)[1].reason  # a graph, but without the end
    moved = points.copy()
    rim = np.argmin(np.abs(points[:, 2]))
    moved[rim] += (0, 0, 1e-3)
    assert verdicts(moved, triangles)[0].status.value == "refuted"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["nozzle", "boss", "on a torus"])
def test_openings_in_any_surface(name, tmp_path):
    """The curve is in no plane where the surface is none of revolution about the cone's axis."""
    blend = pas.blend(OPENINGS[name], 1)
    assert blend.certificate.proved and not blend.fairness.beyond(blend.limits)
    pas.save(blend, tmp_path / "opening.pas.json")
    assert all(finding.proved for finding in check_independently(tmp_path / "opening.pas.json"))
    number = next(i for i, c in enumerate(blend.surface.contacts) if c.clip.degree == 1)
    other = blend.surface.contacts[number]
    elsewhere = str(other.surface * other.clip**2 / 10**6)  # only the opening is met no more
    changed_surface = changed(blend.surface, elsewhere)
    pas.save(replace(blend, surface=changed_surface), tmp_path / "changed.pas.json")
    found = check_independently(tmp_path / "changed.pas.json")[1 : 1 + len(blend.surface.contacts)]
    assert [finding.proved for finding in found] == [c is other for c in blend.surface.contacts]
    surface, contact = blend.surface, blend.surface.contacts[0]
    mesh = surface.mesh(1e-2)
    chain, topology, vertices, near = mesh.certificate.verdicts
    assert chain.proved and topology.proved and near.proved and vertices.status.value == "holds, measured"
    rim = mesh.points[mesh.boundary]
    on_cone = rim[np.abs(contact.clip(rim)) < 1e-9]
    assert len(on_cone) > 12 and np.abs(contact.surface(on_cone)).max() < 1e-9
    assert (contact.clip(mesh.points) < 1e-9).all()
    gradients, wanted = surface.gradient(on_cone), contact.surface.gradient(on_cone)
    assert np.abs(np.cross(gradients, wanted)).max() < 1e-7 * np.linalg.norm(wanted, axis=1).max()
    solid = blend.solid("1/2")
    assert solid.proved and len(solid.verdicts) == 2
    points = np.random.default_rng(0).uniform(*solid.box, (20000, 3))
    q, f = contact.clip(points), contact.surface(points)
    inside = solid.contains(points)
    ahead = points[:, 0] > to_floats(surface.partition.center)[0]
    assert not (inside & (q > 0) & (f > 0) & ~(other.clip(points) > 0)).any()  # around the opening: the neighbour
    assert not (inside & (q < 0) & ahead & (other.clip(points) < 0) & ~surface.contains(points)).any()
    deep = points[:, 0] > solid.box[0, 0] + 1e-6
    assert inside[deep & (q < -1e-9) & surface.contains(points)].all()
    mesh = solid.mesh(2e-2)
    assert mesh.is_closed and (mesh.components, mesh.euler_characteristic) == (1, 2) and mesh.names == solid.faces


def test_surfaces_that_come_back_or_are_grazed_around_their_opening():
    """Across the hole of a torus is its other side; far along its tube rays from inside graze it."""
    f = pas.Torus(Z, (3, 0, 0), 1).contact.surface
    quick = {"energy": pas.ThinPlate(), "prove": False}
    inwards = pas.blend([pas.Opening(f, (-1, 0, 0), "1/2", (3, 0, 0)), pas.Pipe((-1, 0, 0), "1/4", -1)], 1, **quick)
    with pytest.raises(
        pas.GeometryError, match=r"neighbour 1 does not go on .* compose the solid with pas\.solid\.patch"
    ):
        inwards.solid()
    upwards = pas.blend([pas.Opening(f, Z, "1/2", (3, 0, 0)), pas.Pipe(Z, "1/4", 2, (3, 0, 0))], 1, **quick)
    with pytest.raises(pas.GeometryError, match=r"for 3 around its opening; take 0\.75 instead"):
        upwards.solid(3)
    assert upwards.solid().mesh(5e-2).components == 1


LEANING = {
    2: [pas.Plate(Z, 5), pas.Pipe((1, 0, 2), 1, 3, X), pas.Pipe((-1, 0, 2), 1, 3, (-1, 0, 0))],
    3: [
        pas.Plate(Z, 5),
        pas.Pipe((2, 0, 3), 1, 2, X),
        pas.Pipe((-1, 2, 3), 1, 2, ("-1/2", "7/8", 0)),
        pas.Pipe((-1, -2, 3), 1, 2, ("-1/2", "-7/8", 0)),
    ],
    "aside": [pas.Plate(Z, 5), pas.Pipe((2, 0, 3), 1, 2, X), pas.Pipe((1, 2, 3), 1, 2, ("1/2", "3/4", 0))],
}


@pytest.mark.parametrize(("name", "sectors"), [(2, 2), (3, 3), ("aside", 3)])
def test_sectors(name, sectors):
    """One around each contact, and one without where two lie on one side."""
    region = place(LEANING[name], 1).partition
    assert len(region.pieces) == sectors and region.title.endswith(f"and {sectors} sectors")
    assert len(region.interior_faces) == (1 if sectors == 2 else sectors)  # planes
    assert len(region.sides) >= 12


@pytest.mark.parametrize("scale", ["1/1000", "1000"])
def test_the_size_does_not_matter(scale):
    """The regions of a plate and a nozzle so many times as large are as far out, but for how corners are rounded."""
    k = Fraction(scale)
    cases = (
        (UPRIGHT, [pas.Plate(Z, 2 * k), pas.Pipe(Z, k, 2 * k)]),
        (OPENINGS["nozzle"], [pas.Opening(f"x^2 + y^2 - {4 * k * k}", X, "4/7"), pas.Pipe(X, k / 2, 3 * k)]),
    )
    for usual, scaled in cases:
        before, after = (place(items, 1).partition.points for items in (usual, scaled))
        assert after == pytest.approx(before * float(k), abs=0.03 * float(k) * np.abs(before).max())


@pytest.mark.slow
@pytest.mark.parametrize("number", [2, 3])
def test_several_pipes_out_of_one_plate(number):
    blend = pas.blend(LEANING[number], 1, 7)
    assert blend.certificate.proved and not blend.fairness.beyond(blend.limits)
    chain, _, vertices, near = blend.surface.mesh(2e-2).certificate.verdicts
    assert chain.proved and near.proved and vertices.status.value == "holds, measured"


def test_solids(blends):
    solid = blends("upright").solid(1)
    assert solid.proved and len(solid.verdicts) == 2
    assert solid.contains([(0, 0, -0.4), (2.9, 0, -0.1), (0, 0, 2.9)]).all()
    assert not solid.contains([(0, 0, -0.6), (3.1, 0, -0.1), (1.9, 0, 0.5), (0, 0, 3.1)]).any()
    least = np.pi * (9 * 0.5 + 3)  # the slab and the pipe without the fillet
    assert least < solid.volume(2e-2) < least + np.pi * (4 - 1) * 2 / 2
    mesh = solid.mesh(5e-2)
    assert mesh.is_closed and set(mesh.names) == set(solid.faces)


def test_clips_that_are_placed():
    """An arc has as much room along the pipe as on the plate."""
    upright = pas.blend([pas.Plate(Z, 2), pas.Pipe(Z, 1, "auto")], 1).surface.contacts[1]
    assert upright.clip == pas.Polynomial("z - 1")
    along = [pas.Pipe((1, 1, 0), "3/5", 2), pas.Pipe((2, 1, -1), "1/3", "auto"), pas.Plate((2, 1, -1), "3/4")]
    assert with_ends(along, 2)[1].clip == fmpq(11, 64)  # parallel, but for rounding
    leaning = pas.solutions([pas.Plate(Z, 2), pas.Pipe((1, 0, 2), "1/2", "auto")], 1, 5).placed.contacts[1]
    assert leaning.clip.degree == 1


def test_the_same_node_elsewhere():
    """Found among those that are kept: turned, moved and three times as large."""
    with pas.Session(4):
        pas.blend(UPRIGHT, 1)
        again = pas.blend([pas.Plate((0, 1, 0), 6, point=(1, 2, 3)), pas.Pipe((0, 1, 0), 3, 6, (1, 2, 3))], 1)
    assert set(again.timings) == {"repeated"} and again.certificate.proved
    assert again.surface.certify().proved


def test_an_apex_is_found_exactly():
    assert apex(pas.Polynomial("(x - 1)^2 + y^2 - 3*(z + 1/3)^2")) == (fmpq(1), fmpq(0), fmpq(-1, 3))
    assert apex(pas.Polynomial("x^2 + y^2 - 1")) is None and apex(pas.Polynomial("x^2 + y^2 + z^2 - 1")) is None


@pytest.mark.parametrize(
    ("items", "words"),
    [
        ([pas.Plate(Z, 2), pas.Plate(X, 2)], "joins one plate and other contacts, and here are 2 and 0"),
        ([pas.Plate(Z, 2)], "joins one plate and other contacts, and here are 1 and 0"),
        (
            [pas.Plate(Z, 5), pas.Pipe(Z, 1, 4, (2, 0, 0)), pas.Pipe(Z, 1, 4, (-2, 0, 0))],
            "contact 2: .* turns its back",
        ),
        ([*LEANING[2], pas.Pipe(Z, 1, 9)], "contact 4 is seen around the axis of the opening"),
        ([*LEANING[2], LEANING[2][1]], "contacts . and . are seen across one another"),
        ([pas.Plate(Z, 2), pas.Pipe((0, 0, -1), 1, 2)], "contact 2 ends inside the plate of contact 1"),
        ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2, (9, 0, 0))], "contact 2: .* turns its back"),
        ([pas.Plate(Z, 1), pas.Pipe(X, "1/2", "auto")], "contact 2 runs along the plate"),
        ([pas.Plate(Z, 1), pas.Pipe((1, 0, 1), 1, "auto")], "must be wider by 0.4142"),
        ([*OPENINGS["nozzle"], OPENINGS["boss"][0]], "joins it with other contacts, and here are 2 and 1"),
        ([OPENINGS["nozzle"][0], pas.Pipe(X, 1, "auto")], "contact 2 needs a clip that is a number"),
        ([OPENINGS["nozzle"][0], pas.Pipe(X, 6, 9)], "the curve of contact 2 is not seen through that of contact 1"),
        ([OPENINGS["nozzle"][0], pas.Pipe(X, "1/8", 2)], "reaches down to contact 1, and leaves no room"),
        ([pas.Contact("z", "x^2 + y^2 - (z - 1)^2"), pas.Pipe(Z, 1, 2)], "no cone with its apex inside its surface"),
    ],
)
def test_plates_that_cannot_be(items, words):
    with pytest.raises(pas.GeometryError, match=words):
        pas.blend(items, 1)


def test_open_regions_that_cannot_be():
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, -1, 3)]
    with pytest.raises(pas.GeometryError, match="must have a centre"):
        pas.OpenRegion(corners[:4], [(0, 1, 2, 3)])
    with pytest.raises(pas.GeometryError, match="convex cone"):  # two flat wings
        pas.OpenRegion(corners, [(0, 1, 2, 3), (0, 2, 3, 5)], (0, 0, 0))
    with pytest.raises(pas.GeometryError, match="not inside"):
        pas.OpenRegion(corners[:4], [(0, 1, 2, 3)], (5, 5, 5))
