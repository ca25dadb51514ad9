"""Discs: contacts as they are seen from the centre of a node, and the pieces of layouts that hold them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from math import degrees, pi

import numpy as np
from flint import fmpq

from pas.algebra.lengths import across, unit
from pas.algebra.rational import Vector, binary_exponent, dot, exact, minus, three, to_float, to_floats
from pas.arrays import Floats
from pas.contacts.contact import Movable
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.partition.layout import Layout, Ray


@dataclass(frozen=True, eq=False)
class Disc:
    """One contact's curve: all relative to the centre, in the user's units.

    It lies in the plane `normal . x = height`, both exact, with `normal` pointing outwards and `height` positive;
    `points` (m, 3) go round it, `middle` (3,) is inside it.
    """

    number: int
    normal: Vector
    height: fmpq
    points: Floats
    middle: Floats

    @classmethod
    def of(cls, number: int, rim: Rim, center: Vector) -> Disc:
        """The disc of contact `number` (from 1); raises `GeometryError` where the centre lies in its plane."""
        height = dot(rim.normal, minus(rim.center, center))
        if height == 0:
            raise GeometryError(
                f"the clip plane of contact {number} passes through the centre of the node; it must leave room for "
                "the blend"
            )
        x, y, z = rim.normal if height > 0 else (-c for c in rim.normal)
        origin = to_floats(center)
        curve_points = 96  # points of a contact's curve by which a layout is fitted to it
        points, middle = np.asarray(rim.points(curve_points)), np.array(to_floats(rim.center))
        return cls(number, (x, y, z), abs(height), points - origin, middle - origin)

    @cached_property
    def unit(self) -> Floats:
        """The unit normal (3,)."""
        return unit(to_floats(self.normal))

    @cached_property
    def direction(self) -> Floats:
        """The unit vector (3,) towards the middle."""
        return unit(self.middle)

    @cached_property
    def angle(self) -> float:
        """The angle (radians) between that direction and the farthest point of the curve: its angular radius."""
        return float(np.arccos(np.clip(unit(self.points) @ self.direction, -1, 1)).max())

    @cached_property
    def radius(self) -> float:
        """The largest distance of the curve from its middle."""
        return float(np.linalg.norm(self.points - self.middle, axis=1).max())

    @cached_property
    def distance(self) -> float:
        """From the centre to the middle."""
        return float(np.linalg.norm(self.middle))

    @property
    def frame(self) -> Floats:
        """Two unit vectors (2, 3) across the direction, which with it are right-handed."""
        return across(self.direction)

    def azimuths(self, vectors: Sequence[Floats] | Floats) -> Floats:
        """The azimuths of vectors (N, 3) around the direction, (N,)."""
        first, second = self.frame
        found = np.asarray(vectors)
        return np.arctan2(found @ second, found @ first)

    def on_plane(self, place: Floats) -> Vector:
        """An exact point of the plane near a place (3,) of it, with short numbers."""
        normal = self.normal
        axis = max(range(3), key=lambda i: abs(to_float(normal[i])))
        step = power_of_two(self.radius / 64)
        point = list(rounded(place, step))
        rest = sum((normal[i] * point[i] for i in range(3) if i != axis), fmpq(0))
        point[axis] = (self.height - rest) / normal[axis]
        return three(point)


def rim_of(number: int, contact: Movable) -> Rim:
    """The curve of contact `number` (from 1); raises `GeometryError` with that number where there is none."""
    try:
        return contact.rim
    except GeometryError as error:
        raise GeometryError(f"contact {number}: {error}") from None


def first_made(ways: Iterable[Callable[[], Layout]]) -> Layout:
    """The first layout that can be made; raises the last one's `GeometryError` where none can."""
    *others, last = ways
    for make in others:
        with suppress(GeometryError):
            return make()
    return last()


def check_fits(layout: Layout, discs: Sequence[Disc]) -> list[int]:
    """The piece that holds each disc; raises `GeometryError` for a disc in none, or two in one."""
    normals = [sides([layout.rays[i] for i in piece]) for piece in layout.pieces]
    found: list[int] = []
    for disc in discs:
        towards = unit(disc.points).T
        here = [p for p, inwards in enumerate(normals) if (inwards @ towards).min() > 0]
        if len(here) != 1:
            direction = ", ".join(f"{c:.3g}" for c in disc.direction)
            raise GeometryError(
                f"the curve of contact {disc.number} fits in no piece of the layout ({layout.name}): it is seen "
                f"{degrees(disc.angle):.3g} degrees wide around ({direction})"
            )
        if here[0] in found:
            raise GeometryError(
                f"contacts {discs[found.index(here[0])].number} and {disc.number} lie in one piece of the layout "
                f"({layout.name}); each needs a piece of its own"
            )
        found.append(here[0])
    return found


def room(layout: Layout, piece: int, disc: Disc) -> float:
    """The least angle (radians) between a disc's curve and the planes of a piece's sides, negative where it is outside.

    That is right for convex pieces; of others it is at most the truth.
    """
    sines = sides([layout.rays[i] for i in layout.pieces[piece]]) @ unit(disc.points).T
    return float(np.arcsin(np.clip(sines.min(), -1, 1)))


def sides(rays: Sequence[Ray] | Floats) -> Floats:
    """The unit normals (N, 3), inwards, of the planes of a piece's sides."""
    around = np.array(rays, dtype=float)
    return unit(np.cross(around, np.roll(around, -1, axis=0)))


def turn(start: float, end: float) -> float:
    """The angle (radians, 0 up to 2 pi) from one azimuth on to another."""
    return float((end - start) % (2 * pi))


def power_of_two(size: float) -> fmpq:
    """The largest power of two up to a positive number."""
    return fmpq(2) ** binary_exponent(exact(size))


def rounded(place: Sequence[float] | Floats, step: fmpq) -> Vector:
    """The exact point next to a place (3,), in whole multiples of a step."""
    return three(fmpq(round(float(c) / to_float(step))) * step for c in place)


def whole_ray(direction: Floats, largest: int) -> tuple[int, int, int]:
    """A short whole vector near a direction (3,), with entries up to `largest`: longer ones must be nearer.

    Short ones keep the numbers of the exact algebra short.
    """
    wanted = unit(direction)
    price = 0.003 if largest <= 16 else 0.0004
    sizes = np.arange(1, largest + 1)
    near = np.round(wanted / np.abs(wanted).max() * sizes[:, None])
    aside = np.linalg.norm(np.cross(near, wanted), axis=1)
    worth = np.arctan2(aside, near @ wanted) + price * sizes
    best = near[int((worth < worth.min() + 1e-12).argmax())].astype(int)
    return three((best // np.gcd.reduce(best)).tolist())
