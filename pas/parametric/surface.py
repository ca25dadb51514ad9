"""Parametric surfaces, which can be proved, meshed within a tolerance, drawn and saved; curves on them, and curvatures.

Meshes are made in the surface's own frame, so that neither its units nor those of the parameters matter.  Sides that
close up share their vertices, sides and lines that shrink to a point have one vertex, no triangle has two equal
vertices, and triangles are oriented along dP/dt x dP/dh.

A path s -> (t(s), h(s)) gives the curve P(t(s), h(s)); with it come the surface's normals along the curve and the
direction across the curve in the tangent plane, which is what a blend starts from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.affine import Affine, AffineShape
from pas.algebra.brief import brief
from pas.algebra.callables import ComponentLike, component, is_function, texts_of
from pas.algebra.expressions import Formula, Names
from pas.algebra.inputs import check_derivative, set_fields, short, shown
from pas.algebra.jets import Jet, variables
from pas.algebra.lengths import unit
from pas.algebra.rational import Exact, check_tolerance, plain, rational, three
from pas.algebra.rational_function import RationalFunction
from pas.arrays import Floats
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.maps import DomainLike, ParametricMap
from pas.parametric.meshing import CellMesher
from pas.parametric.nets import Framed, exact_rectangle
from pas.parametric.regularity import regularity
from pas.parametric.series import Components
from pas.parametric.solids import solid_of
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape
from pas.solid.solid import Solid
from pas.verdicts import Findings

ParametricMesh = Mesh
"""The former name of the meshes of parametric surfaces."""

PARTS = tuple((n, m) for m in (1, 3) for n in (1, 3))
"""Into how many parts each way the rectangle is cut first, before parts are halved; usually there is one."""

WAYS = {
    Quality.BALANCED: ((PARTS[0], False),),
    Quality.COUNT: tuple((parts, False) for parts in PARTS),
    Quality.ANGLES: ((PARTS[0], False), *((parts, True) for parts in PARTS)),
}
"""Such parts, and whether long cells are halved as well: the best of these meshes is kept."""


class ParametricSurface(ParametricMap, AffineShape["ParametricSurface"], Shape):
    __doc__ = (ParametricMap.__doc__ or "").replace("A map (x, y, z)", "A surface (x, y, z)")
    kind = "parametric surface"

    @cached_property
    def certificate(self) -> Findings:
        """The verdict of `pas.regularity` on the whole domain, worked out when first asked for."""
        return Findings((regularity(self),))

    @limited("meshing a surface", "a coarser tolerance or a smaller domain")
    def mesh(
        self,
        tolerance: Exact | None = None,
        domain: DomainLike = None,
        *,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """A triangle mesh, with normals, nowhere further than `tolerance` from the surface.

        The tolerance is by default a thousandth of the surface's extent.  `domain` is that of the mesh, None for a
        parameter or an end that the surface's own bounds.  The bound is proved for exact surfaces, measured for
        others; the mesh says which.  Of some meshes the `quality` "angles" takes that with the largest smallest angle,
        "count" that with fewest triangles; for "angles" long cells are halved as well.  Raises `ValueError` for an
        infinite domain, `GeometryError` near poles, `MeshError` for a tolerance that needs too many triangles.
        """
        how = Quality.of(quality)
        rectangle = exact_rectangle(self, domain)
        framed = Framed.of(self.with_domain(rectangle))
        wanted = RELATIVE_TOLERANCE * framed.size
        if tolerance is not None:
            wanted = framed.inside(check_tolerance(tolerance, framed.outside(framed.size)))
        makers = (CellMesher(framed, rectangle, wanted, *way).mesh for way in WAYS[how])
        return self._kept((wanted, rectangle, how), lambda: how.best_of(makers))

    def _moved(self, map_: Affine) -> ParametricSurface:
        return self.moved(map_.matrix, map_.shift)

    @limited("making a solid of a surface", "a smaller domain")
    def solid(self, face: str = "surface", **limits: Unpack[WorkLimits]) -> Solid:
        """The body that the surface bounds, as a `pas.solid.Solid` with a face of that name.

        The surface is closed, as a ball's or a ring's are, or has ends in planes, as a vase or a tube has, which are
        closed by flat faces, "surface start" and "surface end".  Raises `ValueError` for an infinite domain,
        `GeometryError` where it has other edges, an end that is not plane, or passes through itself.

            pas.surface_of_revolution("1 + h^2/4", "h", angle=True, interval=(-1, 2)).solid("vase")
        """
        return solid_of(self, self.mesh(), face)


@dataclass(frozen=True, eq=False, init=False)
class SurfaceCurve:
    """The curve P(t(s), h(s)) on a parametric surface.

    `t` and `h` are expressions in the one parameter `parameter`: strings, sympy expressions, numbers or
    callables of one array; `texts` are those as strings, None for callables.  Raises `ValueError` for one that
    cannot be read.
    """

    surface: ParametricSurface
    parameter: str
    path: tuple[Formula, Formula]
    exact_path: tuple[RationalFunction, RationalFunction] | None
    texts: Sequence[str] | None = field(repr=False)

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
        path, texts = (first.formula, second.formula), texts_of((t, h), names)
        set_fields(self, surface=surface, parameter=parameter, path=path, exact_path=exact, texts=texts)

    @property
    def components(self) -> Components:
        """The exact coordinates as rational functions of the parameter; raises `ValueError` where there are none."""
        if self.exact_path is None:
            raise ValueError("the path of this curve is not exact; give it as rational functions over Q")
        return three(c.substitute(*self.exact_path) for c in self.surface.components)

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
            parts = self.surface.values(*(f(line, 0.0) for f in self.path))
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
    return (lambda s, _: expression(s)) if is_function(expression) else expression


@dataclass(frozen=True)
class Forms:
    """First and second forms, E, F, G and L, M, N, (N, 3) each, and unit normals (N, 3) at N places; nan at poles.

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
        p, q, *bends = np.moveaxis(surface.partials(parameters, (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)), -2, 0)
        cross = np.cross(p, q)
        length = np.linalg.norm(cross, axis=-1)
        sizes = np.linalg.norm(p, axis=-1) * np.linalg.norm(q, axis=-1)
        with np.errstate(all="ignore"):
            normals = cross / np.where(length > 1e-12 * sizes, length, np.nan)[:, None]
        first = [(u * v).sum(axis=-1) for u, v in ((p, p), (p, q), (q, q))]
        second = [-(b * normals).sum(axis=-1) for b in bends]
        return cls(np.stack(first, axis=-1), np.stack(second, axis=-1), normals)

    @property
    def principal(self) -> Floats:
        """Principal curvatures (N, 2), the larger first, positive where it bends like a ball with normals outwards."""
        (a, b, c), (e, f, g) = self.first.T, self.second.T
        with np.errstate(all="ignore"):
            area = a * c - b * b
            mean = (e * c - 2 * f * b + g * a) / (2 * area)
            gauss = (e * g - f * f) / area
            half = np.sqrt(np.maximum(mean * mean - gauss, 0.0))
        return np.stack([mean + half, mean - half], axis=1)

    def along(self, directions: Floats) -> Floats:
        """Normal curvatures (N,) in directions (2,) or (N, 2) of the parameters."""
        u, v = np.broadcast_to(directions, (len(self.normals), 2)).T
        terms = np.stack([u * u, 2 * u * v, v * v], axis=-1)
        with np.errstate(all="ignore"):
            return np.asarray((self.second * terms).sum(axis=1) / (self.first * terms).sum(axis=1))

    def principal_for(self, normals: Floats) -> Floats:
        """`principal` as seen from the side to which `normals` (N, 3) point."""
        turned = (self.normals * normals).sum(axis=1) < 0
        return np.where(turned[:, None], -self.principal[:, ::-1], self.principal)
