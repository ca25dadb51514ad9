"""Cones as contacts."""

from __future__ import annotations

import pytest

import pas

CONE = {"axis": (1, 0, 0), "radius": "1/3", "clip": 1, "slope": "1/10"}


def test_a_cone_is_what_it_says():
    cone = pas.Cone(axis=(0, 0, 2), radius="1/2", clip="3/2", slope="1/4", point=(1, 0, 0))
    surface, clip = cone.contact.surface, cone.contact.clip
    assert clip == pas.Polynomial("z/2 - 3/2")
    for length, radius in ((1.5, 0.5), (2.5, 0.75), (0.5, 0.25), (-0.5, 0.0)):
        assert surface.at((1 + radius, 0, 2 * length)) == 0
        assert surface.at((1, radius, 2 * length)) == 0
    assert surface.at((1, 0, 3)) < 0
    assert pas.Cone((1, 2, 0), 1, 1, 0).contact == pas.Pipe((1, 2, 0), 1, 1).contact or (
        pas.Cone((1, 2, 0), 1, 1, 0).contact.surface == pas.Pipe((1, 2, 0), 1, 1).contact.surface
    )
    for wrong, words in (({"axis": (0, 0, 0)}, "axis"), ({"radius": 0}, "radius must be positive")):
        with pytest.raises(ValueError, match=words):
            pas.Cone(**(CONE | wrong))


@pytest.mark.parametrize("order", [1, 2])
def test_cones_and_pipes_blend(order):
    contacts = [
        pas.Cone(axis=(1, 0, 0), radius="1/3", clip=1, slope="1/10"),
        pas.Cone(axis=(0, 1, 0), radius="1/3", clip=1, slope="-1/20"),
        pas.Pipe(axis=(0, 0, 1), radius="1/3", clip=1),
    ]
    corner = pas.SixTetrahedra((0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    blend = pas.blend(contacts, order, partition=corner, energy=pas.ThinPlate())
    assert blend.certificate.proved


def test_a_pipe_and_a_cone_make_an_elbow():
    cone = pas.Cone(axis=(0, 1, 0), radius="1/3", slope="1/10", clip=1)
    blend = pas.blend([pas.Pipe((1, 0, 0), "1/3", 1), cone], 1, limits=pas.FairnessLimits(2, 3, 1, 1))
    assert blend.certificate.proved and blend.attempts[-1].outcome == "proved, fair"
    assert blend.fairness.area > 2  # it is seen all over


def test_cones_make_a_corner_like_pipes():
    """Without a partition: the corner is where the axes meet, not the cones' tips."""
    cones = [
        pas.Cone(axis=(2, 0, 0), radius="1/3", clip="1/2", slope="1/10", point=(5, 1, 0)),
        pas.Cone(axis=(0, 1, 0), radius="1/3", clip=1, slope="-1/20", point=(5, 1, 0)),
        pas.Pipe(axis=(0, 0, 1), radius="1/3", clip=1, point=(5, 1, 0)),
    ]
    blend = pas.blend(cones, 1, energy=pas.ThinPlate())
    assert blend.surface.partition.vertices == pas.SixTetrahedra((5, 1, 0)).vertices
    assert blend.certificate.proved
    wide = pas.Cone(axis=(0, 1, 0), radius="4/5", clip=1, slope=0, point=(5, 1, 0))
    with pytest.raises(pas.GeometryError, match="its circle of radius 4/5 does not fit"):
        pas.blend([cones[0], wide, cones[2]], 1, partition=pas.SixTetrahedra((5, 1, 0)))
