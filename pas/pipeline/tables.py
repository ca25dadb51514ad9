"""Blends side by side: what was found, how long it took, how fair each is and what is proved, a row each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Unpack

from pas.algebra.inputs import shown
from pas.limits import WorkLimits, in_parts, limited
from pas.pipeline.chosen import ChosenBlend

MEASURES = ("sharpness", "hollowness", "bulge", "wrong_sign", "waist", "variation", "bending", "area")
"""The measures of `pas.Fairness` that are told."""


@limited("comparing blends", "fewer blends")
def table(blends: Sequence[ChosenBlend] | Mapping[str, ChosenBlend], **limits: Unpack[WorkLimits]) -> Any:
    """A table of blends, by number or by their names in a mapping: a pandas `DataFrame`, or where pandas is not
    installed a list of one dict for each.

    Columns: `order`, `degree`, `dimension`, `energy`, the `seconds` that it took to find, the measures of
    `pas.Fairness` (None where there is none), `fair` (within the blend's limits) and `verdict`: "proved", "refuted" or
    "undecided".  What is not proved or measured yet is, and `progress` is told which share of the blends is done.

    Raises `TypeError` for what is no blend.
    """
    named = dict(blends) if isinstance(blends, Mapping) else dict(enumerate(blends))
    rows = []
    for name, blend in in_parts(named.items(), "measuring blends"):
        if not isinstance(blend, ChosenBlend):
            raise TypeError(f"blends[{name!r}] must be a pas.Blend, not {shown(blend)}")
        proved, fairness, surface = blend.certificate.proved, blend.fairness, blend.surface
        row: dict[str, Any] = {"order": surface.order, "degree": surface.degree, "dimension": blend.dimension}
        row |= {"energy": blend.energy, "seconds": sum(blend.timings.values())}
        row |= {name: getattr(fairness, name, None) for name in MEASURES}
        row["fair"] = None if fairness is None else fairness.within(blend.limits)
        rows.append(row | {"verdict": "proved" if proved else blend.standing})
    if find_spec("pandas") is None:
        return rows
    return import_module("pandas").DataFrame(rows, index=list(named))
