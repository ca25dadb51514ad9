"""Two teapots: the published one of 8 patches, and one of 12 with all of its parts joined, and hollow."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational, to_fraction
from pas.errors import GeometryError
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.shape import Shape
from pas.solid.assembly import Assembly, assembly
from pas.solid.primitives import ball, cone
from pas.solid.solid import Solid, patch
from pas.teapot import handle, lid, spout
from pas.teapot.body import BOTTOM, LOWER, SEAM, TOP, upper
from pas.verdicts import Findings

STYLES = ("paper", "better")
POT_COLOR, LID_COLOR = "#7d9db5", "#e8a33d"

MOUTH, BACK = Polynomial("z - 11/10"), Polynomial("x - z - 11/10")
SPOUT_SIDES, SPOUT_FRONT = Polynomial("1/4 - y^2"), Polynomial("16/5 - x")
"""Walls that keep other sheets of the spout's cubics away; the spout does not touch them."""

WALL = Fraction(1, 5)
"""Thickness of the hollow pot's walls, as a value of the body's polynomials."""

BEND = Fraction(23, 20)
"""Radius of the ball at a bend of the channel over that of the channel there, so that they cross clearly."""

CHANNEL = (
    (Fraction(23, 20), Fraction(-2, 5)),
    (Fraction(44, 25), Fraction(2, 25)),
    (Fraction(101, 50), Fraction(41, 100)),
    (Fraction(62, 25), Fraction(6, 5)),
)
CHANNEL_RADII = (Fraction(2, 25), Fraction(3, 50), Fraction(1, 20), Fraction(1, 40))
"""The axis (x, z) of the channel through the spout, and its radius at each of these points."""


@dataclass(frozen=True, repr=False)
class Teapot(Shape):
    """A closed solid with all its joints, and the same in parts: the hollow pot (better) and its lid."""

    style: str
    solid: Solid
    pot: Solid
    lid: Solid
    kind = "teapot"

    @property
    def certificate(self) -> Findings:
        """The verdicts on the joints of the closed solid."""
        return self.solid.certificate

    @limited("meshing a teapot", "a coarser tolerance")
    def mesh(
        self, tolerance: float | None = None, *, seconds: float | None = None, progress: Report | None = None
    ) -> Mesh:
        """The mesh of the closed solid; see `Solid.mesh`."""
        return self.solid.mesh(tolerance)

    def __str__(self) -> str:
        return str(self.solid)

    def __repr__(self) -> str:
        return f"<Teapot of style {self.style!r}>"

    @property
    def assembly(self) -> Assembly:
        """Pot and lid as named, coloured parts."""
        return assembly(pot=(self.pot, POT_COLOR), lid=(self.lid, LID_COLOR))


@limited("building the teapot", "")
def teapot(
    style: str = "better",
    *,
    lid_height: Any = "7/5",
    spout_tilt: Any = 0,
    handle_size: Any = 1,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Teapot:
    """A teapot of a style, "paper" or "better", about 5 units long.

    `lid_height` is the height of the knob's top, `spout_tilt` how far the spout leans outwards for each
    unit of height, `handle_size` scales the handle.  Raises `GeometryError` naming the joint that
    cannot be made, `ValueError` for an unknown style.
    """
    if style not in STYLES:
        raise ValueError(f"style must be one of {', '.join(map(repr, STYLES))}, not {style!r}")
    height, tilt, size = (
        to_fraction(rational(v, n))
        for v, n in ((lid_height, "lid_height"), (spout_tilt, "spout_tilt"), (handle_size, "handle_size"))
    )
    cover = lid.lid(height)
    filled, hollow = _paper(tilt, size) if style == "paper" else _better(tilt, size)
    whole = (filled | cover).joined("lid dome", "body upper", lid.RIM, 0).require_joints()
    return Teapot(style, whole, hollow, cover.cap(Polynomial("1 - z"), "lid bottom"))


def _body(upper_walls: tuple[Polynomial, ...], lower_walls: tuple[Polynomial, ...]) -> Solid:
    solid = patch("body upper", upper(), SEAM, TOP, *upper_walls)
    solid |= patch("body lower", LOWER, BOTTOM, -SEAM, spout.ROOT, *lower_walls)
    return solid.joined("body upper", "body lower", (LOWER, SEAM), 1)


def _spout(lower: Polynomial, top: Polynomial) -> Solid:
    end = Polynomial("1/2 - z")
    solid = patch("spout lower", lower, -spout.ROOT, spout.BEND, Polynomial("z + 3/5"), end, SPOUT_SIDES)
    solid |= patch("spout upper", top, -spout.BEND, -MOUTH, BACK, SPOUT_SIDES, SPOUT_FRONT)
    return solid.joined("spout lower", "spout upper", (lower, spout.BEND), 1)


def _paper(tilt: Fraction, size: Fraction) -> tuple[Solid, Solid]:
    if not Fraction(9, 10) <= size <= Fraction(11, 10):
        raise GeometryError(
            f"the joints of handle and body cannot be made with handle_size {size}: the quartic has a clean loop for "
            "sizes from 9/10 to 11/10"
        )
    loop = handle.paper(size)
    solid = _body((handle.UPPER_END,), (handle.LOWER_END,)) | _spout(*spout.paper(tilt))
    middle = Polynomial("z")
    solid |= patch("handle", loop, middle, -handle.UPPER_END) | patch("handle", loop, -middle, -handle.LOWER_END)
    solid = solid.joined("body lower", "spout lower", (LOWER, spout.ROOT), 0)
    solid = solid.joined("body upper", "handle", (upper(), handle.UPPER_END), 0)
    solid = solid.joined("body lower", "handle", (LOWER, handle.LOWER_END), 0)
    solid = solid.cap(-BOTTOM, "bottom disc").cap(MOUTH, "mouth")
    return solid, solid.cap(-TOP, "rim")


def _better(tilt: Fraction, size: Fraction) -> tuple[Solid, Solid]:
    lower, top = spout.better(tilt)
    solid = _body((), ()) | _spout(lower, top) | handle.better(size)
    solid = solid.joined("body lower", "spout lower", (LOWER, spout.ROOT), 1)
    solid = solid.cap(-BOTTOM, "bottom disc").cap(MOUTH, "mouth")
    hollow = solid.cap(-TOP, "rim")
    return solid, hollow - _cavity(tilt)


def _cavity(tilt: Fraction) -> Solid:
    """The room inside: level sets of the body's own polynomials, which keep their joint, and a channel."""
    above, floor = Polynomial("6/5 - z"), Polynomial("z + 7/10")
    room = patch("inner upper", upper() + WALL, SEAM, above)
    room |= patch("inner lower", LOWER + WALL, floor, -SEAM).cap(-floor, "inner floor")
    room = room.joined("inner upper", "inner lower", (LOWER + WALL, SEAM), 1)
    points = [(x + tilt * max(z - Fraction(1, 2), Fraction(0)), Fraction(0), z) for x, z in CHANNEL]
    for (start, end), (wide, narrow) in zip(pairwise(points), pairwise(CHANNEL_RADII), strict=True):
        room |= cone(start, end, wide, narrow, "channel") | ball(end, narrow * BEND, "channel bend")
    return room
