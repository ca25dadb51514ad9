"""Regions whose layout and clip faces the program chose around contacts."""

from __future__ import annotations

from typing import Any

from pas.partition.cells import Partition


class Region(Partition):
    """A partition built around the curves of contacts, as `pas.layouts` does: its room follows from the contacts.

    What counts as fair in it is judged by the arcs that fit between the contacts (`pas.FairnessLimits.of_node`),
    since no cell was given by the user.  Arguments and errors are those of `Partition`.
    """

    name = "region"

    def to_record(self) -> dict[str, Any]:
        """The partition as a table of plain data, exact numbers as texts."""
        return super().to_record() | {"kind": self.name}
