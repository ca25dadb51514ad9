"""Nodes of lattices, and those at their boundary: full planes that follow the symmetry of a cube, proved and fair."""

from itertools import product
from math import hypot

import numpy as np
import pytest

import pas
from pas.contacts.contact import as_contact
from pas.layouts.nodes import ContactNode
from pas.layouts.planes import ORBITS, arrangement, axes_of_cube, has_whole_planes, have_room, planes
from pas.partition.layout import reduced

CUBIC = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
BCC = list(product((1, -1), repeat=3))
OCTET = [d for d in product((1, 0, -1), repeat=3) if sum(map(abs, d)) == 2]
DIAMOND = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
KELVIN = [(1, 1, 0), (-1, 1, 0), (0, -1, 1), (0, -1, -1)]
TURNED = ((1, 2, 2), (2, 1, -2), (2, -2, 1))
"""Three perpendicular vectors of length 3."""


def inside(directions, *axes):
    """Those that are left at a boundary across some axes."""
    return [d for d in directions if all(d[axis] >= 0 for axis in axes)]


NODES = {
    "cubic 6": CUBIC,
    "cubic 5": inside(CUBIC, 2),
    "cubic 4": inside(CUBIC, 1, 2),
    "BCC 8": BCC,
    "BCC 4": inside(BCC, 2),
    "octet 12": OCTET,
    "octet 8": inside(OCTET, 2),
    "octet 5": inside(OCTET, 1, 2),
    "octet 3": inside(OCTET, 0, 1, 2),
    "diamond 4": DIAMOND,
    "Kelvin 4": KELVIN,
    "cross": CUBIC[:4],
}


def struts(name, slenderness, order=1):
    """The struts of a node with a radius of 1, which end where that is so many times twice as far from the centre."""
    ends = [(d, round(512 / slenderness / hypot(*d))) for d in NODES[name]]
    return pas.struts([(d, 1, f"{end}/1024") for d, end in ends], order)


def node(contacts):
    return ContactNode.of([as_contact(c) for c in contacts])


def turned(direction):
    return tuple(sum(c * axis[i] for c, axis in zip(direction, TURNED, strict=True)) for i in range(3))


def check_fair(name, order, slenderness, title):
    blend = pas.blend(struts(name, slenderness, order), order)
    assert blend.certificate.proved
    assert blend.fairness.beyond(blend.limits) == ()
    assert blend.surface.partition.title == title


FAIR = [
    ("cubic 4", 1, 0.25, "4 planes"),
    ("cubic 5", 1, 0.25, "4 planes"),
    ("cubic 6", 1, 0.32, "4 planes"),
    ("BCC 8", 1, 0.24, "3 planes"),
    ("BCC 4", 1, 0.20, "3 planes"),
    ("octet 5", 1, 0.14, "6 planes"),
]

SLOWLY = [
    ("octet 12", 1, 0.15, "6 planes"),
    ("octet 8", 1, 0.14, "6 planes"),
    ("cubic 6", 2, 0.29, "4 planes"),
    ("cubic 5", 2, 0.25, "4 planes"),
    ("cubic 4", 2, 0.25, "4 planes"),
    ("BCC 8", 2, 0.20, "3 planes"),
    ("BCC 8", 2, 0.12, "3 planes"),
    ("BCC 4", 2, 0.16, "3 planes"),
    ("octet 12", 2, 0.12, "6 planes"),  # of 8 unknowns alone
    ("octet 5", 2, 0.12, "6 planes"),
]


@pytest.mark.parametrize(("name", "order", "slenderness", "title"), FAIR)
@pytest.mark.sampled(10)
def test_thick_struts_of_lattices_are_fair(name, order, slenderness, title):
    check_fair(name, order, slenderness, title)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "order", "slenderness", "title"), SLOWLY)
def test_more_thick_struts_of_lattices_are_fair(name, order, slenderness, title):
    check_fair(name, order, slenderness, title)


@pytest.mark.parametrize(
    ("name", "slenderness"),
    [("cubic 6", 0.25), ("cubic 5", 0.25), ("BCC 8", 0.18), ("BCC 4", 0.18), ("octet 12", 0.145)],
)
def test_clips_are_placed_as_near_as_planes_leave_room(name, slenderness):
    contacts = pas.struts([(d, 1) for d in NODES[name]], 1)
    far = max(float(c.clip) * hypot(*map(float, c.axis)) for c in contacts)
    assert 1 / (2 * far) >= slenderness
    assert have_room(node(contacts).discs)


@pytest.mark.parametrize("name", ["octet 3", "diamond 4", "Kelvin 4", "cross"])
def test_others_keep_their_fans(name):
    contacts = pas.struts([(d, 1) for d in NODES[name]], 1)
    assert not have_room(node(contacts).discs)


@pytest.mark.parametrize("name", NODES)
def test_the_cube_is_found_however_it_is_turned(name):
    for directions in (NODES[name], [turned(d) for d in NODES[name]]):
        axes = axes_of_cube([reduced(d) for d in directions])
        assert (axes * axes.transpose()).tolist() == np.eye(3, dtype=int).tolist()
        for direction in directions:
            entries = [sum(a * c for a, c in zip(row, direction, strict=True)) for row in axes.tolist()]
            assert len({abs(e) for e in entries if e}) == 1


@pytest.mark.parametrize(
    "directions",
    [
        [(1, 0, 0), (-1, 0, 0)],
        [(1, 0, 0), (0, 1, 0), (1, 2, 2)],
        [(1, 0, 0), (0, 1, 0), (0, 1, 3), (0, 0, 1)],
        [(1, 1, 0), (1, 0, 1), (1, -1, 4)],
    ],
)
def test_directions_of_no_cube(directions):
    assert axes_of_cube(directions) is None


def test_a_turned_lattice_has_the_same_planes():
    contacts = pas.struts([(turned(d), 1, "2/5") for d in BCC], 1)
    layout = planes(node(contacts).discs, (0, 0, 0), ORBITS[0])
    assert {tuple(map(abs, ray)) for ray in layout.rays} == {tuple(map(abs, axis)) for axis in TURNED}


def test_a_curve_is_clear_of_planes_by_a_degree_and_a_half():
    # planes across the cube's diagonals are 35.26 degrees off its axes
    assert have_room(node(struts("cubic 6", 0.332)).discs)  # 33.6 degrees
    assert not have_room(node(struts("cubic 6", 0.337)).discs)  # 34.0


def test_whole_planes_are_told_from_half_planes():
    assert has_whole_planes(arrangement([(1, 0, 0), (0, 1, 0), (0, 0, 1)], (0, 0, 0)))
    for kind in ("fan", "strips"):
        layout = next(node(struts("cross", 0.2)).regions(1, kind)).layout
        assert not has_whole_planes(layout)
