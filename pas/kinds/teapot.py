"""Teapots as a kind of shape: the closed solid, and the same in parts (which `teapot.assembly` gives)."""

from __future__ import annotations

from typing import Any

from pas.designs.teapot import STYLES, Teapot
from pas.exchange.schema import Table, one_of
from pas.exchange.solid_records import RECORD, read_solid, solid_record
from pas.render.parts import solid_layers
from pas.render.scene import Scene
from pas.shape import Kind
from pas.verdicts import Verdicts

SOLIDS = ("solid", "pot", "lid")


def record(teapot: Teapot, _: Verdicts | None = None) -> dict[str, Any]:
    """The three solids, exact."""
    return {"style": teapot.style, **{name: solid_record(getattr(teapot, name)) for name in SOLIDS}}


def read(content: dict[str, Any]) -> Teapot:
    """The teapot of `record`."""
    return Teapot(content["style"], *(read_solid(content[name]) for name in SOLIDS))


def _layers(teapot: Teapot, scene: Scene) -> None:
    solid_layers(teapot.solid, scene)


CONTENT = Table({"style": one_of(tuple(STYLES))} | dict.fromkeys(SOLIDS, RECORD))
TEAPOT = Kind("teapot", Teapot, CONTENT, record, read, _layers, text=str)
