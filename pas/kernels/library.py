"""The compiled library, loaded when it is first used, and calls of its functions with arrays.

Its functions do products and sums in the order in which they stand, without contracting them (see `setup.py`), so that
results are the same on every machine.  What arguments they take is read from `pas.h`, which the sources include.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike

from pas.arrays import AnyArray
from pas.errors import MissingLibraryError

PLACE = Path(__file__).with_name("_library.so")
HEADER = Path(__file__).with_name("pas.h")

SCALARS = {"whole": ctypes.c_ssize_t, "int": ctypes.c_int, "double": ctypes.c_double}
"""The types of arguments and of results, as the header calls them."""

ENTRIES: dict[str, DTypeLike] = {"whole": np.intp, "double": np.float64, "char": np.bool_}
"""The types of the entries of arrays."""


class Array(NamedTuple):
    """An argument that is an array: the code of its type in numpy, and whether the function writes to it."""

    code: str
    written: bool


class Signature(NamedTuple):
    """The arguments of a function in their order, with None for numbers, and its types for ctypes."""

    arrays: tuple[Array | None, ...]
    arguments: tuple[Any, ...]
    result: Any


@cache
def library() -> ctypes.CDLL:
    """The compiled library.  Raises `MissingLibraryError` where it is not there."""
    try:
        return ctypes.CDLL(str(PLACE))
    except OSError as error:
        raise _missing(error) from None


@cache
def signatures() -> dict[str, Signature]:
    """The signatures of all functions of the header, by name.  Raises `MissingLibraryError` without the header."""
    try:
        text = re.sub(r"/\*.*?\*/", "", HEADER.read_text(), flags=re.DOTALL)
    except OSError as error:
        raise _missing(error) from None
    found = {}
    for result, name, arguments in re.findall(r"^(\w+) (pas_\w+)\(([^)]*)\);", text, re.MULTILINE):
        parsed = [_argument(part.split()) for part in arguments.split(",")]
        arrays, types = zip(*parsed, strict=True)
        found[name] = Signature(arrays, types, SCALARS[result])
    return found


def _argument(words: list[str]) -> tuple[Array | None, Any]:
    """An argument from `const double *points` or `whole count`; structures are given by addresses, as numbers."""
    kind = words[-2]
    if words[-1].startswith("*") and kind not in ENTRIES:
        return None, ctypes.c_void_p
    if words[-1].startswith("*"):
        return Array(np.dtype(ENTRIES[kind]).char, words[0] != "const"), ctypes.c_void_p
    return None, SCALARS[kind]


def declared(name: str) -> Callable[..., Any]:
    """A function of the library that takes what the header says, with addresses for arrays.

    Raises `MissingLibraryError` where the library is missing, or of another version.
    """
    signature, function = signatures().get(name), getattr(library(), name, None)
    if signature is None or function is None:
        raise _missing(f"{PLACE.name if function is None else HEADER.name} has no {name}")
    function.argtypes, function.restype = signature.arguments, signature.result
    return function


def _missing(error: object) -> MissingLibraryError:
    return MissingLibraryError(
        f"the compiled library of pas cannot be used ({error}); installing the package anew makes it: in its folder "
        "`pip install .`, or `pip install --editable .`"
    )


class Functions:
    """The functions of the compiled library, which return 0, or else there was no memory."""

    def __init__(self) -> None:
        library()
        self._declared: dict[str, tuple[Callable[..., int], int, list[tuple[int, Array]]]] = {}

    def call(self, name: str, *arguments: AnyArray | float | None) -> None:
        """Call a function with arrays, for which it takes their addresses (None for an array that is not there), and
        numbers.

        Arrays that it only reads are copied where they are not contiguous, or of a type that fits into the right one.
        Raises `TypeError` for others, `MemoryError` where there was no room.
        """
        function, number, arrays = self._declared.get(name) or self._declare(name)
        if len(arguments) != number:
            raise TypeError(f"{name} takes {number} arguments, not {len(arguments)}")
        given: list[Any] = list(arguments)
        held = []  # copies, which live until the function is done
        for place, array in arrays:  # without calls: meshes make a hundred of microseconds
            value = given[place]
            try:
                given[place] = _addressof(_from_buffer(value))
                taken = value.dtype.char == array.code
            except (TypeError, ValueError):  # not contiguous, not to be written to, empty or none
                given[place] = NOWHERE
                taken = value is None or not value.size
            if not taken:
                held.append(_held(value, array, name))
                given[place] = address_of(held[-1])
        if function(*given):
            raise MemoryError(f"there is no memory for {name}")

    def _declare(self, name: str) -> tuple[Callable[..., int], int, list[tuple[int, Array]]]:
        function, arrays = declared(name), signatures()[name].arrays
        places = [(place, array) for place, array in enumerate(arrays) if array is not None]
        self._declared[name] = function, len(arrays), places
        return self._declared[name]


@cache
def compiled() -> Functions:
    """The functions of the compiled library."""
    return Functions()


def _held(value: Any, array: Array, name: str) -> AnyArray:
    """A contiguous copy, of the right type, of an array that a function only reads."""
    given = np.asarray(value)
    if array.written or not np.can_cast(given.dtype, array.code):
        what = "writes to contiguous arrays of" if array.written else "takes"
        raise TypeError(f"{name} {what} {np.dtype(array.code)}, not {given.dtype}")
    return np.ascontiguousarray(given, dtype=array.code)  # itself, where only to be read


_addressof, _from_buffer = ctypes.addressof, ctypes.c_char.from_buffer
_NOTHING = ctypes.c_double()

NOWHERE = ctypes.addressof(_NOTHING)
"""The address that stands for that of an empty array, from which nothing is read."""


def address_of(array: AnyArray) -> int:
    """Where the numbers of a contiguous array stand."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]  # faster than the other
    except (TypeError, ValueError):  # not to be written to, or empty
        return array.__array_interface__["data"][0]
