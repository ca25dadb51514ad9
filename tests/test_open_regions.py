"""An open region is closed by exactly one contact, which holds all others; whatever else is in it is not proved."""

from __future__ import annotations

from dataclasses import replace

import pytest

import pas
from pas.independent.checker import check_independently

Z = (0, 0, 1)


@pytest.fixture(scope="module")
def foot():
    return pas.blend([pas.Plate(Z, radius=2), pas.Pipe(Z, 1, clip="auto")], 1)


def forged(foot, tmp_path, contacts, order=1):
    """The surface of a foot with other contacts, and what the second checker says of its file."""
    surface = pas.PiecewiseSurface(foot.surface.partition, contacts, order, foot.surface.patches, foot.surface.degree)
    pas.save(replace(foot, surface=surface), tmp_path / "forged.pas.json")
    return surface, {f.claim: f for f in check_independently(tmp_path / "forged.pas.json")}


def test_a_region_without_its_opening_is_not_enclosed(foot, tmp_path):
    _, pipe = foot.surface.contacts
    surface, found = forged(foot, tmp_path, [pipe])
    enclosed = surface.certificate.enclosed
    assert enclosed.status is pas.Status.REFUTED and "no contact closes the region" in enclosed.reason
    assert surface(enclosed.witness) <= 0
    assert min(abs(side.plane(enclosed.witness)) for side in surface.partition.sides) < 1e-12
    assert found["region"].proved and found["contact 1 GC^1"].proved and found["enclosed"].status == "refuted"


def test_such_a_blend_is_refused_and_so_is_its_solid(foot, tmp_path):
    _, pipe = foot.surface.contacts
    with pytest.raises(pas.GeometryError, match=r"is open: one contact must close it, .* \(0, 0, -1\), and none does"):
        pas.blend([pas.Pipe(Z, 1, clip=1)], 1, partition=foot.surface.partition)
    surface, _ = forged(foot, tmp_path, [pipe])
    with pytest.raises(pas.GeometryError, match="no contact closes it"):
        replace(foot, surface=surface).solid()
    hollow = pas.load(tmp_path / "forged.pas.json")
    assert not hollow.certificate.proved


def test_one_contact_alone_closes_a_region(foot, tmp_path):
    """A second opening, which the surface meets exactly, with a wider cone: what is in use ends at the narrower one."""
    plate, pipe = foot.surface.contacts
    wider = pas.Contact(foot.surface.polynomials[0], "x^2 + y^2 - 41/10*(z + 1)^2")
    surface, found = forged(foot, tmp_path, [plate, wider, pipe])
    certificate = surface.certificate
    assert [verdict.proved for verdict in certificate.contacts] == [False, False, True]
    assert "through another contact" in certificate.contacts[0].reason and not certificate.enclosed.proved
    proved = [found[f"contact {i} GC^1"].proved for i in (1, 2, 3)] + [found["enclosed"].proved]
    assert proved == [False, False, True, False]
    with pytest.raises(pas.GeometryError, match="and contacts 1 and 2 do"):
        pas.solutions([plate, wider, pipe], 1, foot.surface.degree, foot.surface.partition)


def test_an_opening_holds_the_other_contacts(foot, tmp_path):
    """Through a cone that the pipe crosses rays leave the region without meeting the surface: there is no curve."""
    _, pipe = foot.surface.contacts
    narrow = pas.Contact(foot.surface.polynomials[0], "x^2 + 9*y^2 - (z + 1)^2")
    surface, found = forged(foot, tmp_path, [narrow, pipe])
    assert surface.certificate.contacts[1].proved and found["contact 2 GC^1"].proved
    assert "curve of contact 2" in surface.certificate.contacts[0].reason
    assert not surface.certificate.contacts[0].proved and not surface.certificate.enclosed.proved
    assert not found["contact 1 GC^1"].proved and not found["enclosed"].proved


def test_the_honest_foot_stays_proved(foot, tmp_path):
    surface, found = forged(foot, tmp_path, list(foot.surface.contacts))
    assert surface.certificate.proved and all(f.proved for f in found.values())
