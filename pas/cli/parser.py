"""The arguments of the commands."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from dataclasses import fields
from typing import Any, NoReturn

from pas.cli import commands, problems
from pas.cli.common import EXIT_CODES, CommandResult, add_settings
from pas.errors import meant
from pas.exchange.formats import Request
from pas.exchange.picture_options import Picture
from pas.settings import MeshSettings


class Parser(argparse.ArgumentParser):
    """A reader of arguments that guesses what a misspelt command or option was meant to be."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong on stderr and end with exit code 2."""
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        if wrong:
            message = f"there is no command {wrong[1]!r}" + (
                meant(wrong[1], re.findall(r"[\w-]+", wrong[2])) or f"; there are {wrong[2]}"
            )
        option = re.search(r"unrecognized arguments: (--[\w-]+)", message)
        if option:
            message += meant(option[1], self.options)
        super().error(message)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As usual, but a project file after --curvature, whose word may be left out, is not its word."""
        words = list(sys.argv[1:] if args is None else args)
        for place, word in enumerate(words[:-1]):
            if word == "--curvature" and words[place + 1].endswith(".json"):
                words[place] = "--curvature=mean"
        return super().parse_known_args(words, namespace)

    @property
    def options(self) -> list[str]:
        """All long options, those of commands included."""
        found = list(self._option_string_actions)
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                found += [o for command in action.choices.values() for o in command._option_string_actions]
        return [o for o in dict.fromkeys(found) if o.startswith("--")]


def parser() -> argparse.ArgumentParser:
    """The reader of all arguments."""
    result = Parser(
        prog="pas",
        description="Smooth transitions between algebraic surfaces, with a proof.",
        epilog=f"`pas COMMAND --help` tells more of a command.\n\n{EXIT_CODES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    result.add_argument("--version", action="store_true", help="show the version; with --verbose all that matters")
    result.add_argument("--verbose", action="store_true", help="with --version: libraries and kernels as well")
    result.set_defaults(command=None, debug=False, json=False, seconds=None)
    added = result.add_subparsers(title="commands", metavar="COMMAND")
    for add in (
        _blend_parser,
        _parametric_parser,
        _solve_parser,
        _check_parser,
        _mesh_parser,
        _render_parser,
        _write_parser,
        _convert_parser,
        _teapot_parser,
        _studio_parser,
    ):
        add(added)
    return result


def _command(
    added: Any, run: Callable[[argparse.Namespace], CommandResult], name: str, text: str, more: str = ""
) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = added.add_parser(
        name, help=text, description=f"{text[0].upper()}{text[1:]}.", epilog=more,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.set_defaults(command=name, run=run)
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    if name not in ("solve", "studio"):  # one prints other forms, too, the other nothing in the end
        parser.add_argument("--json", action="store_true", help="print what came of it as JSON")
    if name != "studio":  # which runs until it is interrupted
        parser.add_argument("--seconds", type=float, metavar="S", help="give up after that many seconds")
    return parser


def _blend_parser(added: Any) -> None:
    parser = _command(
        added,
        problems.run_problem,
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
    _problem_arguments(parser)


def _parametric_parser(added: Any) -> None:
    parser = _command(
        added,
        problems.run_problem,
        "parametric",
        "find, prove, mesh and draw the parametric blend of a problem file",
        "Writes NAME.pas.json (data, method, components, verdicts), NAME.stl and NAME.png.\n\n"
        "A problem file is TOML:\n\n"
        '  order = 2\n  method = "hermite"   # or "weighted", with balance, normalized, exponent\n\n'
        "  [[surfaces]]         # two or more, met at h = 0, 1, ... or at values = [...]\n"
        '  x = "(1 - t^2)/(1 + t^2)"\n  y = "2*t/(1 + t^2)"\n  z = "h - 1"\n\n'
        "  [domain]             # of proof, mesh and picture\n  t = [-1, 1]\n\n"
        "Also: parameters, tolerance, prove, [picture] (style, view).\n\n"
        "Or by a Bezier generatrix between two boundaries of any kind:\n\n"
        '  method = "generatrix"                # or "quadrics": closed plane sections of quadrics\n\n'
        "  [[boundaries]]                       # two of these; a plane section of a quadric,\n"
        '  quadric = "x^2 + y^2 - 1"\n  plane = "z - 2"\n\n'
        "  [[boundaries]]                       # or a curve on an implicit surface, or others\n"
        '  implicit = "y^2 + z^2 - 1"\n  curve = ["3", "cos(2*pi*s)", "sin(2*pi*s)"]\n\n'
        "  [shape]                              # a number, pairs, a cosine; middle: a curve\n"
        "  l1 = 1\n  l2 = { low = 0.5, high = 1 }\n\n"
        "Other boundaries: quadric and other (branch); x, y, z and t, h or path; curve and normal or tangent.\n"
        "Also: align, unit, tolerance, prove, [picture].",
    )
    _problem_arguments(parser)


def _problem_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("problem", metavar="PROBLEM.toml", help="the problem file, of whatever kind")
    parser.add_argument("-o", "--output", metavar="DIR", default=".", help="folder to write to (default: here)")
    parser.add_argument("--order", type=int, metavar="K", help="contact of order K, instead of the file's")
    parser.add_argument(
        "--degree",
        type=_degree,
        metavar="N",
        help="this degree only, or lowest for the lowest that is proved, instead of the lowest that is fair",
    )
    parser.add_argument(
        "--tension",
        metavar="T",
        help="of the surface: from 0 (full) over 4.6 (as usual) up (slim), instead of the file's",
    )
    add_settings(parser, MeshSettings, "the file's, or 0.001 of the size")
    parser.add_argument("--no-picture", action="store_true", help="do not draw NAME.png")


def _degree(text: str) -> int | str:
    """A number, or the word for the lowest."""
    if text == "lowest":
        return text
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number or lowest, not {text!r}") from None


def _solve_parser(added: Any) -> None:
    parser = _command(
        added,
        commands.run_solve,
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
    form = parser.add_mutually_exclusive_group()
    for name in ("json", "latex", "sympy"):
        form.add_argument(f"--{name}", action="store_const", const=name, dest="form", help=f"print {name}")
    parser.set_defaults(form="text")


def _check_parser(added: Any) -> None:
    parser = _command(added, commands.run_check, "check", "prove everything again from a project file alone")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument(
        "--edited", action="store_true", help="accept a file changed by hand, and prove what it says now"
    )
    parser.add_argument(
        "--independent", action="store_true", help="prove a blend by the second checker, in exact arithmetic alone"
    )


def _mesh_parser(added: Any) -> None:
    parser = _command(added, commands.run_mesh, "mesh", "write the shape of a project file as a triangle mesh")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        required=True,
        help="a file of triangles; its suffix, such as .stl, says the format",
    )
    add_settings(parser, MeshSettings, "0.001 of the longest side")


def _render_parser(added: Any) -> None:
    parser = _command(added, commands.run_render, "render", "draw the surface of a project file")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file")
    parser.add_argument("-o", "--output", metavar="OUT.png", required=True, help="the picture")
    style = parser.add_mutually_exclusive_group()
    for name, text in (
        ("zebra", "isophotes, which show the order of continuity"),
        ("highlights", "highlight lines, reflections of parallel lights, which show small dents"),
    ):
        style.add_argument(f"--{name}", action="store_const", const=name, dest="style", help=text)
    style.add_argument(
        "--curvature", nargs="?", const="mean", metavar="WHICH",
        help="colours by curvature: mean (default), gauss, or a principal one, max or min",
    )  # fmt: skip
    add_settings(style, Picture, leave=[f.name for f in fields(Picture) if f.name != "style"])
    add_settings(parser, Picture, "finer than a picture shows", ["style"])


def _write_parser(added: Any) -> None:
    parser = _command(added, commands.run_write, "write", "write the shape of a project file for other programs")
    parser.add_argument("project", metavar="FILE.pas.json", help="a project file of any kind")
    _output_arguments(parser)


def _output_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("output", metavar="OUT", help="the file to write; its suffix says the format")
    add_settings(parser, Request)
    add_settings(parser, MeshSettings, "0.001 of the size")


def _convert_parser(added: Any) -> None:
    parser = _command(added, commands.run_convert, "convert", "write the body of a project file for other programs")
    parser.add_argument(
        "project", metavar="FILE.pas.json", help="a project file; a blend is made solid, with its neighbours"
    )
    parser.add_argument("--length", metavar="L", help="of a blend: how far its neighbours go on before their caps")
    _output_arguments(parser)


def _teapot_parser(added: Any) -> None:
    parser = _command(
        added,
        problems.run_teapot,
        "teapot",
        "build, prove, mesh and draw the teapot",
        "Prints the part list with the verdict on each joint; writes teapot.stl, teapot.pas.json and teapot.png.",
    )
    parser.add_argument("--style", default="better", help="better (12 patches, all joined) or paper (8 patches)")
    parser.add_argument("-o", "--output", metavar="DIR", default=".", help="folder to write to (default: here)")
    parser.add_argument("--lid-height", default="7/5", metavar="Z", help="height of the knob's top")
    parser.add_argument("--spout-tilt", default="0", metavar="T", help="how far the spout leans outwards")
    parser.add_argument("--handle-size", default="1", metavar="S", help="factor of the handle's size")
    add_settings(parser, MeshSettings, "0.001")


def _studio_parser(added: Any) -> None:
    parser = _command(
        added,
        commands.run_studio,
        "studio",
        "drag a shape in the browser, and see it with its curvature and its proof",
        "Listens on this machine alone, prints the address of the page and opens it; Ctrl-C ends it.\n"
        "Without a file it shows a gallery of starting points.  A file that changes is read again.",
    )
    parser.add_argument("file", metavar="FILE", nargs="?", help="a problem file (.toml) or a project (.pas.json)")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="the port to listen on (default: a free one)")
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")
