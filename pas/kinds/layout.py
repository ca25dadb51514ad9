"""Layouts as a kind of shape: the sphere of directions around a centre, cut into pieces."""

from __future__ import annotations

from typing import Any

from pas.exchange.schema import TEXT, WHOLE, List, Table
from pas.exchange.shapes import POINT
from pas.partition.layout import Layout
from pas.render.layout import layers
from pas.shape import Kind
from pas.verdicts import Verdicts

CONTENT = Table(
    {"layout": Table({"center": POINT, "rays": List(List(WHOLE, 3)), "pieces": List(List(WHOLE)), "name": TEXT})}
)


def record(layout: Layout, _: Verdicts | None = None) -> dict[str, Any]:
    """The rays and pieces of a layout."""
    return {"layout": layout.to_record()}


def read(content: dict[str, Any]) -> Layout:
    """The layout of `record`."""
    return Layout.from_record(content["layout"])


LAYOUT = Kind("layout", Layout, CONTENT, record, read, layers)
