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
from flint import fmpq, fmpq_mpoly

from pas._version import __version__
from pas.algebra.inputs import HIGHEST_POWER, shown
from pas.algebra.rational import plain, rational
from pas.algebra.rational_function import RING, RationalFunction
from pas.exchange.container import check_name, understood, write
from pas.exchange.generatrix_records import GENERATRIX_DATA, generatrix_record, read_generatrix
from pas.exchange.records import VERDICT
from pas.exchange.schema import ANYTHING, NUMBER, TEXT, WHOLE, Choice, List, Maybe, Row, Table, TableOf, check
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.verdicts import GeneratrixCertificate
from pas.limits import Report, limited
from pas.parametric.blends import ParametricBlend
from pas.parametric.data import BlendingData
from pas.parametric.methods import blend_by, method_of
from pas.parametric.proofs import ParametricCertificate
from pas.parametric.surface import ParametricSurface

PARAMETRIC_SURFACE, PARAMETRIC_BLEND, GENERATRIX = "parametric surface", "parametric blend", "generatrix blend"

TERMS = List(Row((WHOLE, WHOLE, NUMBER)), words="a list of terms")
COMPONENTS = List(Row((TERMS, TERMS)), 3)
DOMAIN = List(Row((Maybe(NUMBER), Maybe(NUMBER))), 2)
_PARAMETERS = List(TEXT, 2)
SURFACE = Choice(
    (
        Table({"components": COMPONENTS, "parameters": _PARAMETERS, "domain": DOMAIN}),
        Table({"expressions": List(TEXT, 3), "parameters": _PARAMETERS, "domain": DOMAIN}),
    ),
    "a surface: a table with components or expressions",
)
VERDICTS = Maybe(List(VERDICT))
CONTENTS = {
    PARAMETRIC_SURFACE: Table({"kind": TEXT, "surface": SURFACE}),
    PARAMETRIC_BLEND: Table(
        {
            "kind": TEXT,
            "surfaces": List(SURFACE),
            "values": List(NUMBER),
            "order": WHOLE,
            "method": TEXT,
            "options": TableOf(ANYTHING),
            "domain": DOMAIN,
            "components": Maybe(COMPONENTS),
            "verdicts": VERDICTS,
        }
    ),
    GENERATRIX: Table({"kind": TEXT, **GENERATRIX_DATA, "verdicts": VERDICTS}),
}
"""What project files of parametric surfaces and blends hold, by kind."""


@limited("writing a project file", "")
def save_parametric(
    thing: ParametricSurface | ParametricBlend | GeneratrixBlend,
    path: str | Path,
    certificate: ParametricCertificate | GeneratrixCertificate | None = None,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Write a parametric surface or blend, or a blend by a generatrix, as a project file; returns the path.

    `pas.load` reads it.  `certificate`, that of the blend, goes with it for those who read the file; no program
    believes it, and `pas check` proves anew.

    Raises `ValueError` unless the name ends in `.pas.json`, for the certificate of another blend, and for surfaces,
    boundaries and middle curves made of callables; `TypeError` for other things.
    """
    check_name(path)
    if isinstance(thing, ParametricBlend):
        content = {"kind": PARAMETRIC_BLEND, **_blend_record(thing), "verdicts": _verdicts(thing, certificate)}
    elif isinstance(thing, GeneratrixBlend):
        content = {"kind": GENERATRIX, **generatrix_record(thing), "verdicts": _verdicts(thing, certificate)}
    elif isinstance(thing, ParametricSurface):
        content = {"kind": PARAMETRIC_SURFACE, "surface": surface_record(thing)}
    else:
        raise TypeError(f"what to save must be a parametric surface or blend, not {thing!r}")
    return write(path, content, f"pas {__version__}")


def parametric_from_content(
    content: dict[str, Any], name: str
) -> ParametricSurface | ParametricBlend | GeneratrixBlend:
    """The surface or blend of a project file's content; raises `ProjectFileError`."""
    with understood(name):
        check(content, CONTENTS[content["kind"]], "content")
        if content["kind"] == PARAMETRIC_SURFACE:
            return read_surface(content["surface"])
        return read_generatrix(content) if content["kind"] == GENERATRIX else _read_blend(content)


def _verdicts(
    blend: ParametricBlend | GeneratrixBlend, certificate: ParametricCertificate | GeneratrixCertificate | None
) -> list[dict[str, Any]] | None:
    """The verdicts of a certificate, which must be that of the blend; on regularity it may be of another domain."""
    if certificate is None:
        return None
    if type(certificate) is not type(blend.certificate) or certificate.contacts != blend.certificate.contacts:
        raise ValueError("certificate must be that of the blend that is saved, and it is another's")
    return [v.to_record() for v in certificate.verdicts]


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
    first, second = record["parameters"]
    if "expressions" in record:
        a, b, c = record["expressions"]
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
    return [[[int(i), int(j), plain(c)] for (i, j), c in part.to_dict().items()] for part in parts]


def _read_function(record: Any, names: tuple[str, str]) -> RationalFunction:
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
    return [[None if end is None else str(end) for end in interval] for interval in surface.ends]
