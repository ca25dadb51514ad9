"""What Open Cascade says of shapes: validity, closedness, volume, tolerances."""

from __future__ import annotations

from typing import Any

QUADRATURE = 5e-7
"""Relative error that adaptive quadrature of volumes aims at: without adapting it is off by 13 % on some valid solids."""


def explored(shape: Any, kind: str) -> list[Any]:
    """The SOLID, SHELL, FACE or EDGE shapes within one, each once for each place in which it is."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer, found = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}")), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def is_valid(shape: Any) -> bool:
    """Whether all of a shape's geometry and topology is consistent, and its shells are closed."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer

    return bool(BRepCheck_Analyzer(shape).IsValid()) and all(map(BRep_Tool.IsClosed_s, explored(shape, "SHELL")))


def adaptive_volume(shape: Any) -> float:
    """The volume of the solids in a shape, negative where they are inside out."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, QUADRATURE, False, False)
    return float(found.Mass())


def largest_tolerance(shape: Any) -> float:
    """The largest distance within which vertices and edges of a shape are taken to be on what they belong to."""
    from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance

    return float(ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1))
