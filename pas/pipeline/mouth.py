"""What a solid has around the opening of a region: a piece of the surface that the blend rises out of.

The piece is bounded by an edge and by a flat back between the opening and the region's centre.  Of a plate it is a
slab: the edge is the cylinder across the plate through a curve that is wider than the opening.  Of other surfaces the
edge is a wider cone with the same apex, which cuts what is seen from there at an angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, dot, exact, to_float, to_floats
from pas.errors import GeometryError
from pas.solid.solid import Solid
from pas.surface.cones import FARTHEST, first_met
from pas.surface.contact import Contact
from pas.surface.joins import Join
from pas.surface.piecewise import PiecewiseSurface

AROUND, OUTWARDS, ALONG = 48, 12, 256
"""Rays round an opening and between it and the edge, and places on each, by which surfaces are looked through."""

FINE = 2**20
"""Parts of a unit in which an axis and heights are rounded that are given by no plane: too fine to be seen."""


@dataclass(frozen=True, eq=False)
class Mouth:
    """The opening through contact `number` (from 1), as it is seen along its `axis`, which points outwards.

    Heights are `axis . (x - center)`, and `low` is the least one of its curve.  `middle` is that of a plate's curve,
    the centre of others, and `radius` the smallest one of the curve round the axis, in the model's units.
    """

    number: int
    contact: Contact
    center: Vector
    axis: Vector
    low: fmpq
    middle: Vector
    radius: fmpq
    join: Join
    scale: fmpq

    @classmethod
    def of(cls, surface: PiecewiseSurface, number: int) -> Mouth:
        """That of a contact through which a surface's region is open."""
        contact, center = surface.contacts[number], surface.partition.center
        join, scale = surface.joins[number], surface.partition.frame.scale
        assert center is not None
        if contact.surface.degree == 1:
            x, y, z = (contact.surface.diff(i).raw(0, 0, 0) for i in range(3))
            low, rim = -contact.surface.raw(*center), contact.rim
            return cls(number + 1, contact, center, (x, y, z), low, rim.center, exact(rim.radii[0]), join, scale)
        length, *widths = np.linalg.norm(join.nappe, axis=1).tolist()
        heights = join.curve() @ (join.nappe[0] / length)
        low, high = (round(float(h) * FINE) * scale / FINE for h in (heights.min(), heights.max()))
        x, y, z = (fmpq(round(float(c) / length * FINE), FINE) for c in join.nappe[0])
        return cls(number + 1, contact, center, (x, y, z), low, center, high * exact(min(widths) / length), join, scale)

    @property
    def flat(self) -> bool:
        """Whether it is in a plate."""
        return self.contact.surface.degree == 1

    @property
    def _height(self) -> Polynomial:
        raw = sum((a * (g - c) for a, g, c in zip(self.axis, GENERATORS, self.center, strict=True)), 0 * GENERATORS[0])
        return Polynomial.from_raw(raw)

    def at(self, height: fmpq) -> Polynomial:
        """The plane at a height, positive below."""
        return Polynomial(height) - self._height

    def back(self, reach: fmpq) -> Polynomial:
        """The plane that is `reach` below the opening, but no nearer to the centre than to it; half way with 0."""
        size = exact(float(np.linalg.norm(to_floats(self.axis))))
        depth = self.low / 2
        return self.at(self.low - (min(reach * size, depth) if reach > 0 else depth))

    def ended(self, around: Solid, reach: fmpq, shorter: bool) -> Solid:
        """The solid around the opening up to a distance of `reach`, or of less if it may be `shorter`."""
        far = self.fitting(reach) if shorter else reach
        front = self.front(far)
        around = around.cap(self.edge(far), f"{around.faces[0]} end")
        return around if front is None else around.cap(front, "")

    def edge(self, reach: fmpq) -> Polynomial:
        """What ends the piece around the opening at a distance of `reach`, positive outside."""
        share, onto = self._height.raw / dot(self.axis, self.axis), []
        for g, a, c, m in zip(GENERATORS, self.axis, self.center, self.middle, strict=True):
            foot = m if self.flat else c + share * a
            point = g - (share - self.low / dot(self.axis, self.axis)) * a if self.flat else g
            onto.append(foot + (point - foot) / self._wide(reach))
        return Polynomial.from_raw(self.contact.clip.raw.compose(*onto))

    def front(self, reach: fmpq) -> Polynomial | None:
        """The plane, positive above, that parts the piece from where its surface comes back; None where it does not.

        Raises `GeometryError` where no plane does, or the surface leaves the wider cone open, as far as samples tell.
        """
        if self.flat:
            return None
        least, most = self._between(reach)
        if not least < most:
            raise GeometryError(
                f"neighbour {self.number} does not go on as one sheet for {to_float(reach):.4g} around its opening; a "
                f"length of {to_float(self.fitting(reach)):.4g} works"
            )
        if not np.isfinite(most):
            return None
        return -self.at(round((least + most) / 2 * FINE) * self.scale / FINE)

    def fitting(self, reach: fmpq) -> fmpq:
        """So much, or a half, a quarter, ... of it, that the surface goes on as one sheet around the opening."""
        parts = (reach / 2**n for n in range(60))
        return reach if self.flat else next((part for part in parts if np.less(*self._between(part))), reach)

    def _between(self, reach: fmpq) -> tuple[float, float]:
        """The largest height of the piece, and the least of where rays come into its surface again, in local units."""
        length = float(np.linalg.norm(self.join.nappe[0]))
        angles = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
        across = np.outer(np.cos(angles), self.join.nappe[1]) + np.outer(np.sin(angles), self.join.nappe[2])
        away = np.geomspace(1, to_float(self._wide(reach)), OUTWARDS)[:, None, None]
        rays = (self.join.nappe[0] + away * across).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        met, rise = first_met(self.join.contact.surface, rays), rays @ self.join.nappe[0] / length
        shares = np.geomspace(1, FARTHEST, ALONG)[1:, None]
        inside = self.join.contact.surface(met[:, None] * shares[..., None] * rays) < 0
        again = np.where(inside, shares * met * rise, np.inf)
        return (float((met * rise).max()), float(again.min())) if np.isfinite(met).all() else (np.inf, np.inf)

    def _wide(self, reach: fmpq) -> fmpq:
        return 1 + reach / self.radius
