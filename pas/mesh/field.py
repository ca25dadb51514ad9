"""The queries of a boundary that the mesher of solids makes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from pas.algebra.inputs import shown_point
from pas.arrays import Bools, Floats, Integers

Number = TypeVar("Number", int, Integers)

VISIBLE = 1e-7
"""Coordinates below this share of the largest ones of a box are shown as 0."""


def label_of(columns: Number, above: bool | Bools | Integers = False) -> Number:
    """The labels of functions by number, the inside where these are negative, or positive where `above`.

    Those of the first n functions are the numbers below `label_of(n)`.
    """
    return 2 * columns + above  # type: ignore[return-value]  # of one function it is one side


def column_of(labels: Number) -> Number:
    """The numbers of labels' functions."""
    return labels // 2


def is_above(labels: int | Integers) -> Bools:
    """Whether the inside is where the labels' functions are positive."""
    return np.asarray(labels % 2 == 1)


def orientation(labels: int | Integers) -> Floats:
    """The factors, 1 or -1, by which the labels' functions are negative inside."""
    return np.asarray(1.0 - 2.0 * (labels % 2))


def opposite(labels: Number) -> Number:
    """The labels of the same functions with the other side inside."""
    return labels ^ 1


class HasJets(Protocol):
    """Functions by label, negative inside."""

    def jets(self, points: Floats, labels: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of one label's function, or of each point's own (N,)."""


class OneFunction(Protocol):
    """One function."""

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""


@dataclass(frozen=True)
class ShellWall:
    """The `solid` of which a shell is the wall, hollowed out up to a thickness.

    For each label of the solid, its label in the shell, `outer` (L,), and that of the inner face which follows it,
    `inner` (L,), -1 where the face is open.
    """

    solid: FaceField
    thickness: float
    outer: Integers
    inner: Integers


class FaceField(HasJets, Protocol):
    """A set in space whose boundary consists of faces, each on the zero set of a function.

    A label names a function and the side of it that is inside; the label's function is negative
    inside and positive outside.
    """

    @property
    def scale(self) -> float:
        """The user's length of one unit of the coordinates used here."""

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""

    @property
    def box(self) -> Floats:
        """Two corners (2, 3) of a box that holds the set."""

    @property
    def special_points(self) -> Floats:
        """Points (S, 3) where faces may be singular, such as a cone's apex."""

    def crossed(self, centers: Floats, half: float) -> Bools:
        """Which cubes (N,), of centres (N, 3) and half an edge, the boundary may pass; all others it does not."""

    def turning(self, centers: Floats, half: float) -> Floats:
        """How much faces turn in such cubes (N,), at most, in radians.

        Infinite where the boundary may be more than one sheet, or a sheet that is not seen all at once from any side.
        """

    def face(self, label: int) -> str:
        """The name of a label's face."""

    def faces_within(self, label: int, centers: Floats, halves: Floats) -> tuple[str, ...]:
        """The names of the faces on a label's surface that may be in boxes of given centres and half edges (N, 3)."""

    def signs(self, points: Floats) -> Bools:
        """For each function (M, N), whether it is <= 0 at points (N, 3)."""

    def inside(self, signs: Bools) -> Bools:
        """Whether points with given signs (M, N) are in the set (N,)."""

    def shells(self) -> Sequence[FaceField]:
        """The surfaces that the boundary may be made of, if they are apart, each as that of a set; itself if one."""

    def wall(self) -> ShellWall | None:
        """The solid and thickness of which this is the wall; None if it is no shell."""

    def needed(self, within: float) -> FaceField:
        """The field without functions that others imply, up to where the set is thinner than that; itself if there are
        none."""

    def labels_of(self, shell: FaceField, labels: Integers) -> Integers:
        """The labels here of labels (N,) of one of these."""

    def ruled(self, labels: Integers) -> Integers:
        """Along how many directions the normals of faces of given labels (N,) do not turn: 2 of planes, 1 of cylinders
        and cones, 0 of others (N,)."""

    def walls(self, labels: Integers) -> Bools:
        """Whether given labels (N,) are no faces, but only bound regions (N,)."""

    def functions(self, labels: tuple[int, ...]) -> tuple[int, ...]:
        """The labels whose functions' common zeros are where faces of given labels meet."""


def extent_of(field: FaceField) -> float:
    """The longest side of the box."""
    return float(np.ptp(field.box, axis=0).max())


def place_of(field: FaceField, point: Floats) -> str:
    """A point as the user reads it, without the digits of zeros."""
    least = VISIBLE * float(np.abs(field.world(field.box)).max())
    return shown_point(x if abs(x) > least else 0.0 for x in field.world(point))


def bounds_set(field: FaceField, points: Floats, labels: Integers) -> Bools:
    """At which points (N, 3) on faces of labels (N,) the set begins: with the face's function alone it changes."""
    signs, at, above = field.signs(points), (column_of(labels), np.arange(len(points))), is_above(labels)
    signs[at] = ~above
    inside = field.inside(signs)
    signs[at] = above
    return np.asarray(inside & ~field.inside(signs))
