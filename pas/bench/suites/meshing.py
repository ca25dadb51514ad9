"""Meshes of surfaces beside contours of grids, to the same largest error.

One surface is meshed again and again, and what depends on it alone is kept; but for those that are `anew`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from pas.bench.case import Case, Prepare, Suite, Work
from pas.bench.contours import as_near, flying_edges, marching_cubes
from pas.piecewise import PiecewiseSurface

TORUS = "(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"
TANGLE = "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5"
SPHERE = "x^2 + y^2 + z^2 - 3/4"
BOXES = {"torus in a box": (TORUS, "2"), "tangle in a box": (TANGLE, "3"), "sphere in a box": (SPHERE, "1")}
"""Polynomials, and half the edges of their boxes about 0."""


@cache
def corner() -> PiecewiseSurface:
    """Three equal pipes, GC^2."""
    from pas.contacts.pipe import Pipe
    from pas.pipeline.blend import blend

    return blend([Pipe(axis, "1/3", 1) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], 2).surface


def _boxed(text: str, half: str) -> Callable[[], PiecewiseSurface]:
    from pas.algebra.polynomial import Polynomial
    from pas.piecewise import boxed

    @cache
    def made() -> PiecewiseSurface:
        return boxed(Polynomial(text), (f"-{half}",) * 3, (half,) * 3)

    return made


def _tolerance(surface: PiecewiseSurface, share: float) -> float:
    points = surface.partition.points
    return share * float((points.max(axis=0) - points.min(axis=0)).max())


def _mesh(surface: Callable[[], PiecewiseSurface], share: float) -> Prepare:
    def prepare() -> Work:
        shape = surface()
        tolerance = _tolerance(shape, share)
        return lambda: shape.mesh(tolerance)

    return prepare


def _proved(surface: Callable[[], PiecewiseSurface], share: float) -> Prepare:
    def prepare() -> Work:
        shape = surface()
        tolerance = _tolerance(shape, share)
        return lambda: shape.mesh(tolerance).certificate

    return prepare


def _anew(text: str, half: str, share: float, proved: bool) -> Prepare:
    def prepare() -> Work:
        tolerance = _tolerance(_boxed(text, half)(), share)

        def work() -> object:
            mesh = _boxed(text, half)().mesh(tolerance)
            return mesh.certificate if proved else mesh

        return work

    return prepare


def cases() -> list[Case]:
    """Those of this suite."""
    shapes: dict[str, Callable[[], PiecewiseSurface]] = {
        "GC^2 corner": corner,
        **{name: _boxed(*box) for name, box in BOXES.items()},
    }
    meshes = [
        Case(
            f"{name}, {share:g} of its size",
            _mesh(surface, share),
            {
                "VTK flying edges": as_near(surface, share, flying_edges),
                "scikit-image": as_near(surface, share, marching_cubes),
            },
        )
        for name, surface in shapes.items()
        for share in (1e-2, 1e-3, 1e-4)
    ]
    proved = [
        Case(
            f"{name} with its proof, {share:g} of its size",
            _proved(shapes[name], share),
            {"VTK flying edges": as_near(shapes[name], share, flying_edges)},
            "the peer without a proof",
        )
        for name, share in (("torus in a box", 1e-3), ("torus in a box", 1e-4), ("tangle in a box", 1e-3))
    ]
    anew = [
        Case(
            f"{name}{' with its proof' if proved else ''}, {share:g} of its size, anew",
            _anew(text, half, share, proved),
            {"VTK flying edges": as_near(shapes[name], share, flying_edges)},
            "the peer without a proof" if proved else "",
        )
        for name, (text, half) in BOXES.items()
        for share in (1e-3, 1e-4)
        for proved in (False, True)
    ]
    return [*meshes, *proved, *anew]


MESHING = Suite(
    "mesh",
    "meshes, and contours of grids that are as near; of surfaces that were meshed before, but for those anew",
    cases,
)
