"""Horner's rule in the compiled library: what `pas.algebra.kernels` does with numpy, to the last bit, sooner."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, positions
from pas.kernels.library import address_of, library

if TYPE_CHECKING:
    from pas.algebra.tables import Rows


class CompiledKernel:
    """Horner's rule of a compiled library."""

    name = "compiled"

    def __init__(self) -> None:
        self._run = library().pas_horner
        self._run.restype = None
        self._run.argtypes = (ctypes.c_int, ctypes.c_ssize_t, *[ctypes.c_void_p] * 5)
        self._mixed = library().pas_mixed
        size, address = ctypes.c_ssize_t, ctypes.c_void_p
        self._mixed.argtypes = (size, size, *[address] * 3, size, *[address] * 3)

    def __call__(self, coefficients: Floats, degree: int, points: Floats, out: Floats) -> None:
        """See `pas.algebra.kernels.Kernel`."""
        x, y, z = (np.ascontiguousarray(c, dtype=float) for c in points)
        table = np.ascontiguousarray(coefficients[:, order_of_rule(degree)], dtype=float)
        for row, column in zip(table, out, strict=True):
            values = column if column.flags.c_contiguous else np.empty(len(x))
            self._run(degree, len(x), *map(address_of, (row, x, y, z, values)))
            if values is not column:
                column[:] = values

    def on_pieces(self, rows: Rows, points: Floats, pieces: NDArray[np.intp], out: Floats) -> None:
        """Values (m, N) at points (N, 3) of pieces of given numbers (N,); `out` is contiguous."""
        arrays = (np.ascontiguousarray(points), np.ascontiguousarray(pieces, dtype=np.intp), out)
        tables = map(address_of, (rows.degrees, rows.starts, rows.coefficients))
        if self._mixed(*rows.degrees.shape, *tables, len(points), *map(address_of, arrays)):
            raise MemoryError("there is no memory for the points of each piece")


@cache
def order_of_rule(degree: int) -> NDArray[np.intp]:
    """The order in which the rule meets the coefficients: falling powers of z inside y inside x."""
    where = positions(degree)
    return np.array(
        [
            where[a, b, c]
            for a in range(degree, -1, -1)
            for b in range(degree - a, -1, -1)
            for c in range(degree - a - b, -1, -1)
        ],
        dtype=np.intp,
    )
