"""All blends: T + W(h) (R1, R2, R3), a particular one plus a free module.

W = prod (h - s_i)^(k+1).  Over the ring of rational functions whose denominators do not vanish
identically at any h = s_i the blends of order k are exactly these, R ranging over that ring; the
polynomial ones, if there are any, are those with T and R polynomial (Perez-Diaz and Sendra 2003,
theorems 2 and 9).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pas.algebra.brief import brief
from pas.algebra.callables import ComponentLike, component
from pas.algebra.inputs import short
from pas.algebra.jets import power
from pas.algebra.rational import plain, to_float
from pas.algebra.rational_function import ONE, RationalFunction
from pas.errors import GeometryError
from pas.parametric.data import AXES, BlendingData
from pas.parametric.hermite import blending_polynomial
from pas.parametric.series import Components, taylor, univariate
from pas.parametric.surface import ParametricSurface


@dataclass(frozen=True)
class ParametricSolutions:
    """All blends of `data` with contact of order `order`: `particular + multiplier * (R1, R2, R3)`.

    With `polynomial` R is polynomial, otherwise rational without poles along the curves.
    """

    data: BlendingData
    order: int
    particular: ParametricSurface
    polynomial: bool

    __repr__ = brief

    @cached_property
    def multiplier(self) -> RationalFunction:
        """W = prod (h - s_i)^(k+1)."""
        names = self.particular.parameters
        whole = blending_polynomial(self.data.values, self.order)
        return RationalFunction.from_lowest_terms(univariate(whole, 1), ONE, names)

    def member(self, x: ComponentLike, y: ComponentLike, z: ComponentLike) -> ParametricSurface:
        """The blend for chosen R1, R2, R3: strings, sympy expressions, numbers (or callables).

        Raises `GeometryError` where one has a pole along a curve h = s_i, or is no polynomial where only
        those are meant; `ValueError` for one that cannot be read.
        """
        names = self.particular.parameters
        parts = [component(e, names, f"R{axis + 1}") for axis, e in enumerate((x, y, z))]
        for axis, part in enumerate(parts):
            if part.exact is not None:
                self._require_allowed(part.exact, axis)
            elif self.polynomial:
                raise GeometryError(f"R{axis + 1} must be a polynomial; {part.reason}")
        nodes = [to_float(s) for s in self.data.values]

        def values(t: Any, h: Any) -> tuple[Any, ...]:
            product: Any = 1.0
            for node in nodes:
                product = product * (h - node)
            factor = power(product, self.order + 1)
            start = self.particular.values(t, h)
            return tuple(p + factor * r.formula(t, h) for p, r in zip(start, parts, strict=True))

        def source() -> Components:
            exact = [part.exact for part in parts if part.exact is not None]
            x, y, z = (t + self.multiplier * r for t, r in zip(self.particular.components, exact, strict=True))
            return x, y, z

        reason = next((p.reason for p in parts if p.exact is None), "") or self.particular.inexact
        made = source if self.particular.is_exact and not reason else None
        return ParametricSurface.from_parts(values, made, names, self.particular.ends, reason)

    def coordinates(self, surface: ParametricSurface) -> Components | None:
        """The R of an exact surface, None where it is not among these blends."""
        found = []
        for mine, other in zip(self.particular.components, surface.components, strict=True):
            r = (other - mine) / self.multiplier
            if self._pole(r) is not None or (self.polynomial and not r.is_polynomial):
                return None
            found.append(r)
        return found[0], found[1], found[2]

    def contains(self, surface: ParametricSurface) -> bool:
        """Whether an exact surface is among these blends."""
        return self.coordinates(surface) is not None

    def __str__(self) -> str:
        kind = "polynomial" if self.polynomial else "rational"
        return f"T + W (R1, R2, R3) with W = {self.multiplier} and {kind} R"

    def _pole(self, r: RationalFunction) -> str | None:
        """The value at which a denominator vanishes for every t."""
        return next((short(plain(s)) for s in self.data.values if taylor(r.denominator, s, 0)[0].is_zero()), None)

    def _require_allowed(self, r: RationalFunction, axis: int) -> None:
        if self.polynomial and not r.is_polynomial:
            raise GeometryError(f"R{axis + 1} must be a polynomial, not {short(str(r))}")
        pole = self._pole(r)
        if pole is not None:
            raise GeometryError(
                f"R{axis + 1} has a pole along {r.names[1]} = {pole}, where the blend's {AXES[axis]} is prescribed; "
                "its denominator must not vanish there"
            )
