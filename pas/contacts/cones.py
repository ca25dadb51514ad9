"""Cones of degree 2 as clips: openings, for nozzles on vessels and bosses on balls; and the points of cones.

For points the apex is 0: rays along a cone, and the curves in which surfaces cut it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import center_equations, height, quadratic_form
from pas.algebra.bracket import sign_change
from pas.algebra.inputs import short
from pas.algebra.matrices import solved
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import (
    Exact,
    Vector,
    VectorLike,
    dot,
    listed,
    plain,
    positive,
    three,
    to_floats,
)
from pas.arrays import Floats
from pas.contacts.axial import Axial
from pas.contacts.contact import Contact
from pas.errors import GeometryError
from pas.mesh.rows import along_lines

FARTHEST = 64.0
"""How far along rays, over the size of what is looked at, surfaces are looked for."""


WIDEST = 1e6
"""Of the tangent of half a cone's angle, and of one over it: in doubles four digits of the square are left beside 1."""


def apex(clip: Polynomial) -> Vector | None:
    """The apex of a cone of degree 2; None for other polynomials."""
    found = solved(fmpq_mat(center_equations(clip))) if clip.degree == 2 else None
    if found is None or len(found[1]) < 3 or clip.raw(*found[0]) != 0:
        return None
    return three(found[0])


def nappe(cone: Polynomial, towards: Floats) -> Floats:
    """Three vectors (3, 3), of which the first, plus the others times cosine and sine, are rays along a nappe.

    The first is its axis, on the side of `towards` (3,).  Raises `GeometryError` for what is no cone that is negative
    inside: its form must have one negative square and two positive ones; and for one wider or narrower than `WIDEST`.
    """
    form = np.array([to_floats(row[:3]) for row in quadratic_form(cone).tolist()[:3]])
    values, axes = np.linalg.eigh(form)
    squares, most = -values[1:] / values[0] if values[0] < 0 else np.zeros(2), 2 * WIDEST**2  # rounding counts as well
    if not 1 / most < squares[0] <= squares[1] < most:
        raise GeometryError(
            f"{short(str(cone))} is no cone with an inside: it must be negative along an axis, positive across it, and "
            f"its half angle must have a tangent from {1 / WIDEST:g} to {WIDEST:g}"
        )
    found = (axes / np.sqrt(np.abs(values))).T
    found[0] *= 1.0 if found[0] @ towards > 0 else -1.0
    return np.asarray(found)


def nappe_rays(axes: Floats, count: int) -> Floats:
    """Unit vectors (count, 3) along the nappe of three axes (3, 3), in order."""
    angles = 2 * np.pi * np.arange(count)[:, None] / count
    rays = axes[0] + np.cos(angles) * axes[1] + np.sin(angles) * axes[2]
    return np.asarray(rays / np.sqrt((rays * rays).sum(axis=1))[:, None])


def first_met(surface: Polynomial, rays: Floats, size: float = 1.0) -> Floats:
    """How far along unit vectors (N, 3) a surface that is negative at 0 is met, (N,); NaN beyond `FARTHEST`.

    `size` is that of what is looked at, in the units of the surface: 1 in local coordinates.
    """
    steps = size * np.concatenate([[0.0], np.geomspace(1 / FARTHEST, FARTHEST, 128)])
    values = np.stack([surface(rays * s) for s in steps])
    outside = values >= 0
    place = outside.argmax(axis=0)
    low, high = steps[np.maximum(place - 1, 0)], steps[place]
    jets = along_lines(lambda here, _: surface.jets(here), np.zeros_like(rays), rays)
    return np.where(outside.any(axis=0), sign_change(jets, low, high, (low + high) / 2), np.nan)


@dataclass(frozen=True, repr=False)
class Opening(Axial):
    """A surface out of which a blend rises along the curve that a cone cuts, in a plane or in none.

    `surface` is a polynomial, negative inside; the cone has its apex in `point`, which is inside, opens along `axis`,
    and is `slope` wide at a distance of one: the tangent of half of its angle.  With `w = x - point` the clip is
    `|w|^2 |axis|^2 - (1 + slope^2) (w . axis)^2`: the blend is inside the cone, the surface stays outside.

    A blend of an opening and one other contact is proved around the apex (see `pas.certify.contact_proofs`).

    Raises `ValueError` for a zero axis and a slope that is not from 1e-6 to 1e6, `GeometryError` for a point that is
    not inside.
    """

    table: ClassVar[str] = "openings"

    surface: Polynomial
    axis: Vector
    slope: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, surface: PolynomialLike, axis: VectorLike, slope: Exact, point: VectorLike = (0, 0, 0)) -> None:
        polynomial = Polynomial.named(surface, "surface")
        object.__setattr__(self, "surface", polynomial)
        self.settle(axis, point, slope=slope)
        positive(self.slope, "slope")
        if not 1 <= self.slope * fmpq(int(WIDEST)) <= int(WIDEST) ** 2:
            raise ValueError(
                f"slope must be from {1 / WIDEST:g} to {WIDEST:g}, not {short(plain(self.slope))}: it is the tangent "
                "of half of the cone's angle"
            )
        if polynomial.raw(*self.point) >= 0:
            raise GeometryError(
                f"the point ({listed(self.point)}) must be inside the surface, where {polynomial} is "
                "negative: the cone opens from there"
            )

    @cached_property
    def contact(self) -> Contact:
        along = height(self.point, self.axis)
        clip = self.square * dot(self.axis, self.axis) - (1 + self.slope**2) * along * along
        return Contact(self.surface, Polynomial.from_raw(clip))

    def __str__(self) -> str:
        return (
            f"opening of {self.surface} = 0 along ({listed(self.axis)}), {plain(self.slope)} wide at a distance of 1 "
            f"from ({listed(self.point)})"
        )
