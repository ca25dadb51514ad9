"""The summary of a blend, as `print(blend)` and the command line show it, and a table of several side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Unpack

import numpy as np

from pas.algebra.inputs import shown
from pas.algebra.rational import listed
from pas.contacts.contact import Contact
from pas.contacts.ends import unusual
from pas.errors import GeometryError
from pas.limits import WorkLimits, in_parts, limited
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import contact_ends
from pas.pipeline.chosen import ChosenBlend


def summary(blend: ChosenBlend) -> str:
    """A table of what was asked and what was found."""
    surface, several = blend.surface, len(blend.surface.patches) > 1
    rows = [(f"contact {i}", f"{c}{_from_center(surface, c)}") for i, c in enumerate(surface.contacts, start=1)]
    rows += [("junction", blend.reason)] if blend.reason else []
    others = [f"{a.degree} (dimension {a.dimension})" for a in blend.attempts if a.degree != surface.degree]
    tried = f"; tried as well: {', '.join(others)}{_source(blend)}"
    with suppress(GeometryError):  # curves that are not plane have no size to compare
        rows += [("unusual", sentence) for sentence in unusual(contact_ends(surface))]
    rows += [
        ("partition", _partition(surface)),
        ("order", f"GC^{surface.order} at the contacts{f', C^{surface.order} between pieces' * several}"),
        ("degree", f"{surface.degree}{tried if others else ''}"),
        ("dimension", f"{blend.dimension}"),
        ("energy", f"{blend.energy:.6g} ({blend.plate.kind}){_source(blend)}"),
    ]
    rows += _fairness(blend)
    measurable = 0.0005  # seconds below which nothing is said of a stage: they would be printed as none
    rows += [
        (f"seconds: {name}", f"{spent:.3f}{_source(blend)}")
        for name, spent in blend.timings.items()
        if spent >= measurable
    ]
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _source(blend: ChosenBlend) -> str:
    """The remark on facts that are taken from a file and not worked out again."""
    return "" if blend.stored is None else ", as its file tells"


def _partition(surface: PiecewiseSurface) -> str:
    """The pieces in words, and the point around which they are where the program found it."""
    region = surface.partition
    if region.title == region.name or region.center is None:
        return region.title
    return f"{region.title}, centre ({listed(region.center)})"


def _from_center(surface: PiecewiseSurface, contact: Contact) -> str:
    """How far from the centre of the node a contact ends, where there is one and the clip is a plane."""
    center = surface.partition.center
    if center is None or contact.clip.degree != 1:
        return ""
    clip = contact.scaled.clip
    slope = float(np.linalg.norm(clip.gradient(np.zeros(3))))
    return f", {abs(float(clip.at(center))) / slope:.4g} from the centre"


def _fairness(blend: ChosenBlend) -> list[tuple[str, str]]:
    """The measures in words, and why a degree was not enough."""
    several = len({a.partition for a in blend.attempts}) > 1
    rows = [
        (
            f"degree {a.degree}",
            f"dimension {a.dimension}{f' ({a.partition})' * several}: {a.outcome}, {a.seconds:.2f} s{_source(blend)}",
        )
        for a in blend.attempts
        if a.seconds
    ]
    if blend.fairness is not None:
        beyond = blend.fairness.beyond(blend.limits)
        within = f"within its limits: {blend.limits.told}"
        rows.append(("fairness", f"beyond its limits: {', '.join(beyond)}" if beyond else within))
        rows += [(f"  {name}", value) for name, value in blend.fairness.lines()]
    return rows


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
