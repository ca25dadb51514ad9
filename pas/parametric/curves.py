"""Curves on parametric surfaces, iso-curves and any curve in the plane of the parameters, and curvatures.

A path s -> (t(s), h(s)) gives the curve P(t(s), h(s)); with it come the surface's normals along the
curve and the direction across the curve in the tangent plane, which is what a blend starts from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.callables import ComponentLike, component
from pas.algebra.expressions import Formula, Names
from pas.algebra.inputs import check_derivative, short, shown
from pas.algebra.jets import Jet, variables
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.rational import Exact, plain, rational
from pas.algebra.rational_function import RationalFunction
from pas.parametric.series import Components
from pas.parametric.surface import ParametricSurface


@dataclass(frozen=True, eq=False, init=False)
class SurfaceCurve:
    """The curve P(t(s), h(s)) on a parametric surface.

    `t` and `h` are expressions in the one parameter `parameter`: strings, sympy expressions, numbers or
    callables of one array.  Raises `ValueError` for one that cannot be read.
    """

    surface: ParametricSurface
    parameter: str
    path: tuple[Formula, Formula]
    exact_path: tuple[RationalFunction, RationalFunction] | None

    __repr__ = brief

    def __init__(self, surface: ParametricSurface, t: ComponentLike, h: ComponentLike, parameter: str = "s") -> None:
        if not isinstance(surface, ParametricSurface):
            raise TypeError(f"surface must be a ParametricSurface, not {shown(surface)}")
        if not isinstance(parameter, str) or not parameter.isidentifier():
            raise ValueError(f"parameter must be a name such as 's', not {shown(parameter)}")
        names: Names = (parameter, "")
        first, second = (
            component(one_parameter(e), names, name) for e, name in zip((t, h), surface.parameters, strict=True)
        )
        exact = None if first.exact is None or second.exact is None else (first.exact, second.exact)
        object.__setattr__(self, "surface", surface)
        object.__setattr__(self, "parameter", parameter)
        object.__setattr__(self, "path", (first.formula, second.formula))
        object.__setattr__(self, "exact_path", exact)

    @property
    def components(self) -> Components:
        """The exact coordinates as rational functions of the parameter; raises `ValueError` where there are none."""
        if self.exact_path is None:
            raise ValueError("the path of this curve is not exact; give it as rational functions over Q")
        x, y, z = (c.substitute(*self.exact_path) for c in self.surface.components)
        return x, y, z

    def parameters(self, s: ArrayLike) -> Floats:
        """The surface's parameters (t, h) at `s` (...): shape (..., 2)."""
        array = np.asarray(s, dtype=float)
        return np.stack([np.broadcast_to(f(array, 0.0), array.shape) for f in self.path], axis=-1)

    def __call__(self, s: ArrayLike) -> Floats:
        """Points at `s` (...): shape (..., 3).  Raises `ValueError` outside the surface's domain."""
        return self.surface(self.parameters(s))

    def derivative(self, s: ArrayLike, order: int = 1) -> Floats:
        """The derivative of the points of this order at `s` (...): shape (..., 3)."""
        check_derivative(order, "order")
        array = np.asarray(s, dtype=float)
        self.surface(self.parameters(array))  # speaks up outside the domain
        line, _ = variables(array, np.zeros_like(array), (order, 0))
        with np.errstate(all="ignore"):
            inner = [f(line, 0.0) for f in self.path]
            parts = self.surface.values(*inner)
        flat = np.zeros(array.shape)
        return np.stack([p.derivative(order, 0) if isinstance(p, Jet) else flat for p in parts], axis=-1)

    def tangents(self, s: ArrayLike) -> Floats:
        """Unit tangents at `s` (...): (..., 3); nan where the curve stops."""
        return unit(self.derivative(s))

    def normals(self, s: ArrayLike) -> Floats:
        """The surface's unit normals along the curve at `s` (...): (..., 3)."""
        return self.surface.normals(self.parameters(s))

    def across(self, s: ArrayLike) -> Floats:
        """Unit vectors in the tangent plane across the curve, normal x tangent, at `s` (...): (..., 3)."""
        return unit(np.cross(self.normals(s), self.tangents(s)))


