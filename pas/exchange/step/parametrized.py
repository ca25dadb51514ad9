"""Surfaces that have parameters of their own, in a solid's local coordinates, and walls at which one has a value.

They are tubes about curves, flanks of threads, parametric surfaces, and Dupin cyclides, which are told from their
polynomials: with half axes a > b of the ellipse of the balls' centres, c^2 = a^2 - b^2, and radii m - c cos u, in
their own axes f = (x^2 + y^2 + z^2 - m^2 + b^2)^2 - 4 (a x - c m)^2 - 4 b^2 y^2, up to a factor (Forsyth 1912).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine
from pas.algebra.lengths import unit
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import UNITS, three, to_float, to_floats
from pas.arrays import Floats, Integers
from pas.exchange.step.carriers import Carrier, CarrierKind, Plane, carrier_of
from pas.solid.field import SolidField
from pas.solid.functions import Distance, Moved, Parametrized

Map = Callable[[Floats], Floats]
"""A map of points (N, 3)."""


@dataclass(frozen=True, eq=False)
class PlacedSurface:
    """A surface with parameters (N, 2), whose unit is about that of length; maps from and to local coordinates."""

    given: Parametrized
    inward: Map
    outward: Map
    unit: Floats

    @classmethod
    def near(cls, points: Floats, given: Parametrized, inward: Map, outward: Map) -> PlacedSurface:
        """A surface near points (N, 3), with units in which parameters change as lengths do there."""
        places = given.places(inward(points))
        step = np.diag(1e-5 * np.maximum(np.ptp(places, axis=0), 1e-300))
        by = [outward(given.at(places + s)) - outward(given.at(places - s)) for s in step]
        rise = np.array([np.linalg.norm(d, axis=1).mean() for d in by])
        return cls(given, inward, outward, rise / (2 * step.sum(axis=0)))

    def places(self, points: Floats) -> Floats:
        """The parameters (N, 2) of its points next to points (N, 3)."""
        return self.given.places(self.inward(points)) * self.unit

    def unwound(self, places: Floats, start: Floats) -> Floats:
        """Parameters (N, 2), those that return from `start` (2,) on."""
        turned = self.periods > 0
        turns = (places - start) // np.where(turned, self.periods, 1.0)
        return np.asarray(places - np.where(turned, turns * self.periods, 0.0))

    def at(self, places: Floats) -> Floats:
        """Its points (N, 3) with parameters (N, 2)."""
        return self.outward(self.given.at(places / self.unit))

    def slopes(self, places: Floats) -> Floats:
        """Derivatives (2, N, 3) by both parameters, to 1e-9."""
        step = 1e-5
        return np.stack([(self.at(places + s) - self.at(places - s)) / (2 * step) for s in step * np.eye(2)])

    @property
    def domain(self) -> Floats:
        """The ends (2, 2) of parameters that do not return."""
        return np.asarray(self.given.domain * self.unit[:, None])

    @property
    def periods(self) -> Floats:
        """After how much parameters (2,) return, 0 where they do not."""
        return np.asarray(self.given.periods * self.unit)

    def ends(self, points: Floats) -> Integers:
        """At which end of the first parameter points (N, 3) are, 0 or 1, or -1 (N,)."""
        at = self.given.places(self.inward(points))[:, :1] == self.given.domain[0]
        return np.where(at.any(axis=1), at.argmax(axis=1), -1)

    def caps(self) -> list[tuple[Plane, Carrier]]:
        """The balls in which it ends, beyond planes."""
        found = []
        for center, way, radius in self.given.caps:
            place, tip = self.outward(np.stack([center, center + radius * way]))
            far = float(np.linalg.norm(tip - place))
            axis = (tip - place) / far
            found.append((Plane.of(axis, float(axis @ place)), Carrier(CarrierKind.SPHERE, place, axis, far)))
        return found


@dataclass(frozen=True, eq=False)
class ParameterWall:
    """The points for which one of a surface's parameters has a value, or half a period more."""

    surface: PlacedSurface
    axis: int
    value: float

    def heights(self, points: Floats) -> Floats:
        """About how far points (..., 3) near the surface are beyond it (...)."""
        turn = 2 * np.pi / self.surface.periods[self.axis]
        along = self.surface.places(points.reshape(-1, 3))[:, self.axis].reshape(points.shape[:-1])
        return np.asarray(np.sin(turn * (along - self.value)) / turn)

    def jets(self, points: Floats) -> Floats:
        """Heights and their gradients (N, 4) at points (N, 3), the latter those on the surface."""
        places = self.surface.places(points)
        by = self.surface.slopes(places)
        rising = np.cross(by[1 - self.axis], np.cross(by[self.axis], by[1 - self.axis]))
        rising /= np.maximum((rising * by[self.axis]).sum(axis=1, keepdims=True), 1e-300)
        turn = 2 * np.pi / self.surface.periods[self.axis]
        angle = turn * (places[:, self.axis] - self.value)
        return np.concatenate([np.sin(angle)[:, None] / turn, np.cos(angle)[:, None] * rising], axis=1)


