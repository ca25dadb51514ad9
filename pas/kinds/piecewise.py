"""Piecewise surfaces, blends, hollow blends and layouts as kinds of shapes: all exact.

A blend is kept with its whole problem, its solution and its verdicts; what can be found anew is found anew on reading,
and what was asked of the surface must hold of it.
"""

from __future__ import annotations

from functools import cache
from operator import attrgetter
from typing import Any

from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import plain, rational
from pas.blending.solving import solve
from pas.blending.space import Space
from pas.certify.certificate import Certificate
from pas.exchange.records import (
    CERTIFICATE,
    CONSTRAINTS,
    ENERGY,
    constraints_record,
    read_constraints,
    read_surface,
    surface_record,
)
from pas.exchange.schema import (
    NUMBER,
    POINT,
    POLYNOMIAL,
    REAL,
    TEXT,
    WHOLE,
    Table,
    list_of,
    maybe,
    polynomial_record,
    read_polynomial,
    row,
    table_of,
)
from pas.exchange.schema import SURFACE as FORM
from pas.fairing.contradictions import check_kept
from pas.fairing.energy import read_energy
from pas.fairing.wishes import Wishes, check_member
from pas.partition.layout import Layout
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import body
from pas.pipeline.chosen import Attempt
from pas.pipeline.hollow import HollowBlend, check_sides
from pas.pipeline.result import Blend
from pas.render.layout import layers as layout_layers
from pas.render.parts import solid_layers
from pas.render.piecewise import layers
from pas.shape import Kind
from pas.surface.fairness_limits import FairnessLimits
from pas.verdicts import Verdicts

SURFACE = Kind(
    "surface",
    PiecewiseSurface,
    Table({"surface": FORM}),
    lambda surface, _: {"surface": surface_record(surface)},
    lambda content: read_surface(content["surface"]),
    layers,
    piecewise=lambda surface: surface,
    body=body,
    curved=True,
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
)
_LIMITS = Table({}, dict.fromkeys(FairnessLimits.__dataclass_fields__, REAL))
_BLEND = Table(
    {
        "surface": FORM,
        "problem": Table({"constraints": CONSTRAINTS, "energy": ENERGY}, {"limits": maybe(_LIMITS)}),
        "solution": _SOLUTION,
        "certificate": CERTIFICATE,
    },
)
"""What a project file of a blend holds."""


def _record(blend: Blend, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a blend, proved first where that has not been done."""
    return {
        "problem": {
            "constraints": constraints_record(blend.wishes),
            "energy": blend.plate.to_record(),
            "limits": None if blend.wishes.limits is None else vars(blend.wishes.limits),
        },
        "surface": surface_record(blend.surface),
        "solution": {
            "dimension": blend.dimension,
            "basis": None if blend.basis is None else [[polynomial_record(p) for p in m] for m in blend.basis],
            "coefficients": _coefficients(blend),
            "energy": blend.energy,
            "attempts": [[a.degree, a.dimension, a.outcome] for a in blend.attempts],
            "seconds": blend.timings,
            "attempt_seconds": [a.seconds for a in blend.attempts],
            "attempt_partitions": [a.partition for a in blend.attempts],
            "fairness": blend.fairness.to_record() if blend.fairness is not None else None,
        },
        "certificate": blend.certificate.to_record(),
    }


def _coefficients(blend: Blend) -> list[str]:
    """The member's coefficients; none where the surface, which is then refuted, is that of a file and no member."""
    try:
        return [plain(rational(c)) for c in blend.coefficients]
    except ValueError:
        return []


def _read(content: dict[str, Any]) -> Blend:
    """The blend of `_record`: what can be found anew is, and what was asked of the surface must hold of it.

    Its energy, and what was tried in what time, are what the file tells.
    """
    solution, problem = content["solution"], content["problem"]
    surface, basis = read_surface(content["surface"]), _read_basis(solution["basis"])

    @cache
    def find_space() -> Space:
        space = solve(surface.placed, surface.degree)
        return space if basis is None else space.restricted(basis)

    def find_coefficients() -> list[fmpq]:
        """Those of the file where they give its surface, exactly, which is seen sooner than they are found."""
        space, told = find_space(), [rational(c) for c in solution["coefficients"]]
        if len(told) == space.dimension and space.member(told).polynomials == surface.polynomials:
            return told
        return [rational(c) for c in space.coordinates(surface.polynomials)]

    wishes = Wishes(
        energy=read_energy(problem["energy"]),
        limits=None if problem.get("limits") is None else FairnessLimits(**problem["limits"]),
        **read_constraints(problem["constraints"]),
    )
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
        stored=Certificate.from_record(content["certificate"]),
    )


def _of_attempts(solution: dict[str, Any], key: str, usual: Any) -> list[Any]:
    """What is said of each attempt, which older files do not have."""
    attempts = solution["attempts"]
    found = solution.get(key, [usual] * len(attempts))
    if len(found) != len(attempts):
        raise ValueError(f"solution.{key} must have {len(attempts)} entries, one for each attempt")
    return list(found)


def _read_basis(record: Any) -> tuple[tuple[Polynomial, ...], ...] | None:
    return None if record is None else tuple(tuple(read_polynomial(p) for p in m) for m in record)


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
    _record,
    _read,
    lambda blend, scene: layers(blend.surface, scene),
    _facts,
    piecewise=attrgetter("surface"),
    body=Blend.solid,
    open=True,
    curved=True,
)


def _hollow_record(hollow: HollowBlend[Blend], _: Verdicts | None = None) -> dict[str, Any]:
    """Both blends, each as files keep it, and the thickness."""
    return {
        "outer": _record(hollow.outer),
        "inner": _record(hollow.inner),
        "thickness": None if hollow.thickness is None else plain(hollow.thickness),
    }


def _read_hollow(content: dict[str, Any]) -> HollowBlend[Blend]:
    """The hollow blend of `_hollow_record`; that the one is inside the other is proved again when it is asked for.

    The inner contacts must be those that the outer ones and the thickness come to.
    """
    thickness = None if content["thickness"] is None else rational(content["thickness"], "thickness")
    outer, inner = (_read(content[side]) for side in ("outer", "inner"))
    check_sides(outer, inner, thickness)
    return HollowBlend(outer, inner, thickness)


HOLLOW_BLEND = Kind(
    "hollow blend",
    HollowBlend,
    Table({"outer": _BLEND, "inner": _BLEND, "thickness": maybe(NUMBER)}),
    _hollow_record,
    _read_hollow,
    solid_layers,
    lambda hollow: {"outer": _facts(hollow.outer), "inner": _facts(hollow.inner)},
    body=HollowBlend.solid,
)

_LAYOUT = Table({"center": POINT, "rays": list_of(list_of(WHOLE, 3)), "pieces": list_of(list_of(WHOLE)), "name": TEXT})
LAYOUT = Kind(
    "layout",
    Layout,
    Table({"layout": _LAYOUT}),
    lambda layout, _: {"layout": layout.to_record()},
    lambda content: Layout.from_record(content["layout"]),
    layout_layers,
)
