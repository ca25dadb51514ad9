"""The errors: one small tree of exceptions that carry their data.

Misuse of the API (a wrong type, a radius of zero, an unknown file suffix) raises the builtin `TypeError` or
`ValueError`, naming the argument and what would be right.  Everything below is about geometry, mathematics or files and
descends from `PasError`.  On the command line the classes under `InputError` end with exit code 2, the others with 1.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

ELSEWHERE = {
    name: words.split()
    for words, name in (
        ("sphere", "ball"),
        ("cube cuboid block", "box"),
        ("square", "rectangle"),
        ("ngon hexagon", "regular_polygon"),
        ("sweep path_extrude pipe_run", "pipe"),
        ("screw bolt isothread", "thread"),
        ("linear_extrude prism", "extrude"),
        ("rotate_extrude lathe", "revolve"),
        ("line lineto", "line_to"),
        ("arc threepointarc", "arc_to"),
        ("fuse join add combine merge", "union"),
        ("fuse join add combine merge union", "a | b"),
        ("subtract cut minus", "difference"),
        ("subtract cut minus difference", "a - b"),
        ("intersect common", "intersection"),
        ("intersect common intersection", "a & b"),
        ("move shift moved translated", "translate"),
        ("turn spin rotated", "rotate"),
        ("resize scaled", "scale"),
        ("reflect flip mirrored", "mirror"),
        ("round round_edges fillets", "fillet"),
        ("bevel", "chamfer"),
        ("hollow thicken", "shell"),
        ("array linear_pattern grid", "pattern"),
        ("polar_array polar_pattern circular_array", "circular_pattern"),
        ("export export_step export_stl to_step to_stl save_stl save_step", "write"),
        ("plot display view", "show"),
        ("render picture screenshot save_png", "draw"),
        ("bbox bounds extents", "bounding_box"),
        ("center centroid center_of_mass inertia moments mass", "measures"),
        ("color colour paint", "solid.assembly(name=(shape, '#rrggbb'))"),
    )
}
"""What is found here, and the words that other programs have for it; what is no name is written as it stands."""


def meant(word: str, known: Iterable[str]) -> str:
    """The end of a sentence about a word that is not known: a guess at what was meant, or nothing."""
    names = list(known)
    low = word.lower()
    near = [n for n in names if low == (own := n.rpartition(".")[2]).lower() or low in ELSEWHERE.get(own, ())]
    near = near or get_close_matches(word, names, 1)
    return f"; is {near[0]!r} meant?" if near else ""


def missing(owner: str, name: str, known: Iterable[str]) -> AttributeError:
    """The error for a name that something has not, with what is near or how it is written here."""
    written = [here for here, words in ELSEWHERE.items() if not here.isidentifier() and name.lower() in words]
    hint = "" if name.startswith("_") else meant(name, (n for n in known if not n.startswith("_")))
    return AttributeError(f"{owner} has no {name!r}" + (hint or "".join(f"; it is written {w}" for w in written[:1])))


def warn(sentence: str) -> None:
    """Warn (`UserWarning`) at the line outside the package from which it was called."""
    level, frame = 1, sys._getframe()
    while frame.f_globals.get("__name__", "").partition(".")[0] == __package__ and frame.f_back is not None:
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, stacklevel=level)


class PasError(Exception):
    """Root of every error that mathematics or a file causes."""


class InputError(PasError):
    """The input makes no sense: impossible geometry, or a bad file."""


class GeometryError(InputError):
    """The given surfaces, clips or cells do not fit together."""


class ProblemFileError(InputError):
    """A problem file (TOML) that cannot be read; `line` is 1-based where it is known."""

    def __init__(self, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.line = line


class ProjectFileError(InputError):
    """A project file (`.pas.json`) that is truncated, edited, foreign or of a newer version."""


class MeshError(PasError):
    """A surface has no mesh of this tolerance; the message says why."""


class NoSolutionError(PasError):
    """No usable surface in the degrees tried.

    `dimensions` maps each degree tried to the dimension of its solution space.
    """

    def __init__(self, message: str, dimensions: Mapping[int, int]) -> None:
        super().__init__(message)
        self.dimensions = dict(dimensions)


class InfeasibleError(PasError):
    """No member of a solution space satisfies the constraints.

    `conflict` lists the user's constraints that cannot hold together (irreducible: without any
    one of them the others can hold), empty where the conflict is not among the user's own.
    """

    def __init__(self, message: str, conflict: Sequence[str] = ()) -> None:
        super().__init__(message)
        self.conflict = tuple(conflict)


class NotSolvedError(InfeasibleError):
    """No member was found because the solvers failed numerically; there may be one all the same."""


class NotProvedError(PasError):
    """A surface was found, but not one that passes every proof; `blend` is the best one found."""

    def __init__(self, message: str, blend: Any = None) -> None:
        super().__init__(message)
        self.blend = blend


class LimitError(PasError):
    """A computation was given up because it reached a limit (seconds, degree) that was set."""


class MissingLibraryError(PasError):
    """A system library or optional package is absent; the message says how to install it."""


def library(name: str, how: str) -> Any:
    """The module of an optional package; raises `MissingLibraryError`, which says `how` to install it, without it."""
    try:
        __import__(name)
    except ImportError:
        raise MissingLibraryError(how) from None
    return sys.modules[name]


OPTIONAL = {
    "pyvista": "pictures, files of VTK and distances between sides of walls need pyvista: pip install 'pas[pictures]'",
    "cvxpy": "convex problems of one's own need cvxpy: pip install 'pas[convex]'",
    "matplotlib": "fonts by name need matplotlib: pip install 'pas[fonts]', or give the path of a .ttf file",
}
"""Packages that a lean install has not, and what is said where they are needed."""


def optional(name: str) -> Any:
    """The module of one of `OPTIONAL`; raises `MissingLibraryError` where it is not installed."""
    return library(name, OPTIONAL[name])
