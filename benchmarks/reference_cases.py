"""The 60 cases of `reference.py`: how each is made, from public names of `pas` alone.

Draws are written out, so that they stay the same whatever becomes of the scripts that drew them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import pas
from pas import solid

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
Direction = tuple[int, int, int]


@dataclass(frozen=True)
class ReferenceCase:
    """`make()` gives a shape; its mesh is made within `tolerance` (the model's units; None: as fine as is usual)."""

    make: Callable[[], Any]
    tolerance: float | None = None


CORNER_FILES = (
    "elbow_gc1",
    "elbow_gc2",
    "equal_gc1",
    "equal_gc2",
    "equal_gc3",
    "three_pipes",
    "unequal_gc1",
    "published_proved",
)
"""Problem files of `examples/corners`."""

CORNER_TOLERANCE = 2e-4
"""A ten-thousandth of their size, so that time of meshes counts; nodes are meshed as coarsely as is usual."""

RANDOM_CORNERS = (
    (("2/5", "13/20"), ("1/5", "1"), ("27/100", "13/10")),
    (("1/4", "19/10"), ("49/100", "17/20"), ("31/100", "19/10")),
    (("11/20", "27/20"), ("33/100", "9/5"), ("47/100", "33/20")),
    (("3/20", "6/5"), ("3/50", "17/20"), ("31/100", "1/2")),
)
"""Radius and clip of each pipe along an axis: the first draws of `random_corners.py`."""

NODES: dict[int, tuple[tuple[Direction, str], ...]] = {
    2: (((6, -4, -3), "3/2"), ((-1, -2, 0), "11/10")),
    3: (((2, 2, -3), "7/5"), ((0, 1, 6), "8/5"), ((-6, 1, -6), "3/2")),
    4: (((5, 3, 6), "19/10"), ((0, 2, 1), "7/5"), ((0, -1, -6), "7/5"), ((-1, -6, -2), "6/5")),
    5: (
        ((-2, -1, -1), "17/10"),
        ((3, 1, 3), "19/10"),
        ((-5, 1, 6), "13/10"),
        ((-3, 2, -3), "8/5"),
        ((2, -1, 0), "6/5"),
    ),
    6: (
        ((6, 1, -1), "19/10"),
        ((-1, 6, -1), "7/5"),
        ((-6, 1, 3), "3/2"),
        ((-6, -5, 1), "11/10"),
        ((-1, -2, -3), "6/5"),
        ((1, 0, 1), "2"),
    ),
}
"""Direction and radius of each pipe: the first draws of `nodes.py`; clips are placed by `pas.struts`."""

CONTACTS: dict[str, tuple[Sequence[Any], int]] = {
    "T, GC^2": ([pas.Pipe(X, 1, 2), pas.Pipe((-1, 0, 0), 1, 2), pas.Pipe(Y, 1, 2)], 2),
    "axes that miss, GC^2": (
        [pas.Pipe(X, "1/3", 1, (0, "1/20", "-1/30")), pas.Pipe(Y, "1/4", 1), pas.Pipe(Z, "2/5", 1)],
        2,
    ),
    "pipe on a plate, GC^1": ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 1),
    "pipe on a plate, GC^2": ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 2),
    "leaning on a plate, GC^1": ([pas.Plate(Z, "5/2"), pas.Pipe((1, 0, 3), 1, 2)], 1),
    "nozzle, GC^1": ([pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1),
    "boss, GC^1": ([pas.Opening("x^2 + y^2 + z^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1),
    "cone and two pipes, GC^1": (
        [pas.Cone(Z, "1/2", 2, "-1/4"), pas.Pipe(X, "1/2", 2), pas.Pipe((-1, 2, 0), "2/5", "3/4")],
        1,
    ),
    "sphere and pipe, GC^1": ([pas.Contact("x^2 + y^2 + (z + 2)^2 - 4", "-z - 3/2"), pas.Pipe(Z, "1/2", 1)], 1),
}
"""Contacts and order."""

SURFACES = {
    "torus": ("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)", "2", 4e-4),
    "tangle": ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", "3", 6e-4),
    "heart": ("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", "3/2", 3e-3),
    "ring of three holes": ("(x^2 - 1)^2 + (y^2 - 1)^2 + (z^2 - 1)^2 - 27/20", "2", 4e-4),
}
"""Polynomial, half the edge of its box about 0, and tolerance."""


def problem_file(name: str) -> Any:
    """The blend of a problem file of `examples/corners`."""
    problem = pas.read_problem(EXAMPLES / "corners" / f"{name}.toml")
    return pas.blend(problem.contacts, problem.order, problem.degree, **problem.options)


def corner(number: int, order: int) -> Any:
    """One of the random corners."""
    pipes = [pas.Pipe(axis, *sizes) for axis, sizes in zip((X, Y, Z), RANDOM_CORNERS[number], strict=True)]
    return pas.blend(pipes, order)


def node(number: int, order: int) -> Any:
    """The node of so many pipes."""
    return pas.blend(pas.struts(NODES[number], order), order)


def blended(name: str) -> Any:
    """The blend of contacts of the table."""
    contacts, order = CONTACTS[name]
    return pas.blend(contacts, order)


def boxed(text: str, half: str) -> Any:
    """A single surface in a box."""
    return pas.Polynomial(text).surface((f"-{half}",) * 3, (half,) * 3)


def plate() -> Any:
    """A plate with 15 holes."""
    holes = [
        solid.cylinder((1 + 2 * i, 1 + 2 * j, -1), (1 + 2 * i, 1 + 2 * j, 2), "3/5", f"hole {i} {j}")
        for i in range(5)
        for j in range(3)
    ]
    return solid.box((0, 0, 0), (10, 6, 1)) - solid.union(holes)


def bars() -> Any:
    """27 bars along the axes through 27 points."""
    found = []
    for axis, (i, j) in ((axis, (i, j)) for axis in range(3) for i in range(3) for j in range(3)):
        start, end = [i, j], [i, j]
        start.insert(axis, 0)
        end.insert(axis, 2)
        found.append(solid.cylinder(start, end, "1/10", f"bar {len(found)}"))
    return solid.union(found)


def gear(teeth: int) -> Any:
    """A disc with pointed teeth: each is what two half planes and the disc's edge leave."""
    turns = [pi * k / teeth for k in range(2 * teeth)]
    rim = [(round(r * cos(t), 4), round(r * sin(t), 4)) for t, r in zip(turns, (1.0, 1.25) * teeth, strict=True)]
    wedges = []
    for k in range(teeth):
        corners = [(0, 0), rim[2 * k], rim[2 * k + 1], rim[(2 * k + 2) % len(rim)], (0, 0)]
        sides = [f"-({r - p!r})*(y - ({q!r})) + ({s - q!r})*(x - ({p!r}))" for (p, q), (r, s) in pairwise(corners)]
        flanks = [solid.half_space(side, f"side {2 * k + i}") for i, side in enumerate(sides[1:3])]
        wedges.append(solid.intersection([*flanks, solid.patch("", sides[0]), solid.patch("", sides[3])]))
    return solid.union(wedges) & solid.half_space("-z", "bottom") & solid.half_space("z - 2/5", "top")


def shell() -> Any:
    """A pipe with a dome, hollowed out to a wall of one thickness."""
    body = solid.cylinder((0, 0, 0), (0, 0, 2), 1, "side") | solid.ball((0, 0, 2), 1, "dome")
    return body.shell("1/10", open=["side start"])


def parametric(name: str) -> Any:
    """The blend of a problem file of `examples/parametric`."""
    return pas.read_parametric_problem(EXAMPLES / "parametric" / f"{name}.toml").solve()


SOLIDS: dict[str, ReferenceCase] = {
    "hollow ball": ReferenceCase(lambda: solid.ball((0, 0, 0), 1) - solid.ball((0, 0, 0), "19/20"), 1e-3),
    "two cylinders": ReferenceCase(
        lambda: solid.cylinder((-2, 0, 0), (2, 0, 0), 1) & solid.cylinder((0, -2, 0), (0, 2, 0), 1), 1e-3
    ),
    "thin ring": ReferenceCase(lambda: solid.torus((0, 0, 0), (0, 0, 1), 1, "1/50"), 1e-3),
    "27 bars": ReferenceCase(bars, 4e-3),
    "plate with 15 holes": ReferenceCase(plate, 1e-3),
    "gear": ReferenceCase(partial(gear, 20), 1e-3),
    "shell": ReferenceCase(shell, 1e-2),
    "body of a node": ReferenceCase(
        lambda: pas.node([(X, 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], order=2).solid(), 1e-2
    ),
    "teapot": ReferenceCase(lambda: pas.teapot().solid, 2e-3),
    "hollow pot": ReferenceCase(lambda: pas.teapot().pot, 1e-2),
}


def all_cases() -> dict[str, ReferenceCase]:
    """The cases by name."""
    return {
        **{name: ReferenceCase(partial(problem_file, name), CORNER_TOLERANCE) for name in CORNER_FILES},
        **{
            f"random corner {number + 1}, GC^{order}": ReferenceCase(partial(corner, number, order))
            for order in (1, 2, 3)
            for number in range(len(RANDOM_CORNERS))
        },
        **{
            f"{number} pipes, GC^{order}": ReferenceCase(partial(node, number, order))
            for order in (1, 2)
            for number in NODES
        },
        **{name: ReferenceCase(partial(blended, name)) for name in CONTACTS},
        "hollow elbow, GC^1": ReferenceCase(lambda: pas.node([(X, 1), (Y, 1)], 1).hollow("1/10"), 2e-2),
        "hollow corner, GC^2": ReferenceCase(
            lambda: pas.node([(X, 1), (Y, "3/4"), (Z, "1/2")], 2).hollow("1/10"), 2e-2
        ),
        "hollow nozzle, GC^1": ReferenceCase(lambda: blended("nozzle, GC^1").hollow("1/8"), 2e-2),
        **{
            name: ReferenceCase(partial(boxed, text, half), tolerance)
            for name, (text, half, tolerance) in SURFACES.items()
        },
        **SOLIDS,
        "generatrix blend of a helicoid": ReferenceCase(partial(parametric, "generatrix/helicoid"), 1e-2),
        "generatrix blend of quadrics": ReferenceCase(partial(parametric, "generatrix/quadrics"), 1e-2),
        "parametric blend of example 1": ReferenceCase(partial(parametric, "example_1"), 1e-2),
        "parametric blend of example 2": ReferenceCase(partial(parametric, "example_2"), 1e-2),
    }
