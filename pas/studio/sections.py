"""Curvature combs for the page: hairs to draw, and the normal curvature along each curve for a diagram."""

from __future__ import annotations

import numpy as np

from pas.exchange.picture_options import Picture
from pas.render.combs import hair_length
from pas.render.scene import scene_of
from pas.shape import Shape
from pas.studio.messages import Message


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
