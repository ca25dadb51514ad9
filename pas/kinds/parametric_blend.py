"""Parametric blends as a kind of shape.

A blend is kept as its data, order and method, and with its components, so that other programs find them; on reading it
is made anew, and where that is no weighted sum the stored components win (a member of the family of all blends, say).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.algebra.rational import plain
from pas.exchange.parametric_records import (
    COMPONENTS,
    DOMAIN,
    SURFACE,
    domain_record,
    function_record,
    read_function,
    read_surface,
    surface_record,
)
from pas.exchange.records import KEPT_VERDICTS, kept_verdicts
from pas.exchange.schema import ANYTHING, NUMBER, TEXT, WHOLE, List, Maybe, Table, TableOf
from pas.kinds.exact_patches import blend_patches
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend, blend_by, method_of
from pas.parametric.data import BlendingData
from pas.parametric.surface import ParametricSurface
from pas.render.parametric import blend_layers
from pas.shape import Kind
from pas.verdicts import Verdicts

CONTENT = Table(
    {
        "surfaces": List(SURFACE),
        "values": List(NUMBER),
        "order": WHOLE,
        "method": TEXT,
        "options": TableOf(ANYTHING),
        "domain": DOMAIN,
        "components": Maybe(COMPONENTS),
        "verdicts": KEPT_VERDICTS,
    }
)


def record(blend: ParametricBlend, certificate: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a blend; raises `ValueError` for what has no exact text."""
    method, options = method_of(blend)
    if not blend.surface.is_exact and not _same(blend, blend_by(method, blend.data, blend.order, options)):
        raise ValueError(
            f"this surface is not what the method {method!r} makes of its data, and it is not exact to be kept"
        )
    return {
        "surfaces": [surface_record(s) for s in blend.data.surfaces],
        "values": [plain(v) for v in blend.data.values],
        "order": blend.order,
        "method": method,
        "options": options,
        "domain": domain_record(blend.surface),
        "components": [function_record(c) for c in blend.surface.components] if blend.surface.is_exact else None,
        "verdicts": kept_verdicts(blend, certificate),
    }


def _same(blend: ParametricBlend, other: ParametricBlend) -> bool:
    """Whether two surfaces that can only be evaluated have the same values at a few points."""
    low, high = blend.surface.domain[0]
    start = max(low, min(-1.0, high - 1.0))
    places = np.linspace(start, min(high, start + 2.0), 5), np.linspace(*blend.surface.domain[1], 5)
    first, second = (b.surface.with_domain(None).on_grid(*places) for b in (blend, other))
    return np.array_equal(first, second, equal_nan=True)


def read(content: dict[str, Any]) -> ParametricBlend:
    """The blend of `record`."""
    data = BlendingData([read_surface(s) for s in content["surfaces"]], content["values"])
    made = blend_by(content["method"], data, content["order"], content["options"])
    surface = made.surface.with_domain(content["domain"])
    if content["components"] is not None:
        names = surface.parameters
        x, y, z = (read_function(c, names) for c in content["components"])
        if (x, y, z) != surface.components:
            if made.weights is not None:
                raise ValueError("components must be the weighted sum of the surfaces, and they are others")
            surface = ParametricSurface(x, y, z, names, content["domain"])
    return ParametricBlend(data, made.order, surface, made.weights)


def mesh(blend: ParametricBlend, tolerance: Any, domain: Any) -> Mesh:
    """The mesh over a domain."""
    return blend.mesh(tolerance, domain)


BLEND = Kind(
    "parametric blend",
    ParametricBlend,
    CONTENT,
    record,
    read,
    blend_layers,
    mesh=mesh,
    patches=blend_patches,
    curved=True,
)
