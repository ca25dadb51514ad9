"""Two teapots: the published one of 8 patches, and one of 12 with all of its parts joined, and hollow."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational, to_fraction
from pas.errors import GeometryError
from pas.solid.assembly import Assembly, assembly
from pas.solid.solid import Solid, patch
from pas.teapot import handle, lid, spout
from pas.teapot.body import BOTTOM, LOWER, SEAM, TOP, upper

STYLES = ("paper", "better")
POT_COLOR, LID_COLOR = "#7d9db5", "#e8a33d"

MOUTH, BACK = Polynomial("z - 11/10"), Polynomial("x - z - 11/10")
SPOUT_SIDES, SPOUT_FRONT = Polynomial("1/4 - y^2"), Polynomial("16/5 - x")
"""Walls that keep other sheets of the spout's cubics away; the spout does not touch them."""

WALL, SPOUT_WALL = Fraction(1, 10), Fraction(4, 25)
"""Thickness of the hollow pot's walls and its spout's, as values of their polynomials."""

DRAIN = Polynomial("y^2 + (2*(x - 7/5) + 9*(z + 1/5))^2/85 - 9/400")
"""The hole between the cavity of the body and that of the spout."""


@dataclass(frozen=True)
class Teapot:
    """A closed solid with all its joints, and the same in parts: the hollow pot (better) and its lid."""

    style: str
    solid: Solid
    pot: Solid
    lid: Solid

    @property
    def assembly(self) -> Assembly:
        """Pot and lid as named, coloured parts."""
        return assembly(pot=(self.pot, POT_COLOR), lid=(self.lid, LID_COLOR))


def teapot(style: str = "better", *, lid_height: Any = "7/5", spout_tilt: Any = 0, handle_size: Any = 1) -> Teapot:
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
    for cavity in _cavity(lower, top):
        hollow = hollow - cavity
    return solid, hollow


def _cavity(lower: Polynomial, top: Polynomial) -> list[Solid]:
    """The room inside: level sets of the patches' own polynomials, so it keeps every joint between them."""
    floor, above = Polynomial("z + 7/10"), Polynomial("6/5 - z")
    return [
        patch("inner upper", upper() + WALL, SEAM, above),
        patch("inner lower", LOWER + WALL, floor, -SEAM).cap(-floor, "inner floor"),
        patch("drain", DRAIN, spout.ROOT + Fraction(3, 10), Fraction(3, 2) - spout.ROOT),
        patch("inner spout lower", lower + SPOUT_WALL, -spout.ROOT - Fraction(1, 5), spout.BEND, floor, Polynomial("1/2 - z"), SPOUT_SIDES),
        patch("inner spout upper", top + SPOUT_WALL, -spout.BEND, BACK, above, SPOUT_SIDES, SPOUT_FRONT),
    ]  # fmt: skip
