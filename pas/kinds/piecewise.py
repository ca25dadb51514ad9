"""Piecewise surfaces, blends, hollow blends and layouts as kinds of shapes: all exact.

A blend is kept with its whole problem, its solution and its verdicts; what can be found anew is found anew on reading,
and what was asked of the surface must hold of it.
"""

from __future__ import annotations

from functools import cache
from operator import attrgetter
from typing import Any

from flint import fmpq

from pas.algebra.rational import plain, rational
from pas.blending.solving import solve
from pas.blending.space import Space
from pas.certify.certificate import Certificate
from pas.exchange.records import CONSTRAINTS, ENERGY, VERDICT
from pas.exchange.records import SURFACE as FORM
from pas.exchange.schema import (
    NUMBER,
    POINT,
    POLYNOMIAL,
    REAL,
    TEXT,
    WHOLE,
    Table,
    alone,
    list_of,
    maybe,
    read_by,
    row,
    table_of,
)
from pas.fairing.contradictions import check_kept
from pas.fairing.wishes import Wishes, check_member
from pas.partition.layout import Layout
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import body
from pas.pipeline.chosen import Attempt
from pas.pipeline.hollow import HollowBlend, check_sides
from pas.pipeline.result import Blend
from pas.render.layout import layers as layout_layers
from pas.render.piecewise import layers
from pas.render.scene import solid_layers
from pas.shape import Kind
from pas.surface.fairness_limits import FairnessLimits

SURFACE = Kind(
    "surface",
    PiecewiseSurface,
    alone("surface", FORM),
    layers,
    piecewise=lambda surface: surface,
    body=body,
    curved=True,
)

_VERDICTS = list_of(VERDICT)
_CERTIFICATE = read_by(
    Table(
        {"contacts": _VERDICTS, "faces": _VERDICTS, "one_sheet": VERDICT, "enclosed": VERDICT}, {"further": _VERDICTS}
    ),
    Certificate.from_record,
    Certificate.to_record,
)
_LIMITS = dict.fromkeys(FairnessLimits.__dataclass_fields__, REAL)
_PROBLEM = Table(
    {"constraints": CONSTRAINTS, "energy": ENERGY},
    {"limits": maybe(Table({}, _LIMITS, make=FairnessLimits, entries=vars))},
    make=lambda constraints, energy, limits=None: Wishes(**constraints, energy=energy, limits=limits),
    entries=lambda blend: {"constraints": blend.wishes, "energy": blend.plate, "limits": blend.wishes.limits},
)
_SOLUTION = Table(
    {
        "dimension": WHOLE,
        "basis": maybe(list_of(list_of(POLYNOMIAL))),
        "coefficients": list_of(NUMBER),
        "energy": REAL,
        "attempts": list_of(row(WHOLE, WHOLE, TEXT)),
        "seconds": table_of(REAL),
    },
    {"attempt_seconds": list_of(REAL), "attempt_partitions": list_of(TEXT), "fairness": maybe(Table({}, open=True))},
    entries=lambda blend: {
        "dimension": blend.dimension,
        "basis": blend.basis,
        "coefficients": _coefficients(blend),
        "energy": blend.energy,
        "attempts": [[a.degree, a.dimension, a.outcome] for a in blend.attempts],
        "seconds": blend.timings,
        "attempt_seconds": [a.seconds for a in blend.attempts],
        "attempt_partitions": [a.partition for a in blend.attempts],
        "fairness": None if blend.fairness is None else blend.fairness.to_record(),
    },
)


def _coefficients(blend: Blend) -> list[Any]:
    """The member's coefficients; none where the surface, which is then refuted, is that of a file and no member."""
    try:
        return list(blend.coefficients)
    except ValueError:
        return []


