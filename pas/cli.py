"""The command line `pas`.

Exit codes: 0 done (for `check`: all proved), 1 what could not be done or proved, 2 what the user
got wrong.  Errors go to stderr as one sentence; `--debug` shows the traceback.
"""

from __future__ import annotations

import argparse
import sys
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pas._version import __version__
from pas.errors import InputError, MissingLibraryError, PasError

if TYPE_CHECKING:
    from pas.blending.blend import Blend
    from pas.mesh.field import TriangleMesh

    Commands = argparse._SubParsersAction[argparse.ArgumentParser]

DONE, FAILED, WRONG = 0, 1, 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.command is None:
        parser.print_help()
        return WRONG
    try:
        return int(options.run(options))
    except KeyboardInterrupt:
        print("pas: interrupted; nothing was left half-written", file=sys.stderr)
        return FAILED
    except (InputError, ValueError, TypeError, FileNotFoundError, PermissionError, IsADirectoryError) as error:
        return _fail(options, error, WRONG)
    except (PasError, OSError) as error:
        return _fail(options, error, FAILED)


def _fail(options: argparse.Namespace, error: Exception, code: int) -> int:
    if options.debug:
        traceback.print_exc()
    text = f"{error.strerror}: {error.filename}" if isinstance(error, OSError) and error.strerror else str(error)
    print(f"pas: {' '.join(text.split())}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pas",
        description="Smooth transitions between algebraic surfaces, with a proof.",
        epilog="`pas COMMAND --help` tells more of a command.",
    )
    parser.add_argument("--version", action="version", version=f"pas {__version__}")
    parser.set_defaults(command=None, debug=False)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    _blend_parser(commands)
    _solve_parser(commands)
    _check_parser(commands)
    _mesh_parser(commands)
    _render_parser(commands)
    _convert_parser(commands)
    _teapot_parser(commands)
    return parser


