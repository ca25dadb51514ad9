"""The compiled functions of surfaces: forms on triangles, fields and their rims, and windings.

What each is for is said in `pas.certify.triangle_forms`, `windings`, `patch_field`, `local_field`, `rings` and
`radial_field`.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.tables import Rows
from pas.kernels.library import Functions
from pas.mesh.field import Integers

Faces = tuple[int, Floats, Integers]
"""How many faces rays leave a region through, their weights (F, 3, 3), and pieces (F,); 0 where there is one piece."""


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

    def near(
        self, faces: Faces, rows: tuple[Rows, Rows], points: Floats, limits: tuple[int, float, float, float]
    ) -> tuple[Floats, NDArray[np.bool_]]:
        """Where the rays through points (N, 3) meet the surface, and which of them (N,) graze or miss it.

        See `pas.surface.radial_field.RadialField`.  The first of `rows` are those of the parts of each degree, the
        others those of values and gradients.
        """
        result, grazed = np.empty((len(points), 3)), np.empty(len(points), dtype=np.bool_)
        parts, jets = ((some.degrees, some.starts, some.coefficients) for some in rows)
        given = (*faces, len(rows[0].starts), rows[0].degrees.shape[1], *parts, *jets)
        self._call("pas_near", *given, len(points), points, *limits, result, grazed)
        return result, grazed

    def around(
        self,
        faces: Faces,
        rows: Rows,
        skeleton: tuple[Floats, Floats],
        points: Floats,
        otherwise: Floats,
        limits: tuple[int, float, float, float],
    ) -> Floats:
        """See `pas.surface.radial_field.RadialField`: where rays from the skeleton meet the surface, (N, 3)."""
        result, tables = np.array(otherwise, order="C"), (rows.degrees, rows.starts, rows.coefficients)
        given = (*faces, len(rows.starts), *tables, len(skeleton[0]), *skeleton, len(points), points)
        self._call("pas_around", *given, *limits, result)
        return result

    def once(self, profiles: Floats, leave: Floats, shares: Floats) -> bool:
        """Whether profiles (n + 1, N) change their sign once at these shares (S,) of where rays leave (N,)."""
        once = np.empty(1, dtype=np.intp)
        self._call("pas_once", *profiles.shape, profiles, leave, len(shares), shares, once)
        return bool(once[0])

    def crossed(
        self,
        points: Floats,
        triangles: Integers,
        origin: Floats,
        ways: Floats,
        towards: Floats,
        limits: tuple[float, float],
    ) -> tuple[Integers, NDArray[np.bool_]]:
        """See `pas.certify.windings.crossed`: the ends are `ways` (E, 3) away from `origin`, `towards` unit vectors."""
        times, known = np.empty(len(ways), dtype=np.intp), np.empty(len(ways), dtype=np.bool_)
        given = (len(triangles), triangles, points, origin, len(ways), ways, towards)
        self._call("pas_crossed", *given, *limits, times, known)
        return times, known

    def bent(self, faces: Faces, rows: Rows, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Values (N,), gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points (N, 3)."""
        values, bends = np.empty((2, len(points)))
        gradients = np.empty((len(points), 3))
        given = (*faces, len(rows.starts), rows.degrees, rows.starts, rows.coefficients, len(points), points)
        self._call("pas_bent", *given, values, gradients, bends)
        return values, gradients, bends

    def drawn(
        self,
        faces: Faces,
        rows: tuple[Rows, Rows],
        points: Floats,
        still: NDArray[np.bool_],
        limits: tuple[float, float],
    ) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        """Points (N, 3) moved by a step along the gradient but for those that are still, gradients and curvatures,
        and which were not near.

        See `pas.surface.patch_field.PatchField.drawn`.  The first of `rows` are those of values and gradients alone.
        """
        moved, gradients = np.empty((2, len(points), 3))
        bends, lost = np.empty(len(points)), np.empty(len(points), dtype=np.bool_)
        tables = [table for some in rows for table in (some.degrees, some.starts, some.coefficients)]
        given = (*faces, len(rows[0].starts), *tables, len(points), points, still, *limits)
        self._call("pas_drawn", *given, moved, gradients, bends, lost)
        return moved, gradients, bends, lost

    def distances(self, faces: Faces, rows: Rows, points: Floats) -> Floats:
        """See `pas.surface.patch_field.PatchField.distances`; `rows` are those of values and gradients."""
        result, tables = np.empty(len(points)), (rows.degrees, rows.starts, rows.coefficients)
        self._call("pas_distances", *faces, len(rows.starts), *tables, len(points), points, result)
        return result

    def closed(self, faces: Faces, rows: Rows, points: Floats, limits: tuple[int, float]) -> tuple[Floats, Floats]:
        """See `pas.surface.patch_field.PatchField.closed`; `rows` are those of values and gradients."""
        result, gradients = np.array(points, order="C"), np.empty((len(points), 3))
        tables = (rows.degrees, rows.starts, rows.coefficients)
        self._call("pas_closed", *faces, len(rows.starts), *tables, len(points), *limits, result, gradients)
        return result, gradients

    def on_rings(
        self,
        rows: Rows,
        places: tuple[Floats, Floats],
        points: Floats,
        numbers: Integers,
        limits: tuple[int, float],
    ) -> Floats:
        """See `pas.surface.rings.Rings.at`; `places` are the curves' middles and normals (P, 3)."""
        result, tables = np.empty((len(points), 3)), (rows.degrees, rows.starts, rows.coefficients)
        given = (len(rows.starts), *tables, *places, len(points), points, numbers, *limits)
        self._call("pas_on_rings", *given, result)
        return result

    def slid(
        self,
        faces: Faces,
        rows: Rows,
        walls: tuple[Floats, Floats, Floats],
        points: Floats,
        numbers: Integers,
        limits: tuple[int, float, float],
    ) -> Floats:
        """See `pas.surface.local_field`: points (N, 3) moved along gradients, onto walls of given numbers (N,) where
        there are any."""
        result, tables = np.array(points, order="C"), (rows.degrees, rows.starts, rows.coefficients)
        given = (*faces, len(rows.starts), *tables, len(walls[0]), *walls, numbers)
        self._call("pas_slid", *given, *limits, len(result), result)
        return result


@cache
def compiled() -> CompiledForms:
    """The compiled functions."""
    return CompiledForms(Functions())
