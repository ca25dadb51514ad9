"""Blends as project files (`.pas.json`): the whole problem, the exact solution, the verdicts.

`load` reads project files of every kind: blends, solids, assemblies, parametric surfaces and blends.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pas._version import __version__
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational, to_fraction
from pas.blending.blend import Attempt, Blend
from pas.errors import PasError, ProjectFileError
from pas.exchange.container import check_name, read, write
from pas.exchange.parametric_records import GENERATRIX, PARAMETRIC_BLEND, PARAMETRIC_SURFACE, parametric_from_content
from pas.exchange.records import (
    constraints_record,
    energy_record,
    polynomial_record,
    read_constraints,
    read_energy,
    read_polynomial,
    read_surface,
    surface_record,
)
from pas.exchange.solid_records import ASSEMBLY, SOLID, solid_from_content
from pas.generatrix.blend import GeneratrixBlend
from pas.parametric.blends import ParametricBlend
from pas.parametric.surface import ParametricSurface
from pas.solid.assembly import Assembly
from pas.solid.solid import Solid
from pas.surface.certificate import Certificate

BLEND = "blend"


def save(blend: Blend, path: str | Path) -> Path:
    """Write a blend, proving it first where that has not been done; returns the path.

    Raises `ValueError` unless the name ends in `.pas.json`.
    """
    check_name(path)
    content = {
        "kind": BLEND,
        "problem": {"constraints": constraints_record(blend.constraints), "energy": energy_record(blend.plate)},
        "surface": surface_record(blend.surface),
        "solution": {
            "dimension": blend.dimension,
            "basis": None if blend.basis is None else [[polynomial_record(p) for p in m] for m in blend.basis],
            "coefficients": [str(c) for c in blend.coefficients],
            "energy": blend.energy,
            "attempts": [[a.degree, a.dimension, a.outcome] for a in blend.attempts],
            "seconds": blend.timings,
        },
        "certificate": blend.certificate.to_record(),
    }
    return write(path, content, f"pas {__version__}")


def load(
    path: str | Path, *, edited: bool = False
) -> Blend | Solid | Assembly | ParametricSurface | ParametricBlend | GeneratrixBlend:
    """Read a project file back: whatever it holds, exactly as it was written.

    A blend has the verdicts as they were written; everything else is proved anew when asked for.
    With `edited`, a file whose checksum does not match is read all the same, without its
    verdicts: they are proved anew when asked for.

    Raises `ProjectFileError` (see `pas.exchange.container.read`) or `FileNotFoundError`.
    """
    content, name = read(path, edited=edited), Path(path).name
    kind = content.get("kind", BLEND)
    if kind in (SOLID, ASSEMBLY):
        return solid_from_content(content, name)
    if kind in (PARAMETRIC_SURFACE, PARAMETRIC_BLEND, GENERATRIX):
        return parametric_from_content(content, name)
    if kind != BLEND:
        raise ProjectFileError(f"{name}: holds a thing of kind {kind!r}, which this program does not know; update pas")
    try:
        return _from_content(content, with_verdicts=not edited)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, PasError) as error:
        raise ProjectFileError(
            f"{name}: the content cannot be understood ({type(error).__name__}: {error}); "
            "write it again with `pas blend`"
        ) from None


def _from_content(content: dict[str, Any], *, with_verdicts: bool) -> Blend:
    solution = content["solution"]
    return Blend(
        surface=read_surface(content["surface"]),
        basis=_read_basis(solution["basis"]),
        dimension=int(solution["dimension"]),
        coefficients=tuple(to_fraction(rational(c)) for c in solution["coefficients"]),
        energy=float(solution["energy"]),
        timings={str(k): float(v) for k, v in solution["seconds"].items()},
        attempts=tuple(Attempt(*a) for a in solution["attempts"]),
        constraints=read_constraints(content["problem"]["constraints"]),
        plate=read_energy(content["problem"]["energy"]),
        known_certificate=Certificate.from_record(content["certificate"]) if with_verdicts else None,
    )


def _read_basis(record: Any) -> tuple[tuple[Polynomial, ...], ...] | None:
    return None if record is None else tuple(tuple(read_polynomial(p) for p in m) for m in record)
