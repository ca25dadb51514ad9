"""Libraries in C, compiled by the system's compiler when they are first worth it, and kept; Horner's rule is one.

A library is kept in the user's cache (`$XDG_CACHE_HOME/pas`, by default `~/.cache/pas`) under a name that
says of which sources, compiler and machine it is.  It does what the package does with numpy, without contracting
products and sums: values by Horner's rule, which does them in the same order, are the same to the last bit, all else
is the same to rounding.  Where there is no compiler, or it fails, or the folder may be written by others, there is no
such library, and numpy serves.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, positions

if TYPE_CHECKING:
    from pas.algebra.tables import Rows

SOURCE = Path(__file__).with_name("horner.c")

COMPILERS = ("cc", "gcc", "clang")
"""Tried in this order, after `$CC`."""

OPTIONS = ("-O3", "-fPIC", "-shared", "-ffp-contract=off")
"""No contraction: a product and a sum in one rounding would give other results than numpy."""

PATIENCE = 60
"""Seconds after which a compiler is given up; it takes some tenths of a second."""

OTHERS_WRITE = 0o022
"""Bits of a folder's mode that let others put a library of theirs into it."""


class CompiledKernel:
    """Horner's rule of a compiled library."""

    def __init__(self, library: ctypes.CDLL, compiler: str) -> None:
        self.name = f"compiled by {compiler}"
        self._run = library.pas_horner
        self._run.restype = None
        self._run.argtypes = (ctypes.c_int, ctypes.c_ssize_t, *[ctypes.c_void_p] * 5)
        self._mixed = library.pas_mixed
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


class Functions:
    """The functions of a compiled library, which return 0, or else there was no memory."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        self._declared: dict[str, Callable[..., int]] = {}

    def call(self, name: str, *arguments: NDArray[Any] | float) -> None:
        """Arrays by their addresses, whole numbers as large as pointers, and doubles: of the same kinds in all calls.

        Arrays to be written must be contiguous.  Raises `MemoryError` where there was no room.
        """
        given: list[float] = []
        held = []  # copies, which live until the function is done
        for value in arguments:  # in one pass without calls: meshes make a hundred such calls, each of microseconds
            if isinstance(value, np.ndarray):
                if not value.size:
                    given.append(NOWHERE)
                    continue
                if value.dtype.char not in _TAKEN or not value.flags.c_contiguous:
                    held.append(value := _held(value))
                try:
                    given.append(_addressof(_from_buffer(value)))  # type: ignore[arg-type]
                except (TypeError, ValueError):
                    given.append(address_of(value))
            else:
                given.append(value)
        function = self._declared.get(name) or self._declare(name, arguments)
        if function(*given):
            raise MemoryError(f"there is no memory for {name}")

    def _declare(self, name: str, arguments: tuple[NDArray[Any] | float, ...]) -> Callable[..., int]:
        function = getattr(self._library, name)
        function.argtypes = [_kind(value) for value in arguments]
        self._declared[name] = function
        return function


def _held(array: NDArray[Any]) -> NDArray[Any]:
    """A copy of an array as the functions take it; those that they write to already are."""
    return np.ascontiguousarray(array, dtype=np.intp if array.dtype.kind == "i" else None)


_addressof, _from_buffer = ctypes.addressof, ctypes.c_char.from_buffer
_NOTHING = ctypes.c_double()

NOWHERE = ctypes.addressof(_NOTHING)
"""The address that stands for that of an empty array, from which nothing is read."""

_TAKEN = {np.dtype(kind).char for kind in (np.float64, np.intp, np.bool_)}


def _kind(value: NDArray[Any] | float) -> Any:
    if isinstance(value, np.ndarray):
        return ctypes.c_void_p
    return ctypes.c_double if isinstance(value, float) else ctypes.c_ssize_t


def address_of(array: NDArray[Any]) -> int:
    """Where the numbers of a contiguous array stand."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]  # faster than the other
    except (TypeError, ValueError):  # not to be written to, or empty
        address: int = array.__array_interface__["data"][0]
        return address


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


def compiled() -> CompiledKernel | None:
    """The compiled kernel; None where it cannot be made."""
    found = library(SOURCE)
    return None if found is None else CompiledKernel(*found)


def library(*sources: Path) -> tuple[ctypes.CDLL, str] | None:
    """The library of some C sources, made if it was not before, and its compiler's name; None where it cannot be."""
    for compiler in _compilers():
        try:
            place = _place(compiler, sources)
            if not place.exists():
                _make(place, compiler, sources)
            return ctypes.CDLL(str(place)), Path(compiler).name
        except (OSError, RuntimeError, subprocess.SubprocessError, AttributeError):
            continue
    return None


def is_made(*sources: Path) -> bool:
    """Whether the library of some C sources was made before."""
    for compiler in _compilers():
        try:
            return _place(compiler, sources).exists()
        except (OSError, RuntimeError):
            continue
    return False


def _compilers() -> list[str]:
    found = [shutil.which(name) for name in (os.environ.get("CC"), *COMPILERS) if name]
    return [compiler for compiler in found if compiler]


def _place(compiler: str, sources: tuple[Path, ...]) -> Path:
    """Where a library is kept.  Raises `OSError` or `RuntimeError` where there is no folder for it."""
    told = "\n".join((compiler, *OPTIONS, platform.machine(), platform.platform())).encode()
    read = (*sources, *_headers(sources))
    key = hashlib.sha256(b"".join(source.read_bytes() for source in read) + told).hexdigest()[:16]
    return cache_folder() / f"{sources[0].stem}-{key}.so"


def _headers(sources: tuple[Path, ...]) -> list[Path]:
    """The headers that stand beside some sources, or beside `SOURCE`, which they may include."""
    folders = dict.fromkeys(source.parent for source in (SOURCE, *sources))
    return [header for folder in folders for header in sorted(folder.glob("*.h"))]


def _make(place: Path, compiler: str, sources: tuple[Path, ...]) -> None:
    """Compile a library.  Raises `OSError` or `SubprocessError` where that fails."""
    with tempfile.TemporaryDirectory(dir=place.parent) as folder:
        made = Path(folder) / place.name
        command = [compiler, *OPTIONS, "-o", str(made), *map(str, sources), "-lm"]
        subprocess.run(command, check=True, capture_output=True, timeout=PATIENCE)
        made.replace(place)  # at once, for programs that do the same at the same time


def cache_folder() -> Path:
    """The folder in which libraries are kept.  Raises `OSError` where others could write into it."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    folder = (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "pas"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    state = folder.stat()
    if hasattr(os, "getuid") and (state.st_uid != os.getuid() or state.st_mode & OTHERS_WRITE):
        raise PermissionError(f"{folder} may be written by others")
    return folder
