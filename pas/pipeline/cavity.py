"""The cavity of a hollow node: its contacts, where it is looked for, what makes its wall even, and how even one is.

An inner surface is chosen by the outer one's energy and by how far the wall is from its thickness
(`pas.fairing.energies.even_wall`).  It needs a centre of its own where the outer surface passes near the centre of the
outer one, as around sharp bends: from a point less than a thickness inside no inner surface is seen.  That centre lies
further in, in the direction in which the contacts are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from flint import fmpq

from pas.algebra.inputs import HIGHEST_DEGREE
from pas.algebra.rational import Vector, to_float, to_floats
from pas.arrays import Floats
from pas.contacts.contact import Contact
from pas.contacts.joins import Join
from pas.contacts.rims import outlook
from pas.errors import GeometryError
from pas.fairing.basis import to_doubles
from pas.fairing.energies.even_wall import EvenWall, Thickness
from pas.fairing.solver import FitSolver
from pas.fairing.wishes import Wishes
from pas.layouts.discs import power_of_two
from pas.layouts.nodes import ContactNode
from pas.layouts.opened import open_region
from pas.partition.cells import Partition, Region
from pas.partition.layout import Layout
from pas.piecewise import PiecewiseSurface
from pas.pipeline.chosen import B, ChosenBlend
from pas.surface.depth import Depth

Trial: TypeAlias = "tuple[int | None, Partition | Layout]"
"""A degree, None where it is to be found, and a partition to try."""

EVEN = 0.88, 1.2
"""The least and the largest share of its thickness that an even wall has anywhere; others are looked for beside a wall
that is less even."""

SHALLOW, DEEP = 1 / 16, 1 / 8
"""Shares of the smallest inner radius by which a centre is deeper than the thickness: with less it is moved, towards
where it is deeper by the other.  Much deeper, surfaces of GC^2 hollow."""

VISIBLE = 0.1
"""How well all contacts should be seen from such a centre: a pipe of radius r as from a point 0.9 r away from its axis.
With none of it no inner side is found, after many seconds."""

FINE = 32
"""Parts of the smallest inner radius in which centres are moved."""


@dataclass(frozen=True, eq=False)
class Cavity:
    """The task of finding the inner side of an `outer` blend: its `contacts` and the wall's `thickness`, None if
    free."""

    outer: ChosenBlend
    contacts: Sequence[Contact]
    thickness: fmpq | None

    @cached_property
    def evenness(self) -> EvenWall | None:
        """The energy of an uneven wall; None where the outer energy is none of the surface, or has no centre."""
        energy = self.outer.plate
        if self.outer.surface.partition.center is None or not energy.on_surface:
            return None
        depth = Depth(self.outer.surface)
        curves = [self._curve(number) for number in range(len(self.contacts))]
        places = np.array([curve.mean(axis=0) for curve in curves])
        if self.thickness is not None:
            return EvenWall(depth, Thickness(places, np.full(len(places), to_float(self.thickness))))
        values = np.array([depth(curve)[0].mean() for curve in curves])
        return EvenWall(depth, Thickness(places, values)) if values.min() > 0 else None

    def _curve(self, number: int) -> Floats:
        """Points (N, 3) all around the curve in which the inner side meets a contact."""
        contact, join = self.contacts[number], self.outer.surface.joins[number]
        if not join.opening:
            return contact.rim.points()
        frame = self.outer.surface.partition.frame
        inner = Join(Contact(frame.localise(contact.surface), frame.localise(contact.clip)), (), join.partition)
        return frame.global_points(inner.curve())

    @property
    def wishes(self) -> Wishes:
        """What is wished of the inner side: the outer one's energy and limits, and an even wall.

        The outer one's points are not in the inner one.
        """
        energy = self.outer.wishes.energy if self.evenness is None else self.outer.plate + self.evenness
        return Wishes(energy=energy, limits=self.outer.wishes.limits)

    def plain(self, found: B) -> B:
        """An inner blend whose wishes have no energy of an even wall, which files do not keep."""
        choice, wishes = found.choice, self.wishes.changed(energy=self.outer.wishes.energy)
        if self.evenness is None or choice is None:
            return found
        solver = FitSolver(found.space.prepared, wishes.settled(found.surface.placed))
        seen = solver.iterate(to_doubles(choice.working)[0], choice.rows)
        energy = found.energy if seen is None else solver.rounded(seen, choice.share).energy
        return replace(found, energy=energy, wishes=wishes, choice=replace(choice, energy=energy))

    def unevenness(self, inner: PiecewiseSurface) -> float:
        """By what factor the wall's thickness is beyond `EVEN`, at some thousand points: 1 for an even wall."""
        if self.evenness is None:
            return 1.0
        shares = self.evenness.shares(Depth(inner).samples)
        low, high = float(shares.min()), float(shares.max())
        return max(1.0, EVEN[0] / low, high / EVEN[1]) if low > 0 else np.inf

    @cached_property
    def _regions(self) -> list[Partition]:
        """The outer blend's region, and before it one around a deeper centre where its own is not deep enough; at an
        opening one for its cone."""
        own = self.outer.surface.partition
        if own.open:
            return [open_region(self.contacts) if len(own.pieces) == 1 else own]
        return [own] if self._deep_enough else [*self._deeper(), own]

    def trials(self) -> Iterator[Trial]:
        """The regions, layouts and degrees to try, the likeliest first: the outer degree on each region, and the next;
        the outer layout with nearer walls; and where nothing of that is proved, all degrees on each region."""
        own, degree = self.outer.surface.partition, self.outer.surface.degree
        yield from ((degree, region) for region in self._regions)
        if degree < HIGHEST_DEGREE:
            yield degree + 1, self._regions[0]
        if isinstance(own, Region) and not own.open and own.layout is not None:
            yield degree, own.layout
        yield from ((None, region) for region in self._regions)

    @cached_property
    def _radius(self) -> float:
        return min(contact.rim.radii[0] for contact in self.contacts)

    @property
    def _deep_enough(self) -> bool:
        center = self.outer.surface.partition.center
        if self.evenness is None or center is None:
            return True
        depth, thickness = _at(self.evenness, center)
        return (depth - thickness) / self._radius >= SHALLOW

    def _deeper(self) -> Iterator[Partition]:
        """The first region around a centre further in; none where no layout fits."""
        own = self.outer.surface.partition
        if self.evenness is None or own.center is None or not isinstance(own, Region):
            return
        center = self._moved(self.evenness, own.center)
        if center is not None:
            with suppress(GeometryError):
                yield next(ContactNode.of(self.contacts, center).regions(self.outer.surface.order))

    def _moved(self, evenness: EvenWall, center: Vector) -> Vector | None:
        """A centre further in; None where there is none towards the contacts, nor one from which all of them are seen.

        It is the first that is deep enough and sees the contacts well, or the one nearest to both.
        """
        start, radius = np.array(to_floats(center)), self._radius
        off = np.array([to_floats(contact.rim.center) for contact in self.contacts]) - start
        towards = (off / np.linalg.norm(off, axis=1)[:, None]).sum(axis=0)
        length = float(np.linalg.norm(towards))
        if not length > 0:
            return None
        step = power_of_two(radius / FINE)
        most, best = 0.0, None
        for number in range(int(np.linalg.norm(off, axis=1).min() / radius * FINE)):
            shift = number * radius / FINE * towards / length / to_float(step)
            x, y, z = (c + fmpq(round(float(v))) * step for c, v in zip(center, shift, strict=True))
            depth, thickness = _at(evenness, (x, y, z))
            room = depth / (thickness + DEEP * self._radius)  # how deep it is, over how deep a centre should be
            served = min(1.0, room, self._visibility((x, y, z)) / VISIBLE)
            if served > most:
                most, best = served, (x, y, z)
            if served == 1.0:
                break
        return best if best != center else None

    def _visibility(self, center: Vector) -> float:
        """How well the contacts are seen from a point: 1 from their axes, 0 where one of them turns its back."""
        point = np.array(to_floats(center))
        seen = []
        for contact in self.contacts:
            distance = float(np.linalg.norm(np.array(to_floats(contact.rim.center)) - point))
            seen.append(outlook(contact.surface, contact.rim, center)[0] * distance / contact.rim.radii[0])
        return min(seen)


def _at(evenness: EvenWall, place: Vector) -> tuple[float, float]:
    """The depth of a point below the outer surface, and the thickness that the wall is to have there."""
    point = np.array([to_floats(place)])
    return float(evenness.depth(point)[0][0]), float(evenness.thickness(point)[0][0])
