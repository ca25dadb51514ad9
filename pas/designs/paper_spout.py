"""The published spout of two cubics inside the ideals of their joints, fitted anew and as printed."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from pas.algebra.polynomial import Polynomial
from pas.designs.body import Body, below
from pas.designs.exact import Design, Point, Points, closest, even, nearest, points
from pas.designs.spout import MOST_TILT, UPRIGHT
from pas.errors import GeometryError, InfeasibleError, NoSolutionError
from pas.pipeline.result import SolutionSpace
from pas.solid.solid import Solid, patch


@dataclass(frozen=True, repr=False)
class PaperSpout(Design):
    """The published spout (Lou, Feng, Chen and Deng 2002), fitted anew: GC^0 with the body; it has no channel.

    It has two cubics between a plane `root`, a plane `bend` and the height of the mouth.  As there, each cubic has the
    least `sum f(p)^2 / |f|^2` at the points of its outline, |f| the length of its coefficients: 1.88231e-6 below the
    bend, where the printed coefficients of six digits have 1.88263e-6.  Numbers are exact, in the model's units; the
    spout is symmetric in y.  Raises `GeometryError` for the joint that cannot be made.
    """

    lower_outline: Points = points((1.6, 0.15), (1.8, 0.2), (1.7, 0.17), (1.9, 0.25), (1.5, -0.54), (2.2, 0.05),
                                   (1.7, -0.45), (1.9, -0.33), (2.1, -0.1))  # fmt: skip
    upper_outline: Points = points((2.4, 0.55), (2.6, 0.85), (2.8, 1.01), (3.0, 1.1), (2.1, 0.67), (2.2, 0.85),
                                   (2.4, 1.02), (2.65, 1.1), (2.2, 0.85), (2.4, 1.02))  # fmt: skip
    """Points (x, z) of the outline in the plane y = 0, below and above the bend, as published; two occur twice."""

    waist: Polynomial = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
    """The elliptic cylinder that cuts the spout's outline in the plane of the bend."""

    tilt: Fraction = Fraction(0)
    """How far the spout leans outwards for each unit of height."""

    root: Polynomial = Polynomial("13 - 9*x + 2*z")
    bend: Polynomial = Polynomial("48 - 15*x - 40*z")
    """Planes where the spout leaves the body, negative beyond, and where its patches meet, positive below."""

    mouth: Fraction = Fraction(11, 10)
    """The height of the mouth."""

    inside: Point = (Fraction(2), Fraction(0), Fraction(9, 20))
    """A point inside the spout in the plane of the bend, where each member is a multiple of the contact: a
    value there keeps the multiple from vanishing."""

    lower_walls: tuple[Polynomial, ...] = (Polynomial("z + 3/5"), Polynomial("1/2 - z"), Polynomial("1/4 - y^2"))
    upper_walls: tuple[Polynomial, ...] = (
        Polynomial("x - z - 11/10"), Polynomial("1/4 - y^2"), Polynomial("16/5 - x"),
    )  # fmt: skip
    """Walls, positive inside, that keep other sheets of the cubics away; the spout does not touch them."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if abs(self.tilt) > MOST_TILT:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made with spout_tilt {self.tilt}: beyond {MOST_TILT} "
                "either way the cubic has no clean outline"
            )
        for name in ("lower_outline", "upper_outline"):
            points = getattr(self, name)
            if not points or any(len(p) != 2 for p in points):
                raise ValueError(f"{name} must be points (x, z), at least one, not {len(points)} of another form")
        if self.bend.at(self.inside) != 0:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made: inside must be a point of the bend {self.bend} = 0"
            )

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the spout."""
        return (), (self.root,)

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the spout, its two joints and its flat mouth."""
        try:
            lower, upper = self.cubics(body)
        except (GeometryError, NoSolutionError, InfeasibleError) as error:
            raise GeometryError(f"the joints of the spout cannot be made: {error}") from error
        solid |= patch("spout lower", lower, -self.root, self.bend, *self.lower_walls)
        solid |= patch("spout upper", upper, -self.bend, below(self.mouth), *self.upper_walls)
        solid = solid.joined("spout lower", "spout upper", (lower, self.bend), 1)
        solid = solid.joined("body lower", "spout lower", (body.lower, self.root), 0)
        return solid.cap(-below(self.mouth), "mouth")

    def channel(self) -> Solid | None:
        """None: the pot does not pour."""
        return None

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The lower cubic, of those that meet the body and the waist."""
        return closest(space, _outline(self.lower_outline), self.inside, by_gradient=False)

    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """Both cubics as published."""
        lower = self.lower(even([(body.lower, self.root), (self.waist, self.bend)], 0, 3))
        beyond = _outline(self.upper_outline, self.tilt)
        return lower, closest(even([(lower, self.bend)], 1, 3), beyond, self.inside, by_gradient=False)


@dataclass(frozen=True, repr=False)
class PrintedSpout(PaperSpout):
    """The published spout with the lower cubic's printed coefficients.

    These are rounded to six digits, so the cubic meets nothing exactly: it is replaced by the nearest one that does,
    each coefficient of which is that printed to within 4e-7.
    """

    printed: Polynomial = Polynomial(
        "-0.382086 + 0.671121*x - 0.390428*x^2 + 0.0748303*x^3 - 0.124559*y^2 + 0.093717*x*y^2 - 0.27378*z"
        " + 0.346645*x*z - 0.10528*x^2*z - 0.0386148*y^2*z - 0.0905839*z^2 + 0.062592*x*z^2 - 0.038205*z^3"
    )

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The cubic of the space that is nearest to the printed one."""
        return nearest(space, self.printed)


def _outline(points: Points, tilt: Fraction = Fraction(0)) -> list[Point]:
    """Points (x, 0, z) of an outline, leaning outwards by `tilt` per unit of height above the bend."""
    return [(x + tilt * (z - UPRIGHT), Fraction(0), z) for x, z in points]
