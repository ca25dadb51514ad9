"""Every long public call and every command, on a small problem, and a clock whose hand moves on when it is looked at.

A case makes its problem afresh, so that nothing is kept from the run before, and calls with `seconds` and
`progress` and a folder to write to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from conftest import EQUAL, ROOT, solved

import pas
from pas import solid
from pas.designs.teapot import Teapot
from pas.independent.checker import check_independently

EXAMPLES = ROOT / "examples"


class TickingClock:
    """Each look at it takes a second."""

    def __init__(self) -> None:
        self.looks = 0

    def monotonic(self) -> float:
        self.looks += 1
        return float(self.looks)


@dataclass(frozen=True)
class LongCall:
    """`make(folder)` is the problem, `call(problem, folder, **limits)` the call.

    `deadlines` are how many different ones are tried.
    """

    make: Callable[[Path], Any]
    call: Callable[..., Any]
    deadlines: int = 4


def _pipes(*_: Any) -> list[pas.Pipe]:
    return [pas.Pipe(axis, "1/3", 1) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]


def _corner(folder: Path) -> pas.Blend:
    """A blend without proofs yet."""
    return pas.load(_saved_blend(folder))


def _struts(folder: Path) -> Any:
    """Two pipes at an angle."""
    return [((1, 0, 0), 1), ((-1, 2, 0), 1)]


def _run_and_branch(*_: Any) -> tuple[pas.Pipe, pas.Pipe]:
    """A straight run and a branch across it."""
    return pas.Pipe((1, 0, 0), 1, "auto"), pas.Pipe((0, 0, 1), "1/2", "auto")


def _blend(folder: Path) -> pas.Blend:
    """A fair one, whose space is solved again."""
    return pas.load(_saved(folder, lambda path: fairest().save(path)))


@cache
def fairest() -> pas.Blend:
    """The blend of degree 3 that is chosen by curvature variation."""
    return pas.blend(_pipes(), 1, 3, prove=False)


def _surface(folder: Path) -> pas.PiecewiseSurface:
    return _corner(folder).surface


def _saved(folder: Path, save: Callable[[Path], Any]) -> Path:
    """A project file, written at the first time only: what is read from it has been computed nowhere."""
    path = folder / "made.pas.json"
    if not path.exists():
        save(path)
    return path


def _space(*_: Any) -> pas.SolutionSpace:
    return pas.solutions(_pipes(), 1, 3)


def _solid(*_: Any) -> solid.Solid:
    return solid.ball((0, 0, 0), 1) - solid.cylinder((0, 0, -2), (0, 0, 2), "1/2")


def _box(*_: Any) -> solid.Solid:
    return solid.box((0, 0, 0), (3, 2, 1))


def _ball(*_: Any) -> solid.Solid:
    return solid.ball((0, 0, 0), 1)


def _parts(*_: Any) -> solid.Assembly:
    return solid.assembly(ball=_ball(), box=solid.box((2, 0, 0), (3, 1, 1)))


def _data(*_: Any) -> pas.BlendingData:
    first = pas.ParametricSurface("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1", domain=((-1, 1), None))
    second = pas.ParametricSurface("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1", domain=((-1, 1), None))
    return pas.BlendingData([first, second])


def _hermite(*_: Any) -> pas.ParametricBlend:
    return pas.hermite_blend(_data(), 1)


def _patch(*_: Any) -> pas.ParametricSurface:
    return _hermite().surface.with_domain(((-1, 1), (0, 1)))


def _sections(*_: Any) -> tuple[pas.Boundary, pas.Boundary]:
    return pas.plane_section("x^2 + y^2 - 1", "z - 2"), pas.plane_section("x^2 + y^2 - 4", "z + 2")


def _generatrix(*_: Any) -> pas.GeneratrixBlend:
    return pas.generatrix_blend(*_sections(), pas.GeneratrixShape(l1=1, l2=1))


def _ends(*_: Any) -> list[pas.Boundary]:
    return [pas.plane_section("x^2 + y^2 - 1", plane) for plane in ("z - 4", "z + 4")]


def _saved_blend(folder: Path) -> Path:
    return _saved(folder, lambda path: solved(EQUAL, 1).save(path))


def _saved_shell(folder: Path) -> Path:
    return _saved(folder, lambda path: pas.save(_ball().shell(0.2, tolerance=0.4), path))


T = 0.2
"""A coarse tolerance."""

CORNER = EXAMPLES / "corners/equal_gc1.toml"
PARAMETRIC = EXAMPLES / "parametric/example_1.toml"
COARSE = ("--tolerance", T)

LONG_COMMANDS: dict[str, tuple[Callable[[Path], Path], tuple[Any, ...]]] = {
    "blend": (lambda _: CORNER, ("blend", "{}", "-o", "OUT", "--no-picture", *COARSE)),
    "parametric": (lambda _: PARAMETRIC, ("parametric", "{}", "-o", "OUT", "--no-picture", *COARSE)),
    "solve": (lambda _: CORNER, ("solve", "{}", "--method", "syzygy")),
    "check": (_saved_blend, ("check", "{}")),
    "check --independent": (_saved_blend, ("check", "{}", "--independent")),
    "mesh": (_saved_blend, ("mesh", "{}", "-o", "OUT/x.stl", *COARSE)),
    "render": (_saved_blend, ("render", "{}", "-o", "OUT/x.png")),
    "write": (_saved_blend, ("write", "{}", "OUT/x.obj", "--open", *COARSE)),
    "convert": (_saved_blend, ("convert", "{}", "OUT/x.3mf", *COARSE)),
    "build": (lambda _: CORNER, ("build", "{}", "-o", "OUT/x.stl", *COARSE)),
    "network": (lambda _: CORNER, ("network", "build", "cubic", "--degree", "lowest", "-o", "OUT/x.stl")),
    "teapot": (lambda _: CORNER, ("teapot", "-o", "OUT", "--style", "paper", "--tolerance", 1)),
}
"""The commands by name, what they read, and their arguments, of which {} is what they read."""

ENDLESS_COMMANDS = {"studio": "a server, which runs until it is interrupted"}
"""Those that have no end of their own, and why."""

LAX = pas.FairnessLimits(2, 3, 1, 1)
"""What the first degree keeps, so that it is measured and no other is tried."""

LONG_CALLS = {
    "pas.blend": LongCall(_pipes, lambda p, f, **k: pas.blend(p, 1, limits=LAX, **k)),
    "pas.node": LongCall(_struts, lambda p, f, **k: pas.node(p, 1, degree=4, energy=pas.ThinPlate(), **k)),
    "pas.junction": LongCall(_struts, lambda p, f, **k: pas.junction(p, 1, degree=4, energy=pas.ThinPlate(), **k)),
    "pas.foot": LongCall(_run_and_branch, lambda p, f, **k: pas.foot(*p, **k)),
    "pas.header": LongCall(
        lambda _: (_run_and_branch()[0], [pas.foot(*_run_and_branch(), degree=6)]),
        lambda p, f, **k: pas.header(*p, (-3, 3), **k),
    ),
    "PiecewiseSurface.curvature_below": LongCall(_surface, lambda p, f, **k: p.curvature_below(20, **k)),
    "Blend.refit": LongCall(_blend, lambda p, f, **k: p.refit(tension=6, steps=None, **k)),
    "SolutionSpace.fit": LongCall(_space, lambda p, f, **k: p.fit(**k)),
    "pas.save": LongCall(_corner, lambda p, f, **k: pas.save(p, f / "x.pas.json", **k)),
    "Blend.mesh": LongCall(_corner, lambda p, f, **k: p.mesh(T, **k), 3),
    "pas.table": LongCall(lambda f: [_corner(f), _corner(f)], lambda p, f, **k: pas.table(p, **k)),
    "Blend.simplified": LongCall(lambda p: pas.blend(_pipes(), 1, 3), lambda p, f, **k: p.simplified(**k), 3),
    "HollowBlend.simplified": LongCall(
        lambda p: pas.blend(_pipes(), 1, 3).hollow("1/20"), lambda p, f, **k: p.simplified(**k), 3
    ),
    "Blend.hollow": LongCall(_corner, lambda p, f, **k: p.hollow("1/20", **k), 3),
    "HollowBlend.thicker_than": LongCall(
        lambda p: _corner(p).hollow("1/20"), lambda p, f, **k: p.thicker_than("1/25", **k)
    ),
    "HollowBlend.mesh": LongCall(lambda p: _corner(p).hollow("1/20"), lambda p, f, **k: p.mesh(T, **k), 3),
    "SolutionSpace.optimum": LongCall(_space, lambda p, f, **k: p.optimum(**k)),
    "pas.solutions": LongCall(_pipes, lambda p, f, **k: pas.solutions(p, 2, **k)),
    "pas.existence": LongCall(
        lambda _: [("y^2 + z^2 - r1^2", "x - d1"), ("x^2 + z^2 - r2^2", "y - d2")],
        lambda p, f, **k: pas.existence(p, 1, 2, ("r1", "r2", "d1", "d2"), **k),
    ),
    "pas.normal_form_system": LongCall(
        lambda _: [("y^2 + z^2 - 1", "x"), ("x^2 + z^2 - 1", "y")],
        lambda p, f, **k: pas.normal_form_system(p, 1, 4, **k),
    ),
    "pas.syzygies": LongCall(lambda _: ["x^2 - y", "y^2 - z", "z^2 - x*y + 1"], lambda p, f, **k: pas.syzygies(p, **k)),
    "PiecewiseSurface.fairness": LongCall(_surface, lambda p, f, **k: p.fairness(**k)),
    "PiecewiseSurface.certify": LongCall(_surface, lambda p, f, **k: p.certify(**k)),
    "PiecewiseSurface.triangulate": LongCall(_surface, lambda p, f, **k: p.triangulate(T, **k)),
    "PiecewiseSurface.mesh": LongCall(_surface, lambda p, f, **k: p.mesh(T, **k), 3),
    "Solid.mesh": LongCall(_solid, lambda p, f, **k: p.mesh(T, **k), 8),
    "Solid.face_mesh": LongCall(_solid, lambda p, f, **k: p.face_mesh(T, **k), 3),
    "Solid.volume": LongCall(_solid, lambda p, f, **k: p.volume(T, **k), 3),
    "Solid.area": LongCall(_solid, lambda p, f, **k: p.area(T, **k), 3),
    "Solid.measures": LongCall(_solid, lambda p, f, **k: p.measures(T, **k), 3),
    "Part.measures": LongCall(_parts, lambda p, f, **k: p["ball"].measures(T, **k), 3),
    "Assembly.part_list": LongCall(_parts, lambda p, f, **k: p.part_list(T, **k), 3),
    "pas.solid.smooth_union": LongCall(
        lambda _: (_box(), solid.cylinder((1, 1, 0), (1, 1, 2), "1/2")),
        lambda p, f, **k: solid.smooth_union(*p, "1/4", **k),
        3,
    ),
    "Solid.shell": LongCall(_ball, lambda p, f, **k: p.shell(0.2, tolerance=0.4, **k), 3),
    "Part.mesh": LongCall(_parts, lambda p, f, **k: p["ball"].mesh(T, **k), 3),
    "Assembly.mesh": LongCall(_parts, lambda p, f, **k: p.mesh(T, **k), 3),
    "Assembly.meshes": LongCall(_parts, lambda p, f, **k: p.meshes(T, **k)),
    "pas.write": LongCall(_solid, lambda p, f, **k: pas.write(p, f / "x.obj", tolerance=T, **k), 3),
    "pas.volume_mesh": LongCall(_box, lambda p, f, **k: pas.volume_mesh(p, edge_length=1, tolerance=0.05, **k), 3),
    "pas.load": LongCall(_saved_shell, lambda p, f, **k: pas.load(p, **k), 2),
    "pas.draw": LongCall(_surface, lambda p, f, **k: pas.draw(p, f / "x.png", size=(64, 48), **k), 2),
    "pas.animate": LongCall(
        _surface, lambda p, f, **k: pas.animate(lambda _: p, (0,), f / "x.gif", size=(64, 48), **k), 2
    ),
    "ParametricSurface.mesh": LongCall(_patch, lambda p, f, **k: p.mesh(T, **k)),
    "ParametricSurface.solid": LongCall(lambda _: pas.torus(2, 1, angle=True), lambda p, f, **k: p.solid(**k)),
    "ParametricBlend.mesh": LongCall(_hermite, lambda p, f, **k: p.mesh(T, ((-1, 1), (0, 1)), **k)),
    "ParametricBlend.prove": LongCall(_hermite, lambda p, f, **k: p.prove(((-1, 1), (0, 1)), **k)),
    "RationalPatch.mesh": LongCall(
        lambda _: pas.bezier_patch(pas.elliptic_paraboloid(), ((0, 1), (0, 1))), lambda p, f, **k: p.mesh(T, **k), 3
    ),
    "pas.regularity": LongCall(_patch, lambda p, f, **k: pas.regularity(p, **k)),
    "pas.hermite_blend": LongCall(_data, lambda p, f, **k: pas.hermite_blend(p, 1, **k)),
    "pas.weighted_blend": LongCall(_data, lambda p, f, **k: pas.weighted_blend(p, 1, **k)),
    "pas.bezier_patches": LongCall(_patch, lambda p, f, **k: pas.bezier_patches(p, **k)),
    "pas.fit_patch": LongCall(
        lambda _: pas.helicoid().with_domain(((0, 1), (0, 1))), lambda p, f, **k: pas.fit_patch(p, T, **k)
    ),
    "pas.generatrix_blend": LongCall(_sections, lambda p, f, **k: pas.generatrix_blend(*p, **k)),
    "GeneratrixBlend.mesh": LongCall(_generatrix, lambda p, f, **k: p.mesh(size=(12, 6), **k)),
    "GeneratrixBlend.largest_safe": LongCall(_generatrix, lambda p, f, **k: p.largest_safe(size=(24, 8), **k)),
    "pas.blend_quadrics": LongCall(
        lambda _: ("x^2 + y^2 - 1", "z - 2", "x^2 + y^2 - 4", "z + 2"),
        lambda p, f, **k: pas.blend_quadrics(*p, **k),
    ),
    "pas.blend_through_sphere": LongCall(_ends, lambda p, f, **k: pas.blend_through_sphere(p, (0, 0, 0), 1, **k)),
    "SphereBlend.mesh": LongCall(
        lambda _: pas.blend_through_sphere(_ends(), (0, 0, 0), 1), lambda p, f, **k: p.mesh(size=(12, 6), **k)
    ),
    "pas.teapot": LongCall(lambda _: None, lambda p, f, **k: pas.teapot("paper", **k), 2),
    "Teapot.mesh": LongCall(lambda _: Teapot("paper", _box(), _box(), _box()), lambda p, f, **k: p.mesh(T, **k), 2),
    "pas.independent.checker.check_independently": LongCall(
        _saved_blend, lambda p, f, **k: check_independently(p, **k)
    ),
}
