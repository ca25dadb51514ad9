"""File formats of other programs, a file each, by suffix.

A format is a `Format` with a suffix, what it holds (`TRIANGLES` of `pas.exchange.parts`, `PATCHES`, ...) and a
function that writes that.  `FORMATS.register(Format(...))` adds one from outside, for all that can be written so.
"""

from __future__ import annotations

from typing import Any

from pas.exchange.formats.format import Content, Format, Request
from pas.registry import Registry

__all__ = ["FORMATS", "Content", "Format", "Request", "suffixes_for", "suffixes_of"]

FORMATS: Registry[Format[Any]] = Registry(
    "file format",
    {
        ".stl": "pas.exchange.formats.stl:STL",
        ".obj": "pas.exchange.formats.obj:OBJ",
        ".ply": "pas.exchange.formats.ply:PLY",
        ".3mf": "pas.exchange.formats.threemf:THREE_MF",
        ".glb": "pas.exchange.formats.glb:GLB",
        ".vtp": "pas.exchange.formats.vtp:VTP",
        ".step": "pas.exchange.formats.step:STEP",
        ".stp": "pas.exchange.formats.step:STEP",
        ".vtu": "pas.exchange.formats.vtu:VTU",
        ".msh": "pas.exchange.formats.msh:MSH",
    },
)


def suffixes_for(thing: Any) -> tuple[str, ...]:
    """The suffixes that a thing can be written with, one for each format; see `Format.holds`."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].name == suffix and FORMATS[suffix].holds(thing))


def suffixes_of(noun: str) -> tuple[str, ...]:
    """The suffixes of the formats that hold "triangles", "patches", ..."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].content.noun == noun)