def _command(commands: Commands, name: str, text: str, more: str = "") -> argparse.ArgumentParser:
    parser = commands.add_parser(
        name, help=text, description=f"{text[0].upper()}{text[1:]}.", epilog=more,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parser


def _blend_parser(commands: Commands) -> None:
    parser = _command(
        commands,
        "blend",
        "find, prove, mesh and draw the blend of a problem file",
        "Writes NAME.pas.json (the exact solution and its verdicts), NAME.stl and NAME.png.\n\n"
        "A problem file is TOML:\n\n"
        "  order = 2            # the k of GC^k\n\n"
        "  [[pipes]]            # three of them, perpendicular, through one point\n"
        '  axis = [1, 0, 0]\n  radius = "1/3"\n  clip = 1\n\n'
        "Also: degree, tolerance, [[contacts]] (surface, clip), [partition], [energy],\n"
        "[points] (inside, outside, through, near), [normalize], prove, guard, basis.",
    )
    parser.add_argument("problem", metavar="PROBLEM.toml", help="the problem file")
    parser.add_argument("-o", "--output", metavar="DIR", default=".", help="folder to write to (default: here)")
    parser.add_argument("--order", type=int, metavar="K", help="GC^K, instead of the file's order")
    parser.add_argument("--degree", type=int, metavar="N", help="this degree only, instead of the lowest proved")
    _tolerance(parser, "the file's, or 0.001")
    parser.add_argument("--no-picture", action="store_true", help="do not draw NAME.png")
    parser.set_defaults(command="blend", run=_blend)


def _solve_parser(commands: Commands) -> None:
    parser = _command(
        commands,
        "solve",
        "find all surfaces of a degree that meet the contacts of a problem file",
        "Prints degree, dimension, a basis, the generators of all solutions, and which of them are\n"
        "singular along a contact.  The file is one of `pas blend`; for a single polynomial it has\n\n"
        '  [partition]\n  kind = "single cell"',
    )
    parser.add_argument("problem", metavar="PROBLEM.toml", help="the problem file")
    parser.add_argument("--order", type=int, metavar="K", help="GC^K, instead of the file's order")
    parser.add_argument("--degree", type=int, metavar="N", help="this degree, instead of the lowest with solutions")
    parser.add_argument("--method", default="linear", help="linear, syzygy, normal-form or intersection")
    parser.add_argument("--regular", action="store_true", help="the lowest degree with regular solutions")
    parser.add_argument("--generators", action="store_true", help="of several pieces: the generators of the module too")
    parser.add_argument("--seconds", type=float, metavar="S", help="give up after that many seconds")
    form = parser.add_mutually_exclusive_group()
    for name in ("json", "latex", "sympy"):
        form.add_argument(f"--{name}", action="store_const", const=name, dest="form", help=f"print {name}")
    parser.set_defaults(command="solve", run=_solve, form="text")


def _check_parser(commands: Commands) -> None:
    parser = _command(commands, "check", "prove everything again from a project file alone")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument(
        "--edited", action="store_true", help="accept a file changed by hand, and prove what it says now"
    )
    parser.set_defaults(command="check", run=_check)


def _mesh_parser(commands: Commands) -> None:
    parser = _command(commands, "mesh", "write the surface or solid of a project file as a triangle mesh")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument(
        "-o", "--output", metavar="OUT", required=True, help="a .stl, .obj, .ply, .vtp or .glb file; solids also .3mf"
    )
    _tolerance(parser, "0.001; of a solid, 0.001 of its longest side")
    parser.set_defaults(command="mesh", run=_mesh)


def _render_parser(commands: Commands) -> None:
    parser = _command(commands, "render", "draw the surface of a project file")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument("-o", "--output", metavar="OUT.png", required=True, help="the picture")
    style = parser.add_mutually_exclusive_group()
    style.add_argument("--zebra", action="store_true", help="isophotes, which show the order of continuity")
    style.add_argument("--curvature", action="store_true", help="colours by mean curvature")
    parser.set_defaults(command="render", run=_render)


def _convert_parser(commands: Commands) -> None:
    parser = _command(commands, "convert", "write the solid or assembly of a project file in another format")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file of a solid or assembly")
    parser.add_argument("output", metavar="OUT", help="the file to write; its suffix says the format")
    parser.add_argument("--unit", default="millimeter", help="of the model, for formats that have one")
    _tolerance(parser, "0.001 of the size")
    parser.set_defaults(command="convert", run=_convert)


def _teapot_parser(commands: Commands) -> None:
    parser = _command(
        commands,
        "teapot",
        "build, prove, mesh and draw the teapot",
        "Prints the part list with the verdict on each joint; writes teapot.stl, teapot.pas.json and teapot.png.",
    )
    parser.add_argument("--style", default="better", help="better (12 patches, all joined) or paper (8 patches)")
    parser.add_argument("-o", "--output", metavar="DIR", default=".", help="folder to write to (default: here)")
    parser.add_argument("--lid-height", default="7/5", metavar="Z", help="height of the knob's top")
    parser.add_argument("--spout-tilt", default="0", metavar="T", help="how far the spout leans outwards")
    parser.add_argument("--handle-size", default="1", metavar="S", help="factor of the handle's size")
    _tolerance(parser, "0.001")
    parser.set_defaults(command="teapot", run=_teapot)


def _tolerance(parser: argparse.ArgumentParser, default: str) -> None:
    parser.add_argument(
        "--tolerance",
        type=float,
        metavar="T",
        help=f"largest distance of the mesh from the surface (default: {default})",
    )


def _blend(options: argparse.Namespace) -> int:
    from pas.blending.blend import blend
    from pas.blending.summary import summary
    from pas.exchange.meshes import write_mesh
    from pas.exchange.problem import read_problem

    problem = read_problem(options.problem)
    folder = Path(options.output)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is not a folder; -o names the folder to write to")
    tolerance = _checked_tolerance(problem.tolerance if options.tolerance is None else options.tolerance)
    result = blend(
        problem.contacts,
        problem.order if options.order is None else options.order,
        problem.degree if options.degree is None else options.degree,
        progress=_progress,
        **problem.options,
    )
    start = time.perf_counter()
    mesh = result.surface.triangulate(tolerance)
    result.timings["mesh"] = time.perf_counter() - start
    _progress(f"mesh ({len(mesh.triangles)} triangles)", result.timings["mesh"])
    folder.mkdir(parents=True, exist_ok=True)
    base = folder / problem.name
    written = [result.save(f"{base}.pas.json"), write_mesh(mesh, f"{base}.stl")]
    notes = "" if options.no_picture else _draw(result, mesh, base, written)
    print(summary(result, {"mesh": f"{len(mesh.triangles)} triangles, within {tolerance:g} of the surface"}))
    print("\nwritten:", *written, sep="\n  ")
    if notes:
        print(f"pas: no picture: {notes}", file=sys.stderr)
        return FAILED
    return DONE if result.certificate.proved or not problem.prove else FAILED


def _solve(options: argparse.Namespace) -> int:
    from pas.blending.report import report
    from pas.blending.solutions import solutions
    from pas.exchange.problem import read_problem
    from pas.limits import limit

    problem = read_problem(options.problem)
    with limit(options.seconds, lambda line: print(line, file=sys.stderr, flush=True)):
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


def _draw(result: Blend, mesh: TriangleMesh, base: Path, written: list[Path]) -> str:
    """Draw the picture; returns why there is none where OpenGL is missing."""
    from pas.render.picture import draw

    start = time.perf_counter()
    try:
        written.append(draw(result.surface, f"{base}.png", mesh=mesh))
    except MissingLibraryError as error:
        return str(error)
    result.timings["picture"] = time.perf_counter() - start
    _progress("picture", result.timings["picture"])
    return ""


def _check(options: argparse.Namespace) -> int:
    from pas.blending.blend import Blend
    from pas.blending.project import load

    thing = load(options.project, edited=options.edited)
    start = time.perf_counter()
    certificate = thing.surface.certify() if isinstance(thing, Blend) else thing
    print(certificate)
    verdict = "all proved" if certificate.proved else "not all proved"
    print(f"\n{verdict}, in {time.perf_counter() - start:.2f} s")
    return DONE if certificate.proved else FAILED


def _mesh(options: argparse.Namespace) -> int:
    from pas.blending.blend import Blend
    from pas.blending.project import load
    from pas.exchange.meshes import check_mesh_suffix, write_mesh
    from pas.exchange.solids import write_solid

    tolerance = None if options.tolerance is None else _checked_tolerance(options.tolerance)
    thing = load(options.project)
    if not isinstance(thing, Blend):
        print(write_solid(thing, options.output, tolerance=tolerance))
        return DONE
    check_mesh_suffix(options.output)
    tolerance = 0.001 if tolerance is None else tolerance
    mesh = thing.surface.triangulate(tolerance)
    path = write_mesh(mesh, options.output)
    print(f"{path}: {len(mesh.triangles)} triangles, within {tolerance:g} of the surface")
    return DONE


def _render(options: argparse.Namespace) -> int:
    from pas.blending.blend import Blend
    from pas.blending.project import load
    from pas.render.parts import Look, draw_parts
    from pas.render.picture import Style, draw

    thing = load(options.project)
    if isinstance(thing, Blend):
        style = Style.ZEBRA if options.zebra else Style.CURVATURE if options.curvature else Style.PLAIN
        print(draw(thing.surface, options.output, style=style))
        return DONE
    if options.curvature:
        raise ValueError("curvature colours exist for blends; of a solid draw it plain or with --zebra")
    print(draw_parts(thing, options.output, look=Look.ZEBRA if options.zebra else Look.PLAIN))
    return DONE


def _convert(options: argparse.Namespace) -> int:
    from pas.blending.blend import Blend
    from pas.blending.project import load
    from pas.exchange.solids import write_solid

    tolerance = None if options.tolerance is None else _checked_tolerance(options.tolerance)
    thing = load(options.project)
    if isinstance(thing, Blend):
        raise ValueError(f"{options.project} holds a blend, which is no solid; write its surface with `pas mesh`")
    print(write_solid(thing, options.output, tolerance=tolerance, unit=options.unit))
    return DONE


def _teapot(options: argparse.Namespace) -> int:
    from pas.exchange.solid_records import save_solid
    from pas.exchange.solids import write_solid
    from pas.render.parts import Look, draw_parts
    from pas.teapot.pot import teapot

    tolerance = _checked_tolerance(0.001 if options.tolerance is None else options.tolerance)
    folder = Path(options.output)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is not a folder; -o names the folder to write to")
    start = time.perf_counter()
    pot = teapot(
        options.style,
        lid_height=options.lid_height,
        spout_tilt=options.spout_tilt,
        handle_size=options.handle_size,
    )
    _progress("build and prove", time.perf_counter() - start)
    start = time.perf_counter()
    mesh = pot.solid.mesh(tolerance)
    _progress(f"mesh ({len(mesh.triangles)} triangles)", time.perf_counter() - start)
    folder.mkdir(parents=True, exist_ok=True)
    written = [write_solid(mesh, folder / "teapot.stl"), save_solid(pot.assembly, folder / "teapot.pas.json")]
    print(pot.solid)
    try:
        written.append(draw_parts(mesh, folder / "teapot.png", look=Look.FOUR_VIEWS))
    except MissingLibraryError as error:
        print(f"pas: no picture: {error}", file=sys.stderr)
    print("\nwritten:", *written, sep="\n  ")
    return DONE if pot.solid.proved else FAILED


def _checked_tolerance(tolerance: float) -> float:
    if not 0 < tolerance < float("inf"):
        raise ValueError(f"the tolerance must be a positive number, not {tolerance}")
    return tolerance


def _progress(stage: str, seconds: float) -> None:
    print(f"{stage:<48} {seconds:7.2f} s", file=sys.stderr, flush=True)
