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
from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import HIGHEST_POWER, shown
from pas.algebra.rational import plain, rational, to_fraction
from pas.algebra.rational_function import RING, RationalFunction
from pas.exchange.records import KEPT_VERDICTS, kept_verdicts
from pas.exchange.schema import ANYTHING, NUMBER, POINT, REAL, TEXT, WHOLE, Table, choice, list_of, maybe, row, table_of
from pas.parametric.blends import ParametricBlend, blend_by, method_of
from pas.parametric.data import BlendingData
from pas.parametric.patches import ExactControl, RationalPatch, bezier_patches
from pas.parametric.surface import ParametricSurface
from pas.render.parametric import blend_layers, surface_layers
from pas.shape import Kind
from pas.verdicts import Verdicts

_TERMS = list_of(row(WHOLE, WHOLE, NUMBER), words="a list of terms")
_COMPONENTS = list_of(row(_TERMS, _TERMS), 3)
_DOMAIN = list_of(row(maybe(NUMBER), maybe(NUMBER)), 2)
_PARAMETERS = list_of(TEXT, 2)
_SURFACE = choice(
    "a surface: a table with components or expressions",
    Table({"components": _COMPONENTS, "parameters": _PARAMETERS, "domain": _DOMAIN}),
    Table({"expressions": list_of(TEXT, 3), "parameters": _PARAMETERS, "domain": _DOMAIN}),
)


def _surface_record(surface: ParametricSurface) -> dict[str, Any]:
    """Everything that defines a surface; raises `ValueError` for one made of callables."""
    record: dict[str, Any] = {"parameters": list(surface.parameters), "domain": _domain_record(surface)}
    if surface.is_exact:
        return record | {"components": [_function_record(c) for c in surface.components]}
    if surface.text is None:
        raise ValueError(f"a surface without expressions cannot be saved ({surface.inexact}); write them as strings")
    return record | {"expressions": list(surface.text)}


def _read_surface(record: dict[str, Any]) -> ParametricSurface:
    """The surface of `_surface_record`."""
    first, second = record["parameters"]
    if "expressions" in record:
        a, b, c = record["expressions"]
        return ParametricSurface(a, b, c, (first, second), record["domain"])
    x, y, z = (_read_function(part, (first, second)) for part in record["components"])
    return ParametricSurface(x, y, z, (first, second), record["domain"])


def _function_record(function: RationalFunction) -> list[list[list[Any]]]:
    """Terms [i, j, "p/q"] of t^i h^j of the numerator and of the denominator."""
    parts = (function.numerator, function.denominator)
    return [[[int(i), int(j), plain(c)] for (i, j), c in part.to_dict().items()] for part in parts]


def _read_function(record: Any, names: tuple[str, str]) -> RationalFunction:
    """The function of `_function_record`."""
    above, below = map(_read_terms, record)
    return RationalFunction.quotient(above, below, names)


def _read_terms(record: Any) -> fmpq_mpoly:
    terms: dict[tuple[int, ...], fmpq] = {}
    for i, j, coefficient in record:
        if min(i, j) < 0 or i + j > HIGHEST_POWER or (i, j) in terms:
            wrong = "stands twice" if (i, j) in terms else f"must have exponents >= 0 of sum up to {HIGHEST_POWER}"
            raise ValueError(f"the term {shown([i, j, coefficient])} of a component {wrong}")
        terms[i, j] = rational(coefficient, "a coefficient")
    return RING.from_dict(terms)


def _domain_record(surface: ParametricSurface) -> list[list[str | None]]:
    """The exact ends of the domain, null for infinite ones."""
    return [[None if end is None else str(end) for end in interval] for interval in surface.ends]


def exact_patches(surface: ParametricSurface, domain: Any) -> Sequence[RationalPatch]:
    """Bezier patches that are the surface over a domain; raises `ValueError` for a surface that is not exact."""
    if not surface.is_exact:
        raise ValueError("the surface is not exact; write fit_patch(surface, tolerance) in its place")
    return bezier_patches(surface, domain)


SURFACE = Kind(
    "parametric surface",
    ParametricSurface,
    Table({"surface": _SURFACE}),
    lambda surface, _: {"surface": _surface_record(surface)},
    lambda content: _read_surface(content["surface"]),
    surface_layers,
    patches=exact_patches,
    curved=True,
)

_BLEND = Table(
    {
        "surfaces": list_of(_SURFACE),
        "values": list_of(NUMBER),
        "order": WHOLE,
        "method": TEXT,
        "options": table_of(ANYTHING),
        "domain": _DOMAIN,
        "components": maybe(_COMPONENTS),
        "verdicts": KEPT_VERDICTS,
    }
)


