"""Parametric blends: exact Hermite ones, and those along a Bezier generatrix with their meshes."""

from __future__ import annotations

from itertools import cycle

from pas.bench.case import Case, Suite, Work

CYLINDERS = (
    ("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1"),
    ("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1"),
)
SECTIONS = (("x^2 + y^2 - 1", "z - 3"), ("y^2 + z^2/4 - 1/4", "x - 3"))
SIZE = (100, 100)


def _hermite() -> Work:
    from pas.parametric.blends import hermite_blend
    from pas.parametric.data import BlendingData
    from pas.parametric.surface import ParametricSurface

    return lambda: hermite_blend(BlendingData([ParametricSurface(*triple) for triple in CYLINDERS]), 1)


def _slider() -> Work:
    from pas.parametric.generatrix.blend import generatrix_blend
    from pas.parametric.generatrix.sections import plane_section
    from pas.parametric.generatrix.shape import GeneratrixShape

    first, second = (plane_section(*words) for words in SECTIONS)
    blend = generatrix_blend(first, second, GeneratrixShape("1/2", "1/2"))
    blend.mesh(size=SIZE)
    values = cycle([0.4 + i / 500 for i in range(100)])
    return lambda: blend.with_shape(l1=next(values), lambda2=0.1).mesh(size=SIZE)


def cases() -> list[Case]:
    """Those of this suite."""
    return [
        Case("Hermite blend of two cylinders, GC^1, exact", _hermite),
        Case("generatrix blend of two pipes: a slider's step and its mesh, 100 x 100", _slider),
    ]


PARAMETRIC = Suite("parametric", "exact parametric blends, and sliders with their meshes", cases)
