"""Blends of parametric surfaces with contact of order k, by Hermite interpolation or by weights.

Sources: Perez-Diaz and Sendra (2003), algorithms 1 and 2; Hartmann (2001) for two surfaces and weights.
A blend T agrees with P_i in all derivatives up to order k at h = s_i, for every t at which P_i is
defined there; so the two surfaces meet with C^k along the curve, and GC^k where it is regular.

All blends are T + W(h) (R1, R2, R3), a particular one plus a free module, W = prod (h - s_i)^(k+1): over the ring of
rational functions whose denominators do not vanish identically at any h = s_i the blends of order k are exactly these,
R ranging over that ring; the polynomial ones, if there are any, are those with T and R polynomial (Perez-Diaz and
Sendra 2003, theorems 2 and 9).

Guaranteed: exact data give an exact blend, and `prove` shows the contact by polynomial identities that do not refer to
how the blend was made.  Not guaranteed: that the blend is regular or free of poles in between: `prove` looks for that.
Isolated t at which the given curves have poles are those of the blend, too: see `BlendingData.isolated_points`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any, Unpack

from pas.algebra.brief import brief
from pas.algebra.callables import ComponentLike, Values, component
from pas.algebra.inputs import check_order, short, shown
from pas.algebra.jets import power
from pas.algebra.rational import Exact, plain, three, to_float
from pas.algebra.rational_function import ONE, RationalFunction, total
from pas.errors import GeometryError, NoSolutionError
from pas.limits import WorkLimits, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.data import AXES, BlendingData, ParametricCertificate, contact_verdicts
from pas.parametric.hermite import HermiteValues, blending_polynomial, taylor_basis
from pas.parametric.maps import DomainLike
from pas.parametric.regularity import regularity
from pas.parametric.series import Components, taylor, univariate
from pas.parametric.surface import ParametricSurface
from pas.parametric.weights import Weights
from pas.shape import Shape


@dataclass(frozen=True)
class PolynomialCriterion:
    """Whether polynomial blends exist, and why not; its truth value says so, too."""

    exists: bool
    reason: str

    def __bool__(self) -> bool:
        return self.exists


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
        whole = blending_polynomial(self.data.values, self.order)
        return RationalFunction.from_lowest_terms(univariate(whole, 1), ONE, self.particular.parameters)

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
            factor = power(prod((h - node for node in nodes), start=1.0), self.order + 1)
            start = self.particular.values(t, h)
            return tuple(p + factor * r.formula(t, h) for p, r in zip(start, parts, strict=True))

        def source() -> Components:
            exact = [part.exact for part in parts if part.exact is not None]
            return three(t + self.multiplier * r for t, r in zip(self.particular.components, exact, strict=True))

        reason = next((p.reason for p in parts if p.exact is None), "") or self.particular.inexact
        return ParametricSurface.from_parts(values, None if reason else source, names, self.particular.ends, reason)

    def coordinates(self, surface: ParametricSurface) -> Components | None:
        """The R of an exact surface, None where it is not among these blends."""
        pairs = zip(self.particular.components, surface.components, strict=True)
        x, y, z = ((other - mine) / self.multiplier for mine, other in pairs)
        outside = any(self._pole(r) is not None or (self.polynomial and not r.is_polynomial) for r in (x, y, z))
        return None if outside else (x, y, z)

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


@dataclass(frozen=True, repr=False)
class ParametricBlend(Shape):
    """A blend of `data` with contact of order `order`; `weights` is None for one that is no weighted sum."""

    data: BlendingData
    order: int
    surface: ParametricSurface
    weights: Weights | None = None
    kind = "parametric blend"

    __repr__ = brief

    def __post_init__(self) -> None:
        check_order(self.order)

    def all_solutions(self) -> ParametricSolutions:
        """Every rational blend of these data and this order: `surface + W (R1, R2, R3)`."""
        return ParametricSolutions(self.data, self.order, self.surface, polynomial=False)

    def all_polynomial_solutions(self) -> ParametricSolutions:
        """Every polynomial blend; raises `NoSolutionError` with the reason where there is none."""
        criterion = has_polynomial_solution(self.data, self.order)
        if not criterion:
            raise NoSolutionError(f"there is no polynomial blend: {criterion.reason}", {})
        start = self if self.weights is None else hermite_blend(self.data, self.order)
        return ParametricSolutions(self.data, self.order, start.surface, polynomial=True)

    @limited("proving a blend", "less effort or a smaller domain")
    def prove(
        self, domain: DomainLike = None, effort: int = 20_000, **limits: Unpack[WorkLimits]
    ) -> ParametricCertificate:
        """Verdicts on the contact with each surface, and on regularity over `domain` (by default the blend's own).

        `effort` bounds the cells that the proof of regularity may examine.
        """
        contacts = contact_verdicts(self.surface, self.data, self.order)
        within = self.surface if domain is None else self.surface.with_domain(domain)
        return ParametricCertificate(contacts, regularity(within, effort))

    @cached_property
    def certificate(self) -> ParametricCertificate:
        """The verdicts of `prove()`, when first asked for, and kept."""
        return self.prove()

    @limited("meshing a surface", "a coarser tolerance or a smaller domain")
    def mesh(
        self,
        tolerance: Exact | None = None,
        domain: DomainLike = None,
        *,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """The blend's surface as a triangle mesh; see `ParametricSurface.mesh`."""
        return self.surface.mesh(tolerance, domain, quality=quality)

    def __str__(self) -> str:
        kind = "" if self.weights is None else "weighted "
        return f"a {kind}blend of {self.data} with contact of order {self.order}"


@limited("finding a parametric blend", "a lower order")
def hermite_blend(data: BlendingData, order: int, **limits: Unpack[WorkLimits]) -> ParametricBlend:
    """The Hermite blend: polynomial in h of degree at most n(k+1) - 1 (Perez-Diaz and Sendra 2003, algorithm 1).

    Polynomial altogether iff polynomial blends exist.  Surfaces that are not exact give a blend that can
    only be evaluated.  Raises `TypeError` or `ValueError` for other data or a negative order.
    """
    k = check_order(order)
    _require_data(data)

    def source() -> Components:
        names, numbers = data.surfaces[0].parameters, range(len(data.surfaces))
        rows = [row for i in numbers for row in data.coefficients(i, k)]
        basis = [univariate(p, 1) for i in numbers for p in taylor_basis(data.values, i, k)]
        functions = [RationalFunction.from_lowest_terms(p, ONE, names) for p in basis]

        def summed(axis: int) -> RationalFunction:
            checkpoint("adding up the Hermite blend")
            return total([f * row[axis] for f, row in zip(functions, rows, strict=True)])

        return three(map(summed, range(3)))

    return ParametricBlend(data, k, _surface(data, HermiteValues(data.surfaces, data.values, k), source))


@limited("finding a parametric blend", "a lower order")
def weighted_blend(
    data: BlendingData,
    order: int,
    balance: Exact | Sequence[Exact] = "1/2",
    normalized: bool = False,
    exponent: int | None = None,
    **limits: Unpack[WorkLimits],
) -> ParametricBlend:
    """The blend sum f_i P_i; `balance`, `normalized` and `exponent` are those of `Weights`.

    Source: Hartmann (2001) for two surfaces, Perez-Diaz and Sendra (2003, algorithm 2) for more.

    Raises `GeometryError` where a surface is not defined at the value of another (then the order of
    contact is lost there) or a weight has a pole between the values, `ValueError` for a bad balance.
    """
    k = check_order(order)
    _require_data(data)
    weights = Weights(data.values, k, balance, normalized, exponent)
    for i in range(len(data.surfaces)):
        for value in data.values:
            data.require_defined(i, value)
    odd = exponent is not None and exponent % 2 and len(data.values) > 2
    for pole in (p for p in weights.poles() if p.inside) if odd else ():
        raise GeometryError(
            f"with exponent {exponent} weight {pole.weight} has a pole at h = {pole.h:.6g}, between the values; "
            f"an even exponent such as {weights.exponent + 1} has none"
        )

    def values(t: Any, h: Any) -> tuple[Any, ...]:
        sums: list[Any] = [0.0, 0.0, 0.0]
        for f, surface in zip(weights(h), data.surfaces, strict=True):
            sums = [s + f * part for s, part in zip(sums, surface.values(t, h), strict=True)]
        return tuple(sums)

    def source() -> Components:
        checkpoint("expanding the weighted blend")
        pairs = list(zip(weights.functions, data.surfaces, strict=True))
        return three(total([f * surface.components[axis] for f, surface in pairs]) for axis in range(3))

    return ParametricBlend(data, k, _surface(data, values, source), weights)


def has_polynomial_solution(data: BlendingData, order: int) -> PolynomialCriterion:
    """Whether polynomial blends exist (Perez-Diaz and Sendra 2003, theorem 9).

    They do iff all d^j P_i / dh^j, j <= order, are polynomials in t at h = s_i; then the Hermite blend is
    one.  Raises `ValueError` for surfaces that are not exact.
    """
    k = check_order(order)
    _require_data(data)
    data.require_exact()
    for i, value in enumerate(data.values):
        for axis, parts in zip(AXES, zip(*data.coefficients(i, k), strict=True), strict=True):
            for j, part in enumerate(parts):
                if not part.is_polynomial:
                    what = axis if j == 0 else f"d{axis}/dh" if j == 1 else f"d^{j}{axis}/dh^{j}"
                    where = f"surfaces[{i}] at {data.surfaces[i].parameters[1]} = {short(plain(value))}"
                    below = short(str(part.denominator))
                    return PolynomialCriterion(False, f"{what} of {where} is no polynomial; its denominator is {below}")
    return PolynomialCriterion(True, f"all derivatives up to order {k} at the values are polynomials")


def _surface(data: BlendingData, values: Values, source: Callable[[], Components]) -> ParametricSurface:
    """The surface over the data's common domain; `source` is asked only where all of them are exact."""
    reason = next((f"surfaces[{i}]: {s.inexact}" for i, s in enumerate(data.surfaces) if not s.is_exact), "")
    exact = None if reason else source
    return ParametricSurface.from_parts(values, exact, data.surfaces[0].parameters, data.ends, reason)


def _require_data(data: Any) -> None:
    if not isinstance(data, BlendingData):
        kind = "a sequence" if isinstance(data, Sequence) else repr(data)
        raise TypeError(f"data must be BlendingData(surfaces, values), not {kind}")


@dataclass(frozen=True)
class BlendMethod:
    """`build(data, order, **options)` makes a blend; `options` names those that there are.

    They come with their types (`Any` for exact numbers and lists of them).
    """

    build: Callable[..., ParametricBlend]
    options: Mapping[str, Any]


METHODS: dict[str, BlendMethod] = {
    "hermite": BlendMethod(hermite_blend, {}),
    "weighted": BlendMethod(weighted_blend, {"balance": Any, "normalized": bool, "exponent": int}),
}
"""The methods by name, for files and the command line."""


def blend_by(method: str, data: BlendingData, order: int, options: Mapping[str, Any]) -> ParametricBlend:
    """The blend of a method by its name; raises `ValueError` for another name or option, and what the method raises."""
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(map(repr, METHODS))}, not {shown(method)}")
    for name in options:
        if name not in METHODS[method].options:
            known = ", ".join(METHODS[method].options) or "none"
            raise ValueError(f"{name!r} is no option of the method {method!r}; its options: {known}")
    return METHODS[method].build(data, order, **options)


def method_of(blend: ParametricBlend) -> tuple[str, dict[str, Any]]:
    """The name of the method that made a blend, and its options."""
    w = blend.weights
    if w is None:
        return "hermite", {}
    return "weighted", {"balance": [plain(u) for u in w.balance], "normalized": w.normalized, "exponent": w.exponent}
