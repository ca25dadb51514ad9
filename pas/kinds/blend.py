"""Blends as a kind of shape: the whole problem, the exact solution, the verdicts."""

from __future__ import annotations

from functools import cache
from operator import attrgetter
from typing import Any

from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import plain, rational
from pas.blending.solving import solve
from pas.certify.certificate import Certificate
from pas.exchange.cell_grid import cell_grid
from pas.exchange.records import (
    CERTIFICATE,
    CONSTRAINTS,
    ENERGY,
    constraints_record,
    read_constraints,
    read_surface,
    surface_record,
)
from pas.exchange.schema import NUMBER, REAL, TEXT, WHOLE, List, Maybe, OpenTable, Row, Table, TableOf
from pas.exchange.shapes import POLYNOMIAL, SURFACE, polynomial_record, read_polynomial
from pas.fairing.contradictions import check_kept
from pas.fairing.energy import read_energy
from pas.fairing.wishes import Wishes, check_member
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.space import SolutionSpace
from pas.render.piecewise import layers
from pas.render.scene import Scene
from pas.shape import Kind
from pas.surface.fairness_limits import FairnessLimits
from pas.verdicts import Verdicts

SOLUTION = Table(
    {
        "dimension": WHOLE,
        "basis": Maybe(List(List(POLYNOMIAL))),
        "coefficients": List(NUMBER),
        "energy": REAL,
        "attempts": List(Row((WHOLE, WHOLE, TEXT))),
        "seconds": TableOf(REAL),
    },
    {"attempt_seconds": List(REAL), "attempt_partitions": List(TEXT), "fairness": Maybe(OpenTable({}))},
)
LIMITS = Table({}, dict.fromkeys(FairnessLimits.__dataclass_fields__, REAL))
CONTENT = Table(
    {
        "surface": SURFACE,
        "problem": Table({"constraints": CONSTRAINTS, "energy": ENERGY}, {"limits": Maybe(LIMITS)}),
        "solution": SOLUTION,
        "certificate": CERTIFICATE,
    },
)
"""What a project file of a blend holds."""


def record(blend: Blend, _: Verdicts | None = None) -> dict[str, Any]:
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


def read(content: dict[str, Any]) -> Blend:
    """The blend of `record`: what can be found anew is, and what was asked of the surface must hold of it.

    Its energy, and what was tried in what time, are what the file tells.
    """
    solution, problem = content["solution"], content["problem"]
    surface, basis = read_surface(content["surface"]), _read_basis(solution["basis"])

    @cache
    def find_space() -> SolutionSpace:
        space = SolutionSpace.of(solve(surface.placed, surface.degree))
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
                of_attempts(solution, "attempt_seconds", 0.0),
                of_attempts(solution, "attempt_partitions", ""),
                strict=True,
            )
        ),
        wishes=wishes,
        find_space=find_space,
        stored=Certificate.from_record(content["certificate"]),
    )


def of_attempts(solution: dict[str, Any], key: str, usual: Any) -> list[Any]:
    """What is said of each attempt, which older files do not have."""
    attempts = solution["attempts"]
    found = solution.get(key, [usual] * len(attempts))
    if len(found) != len(attempts):
        raise ValueError(f"solution.{key} must have {len(attempts)} entries, one for each attempt")
    return list(found)


def _read_basis(record: Any) -> tuple[tuple[Polynomial, ...], ...] | None:
    return None if record is None else tuple(tuple(read_polynomial(p) for p in m) for m in record)


def _layers(blend: Blend, scene: Scene) -> None:
    layers(blend.surface, scene)


def _cells(blend: Blend) -> Any:
    return cell_grid(blend.surface)


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
    "blend", Blend, CONTENT, record, read, _layers, facts=_facts, text=str, body=Blend.solid, cells=_cells, open=True,
    curved=True, cast=attrgetter("surface"),
)  # fmt: skip
