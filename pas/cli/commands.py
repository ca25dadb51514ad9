"""The functions of the commands, for every kind of shape that a problem asks for or a project file holds."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from pas.cli.common import (
    DONE,
    FAILED,
    Clock,
    CommandResult,
    output_folder,
    problem_file,
    project_file,
    settings_of,
    verdict_record,
    written_lines,
)
from pas.errors import MissingLibraryError
from pas.exchange.files import source, target, together
from pas.exchange.formats import FORMATS, Request, Sizing, suffixes_of, unit_named
from pas.exchange.picture_options import Picture
from pas.exchange.problem import read_problem
from pas.kinds.files import load
from pas.settings import MeshSettings, given
from pas.shape import kind_of
from pas.verdicts import Verdicts

if TYPE_CHECKING:
    from pas.designs.teapot import Teapot
    from pas.exchange.corner_problem import CornerProblem


def run_solve(options: argparse.Namespace) -> CommandResult:
    """`pas solve`."""
    from pas.pipeline.blend import solutions
    from pas.pipeline.report import report

    found = cast("CornerProblem", read_problem(problem_file(options.problem), ("corner",)))
    problem = found.changed(order=options.order, degree=options.degree)
    space = solutions(
        problem.contacts,
        problem.order,
        problem.degree if isinstance(problem.degree, int) else None,
        problem.partition,
        method=options.method,
        regular=options.regular,
    )
    return CommandResult(report(space, options.form, module=options.generators), {})


def _loaded(options: argparse.Namespace, *, edited: bool = False) -> Any:
    """The shape of the project file that a command is given."""
    return load(project_file(options.project), edited=edited)


def run_check(options: argparse.Namespace) -> CommandResult:
    """`pas check`."""
    if options.independent:
        from pas.independent.checker import check_independently

        start = time.perf_counter()
        verdicts: Sequence[Any] = check_independently(project_file(options.project), edited=options.edited)
        text, proved = "\n".join(map(str, verdicts)), all(verdict.proved for verdict in verdicts)
        holds, counts = proved, "all proved" if proved else "not all proved"
    else:
        shape, start = _loaded(options, edited=options.edited), time.perf_counter()
        certificate: Verdicts = shape.certificate
        stored = getattr(shape, "stored", None)
        others = () if stored is None else certificate.differences(stored)
        text = "".join([str(certificate), *(f"\nas stored otherwise: {other}" for other in others)])
        verdicts, proved, holds, counts = (
            certificate.verdicts,
            certificate.proved,
            certificate.holds,
            certificate.counts,
        )
    seconds = time.perf_counter() - start
    record = {
        "proved": proved,
        "holds": holds,
        "seconds": round(seconds, 3),
        "verdicts": [verdict.to_record() for verdict in verdicts],
    }
    return CommandResult(f"{text}\n\n{counts}, in {seconds:.2f} s", record, DONE if holds else FAILED)


def run_mesh(options: argparse.Namespace) -> CommandResult:
    """`pas mesh`."""
    from pas.exchange.write import check_open, write_as

    settings = settings_of(MeshSettings, options)
    target(options.output, suffixes_of("triangles"), "a mesh")
    shape, _ = _sized(_loaded(options), options)
    kind = kind_of(shape)
    mesh = kind.mesh(shape, settings)
    if not mesh.is_closed:
        check_open(options.output)
    whole = kind.parts is None
    write_as(mesh if whole else shape, options.output, MeshSettings() if whole else settings, open=True)
    path = str(Path(options.output))
    return CommandResult(f"{path}: {size_of(mesh)}", {"written": [path], **size_record(mesh)})


def run_render(options: argparse.Namespace) -> CommandResult:
    """`pas render`."""
    from pas.render.drawing import draw

    picture = settings_of(Picture, options)
    if options.curvature is not None:
        picture = replace(picture, style=options.curvature)
    coloring = picture.coloring
    if options.curvature is not None and not coloring.curved:
        raise ValueError(f"--curvature shows mean, gauss, max or min, not {coloring.name}; draw it with --style")
    path = draw(_loaded(options), options.output, **given(picture))
    return CommandResult(str(path), {"written": [str(path)]})


def run_write(options: argparse.Namespace) -> CommandResult:
    """`pas write`."""
    return _written(_loaded(options), options)


def run_convert(options: argparse.Namespace) -> CommandResult:
    """`pas convert`: `pas write` of the body, where the kind of shape has one."""
    shape = _loaded(options)
    body = kind_of(shape).body
    if body is not None:
        shape = body(shape, options.length)
    elif options.length is not None:
        raise ValueError(f"--length is for blends with their neighbours; {options.project} holds none")
    return _written(shape, options)


def run_studio(options: argparse.Namespace) -> CommandResult:
    """`pas studio`: until it is interrupted."""
    from pas.studio.server import serve

    file = None if options.file is None else source(options.file)
    serve(file, options.port, lambda line: print(line, flush=True), browser=not options.no_browser)
    return CommandResult("the studio has ended", {"ended": True})


def _written(shape: Any, options: argparse.Namespace) -> CommandResult:
    from pas.exchange.write import write_as

    mesh = settings_of(MeshSettings, options)
    shape, unit = _sized(shape, options, options.unit)
    reports = write_as(shape, options.output, mesh, unit=unit, sew=options.sew, open=bool(options.open))
    path = str(Path(options.output))
    lines = [f"{path}: {report}" for report in reports] or [path]
    return CommandResult("\n".join(lines), {"written": [path], **_reports_record(reports)})


def _reports_record(reports: Sequence[Any]) -> dict[str, Any]:
    """The reports of files on their parts, as a record."""
    return {"reports": [asdict(report) for report in reports]} if reports else {}


def _sized(shape: Any, options: argparse.Namespace, unit: str | None = None) -> tuple[Any, str | None]:
    """A shape as large as the options want it, and the unit of its lengths."""
    return settings_of(Sizing, options).applied(shape, unit)


def run_build(options: argparse.Namespace) -> CommandResult:
    """`pas build`: the files of a part, or of the body of whatever a problem asks for."""
    from pas.exchange.parts import part_list_of

    problem = read_problem(problem_file(options.problem)).changed(**given(settings_of(MeshSettings, options)))
    outputs = [Path(name) for name in options.output or ()]
    for path in outputs:
        target(path, (".pas.json", ".png", *FORMATS), "a part")
    sizing, unit = settings_of(Sizing, options), unit_named(options.unit) if options.unit else problem.model_unit
    clock = Clock()
    shape = problem.solve()
    body = kind_of(shape).body
    made = shape if body is None else body(shape, None)
    shape, unit = sizing.applied(made, unit)
    clock.passed("build")
    certificate: Verdicts = shape.certificate
    clock.passed("prove")
    listed = part_list_of(shape, Request(problem.name, problem.mesh))
    drawn = partial(shape.draw, **given(problem.picture))
    reports = write_outputs(shape, outputs, problem.mesh, unit, clock, png=drawn)
    files = [str(path) for path in outputs]
    lines = [str(shape), "", *([f"unit: {unit}"] if unit else []), str(listed), "", clock_line(clock)]
    lines += [*written_lines(files), *(f"  {report}" for report in reports)]
    record = {
        **_reports_record(reports),
        "name": problem.name,
        "written": files,
        "unit": unit,
        "parts": [dict(zip(listed.HEADS, row, strict=True)) for row in listed.rows],
        "seconds": clock.seconds,
        **verdict_record(certificate),
    }
    return CommandResult("\n".join(lines), record, DONE if problem.satisfied(certificate) else FAILED)


def write_outputs(
    shape: Any, outputs: Sequence[Path], mesh: MeshSettings, unit: str | None, clock: Clock, **verbs: Any
) -> list[Any]:
    """Write files of a shape, all of them or none; returns what their formats tell.

    `verbs` are other functions of a path by suffix, without its dots, as `png=shape.draw`.
    """
    from pas.exchange.write import write_as

    known = {"pasjson": partial(shape.save, certificate=shape.certificate), "png": shape.draw, **verbs}
    reports: list[Any] = []
    with ExitStack() as stack:
        folders = {path.parent: stack.enter_context(together(path.parent)) for path in outputs}
        for path in outputs:
            place, name = folders[path.parent] / path.name, path.name.lower().replace(".pas.json", ".pasjson")
            if (verb := known.get(name.rpartition(".")[2])) is not None:
                verb(place)
            else:
                meshed = "tolerance" in FORMATS[path.suffix.lower()].content.options
                reports += write_as(shape, place, mesh if meshed else MeshSettings(), unit=unit)
            clock.passed(path.name)
    return reports


def run_problem(options: argparse.Namespace) -> CommandResult:
    """`pas blend` and `pas parametric`: solve, prove, mesh and draw, whatever kind of problem it is."""
    problem = read_problem(problem_file(options.problem)).changed(
        order=options.order,
        degree=options.degree,
        tension=options.tension,
        **given(settings_of(MeshSettings, options)),
    )
    folder = output_folder(options.output)
    clock = Clock()
    shape = problem.solve()
    certificate = shape.certificate
    clock.passed("solve and prove")
    kind = kind_of(shape)
    mesh = kind.mesh(shape, problem.mesh)
    clock.passed("mesh", f" ({len(mesh.triangles)} triangles)")
    drawn = given(problem.picture) | ({} if problem.picture.coloring.fine else {"mesh": mesh})
    text, facts = kind.text(shape), kind.facts(shape)  # nothing that may give up comes after the files are written
    with together(folder) as place:
        base = place / problem.name
        written = [shape.save(f"{base}.pas.json", certificate=certificate), mesh.write(f"{base}.stl", open=True)]
        reason = "" if options.no_picture else _draw(shape, f"{base}.png", drawn, written, clock)
    files = [str(folder / path.name) for path in written]
    done = problem.satisfied(certificate) and not reason
    lines = [text, "", f"mesh: {size_of(mesh)}", clock_line(clock)]
    record = {
        "name": problem.name,
        "written": files,
        "seconds": clock.seconds,
        **size_record(mesh),
        **facts,
        **verdict_record(certificate),
    }
    return CommandResult("\n".join([*lines, *written_lines(files)]), record, DONE if done else FAILED)


def run_teapot(options: argparse.Namespace) -> CommandResult:
    """`pas teapot`."""
    from pas.designs.teapot import teapot

    folder = output_folder(options.output)
    wanted, sizing = given(settings_of(MeshSettings, options)), settings_of(Sizing, options)
    given_unit = unit_named(options.unit) if options.unit else None
    clock = Clock()
    built = teapot(
        options.style,
        lid_height=options.lid_height,
        spout_tilt=options.spout_tilt,
        handle_size=options.handle_size,
    )
    pot, unit = cast("tuple[Teapot, str | None]", sizing.applied(built, given_unit))
    usual = MeshSettings(0.001 if pot is built else None)
    clock.passed("build and prove")
    mesh = pot.meshed(replace(usual, **wanted))
    clock.passed("mesh", f" ({len(mesh.triangles)} triangles)")
    text = str(pot)
    with together(folder) as place:
        written = [mesh.write(place / "teapot.stl", unit=unit), pot.assembly.save(place / "teapot.pas.json")]
        _draw(pot, str(place / "teapot.png"), {"mesh": mesh, "four_views": True}, written, clock)
    files = [str(folder / path.name) for path in written]
    record = {"written": files, "seconds": clock.seconds, **size_record(mesh), "proved": pot.certificate.proved}
    return CommandResult("\n".join([text, *written_lines(files)]), record, DONE if pot.certificate.holds else FAILED)


def clock_line(clock: Clock) -> str:
    """The seconds of the whole in one line."""
    return "seconds in all: " + ", ".join(f"{stage} {spent:.3f}" for stage, spent in clock.seconds.items())


def _draw(shape: Any, path: str, options: dict[str, Any], written: list[Path], clock: Clock) -> str:
    """Draw the picture; returns why there is none where OpenGL is missing, and says so."""
    try:
        written.append(shape.draw(path, **options))
    except MissingLibraryError as error:
        print(f"pas: no picture: {error}", file=sys.stderr)
        return str(error)
    clock.passed("picture")
    return ""


def size_of(mesh: Any) -> str:
    """How large and how near a mesh is, in words."""
    size = f"{len(mesh.triangles)} triangles"
    if mesh.deviation is None:
        return size
    return f"{size}, within {mesh.deviation:.3g} of the surface ({'proved' if mesh.proved else 'measured'})"


def size_record(mesh: Any) -> dict[str, Any]:
    """How large and how near a mesh is, for programs."""
    return {"triangles": len(mesh.triangles), "deviation": mesh.deviation, "bounded": mesh.proved}
