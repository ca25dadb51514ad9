"""Parametric surfaces and blends in project files (`.pas.json`): everything exact, and back.

Rational components are kept as terms of numerators and denominators, others as the expressions that were written;
domains by their exact ends.  A blend is kept as its data, order and method, and with its components, so
that other programs find them; on reading it is made anew, and the stored components win where they are others (a
member of the family of all blends, say).

Guaranteed: what is read is equal to what was written.  Not possible: callables, which have no text.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pas._version import __version__
from pas.algebra.rational import plain, rational, to_fraction
from pas.errors import PasError, ProjectFileError
from pas.exchange.container import check_name, write
from pas.exchange.generatrix_records import generatrix_record, read_generatrix
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.verdicts import GeneratrixCertificate
from pas.parametric.blends import ParametricBlend
from pas.parametric.data import BlendingData
from pas.parametric.methods import blend_by, method_of
from pas.parametric.proofs import ParametricCertificate
from pas.parametric.rational_function import RING, RationalFunction
from pas.parametric.surface import ParametricSurface

PARAMETRIC_SURFACE, PARAMETRIC_BLEND, GENERATRIX = "parametric surface", "parametric blend", "generatrix blend"
READ_ERRORS = (KeyError, TypeError, ValueError, IndexError, AttributeError, ZeroDivisionError, PasError)


def save_parametric(
    thing: ParametricSurface | ParametricBlend | GeneratrixBlend,
    path: str | Path,
    certificate: ParametricCertificate | GeneratrixCertificate | None = None,
) -> Path:
    """Write a parametric surface or blend, or a blend by a generatrix, as a project file; returns the path.

    `pas.load` reads it.  `certificate` goes with a blend for those who read the file; `pas check` proves anew.

    Raises `ValueError` unless the name ends in `.pas.json`, and for surfaces, boundaries and middle curves made of
    callables; `TypeError` for other things.
    """
    check_name(path)
    if isinstance(thing, ParametricBlend):
        content = {"kind": PARAMETRIC_BLEND, **_blend_record(thing), "verdicts": _verdicts(certificate)}
    elif isinstance(thing, GeneratrixBlend):
        content = {"kind": GENERATRIX, **generatrix_record(thing), "verdicts": _verdicts(certificate)}
    elif isinstance(thing, ParametricSurface):
        content = {"kind": PARAMETRIC_SURFACE, "surface": surface_record(thing)}
    else:
        raise TypeError(f"what to save must be a parametric surface or blend, not {thing!r}")
    return write(path, content, f"pas {__version__}")


def parametric_from_content(
    content: dict[str, Any], name: str
) -> ParametricSurface | ParametricBlend | GeneratrixBlend:
    """The surface or blend of a project file's content; raises `ProjectFileError`."""
    try:
        if content["kind"] == PARAMETRIC_SURFACE:
            return read_surface(content["surface"])
        return read_generatrix(content) if content["kind"] == GENERATRIX else _read_blend(content)
    except READ_ERRORS as error:
        raise ProjectFileError(
            f"{name}: the content cannot be understood ({type(error).__name__}: {error}); write it again"
        ) from None


def _verdicts(certificate: ParametricCertificate | GeneratrixCertificate | None) -> list[dict[str, Any]] | None:
    return None if certificate is None else [v.to_record() for v in certificate.verdicts]


def surface_record(surface: ParametricSurface) -> dict[str, Any]:
    """Everything that defines a surface; raises `ValueError` for one made of callables."""
    record: dict[str, Any] = {"parameters": list(surface.parameters), "domain": _domain_record(surface)}
    if surface.is_exact:
        return record | {"components": [_function_record(c) for c in surface.components]}
    if surface.text is None:
        raise ValueError(f"a surface without expressions cannot be saved ({surface.inexact}); write them as strings")
    return record | {"expressions": list(surface.text)}


def read_surface(record: dict[str, Any]) -> ParametricSurface:
    """The surface of `surface_record`."""
    first, second = map(str, record["parameters"])
    if "expressions" in record:
        a, b, c = map(str, record["expressions"])
        return ParametricSurface(a, b, c, (first, second), record["domain"])
    x, y, z = (_read_function(part, (first, second)) for part in record["components"])
    return ParametricSurface(x, y, z, (first, second), record["domain"])


def _blend_record(blend: ParametricBlend) -> dict[str, Any]:
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
        "domain": _domain_record(blend.surface),
        "components": [_function_record(c) for c in blend.surface.components] if blend.surface.is_exact else None,
    }


def _same(blend: ParametricBlend, other: ParametricBlend) -> bool:
    """Whether two surfaces that can only be evaluated have the same values at a few points."""
    low, high = blend.surface.domain[0]
    start = max(low, min(-1.0, high - 1.0))
    places = np.linspace(start, min(high, start + 2.0), 5), np.linspace(*blend.surface.domain[1], 5)
    first, second = (b.surface.with_domain(None).on_grid(*places) for b in (blend, other))
    return np.array_equal(first, second, equal_nan=True)


def _read_blend(content: dict[str, Any]) -> ParametricBlend:
    data = BlendingData([read_surface(s) for s in content["surfaces"]], content["values"])
    made = blend_by(content["method"], data, content["order"], content["options"])
    surface = made.surface.with_domain(content["domain"])
    if content["components"] is not None:
        names = surface.parameters
        x, y, z = (_read_function(c, names) for c in content["components"])
        if (x, y, z) != surface.components:
            surface = ParametricSurface(x, y, z, names, content["domain"])
    return ParametricBlend(data, made.order, surface, made.weights)


def _function_record(function: RationalFunction) -> list[list[list[Any]]]:
    """Terms [i, j, "p/q"] of t^i h^j of the numerator and of the denominator."""
    parts = (function.numerator, function.denominator)
    return [[[int(i), int(j), str(to_fraction(c))] for (i, j), c in part.to_dict().items()] for part in parts]


def _read_function(record: Any, names: tuple[str, str]) -> RationalFunction:
    above, below = (RING.from_dict({(i, j): rational(c) for i, j, c in part}) for part in record)
    return RationalFunction.quotient(above, below, names)


def _domain_record(surface: ParametricSurface) -> list[list[str | None]]:
    return [[None if end is None else str(end) for end in interval] for interval in surface.ends]
