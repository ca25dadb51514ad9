"""Lengths of the control legs where none are given."""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import lengths as vector_lengths
from pas.generatrix.frames import Frames
from pas.generatrix.shape import GeneratrixShape, ShapeFunction

THIRD = 1 / 3
"""A straight generatrix has its inner control points at thirds."""

SAMPLES = 120
LEAST_SWING, MOST_SWING = 0.02, 0.9
"""Share of the mean by which the lengths swing on closed curves: less is not worth it, more would not be positive."""


def with_lengths(shape: GeneratrixShape, frames: Frames) -> GeneratrixShape:
    """The shape with open lengths filled in: a third of the distance of corresponding points, rounded.

    The mean distance, for closed curves with its first harmonic, so that the outside of a bend bulges as it should.
    """
    missing = [name for name in ("l1", "l2") if getattr(shape, name) is None]
    if not missing:
        return shape
    s = frames.parameters(SAMPLES)
    first, second = frames.boundaries
    distance = THIRD * vector_lengths(first(s) - second(s))
    mean = float(distance.mean())
    wave = complex(2 * (distance * np.exp(2j * np.pi * s)).mean())
    swing = min(abs(wave), MOST_SWING * mean)
    if not frames.closed or not frames.unit or swing < LEAST_SWING * mean:
        length = ShapeFunction.constant(f"{mean:.3g}")
    else:
        start = (np.angle(wave) / (2 * np.pi) + 0.5) % 1.0
        length = ShapeFunction.cosine(*(f"{x:.3g}" for x in (mean - swing, mean + swing, start)))
    return shape.changed(**dict.fromkeys(missing, length))
