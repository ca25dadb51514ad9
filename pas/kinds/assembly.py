"""Assemblies and their parts as kinds of shapes: each part a solid or a mesh, with its name and colour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pas.exchange.mesh_records import MESH, mesh_record, read_mesh
from pas.exchange.schema import TEXT, Choice, List, Table
from pas.exchange.solid_records import RECORD, read_solid, solid_record
from pas.render.parts import part_layers
from pas.render.scene import Scene
from pas.shape import Kind
from pas.solid.assembly import Assembly, Part, assembly
from pas.solid.solid import Solid
from pas.verdicts import Verdicts

_COMMON = {"name": TEXT, "color": TEXT}
NAMED = Choice(
    (Table({"solid": RECORD, **_COMMON}), Table({"mesh": MESH, **_COMMON})), "a part: a table with a solid or a mesh"
)


def record(thing: Assembly, _: Verdicts | None = None) -> dict[str, Any]:
    """The parts in their order; raises `ValueError` naming the part that cannot be kept."""
    return {"parts": [_part_record(name, part) for name, part in thing.parts.items()]}


def read(content: dict[str, Any]) -> Assembly:
    """The assembly of `record`."""
    names = [p["name"] for p in content["parts"]]
    if len(set(names)) < len(names):
        raise ValueError("two parts have the same name")
    return assembly({p["name"]: (_read_shape(p), p["color"]) for p in content["parts"]})


def _part_record(name: str, part: Part) -> dict[str, Any]:
    try:
        shape = part.shape
        kept = {"solid": solid_record(shape)} if isinstance(shape, Solid) else {"mesh": mesh_record(shape)}
    except ValueError as error:
        raise ValueError(f"the part {name!r}: {error}") from None
    return {"name": name, "color": part.color, **kept}


def _read_shape(record: dict[str, Any]) -> Any:
    return read_solid(record["solid"]) if "solid" in record else read_mesh(record["mesh"])


def _layers(thing: Assembly, scene: Scene) -> None:
    for name, part in thing.parts.items():
        part_layers(part, scene, name)


def _parts(thing: Assembly) -> Mapping[str, Part]:
    return thing.parts


def _one_record(part: Part, _: Verdicts | None = None) -> dict[str, Any]:
    return {"part": _part_record("part", part)}


def _read_one(content: dict[str, Any]) -> Part:
    kept = content["part"]
    return assembly({kept["name"]: (_read_shape(kept), kept["color"])})[kept["name"]]


ASSEMBLY = Kind("assembly", Assembly, Table({"parts": List(NAMED)}), record, read, _layers, parts=_parts, text=str)


def _itself(part: Part) -> Mapping[str, Part]:
    return {"part": part}


PART = Kind("part", Part, Table({"part": NAMED}), _one_record, _read_one, part_layers, parts=_itself)
