"""What the commands do."""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pas.algebra.inputs import check_tolerance
from pas.cli import parametric
from pas.cli.common import DONE, FAILED, output_folder, passed, problem_file, project_file
from pas.errors import MissingLibraryError

if TYPE_CHECKING:
    from pas.mesh.mesh import Mesh
    from pas.pipeline.result import Blend


def run_blend(options: argparse.Namespace) -> int:
    """`pas blend`."""
    from pas.exchange.files import together
    from pas.exchange.problem import read_problem
    from pas.exchange.write import write_mesh
    from pas.pipeline.blend import blend
    from pas.pipeline.summary import summary

    problem = read_problem(problem_file(options.problem))
    folder = output_folder(options.output)
    tolerance = check_tolerance(problem.tolerance if options.tolerance is None else options.tolerance)
    result = blend(
        problem.contacts,
        problem.order if options.order is None else options.order,
        problem.degree if options.degree is None else options.degree,
        **problem.options,
    )
    start = time.perf_counter()
    mesh = result.surface.mesh(tolerance)
    result.timings["mesh"] = passed(f"mesh ({len(mesh.triangles)} triangles)", start) - start
    with together(folder) as place:
        base = place / problem.name
        written = [result.save(f"{base}.pas.json"), write_mesh(mesh, f"{base}.stl")]
        notes = "" if options.no_picture else _draw(result, mesh, base, written)
    print(summary(result, {"mesh": f"{len(mesh.triangles)} triangles, within {tolerance:g} of the surface"}))
    print("\nwritten:", *(folder / path.name for path in written), sep="\n  ")
    if notes:
        print(f"pas: no picture: {notes}", file=sys.stderr)
        return FAILED
    return DONE if result.certificate.proved or not problem.wishes.prove else FAILED


def run_solve(options: argparse.Namespace) -> int:
    """`pas solve`."""
    from pas.exchange.problem import read_problem
    from pas.pipeline.report import report
    from pas.pipeline.space import solutions

    problem = read_problem(problem_file(options.problem))
    space = solutions(
        problem.contacts,
        problem.order if options.order is None else options.order,
        problem.degree if options.degree is None else options.degree,
        problem.partition,
        method=options.method,
        regular=options.regular,
    )
    print(report(space, options.form, module=options.generators))
    return DONE


def _draw(result: Blend, mesh: Mesh, base: Path, written: list[Path]) -> str:
    """Draw the picture; returns why there is none where OpenGL is missing."""
    from pas.render.picture import draw

    start = time.perf_counter()
    try:
        written.append(draw(result.surface, f"{base}.png", mesh=mesh))
    except MissingLibraryError as error:
        return str(error)
    result.timings["picture"] = passed("picture", start) - start
    return ""


def run_check(options: argparse.Namespace) -> int:
    """`pas check`."""
    from pas.exchange.project import load
    from pas.generatrix.blend import GeneratrixBlend
    from pas.parametric.blends import ParametricBlend
    from pas.parametric.surface import ParametricSurface
    from pas.pipeline.result import Blend
    from pas.surface.certificate import Certificate

    if options.independent:
        return _check_independently(options)
    thing = load(project_file(options.project), edited=options.edited)
    if options.json and not isinstance(thing, Blend):
        raise ValueError(f"--json is for blends by patches, and {options.project} holds another thing")
    if isinstance(thing, ParametricSurface | ParametricBlend | GeneratrixBlend):
        return parametric.check(thing)
    start = time.perf_counter()
    certificate = thing.certificate if isinstance(thing, Blend) else thing
    text = str(certificate)
    if isinstance(thing, Blend) and thing.stored is not None:
        text += "".join(f"\nas stored otherwise: {d}" for d in thing.certificate.differences(thing.stored))
    records = [v.to_record() for v in certificate.verdicts] if isinstance(certificate, Certificate) else []
    return _tell(text, records, certificate.proved, start, as_json=options.json)


def _check_independently(options: argparse.Namespace) -> int:
    from pas.independent.checker import check_independently

    start = time.perf_counter()
    findings = check_independently(project_file(options.project), edited=options.edited)
    records = [finding.to_record() for finding in findings]
    proved = all(finding.proved for finding in findings)
    return _tell("\n".join(map(str, findings)), records, proved, start, as_json=options.json)


