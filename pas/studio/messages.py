"""Messages to the page: a table and arrays of numbers, in one piece of bytes or as anywidget's buffers.

A packed message is the length of its head (4 bytes, least first), the head as JSON in UTF-8, spaces up to a multiple of
8, and the arrays one after the other, each begun at a multiple of 8.  The head's "arrays" says of each its name, its
type and how many numbers it has.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

TYPES = {"float64": "<f8", "float32": "<f4", "uint32": "<u4", "uint8": "u1"}
"""Types of arrays by the names that JavaScript's have, in lower case."""


@dataclass(frozen=True)
class Message:
    """A table of plain data, and arrays by name."""

    head: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def numbered(self, number: int) -> Message:
        """This message as the answer to the request of a number."""
        return replace(self, head={**self.head, "seq": number})

    def parts(self) -> tuple[dict[str, Any], list[bytes]]:
        """The table, with what the arrays are, and their bytes."""
        listed, parts = [], []
        for name, array in self.arrays.items():
            kind = array.dtype.name
            if kind not in TYPES:
                raise TypeError(f"the array {name!r} must be of {', '.join(TYPES)}, not {kind}")
            listed.append([name, kind, int(array.size)])
            parts.append(np.ascontiguousarray(array, dtype=TYPES[kind]).tobytes())
        return {**self.head, "arrays": listed}, parts

    def packed(self) -> bytes:
        """All of it in one piece."""
        table, parts = self.parts()
        head = json.dumps(table, separators=(",", ":"), allow_nan=False).encode()
        head += b" " * (-(4 + len(head)) % 8)
        return b"".join([struct.pack("<I", len(head)), head, *(part + bytes(-len(part) % 8) for part in parts)])


def refusal(error: BaseException) -> Message:
    """One clear sentence of up to 600 characters about what could not be done; the picture stays as it is."""
    return Message({"kind": "refused", "text": " ".join(str(error).split())[:600]})
