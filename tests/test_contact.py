"""Contacts and pipes."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pas
from pas import Contact, Pipe, Polynomial


def test_a_pipe_along_x():
    pipe = Pipe(axis=(1, 0, 0), radius="1/3", clip=1)
    assert pipe.contact == Contact("y^2 + z^2 - 1/9", "x - 1")


def test_a_pipe_of_any_rational_axis_is_rational_and_circular():
    pipe = Pipe(axis=(1, 2, -2), radius="1/4", clip="2/3", point=(1, 0, "1/2"))
    rng = np.random.default_rng(3)
    axis, point = np.array([1, 2, -2.0]), np.array([1, 0, 0.5])
    x = rng.normal(size=(50, 3))
    along = (x - point) @ axis / 9
    distance = np.linalg.norm(x - point - along[:, None] * axis, axis=1)
    assert pipe.contact.surface(x) == pytest.approx(distance**2 - 1 / 16)
    assert pipe.contact.clip(point + 2 / 3 * axis) == pytest.approx(0)
    assert pipe.contact.clip.at(pipe.point) < 0


def test_a_pipe_clipped_backwards_has_its_point_on_the_blends_side():
    assert Pipe((0, 0, 1), 1, -2).contact == Contact("x^2 + y^2 - 1", "-z - 2")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"radius": 0}, ValueError, "radius must be positive"),
        ({"radius": "-1/3"}, ValueError, "radius must be positive, not -1/3"),
        ({"radius": math.nan}, ValueError, "radius must be finite"),
        ({"radius": math.inf}, ValueError, "radius must be finite"),
        ({"radius": "a third"}, ValueError, "radius is not a rational number"),
        ({"radius": None}, TypeError, "radius must be a number"),
        ({"radius": True}, TypeError, "radius"),
        ({"axis": (0, 0, 0)}, ValueError, "axis must not be the zero vector"),
        ({"axis": (1, 0)}, ValueError, "axis must be three numbers, not 2"),
        ({"axis": "x"}, TypeError, "axis must be three numbers"),
        ({"axis": (1, math.nan, 0)}, ValueError, r"axis\[1\] must be finite"),
        ({"clip": "1/0"}, ValueError, "clip divides by zero"),
        ({"point": (0, 0, None)}, TypeError, r"point\[2\]"),
    ],
)
def test_bad_pipes(arguments, error, words):
    with pytest.raises(error, match=words):
        Pipe(**({"axis": (1, 0, 0), "radius": 1, "clip": 1} | arguments))


@pytest.mark.parametrize(
    ("surface", "clip", "words"),
    [
        (0, "x", "surface of a contact must be a polynomial that is not constant"),
        ("x^2+y^2-1", 3, "clip of a contact"),
        ("(x-1)*(y^2+z^2-1)", "x - 1", "common factor x - 1"),
    ],
)
def test_bad_contacts(surface, clip, words):
    with pytest.raises(ValueError, match=words):
        Contact(surface, clip)


def test_contacts_are_values():
    a = Contact("x^2+y^2-1", "z-1")
    assert a == Contact(Polynomial("y^2+x^2-1"), "z - 1")
    assert hash(a) == hash(Contact("x^2+y^2-1", "z-1"))
    with pytest.raises(AttributeError):
        a.clip = Polynomial("z")
    assert pas.Pipe((0, 0, 1), 1, 1).contact == a
