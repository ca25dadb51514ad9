"""What the commands do that make shapes: of problem files of every kind, and the teapot."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from pas.cli.commands import size_of, size_record
from pas.cli.common import DONE, FAILED, Clock, CommandResult, output_folder, problem_file, settings_of
from pas.errors import MissingLibraryError
from pas.settings import MeshSettings, given

TEAPOT_TOLERANCE = 0.001
"""Of the teapot's mesh, which is about 5 units long."""


def run_problem(options: argparse.Namespace) -> CommandResult:
    """`pas blend` and `pas parametric`: solve, prove, mesh and draw, whatever kind of problem it is."""
    from pas.exchange.files import together
    from pas.exchange.problem import read_problem
    from pas.shape import kind_of

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
        written = [shape.save(f"{base}.pas.json", certificate=certificate), mesh.write(f"{base}.stl")]
        reason = "" if options.no_picture else _draw(shape, f"{base}.png", drawn, written, clock)
    files = [str(folder / path.name) for path in written]
    done = problem.satisfied(certificate) and not reason
    lines = [text, "", f"mesh: {size_of(mesh)}", clock_line(clock), "", "written:"]
    record = {
        "name": problem.name,
        "written": files,
        "seconds": clock.seconds,
        **size_record(mesh),
        **facts,
        "proved": certificate.proved,
        "holds": certificate.holds,
        "verdicts": [verdict.to_record() for verdict in certificate.verdicts],
    }
    return CommandResult("\n".join([*lines, *(f"  {name}" for name in files)]), record, DONE if done else FAILED)


def run_teapot(options: argparse.Namespace) -> CommandResult:
    """`pas teapot`."""
    from pas.designs.teapot import teapot
    from pas.exchange.files import together

    settings = replace(MeshSettings(TEAPOT_TOLERANCE), **given(settings_of(MeshSettings, options)))
    folder = output_folder(options.output)
    clock = Clock()
    pot = teapot(
        options.style,
        lid_height=options.lid_height,
        spout_tilt=options.spout_tilt,
        handle_size=options.handle_size,
    )
    clock.passed("build and prove")
    mesh = pot.meshed(settings)
    clock.passed("mesh", f" ({len(mesh.triangles)} triangles)")
    text = str(pot)
    with together(folder) as place:
        written = [mesh.write(place / "teapot.stl"), pot.assembly.save(place / "teapot.pas.json")]
        _draw(pot, str(place / "teapot.png"), {"mesh": mesh, "four_views": True}, written, clock)
    files = [str(folder / path.name) for path in written]
    record = {"written": files, "seconds": clock.seconds, **size_record(mesh), "proved": pot.certificate.proved}
    text = "\n".join([text, "", "written:", *(f"  {name}" for name in files)])
    return CommandResult(text, record, DONE if pot.certificate.holds else FAILED)


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
