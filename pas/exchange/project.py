"""Blends as project files (`.pas.json`): the whole problem, the exact solution, the verdicts.

`load` reads project files of every kind: blends, solids, assemblies, parametric surfaces and blends.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pas._version import __version__
from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import plain, rational, to_fraction
from pas.blending.solving import solve
from pas.errors import ProjectFileError
from pas.exchange.container import check_name, read, understood, write
from pas.exchange.parametric_records import GENERATRIX, PARAMETRIC_BLEND, PARAMETRIC_SURFACE, parametric_from_content
from pas.exchange.records import (
    CERTIFICATE,
    CONSTRAINTS,
    ENERGY,
    constraints_record,
    read_constraints,
    read_surface,
    surface_record,
)
from pas.exchange.schema import NUMBER, REAL, TEXT, WHOLE, List, Maybe, Row, Table, TableOf, check
from pas.exchange.shapes import POLYNOMIAL, SURFACE, polynomial_record, read_polynomial
from pas.exchange.solid_records import ASSEMBLY, SOLID, solid_from_content
from pas.fairing.energy import read_energy
from pas.fairing.wishes import Wishes
from pas.generatrix.blend import GeneratrixBlend
from pas.limits import Report, limited
from pas.parametric.blends import ParametricBlend
from pas.parametric.surface import ParametricSurface
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.space import SolutionSpace
from pas.solid.assembly import Assembly
from pas.solid.solid import Solid
from pas.surface.certificate import Certificate

BLEND = "blend"

SOLUTION = Table(
    {
        "dimension": WHOLE,
        "basis": Maybe(List(List(POLYNOMIAL))),
        "coefficients": List(NUMBER),
        "energy": REAL,
        "attempts": List(Row((WHOLE, WHOLE, TEXT))),
        "seconds": TableOf(REAL),
    }
)
CONTENT = Table(
    {
        "surface": SURFACE,
        "problem": Table({"constraints": CONSTRAINTS, "energy": ENERGY}),
        "solution": SOLUTION,
        "certificate": CERTIFICATE,
    },
    {"kind": TEXT},
)
"""What a project file of a blend holds; those of the first versions have no kind."""


def save(blend: Blend, path: str | Path) -> Path:
    """Write a blend, proving it first where that has not been done; returns the path.

    Raises `ValueError` unless the name ends in `.pas.json`.
    """
    check_name(path)
    content = {
        "kind": BLEND,
        "problem": {"constraints": constraints_record(blend.wishes), "energy": blend.wishes.energy.to_record()},
        "surface": surface_record(blend.surface),
        "solution": {
            "dimension": blend.dimension,
            "basis": None if blend.basis is None else [[polynomial_record(p) for p in m] for m in blend.basis],
            "coefficients": [plain(rational(c)) for c in blend.coefficients],
            "energy": blend.energy,
            "attempts": [[a.degree, a.dimension, a.outcome] for a in blend.attempts],
            "seconds": blend.timings,
        },
        "certificate": blend.certificate.to_record(),
    }
    return write(path, content, f"pas {__version__}")


@limited("reading a project file", "")
def load(
    path: str | Path,
    *,
    edited: bool = False,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Blend | Solid | Assembly | ParametricSurface | ParametricBlend | GeneratrixBlend:
    """Read a project file back: whatever it holds, exactly as it was written.

    No verdict of a file is believed: all are proved, in this process, when they are first asked for.  A
    blend has those of its file as `stored`.  With `edited`, a file whose checksum does not match is read
    all the same.

    Raises `ProjectFileError` (see `pas.exchange.container.read`) or `FileNotFoundError`.
    """
    content, name = read(path, edited=edited), Path(path).name
    kind = content.get("kind", BLEND)
    if kind in (SOLID, ASSEMBLY):
        return solid_from_content(content, name)
    if kind in (PARAMETRIC_SURFACE, PARAMETRIC_BLEND, GENERATRIX):
        return parametric_from_content(content, name)
    if kind != BLEND:
        raise ProjectFileError(
            f"{name}: holds a thing of kind {shown(kind)}, which this program does not know; update pas"
        )
    with understood(name):
        check(content, CONTENT, "content")
        return _from_content(content)


def _from_content(content: dict[str, Any]) -> Blend:
    solution, problem = content["solution"], content["problem"]
    surface, basis = read_surface(content["surface"]), _read_basis(solution["basis"])

    def find_space() -> SolutionSpace:
        space = SolutionSpace.of(solve(surface.placed, surface.degree))
        return space if basis is None else space.restricted(basis)

    return Blend(
        surface=surface,
        basis=basis,
        dimension=solution["dimension"],
        coefficients=tuple(to_fraction(rational(c)) for c in solution["coefficients"]),
        energy=float(solution["energy"]),
        timings={stage: float(spent) for stage, spent in solution["seconds"].items()},
        attempts=tuple(Attempt(*a) for a in solution["attempts"]),
        wishes=Wishes(energy=read_energy(problem["energy"]), **read_constraints(problem["constraints"])),
        find_space=find_space,
        stored=Certificate.from_record(content["certificate"]),
    )


def _read_basis(record: Any) -> tuple[tuple[Polynomial, ...], ...] | None:
    return None if record is None else tuple(tuple(read_polynomial(p) for p in m) for m in record)
