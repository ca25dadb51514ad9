"""Hollow blends as a kind of shape: both blends, each as files keep it, and the thickness."""

from __future__ import annotations

from typing import Any

from pas.algebra.rational import plain, rational
from pas.exchange.schema import NUMBER, Maybe, Table
from pas.kinds import blend as blends
from pas.pipeline.hollow import HollowBlend, check_sides
from pas.render.parts import solid_layers
from pas.shape import Kind
from pas.verdicts import Verdicts

CONTENT = Table({"outer": blends.CONTENT, "inner": blends.CONTENT, "thickness": Maybe(NUMBER)})


def record(hollow: HollowBlend, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a hollow blend."""
    return {
        "outer": blends.record(hollow.outer),
        "inner": blends.record(hollow.inner),
        "thickness": None if hollow.thickness is None else plain(hollow.thickness),
    }


def read(content: dict[str, Any]) -> HollowBlend:
    """The hollow blend of `record`; that the one is inside the other is proved again when it is asked for.

    The inner contacts must be those that the outer ones and the thickness come to.
    """
    thickness = None if content["thickness"] is None else rational(content["thickness"], "thickness")
    outer, inner = (blends.read(content[side]) for side in ("outer", "inner"))
    check_sides(outer, inner, thickness)
    return HollowBlend(outer, inner, thickness)


def _facts(hollow: HollowBlend) -> dict[str, Any]:
    return {"outer": blends.BLEND.facts(hollow.outer), "inner": blends.BLEND.facts(hollow.inner)}


BLEND = Kind("hollow blend", HollowBlend, CONTENT, record, read, solid_layers, facts=_facts, body=HollowBlend.solid)
