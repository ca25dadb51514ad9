"""The arguments of the commands: a table of commands, and a parser that guesses what was meant."""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NoReturn

from pas.cli import commands, networks
from pas.cli.common import EXIT_CODES, CommandResult, add_settings
from pas.errors import meant
from pas.exchange.formats import Request, Sizing
from pas.exchange.picture_options import Picture
from pas.settings import MeshSettings

Add = Callable[[argparse.ArgumentParser], object]
"""Adds an argument, or several, to the parser of a command."""


@dataclass(frozen=True)
class Command:
    """A command: what runs it, what it does in a line, its arguments, and more text below them.

    `reader` is the module of `pas.exchange` that reads its files, and says what these look like.
    """

    name: str
    run: Callable[[argparse.Namespace], CommandResult]
    text: str
    arguments: tuple[Add, ...]
    more: str = ""
    reader: str = ""

    def add_to(self, commands: Any) -> None:
        """Make its parser, one of several."""
        parser = commands.add_parser(
            self.name, help=self.text, description=f"{self.text[0].upper()}{self.text[1:]}.", epilog=self.more,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )  # fmt: skip
        parser.set_defaults(command=self.name, run=self.run)
        parser.reader = self.reader
        parser._negative_number_matcher = re.compile("-[^a-zA-Z-]")  # fractions and lists of numbers as well
        parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
        if self.name not in ("solve", "studio"):  # one prints other forms, too, the other nothing in the end
            parser.add_argument("--json", action="store_true", help="print the result as JSON")
        if self.name != "studio":  # which runs until it is interrupted
            parser.add_argument("--seconds", type=float, metavar="S", help="give up after that many seconds")
        for add in self.arguments:
            add(parser)


def flag(name: str, text: str) -> Add:
    """An argument that is there or not."""
    return lambda parser: parser.add_argument(name, action="store_true", help=text)


def value(names: str, metavar: str, text: str, kind: Callable[[str], Any] = str, **more: Any) -> Add:
    """An argument with a value; `names` are one or several, apart by spaces."""
    return lambda parser: parser.add_argument(*names.split(), type=kind, metavar=metavar, help=text, **more)


def settings(kind: type[Any], usual: str = "", leave: tuple[str, ...] = ()) -> Add:
    """The options of a class of settings, but those to leave out."""
    return lambda parser: add_settings(parser, kind, usual, leave)


def project(text: str = "a project file") -> Add:
    """The file that a command reads."""
    return value("project", "FILE.pas.json", text)


def _degree(text: str) -> int | str:
    """A number, or the word for the lowest."""
    if text == "lowest":
        return text
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number or lowest, not {text!r}") from None


