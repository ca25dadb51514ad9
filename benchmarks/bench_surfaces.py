"""Surfaces: values, rays, and meshes beside contours of grids that are as near.

A surface is meshed again and again, and what depends on it alone is kept; but for those that are meshed anew.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import product

import numpy as np
from contours import as_near, flying_edges, marching_cubes
from measured import Prepare, Work, measured

import pas

Shape = Callable[[], pas.PiecewiseSurface]
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
POINTS, RAYS = 1_000_000, 10_000
QUINTIC = "x^5 + 2*x^2*y^3 - z^5 + x*y*z^3 - 3*x^2*y*z + y^4 - z^2*x + x - 2*y + 1"
BOXES = {
    "torus in a box": ("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)", "2"),
    "tangle in a box": ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", "3"),
    "sphere in a box": ("x^2 + y^2 + z^2 - 3/4", "1"),
}
"""Polynomials, and half the edges of their boxes about 0."""


@cache
def corner(degree: int | None = None) -> pas.PiecewiseSurface:
    """Three equal pipes, GC^2."""
    return pas.blend([pas.Pipe(axis, "1/3", 1) for axis in AXES], 2, degree).surface


def points(number: int = POINTS) -> np.ndarray:
    """Drawn points (number, 3) in the corner's region."""
    return np.random.default_rng(0).uniform(-0.5, 0.5, (number, 3))


def values() -> Work:
    """By pas."""
    polynomial, places = pas.Polynomial(QUINTIC), points()
    return lambda: polynomial(places)


def numpy_values() -> Work:
    """By numpy's polynomials in three variables."""
    from numpy.polynomial.polynomial import polyval3d

    table = np.zeros((6, 6, 6))
    for exponents, value in pas.Polynomial(QUINTIC).raw.to_dict().items():
        table[exponents] = float(value.p) / float(value.q)
    x, y, z = points().T
    return lambda: polyval3d(x, y, z, table)


def sympy_values() -> Work:
    """By sympy's function for numpy, common expressions shared."""
    from sympy import lambdify, symbols, sympify

    function = lambdify(symbols("x y z"), sympify(QUINTIC.replace("^", "**")), "numpy", cse=True)
    x, y, z = points().T
    return lambda: function(x, y, z)


def surface_values() -> Work:
    """Of several pieces."""
    evaluator, places = pas.Evaluator(corner(5)), points()
    return lambda: evaluator.values(places)


def rays() -> Work:
    """All crossings with several pieces."""
    evaluator, directions = pas.Evaluator(corner(5)), np.random.default_rng(1).normal(size=(RAYS, 3))
    origins = np.zeros_like(directions)
    return lambda: evaluator.rays(origins, directions)


def boxed(name: str) -> pas.PiecewiseSurface:
    """A new surface in a box."""
    text, half = BOXES[name]
    return pas.Polynomial(text).surface((f"-{half}",) * 3, (half,) * 3)


def meshed(
    surface: Callable[[], pas.PiecewiseSurface], share: float, proved: bool = False, anew: bool = False
) -> Prepare:
    """A mesh with a tolerance of that share of the region's longest side."""

    def prepare() -> Work:
        shape = surface()
        tolerance = share * float(np.ptp(shape.partition.points, axis=0).max())

        def work() -> object:
            shape._last_mesh.clear()  # which would be given again
            mesh = (surface() if anew else shape).mesh(tolerance)
            return mesh.certificate if proved else mesh

        return work

    return prepare


SHAPES: dict[str, Shape] = {
    "GC^2 corner": corner,
    **{name: cache(lambda name=name: boxed(name)) for name in BOXES},
}


def peers(name: str, share: float) -> dict[str, Prepare]:
    """Contours that are as near."""
    return {
        "VTK flying edges": as_near(SHAPES[name], share, flying_edges),
        "scikit-image": as_near(SHAPES[name], share, marching_cubes),
    }


test_values = measured(
    {
        f"{POINTS:,} values of a quintic": {"pas": values, "numpy": numpy_values, "sympy": sympy_values},
        f"{POINTS:,} values of a GC^2 corner, cells found": {"pas": surface_values},
        f"all crossings of {RAYS:,} rays with it": {"pas": rays},
    }
)
test_meshes = measured(
    {
        f"{name}, {share:g} of its size": {"pas": meshed(SHAPES[name], share), **peers(name, share)}
        for name, share in product(SHAPES, (1e-2, 1e-3, 1e-4))
    }
)
test_meshes_with_proofs_and_anew = measured(
    {
        f"{name}{', proved' * proved}{', anew' * anew}, {share:g} of its size (the peer without a proof)": {
            "pas": meshed((lambda name=name: boxed(name)) if anew else SHAPES[name], share, proved, anew),
            "VTK flying edges": as_near(SHAPES[name], share, flying_edges),
        }
        for name, share, proved, anew in product(BOXES, (1e-3, 1e-4), (False, True), (False, True))
        if proved or anew
    }
)
