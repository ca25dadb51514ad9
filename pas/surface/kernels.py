"""Forms on triangles and faces that rays leave through in compiled code, where there is some.

The functions here are those of `pas.surface.triangle_forms` and `radial_field`, which do the same with numpy.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from pas.algebra.compiled import SOURCE, Functions, is_made, library
from pas.algebra.kernels import compiling
from pas.algebra.monomials import Floats
from pas.mesh.field import Integers

SOURCES = (Path(__file__).with_name("forms.c"), SOURCE)


class CompiledForms:
    """The functions of the compiled library; polynomials by coefficients in the order of the rule."""

    def __init__(self, functions: Functions) -> None:
        self._call = functions.call

    def ranges(
        self,
        degree: int,
        lattice: tuple[Floats, Floats],
        raising: Floats | None,
        coefficients: Floats,
        corners: Floats,
    ) -> tuple[Floats, Floats]:
        """The least and largest B-coefficients (T,) of a polynomial on triangles (T, 3, 3), of a higher degree where
        there is a matrix for it."""
        low, high = np.empty(len(corners)), np.empty(len(corners))
        places, inverse = lattice
        higher = (0, places) if raising is None else (len(raising), raising)
        outputs = (len(corners), corners, low, high)
        self._call("pas_ranges", degree, len(places), places, inverse, *higher, coefficients, *outputs)
        return low, high

    def slopes(
        self, degree: int, lattice: tuple[Floats, Floats], coefficients: Floats, corners: Floats, normals: Floats
    ) -> tuple[Floats, Floats]:
        """The least B-coefficient of the derivative along normals (T, 3), and the gradient's largest squared size."""
        least, sizes = np.empty(len(corners)), np.empty(len(corners))
        outputs = (len(corners), corners, normals, least, sizes)
        self._call("pas_slopes", degree, len(lattice[0]), *lattice, coefficients, *outputs)
        return least, sizes

    def leaving(self, weights: Floats, points: Floats) -> tuple[Floats, Integers]:
        """See `pas.surface.radial_field.RadialField.leaving`: the multiples (N,), and the faces (N,)."""
        multiples, faces = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
        self._call("pas_leaving", len(weights), weights, len(points), points, multiples, faces)
        return multiples, faces


def compiled(work: int) -> CompiledForms | None:
    """The compiled functions for so many more products, None where there are none or numpy is wanted."""
    return _best() if compiling(work, _made) else None


@cache
def _made() -> bool:
    return is_made(*SOURCES)


@cache
def _best() -> CompiledForms | None:
    found = library(*SOURCES)
    return None if found is None else CompiledForms(Functions(found[0]))
