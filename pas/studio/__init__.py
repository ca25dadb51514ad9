"""The studio: a page on this machine in which shapes are dragged, and seen with their curvature and their proofs.

`GALLERY` are starting points: documents by name, for a page that is opened without a file.  They are nothing but plain
data, so that the server is there at once: problems stand as such in `gallery.toml`.

A `Message` to the page is a table and arrays of numbers, in one piece of bytes or as anywidget's buffers.  Packed it is
the length of its head (4 bytes, least first), the head as JSON in UTF-8, spaces up to a multiple of 8, and the arrays
one after the other, each begun at a multiple of 8.  The head's "arrays" says of each its name, its type and how many
numbers it has.
"""

from __future__ import annotations

import json
import struct
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from pas.arrays import AnyArray

Data = dict[str, Any]

TEAPOT = {"lid_height": "7/5", "spout_tilt": "0", "handle_size": "1"}
"""The teapot's parameters as they are without a word."""

_PROBLEMS = tomllib.loads(Path(__file__).with_name("gallery.toml").read_text(encoding="utf-8"))

GALLERY: dict[str, Data] = {
    **{title: {"kind": "problem", "problem": problem} for title, problem in _PROBLEMS.items()},
    "Teapot": {"kind": "teapot", "values": dict(TEAPOT)},
}
"""The documents; a test solves each."""

TYPES = {"float64": "<f8", "float32": "<f4", "uint32": "<u4", "uint8": "u1"}
"""Types of arrays by the names that JavaScript's have, in lower case."""


@dataclass(frozen=True)
class Message:
    """A table of plain data, and arrays by name."""

    head: Mapping[str, Any]
    arrays: Mapping[str, AnyArray] = field(default_factory=dict)

    def added(self, **more: Any) -> Message:
        """This message with more in its head."""
        return replace(self, head={**self.head, **more})

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