def _blend(surface: PiecewiseSurface, problem: Wishes, solution: dict[str, Any], certificate: Certificate) -> Blend:
    """The blend of a file: what can be found anew is, and what was asked of the surface must hold of it.

    Its energy, and what was tried in what time, are what the file tells.
    """
    wishes, basis = problem, None if solution["basis"] is None else tuple(map(tuple, solution["basis"]))

    @cache
    def find_space() -> Space:
        space = solve(surface.placed, surface.degree)
        return space if basis is None else space.restricted(basis)

    def find_coefficients() -> list[fmpq]:
        """The file's coefficients, if they give its surface, exactly, which is checked faster than they are found."""
        space, told = find_space(), [rational(c) for c in solution["coefficients"]]
        if len(told) == space.dimension and space.member(told).polynomials == surface.polynomials:
            return told
        return [rational(c) for c in space.coordinates(surface.polynomials)]

    check_kept(wishes, surface)
    if basis is not None or wishes.coefficients:
        found = find_coefficients()  # raises where the basis is none, or the surface is not of it
        for number, value in wishes.coefficients:
            check_member(number, len(found))
            if found[number] != value:
                raise ValueError(f"coefficient {number} must be {plain(value)}, and that of the surface is another")
    return Blend(
        surface=surface,
        basis=basis,
        find_coefficients=find_coefficients,
        energy=float(solution["energy"]),
        timings={stage: float(spent) for stage, spent in solution["seconds"].items()},
        attempts=tuple(
            Attempt(n, m, outcome, float(spent), where)
            for (n, m, outcome), spent, where in zip(
                solution["attempts"],
                _of_attempts(solution, "attempt_seconds", 0.0),
                _of_attempts(solution, "attempt_partitions", ""),
                strict=True,
            )
        ),
        wishes=wishes,
        find_space=find_space,
        stored=certificate,
    )


def _of_attempts(solution: dict[str, Any], key: str, usual: Any) -> list[Any]:
    """An entry of each attempt, which older files do not have."""
    attempts = solution["attempts"]
    found = solution.get(key, [usual] * len(attempts))
    if len(found) != len(attempts):
        raise ValueError(f"solution.{key} must have {len(attempts)} entries, one for each attempt")
    return list(found)


_BLEND = Table(
    {"surface": FORM, "problem": _PROBLEM, "solution": _SOLUTION, "certificate": _CERTIFICATE},
    make=_blend,
    entries=lambda blend: {
        "problem": blend, "surface": blend.surface, "solution": blend, "certificate": blend.certificate,
    },
)  # fmt: skip
"""The form of a project file of a blend; it is proved first where that has not been done."""


def _facts(blend: Blend) -> dict[str, Any]:
    """How it was chosen, and how fair it is."""
    return {
        "degree": blend.surface.degree,
        "dimension": blend.dimension,
        "energy": {**blend.plate.to_record(), "value": blend.energy},
        "attempts": [vars(attempt) for attempt in blend.attempts],
        "fairness": None if blend.fairness is None else blend.fairness.to_record(),
        "beyond": [] if blend.fairness is None else list(blend.fairness.beyond(blend.limits)),
    }


BLEND = Kind(
    "blend",
    Blend,
    _BLEND,
    lambda blend, scene: layers(blend.surface, scene),
    _facts,
    piecewise=attrgetter("surface"),
    body=Blend.solid,
    open=True,
    curved=True,
)


def _hollow(outer: Blend, inner: Blend, thickness: str | None) -> HollowBlend[Blend]:
    """The hollow blend of two; that the one is inside the other is proved again when it is asked for.

    The inner contacts must be those that the outer ones and the thickness come to.
    """
    wall = None if thickness is None else rational(thickness, "thickness")
    check_sides(outer, inner, wall)
    return HollowBlend(outer, inner, wall)


HOLLOW_BLEND = Kind(
    "hollow blend",
    HollowBlend,
    Table({"outer": _BLEND, "inner": _BLEND, "thickness": maybe(NUMBER)}, make=_hollow),
    solid_layers,
    lambda hollow: {"outer": _facts(hollow.outer), "inner": _facts(hollow.inner)},
    body=HollowBlend.solid,
    solid=HollowBlend.solid,
)

_LAYOUT = Table({"center": POINT, "rays": list_of(list_of(WHOLE, 3)), "pieces": list_of(list_of(WHOLE)), "name": TEXT})
LAYOUT = Kind(
    "layout",
    Layout,
    alone("layout", read_by(_LAYOUT, Layout.from_record, Layout.to_record)),
    layout_layers,
)