def iso_curve(surface: ParametricSurface, t: Exact | None = None, h: Exact | None = None) -> SurfaceCurve:
    """The curve along which one parameter is constant: `iso_curve(surface, h="1/2")` runs along t.

    Its parameter is the surface's other one.  Raises `ValueError` unless exactly one of the two is given, and
    where that lies outside the domain.
    """
    if (t is None) == (h is None):
        raise ValueError("give exactly one of t and h: the parameter that is constant")
    fixed = 0 if h is None else 1
    value = rational(t if h is None else h, surface.parameters[fixed])
    if not surface.contains(value, fixed):
        low, high = surface.domain[fixed]
        raise ValueError(
            f"{surface.parameters[fixed]} = {short(plain(value))} lies outside the domain [{low:.6g}, {high:.6g}]"
        )
    free = surface.parameters[1 - fixed]
    return SurfaceCurve(surface, free if fixed else value, value if fixed else free, free)


def one_parameter(expression: Any) -> Any:
    """A callable of one array as one of two; an expression as it is."""
    symbolic = hasattr(expression, "free_symbols") or isinstance(expression, RationalFunction)
    return (lambda s, _: expression(s)) if callable(expression) and not symbolic else expression


@dataclass(frozen=True)
class Forms:
    """First and second forms (N, 2, 2) and unit normals (N, 3) of a surface at N places; nan at poles.

    With P_t, P_h and the normal N = P_t x P_h / |P_t x P_h| these are I = [P_i . P_j] and II = -[P_ij . N], whose sign
    is that of a ball with its normals outwards: the principal curvatures are the eigenvalues of I^-1 II, the normal
    curvature in a direction u is II(u, u) / I(u, u) (do Carmo 1976, chapter 3).
    """

    first: Floats
    second: Floats
    normals: Floats

    @classmethod
    def at(cls, surface: ParametricSurface, parameters: Floats) -> Forms:
        """The forms at parameters (N, 2)."""
        p, q = (surface.derivative(parameters, *orders) for orders in ((1, 0), (0, 1)))
        bends = [surface.derivative(parameters, *orders) for orders in ((2, 0), (1, 1), (0, 2))]
        cross = np.cross(p, q)
        length = np.linalg.norm(cross, axis=-1)
        sizes = np.linalg.norm(p, axis=-1) * np.linalg.norm(q, axis=-1)
        with np.errstate(all="ignore"):
            normals = cross / np.where(length > 1e-12 * sizes, length, np.nan)[:, None]
        first = _symmetric(*((u * v).sum(axis=-1) for u, v in ((p, p), (p, q), (q, q))))
        return cls(first, _symmetric(*(-(b * normals).sum(axis=-1) for b in bends)), normals)

    @property
    def principal(self) -> Floats:
        """Principal curvatures (N, 2), the larger first, positive where it bends like a ball with normals outwards."""
        (a, b, c), (e, f, g) = ((m[:, 0, 0], m[:, 0, 1], m[:, 1, 1]) for m in (self.first, self.second))
        with np.errstate(all="ignore"):
            area = a * c - b * b
            mean = (e * c - 2 * f * b + g * a) / (2 * area)
            gauss = (e * g - f * f) / area
            half = np.sqrt(np.maximum(mean * mean - gauss, 0.0))
        return np.stack([mean + half, mean - half], axis=1)

    def along(self, directions: Floats) -> Floats:
        """Normal curvatures (N,) in directions (2,) or (N, 2) of the parameters."""
        ways = np.broadcast_to(directions, (len(self.normals), 2))
        with np.errstate(all="ignore"):
            above, below = (np.einsum("ni,nij,nj->n", ways, form, ways) for form in (self.second, self.first))
            return np.asarray(above / below)

    def principal_for(self, normals: Floats) -> Floats:
        """`principal` as seen from the side to which `normals` (N, 3) point."""
        turned = (self.normals * normals).sum(axis=1) < 0
        return np.where(turned[:, None], -self.principal[:, ::-1], self.principal)


def _symmetric(a: Floats, b: Floats, c: Floats) -> Floats:
    return np.stack([np.stack([a, b], axis=-1), np.stack([b, c], axis=-1)], axis=-2)
