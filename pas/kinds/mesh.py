"""Meshes as a kind of shape: their arrays to the last bit."""

from __future__ import annotations

from typing import Any

from pas.exchange.mesh_records import MESH as FORM
from pas.exchange.mesh_records import mesh_record, read_mesh
from pas.exchange.schema import Table
from pas.mesh.mesh import Mesh
from pas.render.parts import solid_layers
from pas.shape import Kind
from pas.verdicts import Verdicts


def record(mesh: Mesh, _: Verdicts | None = None) -> dict[str, Any]:
    """The arrays of a mesh."""
    return {"mesh": mesh_record(mesh)}


def read(content: dict[str, Any]) -> Mesh:
    """The mesh of `record`."""
    return read_mesh(content["mesh"])


MESH = Kind("mesh", Mesh, Table({"mesh": FORM}), record, read, solid_layers, meshed=True)