def _forms(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    for name in ("json", "latex", "sympy"):
        group.add_argument(f"--{name}", action="store_const", const=name, dest="form", help=f"print {name}")
    parser.set_defaults(form="text")


def _styles(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    for name, text in (
        ("zebra", "isophotes, which show the order of continuity"),
        ("highlights", "highlight lines, reflections of parallel lights, which show small dents"),
    ):
        group.add_argument(f"--{name}", action="store_const", const=name, dest="style", help=text)
    text = "colours by curvature: mean (default), gauss, or a principal one, max or min"
    group.add_argument("--curvature", nargs="?", const="mean", metavar="WHICH", help=text)
    add_settings(group, Picture, leave=[f.name for f in fields(Picture) if f.name != "style"])
    add_settings(parser, Picture, "finer than a picture shows", ["style"])


FOLDER = value("-o --output", "DIR", "folder to write to (default: here)", default=".")
DEGREE = value("--degree", "N", "this degree, or lowest: the lowest that is proved; else one that is fair", _degree)
PROBLEM = (
    value("problem", "PROBLEM.toml", "the problem file, of any kind"),
    FOLDER,
    value("--order", "K", "contact of order K, instead of the file's", int),
    DEGREE,
    value("--tension", "T", "from 0 (full) over 4.6 (the default) upwards (slim), instead of the file's"),
    settings(MeshSettings, "the file's, or 0.001 of the size"),
    flag("--no-picture", "do not draw NAME.png"),
)  # fmt: skip
OUTPUT = (
    value("output", "OUT", "the file to write; its suffix says the format"),
    settings(Request),
    settings(Sizing),
    settings(MeshSettings, "0.001 of the size"),
)

COMMANDS = (
    Command(
        "blend",
        commands.run_problem,
        "find, prove, mesh and draw the blend of a problem file",
        PROBLEM,
        "Writes NAME.pas.json (the exact solution and its verdicts), NAME.stl and NAME.png.",
        "corner_problem",
    ),
    Command(
        "parametric",
        commands.run_problem,
        "find, prove, mesh and draw the parametric blend of a problem file",
        PROBLEM,
        "Writes NAME.pas.json (data, method, components, verdicts), NAME.stl and NAME.png.",
        "parametric_problem",
    ),
    Command(
        "solve",
        commands.run_solve,
        "find all surfaces of a degree that meet the contacts of a problem file",
        (
            value("problem", "PROBLEM.toml", "the problem file"),
            value("--order", "K", "GC^K, instead of the file's order", int),
            value("--degree", "N", "this degree, instead of the lowest with solutions", int),
            value("--method", "METHOD", "linear, syzygy, normal-form or intersection", default="linear"),
            flag("--regular", "the lowest degree with regular solutions"),
            flag("--generators", "of several pieces: the generators of the module too"),
            _forms,
        ),
        "Prints degree, dimension, a basis, the generators of all solutions, and which of them are\n"
        "singular along a contact.  The file is one of `pas blend`; for a single polynomial it has\n\n"
        '  [partition]\n  kind = "single cell"',
    ),
    Command(
        "build",
        commands.run_build,
        "make the solids of a part file, and write them",
        (
            value("problem", "PART.toml", "the part file"),
            value(
                "-o --output", "OUT", "a file, by its suffix such as .step or .png; may be repeated", action="append"
            ),
            value("--unit", "UNIT", "of the part's lengths, such as mm or inch, instead of the file's"),
            settings(Sizing),
            settings(MeshSettings, "the file's, or 0.001 of the size"),
        ),
        "Prints the faces, the verdicts on their joints, and what each part measures.",
        "part_problem",
    ),
    Command(
        "check",
        commands.run_check,
        "prove everything again from a project file alone",
        (
            project(),
            flag("--edited", "accept a file changed by hand, and prove what it says now"),
            flag("--independent", "prove a blend by the second checker, in exact arithmetic alone"),
        ),
    ),
    Command(
        "mesh",
        commands.run_mesh,
        "write the surface or solid of a project file as a triangle mesh",
        (
            project(),
            value(
                "-o --output", "OUT", "a file of triangles; its suffix, such as .stl, says the format", required=True
            ),
            settings(Sizing),
            settings(MeshSettings, "0.001 of the longest side"),
        ),
    ),
    Command(
        "render",
        commands.run_render,
        "draw the surface of a project file",
        (
            project(),
            value("-o --output", "OUT.png", "the picture, or a turntable as a .gif", required=True),
            _styles,
        ),
    ),
    Command(
        "write",
        commands.run_write,
        "write the shape of a project file for other programs",
        (project("a project file of any kind"), *OUTPUT),
    ),
    Command(
        "convert",
        commands.run_convert,
        "write the body of a project file for other programs",
        (
            project("a project file; a blend is made solid, with its neighbours"),
            value("--length", "L", "of a blend: how far its neighbours go on before their caps"),
            *OUTPUT,
        ),
    ),
    Command(
        "teapot",
        commands.run_teapot,
        "build, prove, mesh and draw the teapot",
        (
            value("--style", "STYLE", "better (12 patches, all joined) or paper (8 patches)", default="better"),
            FOLDER,
            value("--lid-height", "Z", "height of the knob's top", default="7/5"),
            value("--spout-tilt", "T", "how far the spout leans outwards", default="0"),
            value("--handle-size", "S", "factor of the handle's size", default="1"),
            value("--unit", "UNIT", "of its lengths, such as mm or inch"),
            settings(Sizing),
            settings(MeshSettings, "0.001, or that of its size where it is scaled"),
        ),
        "Prints the part list with the verdict on each joint; writes teapot.stl, teapot.pas.json and teapot.png.",
    ),
    Command(
        "network",
        networks.run_network,
        "check a network of struts, or make a body of it: proved nodes, exact struts",
        (
            value("action", "ACTION", "check (what is wrong), classes (of its nodes), build, or status (of a run)"),
            value(
                "source",
                "FILE",
                "a graph (.npz, .csv, .obj, .3mf), or cubic, BCC, FCC, octet, diamond, Kelvin; "
                "of status the folder of --blocks",
            ),
            value("-o --output", "OUT", "of build: a file to write; may be repeated", action="append", default=[]),
            value("--cells", "X,Y,Z", "of a lattice: how many, as 4 or 4,4,2 (default: 1)"),
            value("--cell-size", "S", "of a lattice: the side of a cell (default: 1)", default=1),
            value("--radius", "R", "of all struts, instead of the file's (of a lattice by default: 1/20)"),
            value("--grid", "G", "of the points of a file (default: 1/1024)", default="1/1024"),
            value("--order", "K", "the k of GC^k (default: 1)", int, default=1),
            DEGREE,
            value("--wall", "W", "struts and nodes are hollow, with walls of this thickness"),
            value("--cache", "DIR", "folder that keeps blends; an interrupted run continues from it"),
            value("--blocks", "DIR", "for STL files of some 20 000 struts each"),
            flag("--resume", "go on with the blocks of an earlier run"),
            value("--workers", "N", "so many processes of Dask on this machine; needs --cache", int),
            value("--scheduler", "ADDRESS", "the workers of a scheduler of Dask, as tcp://host:8786; needs --cache"),
            flag("--collapse", "struts too short for any blend become points, and the shortest at nodes without one"),
            flag("--join", "struts that cross end in a point between them"),
            flag("--whole", "of check: loose ends and several pieces are wrong, too"),
            settings(Request, leave=("sew", "open")),
            settings(MeshSettings, "3 % of the least radius"),
        ),
        "`pas network build octet --cells 4 --radius 1/20 -o block.3mf` writes each kind of node once.",
    ),
    Command(
        "studio",
        commands.run_studio,
        "drag a shape in the browser, and see it with its curvature and its proof",
        (
            value("file", "FILE", "a problem file (.toml) or a project (.pas.json)", nargs="?"),
            value("--port", "N", "the port to listen on (default: a free one)", int, default=0),
            flag("--no-browser", "do not open the page"),
        ),
        "Listens on this machine alone, prints the address of the page and opens it; Ctrl-C ends it.\n"
        "Without a file it shows a gallery of starting points.  A file that changes is read again.",
    ),
)


class Parser(argparse.ArgumentParser):
    """A reader of arguments that guesses what a misspelt command or option was meant to be."""

    reader = ""

    def format_help(self) -> str:
        """As usual, and what the files look like that are read, as the reader of these says it."""
        if not self.reader:
            return super().format_help()
        source = Path(__file__).parents[1] / "exchange" / f"{self.reader}.py"
        told = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8")))
        return f"{super().format_help()}\n{told}\n"

    def error(self, message: str) -> NoReturn:
        """Say what is wrong on stderr and end with exit code 2."""
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        if wrong:
            message = f"there is no command {wrong[1]!r}" + (
                meant(wrong[1], re.findall(r"[\w-]+", wrong[2])) or f"; there are {wrong[2]}"
            )
        message = message.replace("invalid int value:", "must be a whole number, not")
        message = message.replace("invalid float value:", "must be a number, not")
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
    result.add_argument("--version", action="store_true", help="show the version; with --verbose those of libraries")
    result.add_argument("--verbose", action="store_true", help="with --version: versions of libraries as well")
    result.set_defaults(command=None, debug=False, json=False, seconds=None)
    added = result.add_subparsers(title="commands", metavar="COMMAND")
    for command in COMMANDS:
        command.add_to(added)
    return result
