"""The part of a solid around the opening of a region: a piece of the neighbour out of which the blend rises.

The piece is bounded by an edge and by a flat back between the opening and the region's centre.  Of a plate it is a
slab: the edge is the cylinder across the plate through a curve that is wider than the opening.  Of other surfaces the
edge is a wider cone with the same apex, which rays cross at an angle.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from flint import fmpq

from pas.algebra.affine import height, slope_at
from pas.algebra.lengths import unit
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, exact, exact_vector, minus, moved, three, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.arrays import Floats
from pas.contacts.cones import FARTHEST, first_met, nappe, nappe_rays
from pas.contacts.ends import ContactEnd, triple
from pas.errors import GeometryError
from pas.layouts.discs import rounded
from pas.piecewise import PiecewiseSurface
from pas.pipeline.neighbours import is_left_once
from pas.solid.faces import End
from pas.solid.solid import Solid, patch
from pas.solid.strips import Chain, Outwards, SolidStrip, Straight

AtOpening: TypeAlias = "tuple[list[tuple[Polynomial, str]], Solid | None]"
"""The faces that bound a blend at an opening, with names, and the piece of the neighbour there, if there is one."""

AROUND, OUTWARDS, ALONG = 48, 12, 256
"""Rays round an opening and between it and the edge, and places on each, by which surfaces are looked through."""

GRAZING, PARTS = 0.5, 8
"""The least cosine between such rays and the surface's normals, and how often a distance is halved at most: edges that
graze the surface leave feathers, which are hard to mesh."""

HIGHER, BEYOND = 1.2, 1.05
"""How much higher than where rays leave the surface it ends at last, and how much wider than the edge what is looked at
is."""

WITHIN = 0.99
"""Of a height: the one at which what is looked at begins below the back, and at which the piece ends below its top."""

FINE = 2**20
"""Parts of a unit in which an axis and heights are rounded that are given by no plane: too fine to be seen."""


class AroundOpening:
    """The opening of a surface through contact `number` (from 0), as it is seen along its `axis`, outwards.

    Heights are `axis . (x - center)`, and `low` is the least one of its curve.  `middle` is that of a plate's curve,
    the centre of others, and `radius` the smallest one of the curve round the axis, in the model's units.
    """

    def __init__(self, surface: PiecewiseSurface, number: int) -> None:
        self.surface, self.number, self.join = surface, number, surface.joins[number]
        self.contact, self.frame = surface.contacts[number].scaled, surface.partition.frame
        self.center = self.middle = self.frame.origin
        if self.flat:
            rim, plate = self.contact.rim, self.contact.surface
            self.axis, self.low = slope_at(plate), -plate.raw(*self.center)
            self.middle, self.radius = rim.center, exact(rim.radii[0])
            return
        length, *widths = np.linalg.norm(self.join.nappe, axis=1).tolist()
        heights = self.join.curve() @ (self.join.nappe[0] / length)
        self.low, high = (round(float(h) * FINE) * self.frame.scale / FINE for h in (heights.min(), heights.max()))
        self.axis = three(fmpq(round(float(c) / length * FINE), FINE) for c in self.join.nappe[0])
        self.radius = high * exact(min(widths) / length)

    @classmethod
    def of(cls, surface: PiecewiseSurface) -> AroundOpening | None:
        """The opening of a surface's region; None for a closed region."""
        return next((cls(surface, number) for number, join in enumerate(surface.joins) if join.opening), None)

    def even(self, thickness: fmpq) -> Polynomial | None:
        """The clip of the inner side of an even wall, None if it is the outer one: a cone half way between the
        narrowest and the widest one through the curve moved inwards along normals by the thickness, never narrower."""
        parts = fmpq(1, 64)  # of the width and the axis, in which these are rounded where they are not exact
        axis = self.axis if self.flat else rounded(to_floats(self.axis), parts)
        slopes, up = self.contact.surface.gradient(self.curve), np.array(to_floats(axis))
        deep = self.curve - to_float(thickness) * slopes / np.linalg.norm(slopes, axis=1)[:, None]
        raised = Straight(-self.contact.clip, np.array([*up, 0.0]))(deep, 1.0)
        shares = 1 + (raised - deep) @ up / ((deep - to_floats(self.center)) @ up)
        wide = round(float(shares.min() + shares.max()) / (2 * to_float(parts))) * parts
        if not wide > 1:
            return None
        higher = (wide - 1) / dot(axis, axis) * height(self.center, axis)
        return Polynomial.from_raw(
            self.contact.clip.raw.compose(*(g + a * higher for g, a in zip(GENERATORS, axis, strict=True)))
        )

    @property
    def flat(self) -> bool:
        """Whether the contact is a plate."""
        return self.contact.surface.degree == 1

    def at(self, level: fmpq) -> Polynomial:
        """The plane at a height, positive below."""
        return Polynomial.from_raw(level - height(self.center, self.axis))

    def level(self, reach: fmpq) -> fmpq:
        """The flat back's height: `reach` below the opening, at least half the opening's height; half of it for 0."""
        size = exact(float(np.linalg.norm(to_floats(self.axis))))
        depth = self.low / 2
        return self.low - (min(reach * size, depth) if reach > 0 else depth)

    def fitting(self, reach: fmpq, shorter: bool) -> fmpq:
        """The width of the neighbour's ring around the opening: `reach`, or if it may be `shorter` less.

        Of a plate it is always `reach`.  Raises `GeometryError` where rays between the opening and the edge do not
        cross the surface transversally, by samples.
        """
        if self.flat or reach == 0:
            return reach
        wanted = min(reach, self.radius / 2) if shorter else reach
        works = next((part for n in range(PARTS) if self.leave(self.wide(part := wanted / 2**n))), None)
        if works is None or (works != reach and not shorter):
            advice = "compose the solid with pas.solid.patch" if works is None else f"take {to_float(works):.4g}"
            raise GeometryError(
                f"neighbour {self.number + 1} does not go on as one sheet, seen from within, for {to_float(reach):.4g} "
                f"around its opening; {advice} instead; of a straight run pas.header gives the whole"
            )
        return works

    def ended(self, name: str, level: fmpq, works: fmpq, endless: bool = False) -> AtOpening:
        """The blend's boundary at the opening, and the neighbour's ring of width `works`, or without an outer edge.

        Raises `GeometryError` where it is not proved that each ray crosses the surface once.
        """
        given, back = self.surface.contacts[self.number], self.at(level)
        piece = patch(name, given.surface, given.clip).cap(back, f"{name} back") if works > 0 else None
        if piece is not None and not endless:
            piece = (piece if self.flat else self._apart(piece, level, works)).cap(self.edge(works), f"{name} end")
        return [(back, f"{name} back"), (given.clip, "")], piece

    def chain(self, name: str, level: fmpq, works: fmpq) -> Chain:
        """The boundary of a solid from the opening on: a ring called `name` of width `works` in the neighbour, the edge
        down to the flat back, and that; for a width of 0 the cone of the opening down to the back."""
        back, length = scaled(self.at(level)), float(np.linalg.norm(to_floats(self.axis)))
        down, clip = -np.array(to_floats(self.axis)) / length, self.contact.clip
        if works > 0:
            around, edge = self.walled(name, self.edge(works)), scaled(self.edge(works))
            pole = np.array([*down, 0.0]) if self.flat else self._center
            strips = (*around.strips, SolidStrip(f"{name} end", edge, Straight(back, pole)))
        else:
            strips = (SolidStrip(f"{name} end", clip, Straight(back, self._center)),)
        return Chain(self.contact, self._clip, self.curve, strips, End(back, down), f"{name} back")

    def walled(self, name: str, edge: Polynomial | None = None, floor: Polynomial | None = None) -> Chain:
        """The boundary of one side of a wall from the opening on: the neighbour's surface up to an edge, if there is
        one; both sides end in the edge, or else in the opening's cone, above a floor."""
        clip, strips = self._clip, tuple[SolidStrip, ...]()
        if edge is not None and self.flat:
            # where the line from the centre through the middle is in the plane through the opening across the axis
            way = minus(self.middle, self.center)
            middle = np.array([*to_floats(moved(self.center, (self.low / dot(way, self.axis), way))), 1.0])
            strips = (SolidStrip(name, self.contact.surface, Straight(scaled(edge), middle, towards=False)),)
        elif edge is not None:
            axis = np.array(to_floats(self.axis)) * to_float(self.frame.scale)
            rays = Outwards(self.join.contact.surface, self.frame, axis, self.frame.localise(edge))
            strips = (SolidStrip(name, self.contact.surface, rays),)
        end = End(clip.surface if edge is None else scaled(edge), clip.axis)
        return Chain(self.contact, clip, self.curve, strips, end, f"{name} end", floor)

    @property
    def _center(self) -> Floats:
        return np.array([*to_floats(self.center), 1.0])

    @property
    def curve(self) -> Floats:
        """Points (N, 3) spread along the opening."""
        return self.frame.global_points(self.join.curve())

    @property
    def end(self) -> ContactEnd:
        """Where the blend ends: seen along the axis, in the middle of the heights of the curve, which need not be
        plane."""
        axis, points = unit(to_floats(self.axis)), to_float(self.frame.scale) * self.join.curve()
        origin = np.array(to_floats(self.center))
        middle, heights = np.array(to_floats(self.middle)) - origin, points @ axis
        middle += ((heights.min() + heights.max()) / 2 - middle @ axis) * axis
        radii = np.linalg.norm(points - middle - ((points - middle) @ axis)[:, None] * axis, axis=1)
        place, far = origin + middle, float(np.linalg.norm(middle))
        return ContactEnd(triple(place), triple(-axis), (float(radii.min()), float(radii.max())), far)

    @property
    def _clip(self) -> End:
        """The cone, seen from its apex."""
        return End(self.contact.clip, -self.join.nappe[0] / np.linalg.norm(self.join.nappe[0]))

    def _apart(self, around: Solid, level: fmpq, works: fmpq) -> Solid:
        """The solid around the opening between a level and a plane above which rays do not come back (`neighbours`)."""
        length = float(np.linalg.norm(self.join.nappe[0]))
        high = HIGHER * float((self._met(self.wide(works))[1] @ self.join.nappe[0]).max()) / length**2
        low = to_float(level / self.frame.scale) / length
        across = BEYOND * to_float(self.wide(works)) * self.join.nappe[1:]
        square = [self.join.nappe[0] + i * across[0] + j * across[1] for i, j in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
        floor, roof = ([exact_vector((share * corner).tolist()) for corner in square] for share in (WITHIN * low, high))
        ceiling = self.at(exact(WITHIN * high * length) * self.frame.scale)
        places = [[self.frame.affine.exact(corner) for corner in quad] for quad in (floor, roof)]
        between = all(self.at(level).raw(*p) > 0 for p in places[0]) and all(ceiling.raw(*p) < 0 for p in places[1])
        if between and is_left_once(self.join.contact.surface, self.frame.localise(self.edge(works)), floor, roof):
            return around.cap(-ceiling, "")
        raise GeometryError(
            f"neighbour {self.number + 1} is not proved to go on as one sheet, seen from within, for "
            f"{to_float(works):.4g} around its opening; take a shorter length, or compose the solid with "
            "pas.solid.patch"
        )

    def edge(self, reach: fmpq) -> Polynomial:
        """The outer edge of the ring of width `reach` around the opening, positive outside."""
        share, onto = height(self.center, self.axis) / dot(self.axis, self.axis), []
        for g, a, c, m in zip(GENERATORS, self.axis, self.center, self.middle, strict=True):
            foot = m if self.flat else c + share * a
            point = g - (share - self.low / dot(self.axis, self.axis)) * a if self.flat else g
            onto.append(foot + (point - foot) / self.wide(reach))
        return Polynomial.from_raw(self.contact.clip.raw.compose(*onto))

    def _met(self, wide: fmpq) -> tuple[Floats, Floats]:
        """Unit rays (N, 3) between the opening and the edge, and their first points on the surface, NaN without any."""
        angles = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
        across = np.outer(np.cos(angles), self.join.nappe[1]) + np.outer(np.sin(angles), self.join.nappe[2])
        away = np.geomspace(1, to_float(wide), OUTWARDS)[:, None, None]
        rays = (self.join.nappe[0] + away * across).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        return rays, first_met(self.join.contact.surface, rays)[:, None] * rays

    def leave(self, wide: fmpq) -> bool:
        """Whether rays, up to `wide` times as wide as the opening, cross the surface once, transversally (sampled)."""
        rays, met = self._met(wide)
        surface = self.join.contact.surface
        if not np.isfinite(met).all():
            return False
        slopes = surface.gradient(met)
        cosines = (slopes * rays).sum(axis=1) / np.linalg.norm(slopes, axis=1)
        beyond = np.geomspace(1, FARTHEST, ALONG)[1:, None, None] * met
        return bool(cosines.min() > GRAZING and (surface(beyond) > 0).all())

    def faces(self, points: Floats) -> bool:
        """Whether any of the points (N, 3) is in the cone, on the opening's side of its apex."""
        return bool(self.surface.placed.in_use(self.frame.local_points(points)).any())

    def inside(self, edge: Polynomial) -> bool:
        """Whether the opening's curve is inside an edge."""
        return bool((scaled(edge)(self.curve) < 0).all())

    def holds(self, edge: Polynomial) -> bool:
        """Whether an edge, a cone with the same apex, is inside the opening's cone."""
        rays = nappe_rays(nappe(scaled(edge), self.join.nappe[0]), AROUND)
        return bool((self.join.contact.clip(rays) < 0).all())

    def wide(self, reach: fmpq) -> fmpq:
        """The ratio of the widths of the edge at a distance and of the opening."""
        return 1 + reach / self.radius