def _tell(text: str, records: list[dict[str, Any]], proved: bool, start: float, *, as_json: bool) -> int:
    """Print verdicts, as text or JSON; returns the exit code."""
    seconds = time.perf_counter() - start
    if as_json:
        print(json.dumps({"proved": proved, "seconds": round(seconds, 3), "verdicts": records}, indent=1))
    else:
        print(f"{text}\n\n{'all proved' if proved else 'not all proved'}, in {seconds:.2f} s")
    return DONE if proved else FAILED


def run_mesh(options: argparse.Namespace) -> int:
    """`pas mesh`."""
    from pas.exchange.project import load
    from pas.exchange.write import check_mesh_suffix, write_mesh, write_solid
    from pas.generatrix.blend import GeneratrixBlend
    from pas.parametric.blends import ParametricBlend
    from pas.parametric.surface import ParametricSurface
    from pas.pipeline.result import Blend

    tolerance = None if options.tolerance is None else check_tolerance(options.tolerance)
    thing = load(project_file(options.project))
    if isinstance(thing, ParametricSurface | ParametricBlend | GeneratrixBlend):
        return parametric.mesh(thing, options.output, tolerance)
    if not isinstance(thing, Blend):
        print(write_solid(thing, options.output, tolerance=tolerance))
        return DONE
    check_mesh_suffix(options.output)
    tolerance = 0.001 if tolerance is None else tolerance
    mesh = thing.surface.mesh(tolerance)
    path = write_mesh(mesh, options.output)
    print(f"{path}: {len(mesh.triangles)} triangles, within {tolerance:g} of the surface")
    return DONE


def run_render(options: argparse.Namespace) -> int:
    """`pas render`."""
    from pas.exchange.project import load
    from pas.pipeline.result import Blend
    from pas.render.parts import Look, draw_parts
    from pas.render.picture import Style, draw
    from pas.solid.assembly import Assembly
    from pas.solid.solid import Solid

    thing = load(project_file(options.project))
    if not isinstance(thing, Solid | Assembly):
        style = Style.ZEBRA if options.zebra else Style.CURVATURE if options.curvature else Style.PLAIN
        print(draw(thing.surface if isinstance(thing, Blend) else thing, options.output, style=style))
        return DONE
    if options.curvature:
        raise ValueError("curvature colours exist for blends; of a solid draw it plain or with --zebra")
    print(draw_parts(thing, options.output, look=Look.ZEBRA if options.zebra else Look.PLAIN))
    return DONE


def run_convert(options: argparse.Namespace) -> int:
    """`pas convert`."""
    from pas.exchange.project import load
    from pas.exchange.write import write_solid
    from pas.pipeline.result import Blend
    from pas.solid.assembly import Assembly
    from pas.solid.solid import Solid

    tolerance = None if options.tolerance is None else check_tolerance(options.tolerance)
    thing = load(project_file(options.project))
    if isinstance(thing, Blend):
        thing = thing.solid(options.length)
    elif options.length is not None:
        raise ValueError(f"--length is for blends with their neighbours; {options.project} holds none")
    if not isinstance(thing, Solid | Assembly):
        raise ValueError(f"{options.project} holds no solid but a surface; write it with `pas mesh`")
    print(write_solid(thing, options.output, tolerance=tolerance, unit=options.unit))
    return DONE


def run_teapot(options: argparse.Namespace) -> int:
    """`pas teapot`."""
    from pas.exchange.files import together
    from pas.exchange.solid_records import save_solid
    from pas.exchange.write import write_solid
    from pas.render.parts import Look, draw_parts
    from pas.teapot.pot import teapot

    tolerance = check_tolerance(0.001 if options.tolerance is None else options.tolerance)
    folder = output_folder(options.output)
    start = time.perf_counter()
    pot = teapot(
        options.style,
        lid_height=options.lid_height,
        spout_tilt=options.spout_tilt,
        handle_size=options.handle_size,
    )
    start = passed("build and prove", start)
    mesh = pot.solid.mesh(tolerance)
    passed(f"mesh ({len(mesh.triangles)} triangles)", start)
    with together(folder) as place:
        written = [write_solid(mesh, place / "teapot.stl"), save_solid(pot.assembly, place / "teapot.pas.json")]
        try:
            written.append(draw_parts(mesh, place / "teapot.png", look=Look.FOUR_VIEWS))
        except MissingLibraryError as error:
            print(f"pas: no picture: {error}", file=sys.stderr)
    print(pot.solid)
    print("\nwritten:", *(folder / path.name for path in written), sep="\n  ")
    return DONE if pot.solid.proved else FAILED
