"""Solids as a kind of shape: the tree of inequalities, exact, and the claimed joints."""

from __future__ import annotations

from typing import Any

from pas.exchange.schema import Table
from pas.exchange.solid_records import RECORD, read_solid, solid_record
from pas.render.parts import solid_layers
from pas.shape import Kind
from pas.solid.solid import Solid
from pas.verdicts import Verdicts


def record(solid: Solid, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a solid; raises `ValueError` for a function that cannot be kept."""
    return {"solid": solid_record(solid)}


def read(content: dict[str, Any]) -> Solid:
    """The solid of `record`."""
    return read_solid(content["solid"])


SOLID = Kind("solid", Solid, Table({"solid": RECORD}), record, read, solid_layers, text=str)
