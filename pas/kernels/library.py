"""The compiled library, loaded when it is first used, and calls of its functions with arrays.

Its functions do products and sums in the order in which they stand, without contracting them (see `setup.py`), so that
results are the same on every machine.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pas.errors import MissingLibraryError

PLACE = Path(__file__).with_name("_library.so")


@cache
def library() -> ctypes.CDLL:
    """The compiled library.  Raises `MissingLibraryError` where it is not there."""
    try:
        return ctypes.CDLL(str(PLACE))
    except OSError as error:
        raise _missing(error) from None


def _missing(error: Exception) -> MissingLibraryError:
    return MissingLibraryError(
        f"the compiled library of pas cannot be used ({error}); installing the package anew makes it: in its folder "
        "`pip install .`, or `pip install --editable .`"
    )


class Functions:
    """The functions of a compiled library, which return 0, or else there was no memory."""

    def __init__(self) -> None:
        self._library = library()
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
        try:
            function = getattr(self._library, name)
        except AttributeError as error:  # one of another version
            raise _missing(error) from None
        function.argtypes = [_kind(value) for value in arguments]
        self._declared[name] = function
        return function


@cache
def compiled() -> Functions:
    """The functions of the compiled library."""
    return Functions()


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
