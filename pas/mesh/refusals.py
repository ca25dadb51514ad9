"""Why a mesh was not made, as a value: the meshers return it, and what the user calls raises it."""

from __future__ import annotations

from dataclasses import dataclass

from pas.errors import MeshError
from pas.mesh.field import Field
from pas.mesh.labelled import Labelled


@dataclass(frozen=True)
class Refusal:
    """Why a mesh was not made, in a sentence."""

    sentence: str

    @property
    def error(self) -> MeshError:
        """The error to raise."""
        return MeshError(self.sentence)


Made = tuple[Labelled, float] | Refusal
"""A mesh and how far it is from the boundary, as measured, or why there is none."""


def too_many(field: Field, triangles: int, most: int, tolerance: float, reached: float) -> Refusal:
    """That a tolerance needs more than `most` triangles, and what is reached with some: with those of the coarsest
    mesh if these are more."""
    near = f"{reached * field.scale:.2g} is reached"
    some = f"{near} with {triangles}"
    if triangles > most:
        some = f"even the coarsest mesh has {triangles}, and {near} by it"
    return Refusal(f"the tolerance {tolerance * field.scale:.3g} needs more than {most} triangles; {some}")


def not_reached(field: Field, triangles: int, tolerance: float, reached: float, why: str) -> Refusal:
    """That a tolerance was not reached, and why."""
    return Refusal(
        f"the tolerance {tolerance * field.scale:g} was not reached with {triangles} triangles "
        f"({reached * field.scale:.2g} was): {why}"
    )
