"""Partitions, layouts and names of kinds of layouts, as tables of problem files have them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pas.described import described, keys_of
from pas.layouts.nodes import KINDS
from pas.partition.cells import Partition
from pas.partition.kinds import PARTITIONS, read_partition
from pas.partition.layout import Layout
from pas.registry import Registry

LAYOUTS: Registry[type[Layout]] = Registry("partition", {"layout": Layout})
"""The kind of a table with a user's own rays and pieces."""


def partition_keys() -> set[str]:
    """All keys that a table may have, with those of partitions that were registered since."""
    return keys_of(PARTITIONS) | set(Layout.keys())


def read_partition_like(record: Mapping[str, Any]) -> Partition | Layout | str:
    """What a table describes: `kind = "fan"` or another kind of layouts by name, `kind = "layout"` with rays and
    pieces, or a partition (see `pas.partition.kinds.read_partition`).

    Raises `ValueError`, `TypeError` or `GeometryError`; sentences begin with the key at fault where there is one.
    """
    kind = record.get("kind")
    if kind in KINDS and kind not in PARTITIONS:  # a user's own partition may have such a name
        if rest := [key for key in record if key != "kind"]:
            raise ValueError(f"{rest[0]!r} does not belong to the layout {kind!r}, which is chosen by the program")
        return str(kind)
    if kind not in LAYOUTS:
        return read_partition(record)
    return described(LAYOUTS, record)