def _blend_record(blend: ParametricBlend, certificate: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a blend; raises `ValueError` for what has no exact text."""
    method, options = method_of(blend)
    if not blend.surface.is_exact and not _same(blend, blend_by(method, blend.data, blend.order, options)):
        raise ValueError(
            f"this surface is not what the method {method!r} makes of its data, and it is not exact to be kept"
        )
    return {
        "surfaces": [_surface_record(s) for s in blend.data.surfaces],
        "values": [plain(v) for v in blend.data.values],
        "order": blend.order,
        "method": method,
        "options": options,
        "domain": _domain_record(blend.surface),
        "components": [_function_record(c) for c in blend.surface.components] if blend.surface.is_exact else None,
        "verdicts": kept_verdicts(blend, certificate),
    }


def _same(blend: ParametricBlend, other: ParametricBlend) -> bool:
    """Whether two surfaces that can only be evaluated have the same values at a few points."""
    low, high = blend.surface.domain[0]
    start = max(low, min(-1.0, high - 1.0))
    places = np.linspace(start, min(high, start + 2.0), 5), np.linspace(*blend.surface.domain[1], 5)
    first, second = (b.surface.with_domain(None).on_grid(*places) for b in (blend, other))
    return np.array_equal(first, second, equal_nan=True)


def _read_blend(content: dict[str, Any]) -> ParametricBlend:
    """The blend of `_blend_record`."""
    data = BlendingData([_read_surface(s) for s in content["surfaces"]], content["values"])
    made = blend_by(content["method"], data, content["order"], content["options"])
    surface = made.surface.with_domain(content["domain"])
    if content["components"] is not None:
        names = surface.parameters
        x, y, z = (_read_function(c, names) for c in content["components"])
        if (x, y, z) != surface.components:
            if made.weights is not None:
                raise ValueError("components must be the weighted sum of the surfaces, and they are others")
            surface = ParametricSurface(x, y, z, names, content["domain"])
    return ParametricBlend(data, made.order, surface, made.weights)


BLEND = Kind(
    "parametric blend",
    ParametricBlend,
    _BLEND,
    _blend_record,
    _read_blend,
    blend_layers,
    patches=lambda blend, domain: exact_patches(blend.surface, domain),
    curved=True,
)

_EXACT = Table(
    {
        "points": list_of(list_of(POINT)),
        "weights": list_of(list_of(NUMBER)),
        "rectangle": list_of(list_of(NUMBER, 2), 2),
    }
)
_PATCH = Table(
    {
        "points": list_of(list_of(list_of(REAL, 3))),
        "weights": list_of(list_of(REAL)),
        "knots": list_of(list_of(REAL), 2),
        "exact": maybe(_EXACT),
    }
)


def _patch_record(patch: RationalPatch, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a patch: doubles and, where they are known, the fractions that they stand for."""
    exact = patch.exact
    names = ("points", "weights", "rectangle")
    return {
        "points": patch.points.tolist(),
        "weights": patch.weights.tolist(),
        "knots": [knots.tolist() for knots in patch.knots],
        "exact": None if exact is None else {n: _texts(getattr(exact, n)) for n in names},
    }


def _read_patch(content: dict[str, Any]) -> RationalPatch:
    """The patch of `_patch_record`."""
    u, v = (np.array(knots, dtype=float) for knots in content["knots"])
    kept = content["exact"]
    exact = None if kept is None else ExactControl(*(_fractions(kept[n]) for n in ("points", "weights", "rectangle")))
    points, weights = (_array(content[name], name, float) for name in ("points", "weights"))
    patch = RationalPatch(points, weights, (u, v), exact)
    if exact is not None:
        _check_rounded(patch, exact)
    return patch


def _check_rounded(patch: RationalPatch, exact: ExactControl) -> None:
    """Raises `ValueError` unless the doubles of a patch are those nearest to its fractions."""
    if exact.points.shape != patch.points.shape or exact.weights.shape != patch.weights.shape:
        raise ValueError("the exact control points and weights must be as many as the rounded ones")
    pairs = {
        "points": (exact.points, patch.points),
        "weights": (exact.weights, patch.weights),
        "rectangle": (exact.rectangle, np.array(patch.domain)),
    }
    for name, (fractions, doubles) in pairs.items():
        if not np.array_equal(fractions.astype(float), doubles):
            ends = "ends of the knots" if name == "rectangle" else name
            raise ValueError(f"exact.{name} must be what the {ends} are rounded from, and they are others")


def _texts(numbers: Any) -> Any:
    if np.ndim(numbers):
        return [_texts(part) for part in numbers]
    return plain(rational(numbers))


def _fractions(texts: Any) -> Any:
    def read_all(part: Any) -> Any:
        return [read_all(p) for p in part] if isinstance(part, list) else to_fraction(rational(part))

    return _array(read_all(texts), "exact", object)


def _array(rows: Any, name: str, number: type) -> Any:
    if len({len(row) for row in rows}) != 1:
        raise ValueError(f"the rows of {name} must be equally long")
    return np.array(rows, dtype=number)


PATCH = Kind(
    "rational patch",
    RationalPatch,
    _PATCH,
    _patch_record,
    _read_patch,
    lambda patch, scene: surface_layers(patch.surface(), scene),
    patches=lambda patch, domain: (patch,),
    curved=True,
)
