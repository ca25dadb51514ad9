"""Surfaces through a curve: the order in which each two meet there, and on which side of one the other is.

A plane across the curve shows a regular surface as a smooth line through a point, so as two rays, and
along a ray all other surfaces have one sign.  Lines that touch are told apart by derivatives: those of q
along `grad q0 x grad form` are derivatives along the line q0 = 0 in the plane of a linear form, and the
first that does not vanish all along the curve gives the order of contact, and the side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations

from pas.algebra.curve import CurvePart, along, gradient
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import cross, dot
from pas.algebra.roots import RealRoot
from pas.algebra.zeros import RealZero
from pas.limits import checkpoint


@dataclass(frozen=True)
class Ray:
    """One half of a sheet, in the plane across the curve: `side` is 1 along `grad q x grad form`, or -1."""

    sheet: int
    side: int


@dataclass(frozen=True)
class SheetContact:
    """How two sheets meet along a curve: the order, and the derivative of `other` along `base` that does not vanish,
    as a positive multiple of `side * derivative^power`."""

    order: int
    base: int
    other: int
    derivative: Polynomial
    side: int = 1
    power: int = 1

    def sign(self, at: RealZero) -> int:
        """The sign of the derivative at a point."""
        return int(self.side * at.sign(self.derivative) ** self.power)


@dataclass(frozen=True)
class Factors:
    """A polynomial as a product: a sign, sheets through the curve and others that do not hold it, with powers."""

    sign: int
    sheets: tuple[tuple[int, int], ...]
    others: tuple[tuple[Polynomial, int], ...]


class Sheets:
    """The irreducible surfaces through a part of a curve on which some polynomials vanish.

    Raises `pas.algebra.curve.SplitError` where that differs from component to component.
    """

    def __init__(self, part: CurvePart, polynomials: list[Polynomial]) -> None:
        self.part = part
        self.polynomials: list[Polynomial] = []
        self.factors: dict[int, Factors] = {}
        self._product = cache(lambda i, j: dot(gradient(self.polynomials[i]), gradient(self.polynomials[j])))
        for number, polynomial in enumerate(polynomials):
            if part.contains(polynomial):
                self.factors[number] = self._factored(polynomial)

    def _factored(self, polynomial: Polynomial) -> Factors:
        constant, found = polynomial.raw.factor()
        sign, sheets, others = 1 if constant > 0 else -1, [], []
        for raw, power in found:
            factor = Polynomial.from_raw(raw)
            if not self.part.contains(factor):
                others.append((factor, int(power)))
                continue
            if factor not in self.polynomials:
                self.polynomials.append(factor)
            sheets.append((self.polynomials.index(factor), int(power)))
        return Factors(sign, tuple(sheets), tuple(others))

    @cached_property
    def regular(self) -> list[bool]:
        """Which sheets have a gradient at all but finitely many points."""
        return [not all(self.part.contains(d) for d in gradient(q)) for q in self.polynomials]

    @cached_property
    def contacts(self) -> dict[tuple[int, int], SheetContact]:
        """How each two regular sheets meet."""
        numbers = [i for i, regular in enumerate(self.regular) if regular]
        return {(i, j): self._contact(i, j) for i, j in combinations(numbers, 2)}

    def _contact(self, i: int, j: int) -> SheetContact:
        base, other = (i, j) if self.polynomials[i].degree <= self.polynomials[j].degree else (j, i)
        ground = self.polynomials[base]
        field = cross(gradient(ground), gradient(self.part.curve.form))
        for h, power, side in self._powers(ground, self.polynomials[other]):
            return SheetContact(power - 1, base, other, along(field, h), side, power)
        derivative, order = self.polynomials[other], -1
        while self.part.contains(derivative):
            checkpoint("comparing surfaces along a curve")
            # the field is tangent to the ground, so multiples of that stay multiples
            derivative = Polynomial.from_raw(divmod(along(field, derivative).raw, ground.raw)[1])
            order += 1
        return SheetContact(order, base, other, self.part.ideal.normal_form(derivative))

    def _powers(self, ground: Polynomial, other: Polynomial) -> Iterator[tuple[Polynomial, int, int]]:
        """What a polynomial is on the ground, if that is c h^power with one of the curve's own two, h, that is not of
        the ground, and the sign of c.

        As fillets are beside their faces.  Along the field, h falls to order 0 on a reduced curve: so the derivative
        that does not vanish is c power! (field h)^power, of far lower degree than as it is found otherwise.
        """
        rest = divmod(other.raw, ground.raw)[1]
        for g, h in (self.part.curve.pair, self.part.curve.pair[::-1]):
            if not divmod(g.raw, ground.raw)[1].is_zero():
                continue
            step = value = divmod(h.raw, ground.raw)[1]
            for power in range(1, other.degree // h.degree + 1):
                if Polynomial.from_raw(value).primitive() == Polynomial.from_raw(rest).primitive():
                    yield h, power, 1 if value.leading_coefficient() * rest.leading_coefficient() > 0 else -1
                value = divmod(value * step, ground.raw)[1]

    @cached_property
    def cuts(self) -> list[RealRoot]:
        """Values of the form between which nothing of the arrangement of sheets changes along an arc."""
        cross_ = self.part.crossings
        result = [r for f in self.factors.values() for p, _ in f.others for r in cross_(p)]
        result += [r for c in self.contacts.values() for r in cross_(c.derivative)]
        for q, regular in zip(self.polynomials, self.regular, strict=True):
            result += cross_(*gradient(q)) if regular else []
        return result

    def order(self, i: int, j: int) -> int:
        """The order of contact of two different regular sheets."""
        return self.contacts[min(i, j), max(i, j)].order

    def singular_points(self, number: int) -> list[RealZero]:
        """The real points of the curve where a sheet of a polynomial has no gradient, if it has one elsewhere."""
        sheets = (sheet for sheet, _ in self.factors[number].sheets if self.regular[sheet])
        return [p for sheet in sheets for p in self.part.singular_points(self.polynomials[sheet])]

    def parallel(self, i: int, j: int, at: RealZero) -> int:
        """Whether the gradients of two sheets that touch point the same way (1) or opposite ways (-1)."""
        return at.sign(self._product(i, j))

    def signs(self, ray: Ray, at: RealZero) -> dict[int, int | None]:
        """The signs of all other sheets' polynomials along a ray at a point; None for sheets that are not regular."""
        return {i: self._sign(i, ray, at) for i in range(len(self.polynomials)) if i != ray.sheet}

    def _sign(self, sheet: int, ray: Ray, at: RealZero) -> int | None:
        pair = min(sheet, ray.sheet), max(sheet, ray.sheet)
        if pair not in self.contacts:
            return None
        contact = self.contacts[pair]
        sign, power = contact.sign(at), contact.order + 1
        if contact.base == ray.sheet:
            return int(sign * ray.side**power)
        if contact.order == 0:
            return -sign * ray.side
        # near the point, sheet = ratio * (base - derivative * u^power) with u along the other's field
        ratio = self.parallel(*pair, at)
        return int(-ratio * sign * (ratio * ray.side) ** power)
