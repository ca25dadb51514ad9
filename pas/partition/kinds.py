"""The partitions that files know, by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pas.algebra.inputs import shown
from pas.partition.cells import Partition
from pas.registry import Registry, read_record

PARTITIONS: Registry[type[Partition]] = Registry(
    "partition",
    {
        "six tetrahedra": "pas.partition.six_tetrahedra:SixTetrahedra",
        "single cell": "pas.partition.boxes:SingleCell",
        "tetrahedra": Partition,
        "region": "pas.partition.cells:Region",
        "open region": "pas.partition.cells:OpenRegion",
        "alfeld split": "pas.partition.boxes:AlfeldSplit",
        "worsey-farin split": "pas.partition.boxes:WorseyFarinSplit",
        "kuhn cube": "pas.partition.boxes:KuhnCube",
    },
)
"""The first is that of a table that does not say its kind."""


def register_partition(partition: type[Partition]) -> type[Partition]:
    """Make a class of partitions known to project files and problem files, by its `name`; returns it.

    Unless the class says otherwise (`to_record`, `keys`, `from_record`) it is written as its tetrahedra.
    Raises `ValueError` for a name that is taken, `TypeError` for what is no class of partitions.
    """
    if not isinstance(partition, type) or not issubclass(partition, Partition):
        raise TypeError(f"partition must be a subclass of pas.Partition, not {shown(partition)}")
    return PARTITIONS.register(partition)


def read_partition(record: Mapping[str, Any]) -> Partition:
    """The partition that a table describes.

    Raises `ValueError`, `TypeError` or `GeometryError`; sentences begin with the key at fault where there is one.
    """
    return read_record(PARTITIONS, record, next(iter(PARTITIONS)))