Wall = Plane | ParameterWall


def surface_of(field: SolidField, column: int, points: Floats) -> Carrier | PlacedSurface | None:
    """The surface on which the zeros of a column of a field are near points (N, 3); all in local coordinates."""
    polynomial, function = field.evaluator.polynomial(column), field.evaluator.columns[column].function
    if polynomial is not None:
        return carrier_of(polynomial) or _cyclide(polynomial, points)
    map_ = Affine(UNITS, three((fmpq(0),) * 3))
    while isinstance(function, Moved):
        map_ = map_.after(function.map)
        function = function.inner
    if isinstance(function, Distance) and function.plane is not None:
        place, tip = field.evaluator.local(map_.points(np.stack([function.plane[0], np.sum(function.plane, axis=0)])))
        return Carrier(CarrierKind.PLANE, place, unit(tip - place))
    if not isinstance(function, Parametrized):
        return None
    return PlacedSurface.near(
        points,
        function,
        lambda p: map_.inverse.points(field.world(p)),
        lambda p: field.evaluator.local(map_.points(p)),
    )


@dataclass(frozen=True)
class Cyclide(Parametrized):
    """A Dupin cyclide in its own axes, by the angles around the ellipse of half axes a > b, and around the balls."""

    a: float
    b: float
    m: float

    domain, periods = np.array([(0.0, 2 * np.pi)] * 2), np.full(2, 2 * np.pi)

    @property
    def c(self) -> float:
        """Half the distance of the foci."""
        return float(np.sqrt(self.a**2 - self.b**2))

    def places(self, points: Floats) -> Floats:
        """Both angles (N, 2); each has its circle in a plane of a pencil."""
        x, y, z = points.T
        ahead, aside, behind = self.a * x - self.c * self.m, self.b * y, self.c * x - self.a * self.m
        u = np.arctan2(aside, ahead)
        share = (self.c * np.cos(u) - self.m) / behind * np.hypot(ahead, aside)
        return np.stack([u, np.arctan2(self.b * z / behind, (self.a - share) / self.m)], axis=1)

    def at(self, places: Floats) -> Floats:
        a, b, c, m = self.a, self.b, self.c, self.m
        (p, q), (s, t) = np.cos(places).T, np.sin(places).T
        found = m * (c - a * p * q) + b * b * p, b * s * (a - m * q), b * t * (c * p - m)
        return np.asarray(np.stack(found, axis=1) / (a - c * p * q)[:, None])


def _cyclide(polynomial: Polynomial, points: Floats) -> PlacedSurface | None:
    """The Dupin cyclide of a polynomial, near whose points (N, 3) it is; None where it is none, to rounding."""
    top, least = polynomial.raw.to_dict().get((4, 0, 0), fmpq(0)), 1e-9
    if polynomial.degree != 4 or top == 0:
        return None
    cubes = [polynomial.raw.to_dict().get(e, fmpq(0)) for e in ((3, 0, 0), (2, 1, 0), (2, 0, 1))]
    center = [-value / top / 4 for value in cubes]
    moved = polynomial.compose(*(Polynomial.from_raw(g + s) for g, s in zip(GENERATORS, center, strict=True)))
    raw = {e: to_float(value / top) for e, value in moved.raw.to_dict().items()}
    form = np.zeros((3, 3))
    for i, j in ((i, j) for i in range(3) for j in range(3)):
        form[i, j] = raw.get(tuple(np.eye(3, dtype=int)[[i, j]].sum(axis=0).tolist()), 0.0) / (2 - (i == j))
    sizes, ways = np.linalg.eigh(form)
    axes = ways.T * np.sign(ways.T @ [raw.get(e, 0.0) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))] + least)[:, None]
    squares = np.array([sizes[2] - sizes[0], sizes[2] - sizes[1], -sizes[2] - sizes[1]]) / 4
    if not squares[0] - squares[1] > least * squares[0] or squares.min() <= 0:
        return None
    place = np.array(to_floats(center))
    found = Cyclide(*np.sqrt(squares).tolist())
    surface = PlacedSurface.near(points, found, lambda p: (p - place) @ axes.T, lambda p: p @ axes + place)
    there = surface.at(surface.places(points))
    slopes = np.linalg.norm(polynomial.gradient(there), axis=1)
    return surface if (np.abs(polynomial(there)) <= least * slopes).all() else None
