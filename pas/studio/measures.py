"""What the page tells of a shape beside its picture: how fair it is, and its curvature combs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pas.exchange.picture_options import Picture
from pas.render.combs import hair_length
from pas.render.scene import scene_of
from pas.shape import Shape, kind_of
from pas.studio.messages import Message
from pas.surface.fairness_limits import LOOSE, NODE_SHARPNESS


def measures(shape: Shape | None) -> Message:
    """The measures of a shape, and what is not fair of it; of other kinds than blends, and of none, there are none."""
    told = {} if shape is None else kind_of(shape).facts(shape)
    limits = getattr(shape, "limits", None)
    facts = {"fairness": told.get("fairness"), "limits": {} if limits is None else vars(limits)}
    return Message({"kind": "measures", "facts": facts, "unfair": list(_unfair(shape))})


def _unfair(shape: Any) -> Iterator[str]:
    """What is not fair, each in some words.

    Where the neighbours leave no room for a fair surface there is no limit of sharpness: the usual one is looked at.
    """
    if getattr(shape, "kind", "") != "blend" or shape.fairness is None:
        return
    fairness = shape.fairness
    yield from fairness.beyond(shape.limits)
    if shape.limits.sharpness >= LOOSE and fairness.sharpness > NODE_SHARPNESS:
        times = f"{fairness.sharpness:.3g} times as sharp as its sharpest neighbour"
        yield f"{times}, for the neighbours leave no room for a fair surface"


def hairs(shape: Shape) -> Message:
    """The combs of a shape: points and tips of hairs, and curvatures, of one curve after the other.

    Raises `ValueError` for a kind of shape of which no curvature is known.
    """
    layers = scene_of(shape, Picture(combs=True)).layers
    length = hair_length(layers)
    combs = [comb for layer in layers for comb in layer.combs]
    points = np.concatenate([np.empty((0, 3)), *(comb.points for comb in combs)])
    normals = np.concatenate([np.empty((0, 3)), *(comb.normals for comb in combs)])
    curvatures = np.concatenate([np.empty(0), *(comb.curvatures for comb in combs)])
    tips = points + length * np.abs(curvatures)[:, None] * normals
    head = {"kind": "combs", "counts": [len(comb.points) for comb in combs]}
    return Message(head, {"points": points, "tips": tips, "curvatures": curvatures})
