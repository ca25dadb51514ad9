"""What the commands do with parametric surfaces and blends."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pas.algebra.inputs import check_tolerance
from pas.bernstein.signs import Status
from pas.cli.common import DONE, FAILED, output_folder, passed, problem_file
from pas.errors import MissingLibraryError
from pas.surface.certificate import Verdict

if TYPE_CHECKING:
    from pas.exchange.generatrix_problem import GeneratrixProblem
    from pas.exchange.parametric_problem import ParametricProblem
    from pas.generatrix.blend import GeneratrixBlend
    from pas.generatrix.verdicts import GeneratrixCertificate
    from pas.mesh.mesh import Mesh
    from pas.parametric.blends import ParametricBlend
    from pas.parametric.proofs import ParametricCertificate
    from pas.parametric.surface import ParametricSurface

    Problem = ParametricProblem | GeneratrixProblem
    Made = ParametricBlend | GeneratrixBlend
    Certificate = ParametricCertificate | GeneratrixCertificate
    Thing = ParametricSurface | Made


WORDS = {
    Status.PROVED: "proved",
    Status.REFUTED: "refuted",
    Status.UNDECIDED: "undecided",
    Status.HOLDS_MEASURED: "measured to hold",
    Status.FAILS_MEASURED: "measured to fail",
}


def run_parametric(options: argparse.Namespace) -> int:
    """`pas parametric`."""
    from pas.exchange.files import together
    from pas.exchange.parametric_problem import read_parametric_problem
    from pas.exchange.parametric_records import save_parametric
    from pas.exchange.write import write_mesh

    problem = read_parametric_problem(problem_file(options.problem))
    if options.order is not None:
        problem = _with_order(problem, options.order)
    folder = output_folder(options.output)
    tolerance = problem.tolerance if options.tolerance is None else options.tolerance
    tolerance = None if tolerance is None else check_tolerance(tolerance)
    start = time.perf_counter()
    blend = _blend(problem)
    start = passed("blend", start)
    certificate = prove(blend)
    start = passed("proofs", start)
    print(f"{blend}\n\n{certificate}\n")
    made = blend.surface.mesh(tolerance)
    passed(f"mesh ({len(made.triangles)} triangles)", start)
    with together(folder) as place:
        base = place / problem.name
        written = [save_parametric(blend, f"{base}.pas.json", certificate), write_mesh(made, f"{base}.stl")]
        notes = "" if options.no_picture else _draw(problem, blend, made, base, written)
    print(f"mesh: {size_of(made)}")
    print("\nwritten:", *(folder / path.name for path in written), sep="\n  ")
    if notes:
        print(f"pas: no picture: {notes}", file=sys.stderr)
        return FAILED
    return DONE if _holds(certificate, problem.prove) else FAILED


def check(thing: Thing) -> int:
    """`pas check` of a parametric surface or blend."""
    from pas.parametric.regularity import regularity
    from pas.parametric.surface import ParametricSurface

    start = time.perf_counter()
    found = regularity(thing) if isinstance(thing, ParametricSurface) else prove(thing)
    holds = found.proved if isinstance(found, Verdict) else _holds(found, None)
    verdicts = (found,) if isinstance(found, Verdict) else found.verdicts
    print(f"{found}\n\n{_counts(verdicts)}, in {time.perf_counter() - start:.2f} s")
    return DONE if holds else FAILED


def _counts(verdicts: Sequence[Verdict]) -> str:
    """How many claims are proved, hold or fail as measured, and so on; "all proved" where they are."""
    if all(v.proved for v in verdicts):
        return "all proved"
    counts = Counter(v.status for v in verdicts)
    return "; ".join(f"{counts[status]} {WORDS[status]}" for status in Status if counts[status])


def prove(blend: Made) -> Certificate:
    """All verdicts about a blend."""
    from pas.parametric.blends import ParametricBlend

    return blend.prove() if isinstance(blend, ParametricBlend) else blend.certificate


def _holds(certificate: Certificate, wanted: bool | None) -> bool:
    """Whether a certificate is as wanted: True, all proved; False, anything.

    None: what the kind of blend can give, for generatrix blends, much of which is measured, that nothing is refuted
    and nothing fails as measured.
    """
    from pas.generatrix.verdicts import GeneratrixCertificate

    if wanted is False or certificate.proved:
        return True
    return wanted is None and isinstance(certificate, GeneratrixCertificate) and not certificate.failed


def _blend(problem: Problem) -> Made:
    """The blend of a problem, on the problem's domain."""
    from pas.exchange.generatrix_problem import GeneratrixProblem

    if isinstance(problem, GeneratrixProblem):
        return problem.blend()
    blend = problem.blend()
    return blend if problem.domain is None else replace(blend, surface=blend.surface.with_domain(problem.domain))


def _with_order(problem: Problem, order: int) -> Problem:
    from pas.exchange.generatrix_problem import GeneratrixProblem

    if isinstance(problem, GeneratrixProblem):
        raise ValueError(f"a blend of the method {problem.method!r} has contact of order 1; leave out --order")
    return replace(problem, order=order)


def mesh(thing: Thing, path: str, tolerance: float | None) -> int:
    """`pas mesh` of a parametric surface or blend."""
    from pas.exchange.write import check_mesh_suffix, write_mesh
    from pas.parametric.fitting import surface_of

    check_mesh_suffix(path)
    made = surface_of(thing).mesh(tolerance)
    print(f"{write_mesh(made, path)}: {size_of(made)}")
    return DONE


def size_of(mesh: Mesh) -> str:
    """How large and how near a mesh is, in words."""
    how = "proved" if mesh.proved else "measured"
    return f"{len(mesh.triangles)} triangles, within {mesh.deviation:.3g} of the surface ({how})"


def _draw(problem: Problem, blend: Made, mesh: Mesh, base: Path, written: list[Path]) -> str:
    """Draw the picture; returns why there is none where OpenGL is missing."""
    from pas.parametric.blends import ParametricBlend
    from pas.render.picture import Style, draw

    start, style = time.perf_counter(), Style(problem.style)
    known = mesh if style is not Style.ZEBRA and isinstance(blend, ParametricBlend) else None
    try:
        written.append(draw(blend, f"{base}.png", style=style, mesh=known, view=problem.view))
    except MissingLibraryError as error:
        return str(error)
    passed("picture", start)
    return ""
