"""What the commands do with parametric surfaces and blends."""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pas.cli.common import DONE, FAILED, checked_tolerance, output_folder, progress
from pas.errors import MissingLibraryError

if TYPE_CHECKING:
    from pas.exchange.parametric_problem import ParametricProblem
    from pas.parametric.blends import ParametricBlend
    from pas.parametric.meshing import ParametricMesh
    from pas.parametric.surface import ParametricSurface

    Thing = ParametricSurface | ParametricBlend


def run_parametric(options: argparse.Namespace) -> int:
    """`pas parametric`."""
    from pas.exchange.meshes import write_mesh
    from pas.exchange.parametric_problem import read_parametric_problem
    from pas.exchange.parametric_records import save_parametric

    problem = read_parametric_problem(options.problem)
    if options.order is not None:
        problem = replace(problem, order=options.order)
    folder = output_folder(options.output)
    tolerance = problem.tolerance if options.tolerance is None else options.tolerance
    tolerance = None if tolerance is None else checked_tolerance(tolerance)
    start = time.perf_counter()
    blend = problem.blend()
    if problem.domain is not None:
        blend = replace(blend, surface=blend.surface.with_domain(problem.domain))
    start = _passed("blend", start)
    certificate = blend.prove()
    start = _passed("proofs", start)
    print(f"{blend}\n\n{certificate}\n")
    made = blend.mesh(tolerance)
    _passed(f"mesh ({len(made.triangles)} triangles)", start)
    folder.mkdir(parents=True, exist_ok=True)
    base = folder / problem.name
    written = [save_parametric(blend, f"{base}.pas.json", certificate), write_mesh(made, f"{base}.stl")]
    notes = "" if options.no_picture else _draw(problem, blend, made, base, written)
    print(f"mesh: {size_of(made)}")
    print("\nwritten:", *written, sep="\n  ")
    if notes:
        print(f"pas: no picture: {notes}", file=sys.stderr)
        return FAILED
    return DONE if certificate.proved or not problem.prove else FAILED


def check(thing: Thing) -> int:
    """`pas check` of a parametric surface or blend."""
    from pas.parametric.blends import ParametricBlend
    from pas.parametric.regularity import regularity

    start = time.perf_counter()
    found = thing.prove() if isinstance(thing, ParametricBlend) else regularity(thing)
    verdict = "all proved" if found.proved else "not all proved"
    print(f"{found}\n\n{verdict}, in {time.perf_counter() - start:.2f} s")
    return DONE if found.proved else FAILED


def mesh(thing: Thing, path: str, tolerance: float | None) -> int:
    """`pas mesh` of a parametric surface or blend."""
    from pas.exchange.meshes import check_mesh_suffix, write_mesh

    check_mesh_suffix(path)
    made = thing.mesh(tolerance)
    print(f"{write_mesh(made, path)}: {size_of(made)}")
    return DONE


def size_of(mesh: ParametricMesh) -> str:
    """How large and how near a mesh is, in words."""
    how = "proved" if mesh.certified else "measured"
    return f"{len(mesh.triangles)} triangles, within {mesh.deviation:.3g} of the surface ({how})"


def _draw(
    problem: ParametricProblem, blend: ParametricBlend, mesh: ParametricMesh, base: Path, written: list[Path]
) -> str:
    """Draw the picture; returns why there is none where OpenGL is missing."""
    from pas.render.picture import Style, draw

    start, style = time.perf_counter(), Style(problem.style)
    known = None if style is Style.ZEBRA else mesh
    try:
        written.append(draw(blend, f"{base}.png", style=style, mesh=known, view=problem.view))
    except MissingLibraryError as error:
        return str(error)
    _passed("picture", start)
    return ""


def _passed(stage: str, start: float) -> float:
    progress(stage, time.perf_counter() - start)
    return time.perf_counter()
