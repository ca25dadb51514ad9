"""Parametric surfaces, their blends and rational patches as kinds of shapes: everything exact, and back.

Rational components are kept as terms of numerators and denominators, others as the expressions that were written;
domains by their exact ends; patches by their doubles and the fractions that these stand for.  A blend is kept as its
data, order and method, and with its components, so that other programs find them; on reading it is made anew, and where
that is no weighted sum the stored components win (a member of the family of all blends, say).

Not possible: callables, which have no text.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.rational import rational, to_fraction
from pas.exchange.records import COMPONENTS, DOMAIN, PARAMETRIC, exact_surface
from pas.exchange.schema import (
    ANYTHING,
    NUMBER,
    POINT,
    REAL,
    TEXT,
    WHOLE,
    Table,
    alone,
    list_of,
    maybe,
    table_of,
)
from pas.parametric.blends import ParametricBlend, blend_by, method_of
from pas.parametric.data import BlendingData
from pas.parametric.patches import ExactControl, RationalPatch, bezier_patches
from pas.parametric.surface import ParametricSurface
from pas.render.parametric import blend_layers, surface_layers
from pas.shape import Kind


def exact_patches(surface: ParametricSurface, domain: Any) -> Sequence[RationalPatch]:
    """Bezier patches that are the surface over a domain; raises `ValueError` for a surface that is not exact."""
    if not surface.is_exact:
        raise ValueError("the surface is not exact; write fit_patch(surface, tolerance) in its place")
    return bezier_patches(surface, domain)


SURFACE = Kind(
    "parametric surface",
    ParametricSurface,
    alone("surface", PARAMETRIC),
    surface_layers,
    patches=exact_patches,
    curved=True,
)


def _blend_entries(blend: ParametricBlend) -> dict[str, Any]:
    """Everything that defines a blend; raises `ValueError` for what has no exact text."""
    method, options = method_of(blend)
    if not blend.surface.is_exact and not _same(blend, blend_by(method, blend.data, blend.order, options)):
        raise ValueError(
            f"this surface is not what the method {method!r} makes of its data, and it is not exact to be kept"
        )
    return {
        "surfaces": blend.data.surfaces,
        "values": blend.data.values,
        "order": blend.order,
        "method": method,
        "options": options,
        "domain": blend.surface.ends,
        "components": blend.surface.components if blend.surface.is_exact else None,
    }


def _same(blend: ParametricBlend, other: ParametricBlend) -> bool:
    """Whether two surfaces that can only be evaluated have the same values at a few points."""
    low, high = blend.surface.domain[0]
    start = max(low, min(-1.0, high - 1.0))
    places = np.linspace(start, min(high, start + 2.0), 5), np.linspace(*blend.surface.domain[1], 5)
    first, second = (b.surface.with_domain(None).on_grid(*places) for b in (blend, other))
    return np.array_equal(first, second, equal_nan=True)


def _blend(surfaces: Any, values: Any, order: int, method: str, options: Any, domain: Any, components: Any) -> Any:
    """The blend of its data, made anew; of the stored components where it is no weighted sum."""
    data = BlendingData(surfaces, values)
    made = blend_by(method, data, order, options)
    surface = made.surface.with_domain(domain)
    if components is not None:
        stored = exact_surface(components, surface.parameters, domain)
        if stored.components != surface.components:
            if made.weights is not None:
                raise ValueError("components must be the weighted sum of the surfaces, and they are others")
            surface = stored
    return ParametricBlend(data, made.order, surface, made.weights)


_BLEND = Table(
    {
        "surfaces": list_of(PARAMETRIC),
        "values": list_of(NUMBER),
        "order": WHOLE,
        "method": TEXT,
        "options": table_of(ANYTHING),
        "domain": DOMAIN,
        "components": maybe(COMPONENTS),
    },
    make=_blend,
    entries=_blend_entries,
)
BLEND = Kind(
    "parametric blend",
    ParametricBlend,
    _BLEND,
    blend_layers,
    patches=lambda blend, domain: exact_patches(blend.surface, domain),
    curved=True,
    kept=True,
)


def _array(rows: Any, name: str, number: type) -> Any:
    if len({len(row) for row in rows}) != 1:
        raise ValueError(f"the rows of {name} must be equally long")
    return np.array(rows, dtype=number)


def _control(**entries: Any) -> ExactControl:
    def fractions(part: Any) -> Any:
        return [fractions(p) for p in part] if isinstance(part, list) else to_fraction(rational(part))

    return ExactControl(*(_array(fractions(entries[name]), "exact", object) for name in _EXACT.needs))


_EXACT = Table(
    {
        "points": list_of(list_of(POINT)),
        "weights": list_of(list_of(NUMBER)),
        "rectangle": list_of(list_of(NUMBER, 2), 2),
    },
    make=_control,
)


def _patch(points: Any, weights: Any, knots: Any, exact: ExactControl | None) -> RationalPatch:
    """A patch of doubles and, where they are known, the fractions that they stand for."""
    u, v = (np.array(k, dtype=float) for k in knots)
    patch = RationalPatch(_array(points, "points", float), _array(weights, "weights", float), (u, v), exact)
    if exact is not None:
        _check_rounded(patch, exact)
    return patch


_PATCH = Table(
    {
        "points": list_of(list_of(list_of(REAL, 3))),
        "weights": list_of(list_of(REAL)),
        "knots": list_of(list_of(REAL), 2),
        "exact": maybe(_EXACT),
    },
    make=_patch,
)


def _check_rounded(patch: RationalPatch, exact: ExactControl) -> None:
    """Raises `ValueError` unless the doubles of a patch are those nearest to its fractions."""
    if exact.points.shape != patch.points.shape or exact.weights.shape != patch.weights.shape:
        raise ValueError("the exact control points and weights must be as many as the rounded ones")
    for name in _EXACT.needs:
        doubles = np.array(patch.domain) if name == "rectangle" else getattr(patch, name)
        if not np.array_equal(getattr(exact, name).astype(float), doubles):
            ends = "ends of the knots" if name == "rectangle" else name
            raise ValueError(f"exact.{name} must be what the {ends} are rounded from, and they are others")


PATCH = Kind(
    "rational patch",
    RationalPatch,
    _PATCH,
    lambda patch, scene: surface_layers(patch.surface(), scene),
    patches=lambda patch, domain: (patch,),
    curved=True,
)
