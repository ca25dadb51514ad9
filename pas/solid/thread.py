"""Threads of screws: a ridge of straight flanks that winds around a cylinder.

A point at angle a about the axis is off the middle of the ridge by u, its height less pitch a / (2 pi), up to
multiples of the pitch; on the flanks |u| is half the width of the ridge, which falls evenly with the distance from the
axis.  That is no polynomial: crest and root are exact cylinders, the flanks a function that is evaluated in doubles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, plain, positive, square_root, to_float
from pas.arrays import Floats
from pas.solid.faces import FacedBody, Faces
from pas.solid.functions import Distance, Parametrized
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined

X, Y, Z = GENERATORS


class Flank(Distance, Parametrized):
    """A function negative in the ridge of a thread about the z axis, for points as far from that as the root."""

    periods = np.zeros(2)

    def __init__(self, diameter: Exact, pitch: Exact) -> None:
        self.exact_diameter, self.exact_pitch = positive(diameter, "diameter"), positive(pitch, "pitch")
        depth = self.exact_pitch * fmpq(5, 16) * square_root(fmpq(3))  # ISO 68-1
        self.exact_crest, self.exact_root = self.exact_diameter / 2, self.exact_diameter / 2 - depth
        if self.exact_root <= self.exact_pitch / 8:
            most = self.exact_diameter / (fmpq(1, 4) + 2 * depth / self.exact_pitch)
            raise ValueError(f"pitch must be below {to_float(most):.6g} for the diameter {plain(self.exact_diameter)}")
        self.pitch, self.crest = to_float(self.exact_pitch), to_float(self.exact_crest)
        self.root, self.tangent = to_float(self.exact_root), 1 / math.sqrt(3)
        self.domain = np.array([(-np.inf, np.inf), (-3 / 8 * self.pitch, 3 / 8 * self.pitch)])
        turn = self.pitch / (math.pi * self.root)  # more than anywhere, as it is faded out
        self._steepest = math.sqrt(1 + turn * turn) + self.pitch / self.root + self.tangent

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are above the middle of the ridge (N,), at most half the pitch."""
        turns = points[:, 2] / self.pitch - np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi)
        return np.asarray(self.pitch * (turns - np.round(turns)))

    def radius(self, off: Floats) -> Floats:
        """The distance of the thread from the axis that far from the middle of the ridge (N,)."""
        return np.clip(self.crest - (np.abs(off) - self.pitch / 16) / self.tangent, self.root, self.crest)

    def places(self, points: Floats) -> Floats:
        """At which turn of the middle of the ridge points are, and how far above that (N, 2)."""
        off = self.off(points)
        return np.stack([(points[:, 2] - off) / self.pitch, off], axis=1)

    def at(self, places: Floats) -> Floats:
        """The points (N, 3) of flanks at turns and heights above the middle (N, 2)."""
        turn, off = places.T
        r, angle = self.crest - (np.abs(off) - self.pitch / 16) / self.tangent, 2 * np.pi * turn
        return np.stack([r * np.cos(angle), r * np.sin(angle), self.pitch * turn + off], axis=1)

    def jets(self, points: Floats) -> Floats:
        off, r = self.off(points), np.hypot(points[:, 0], points[:, 1])
        # Inside the root, where it is not asked for, the winding is faded out: it is not continuous at the axis.
        share = np.clip(2 * r / self.root - 1 / 2, 0, 1)
        safe, sign = np.maximum(r, self.root / 4), np.sign(off)
        radial = np.where(share < 1, np.abs(off) * 2 / self.root * (share > 0), 0.0) + self.tangent
        around = -sign * share * self.pitch / (2 * np.pi) / safe
        e = points[:, :2] / np.maximum(r, 1e-300)[:, None]
        value = np.abs(off) * share - self.pitch / 16 + (r - self.crest) * self.tangent
        x, y = radial * e[:, 0] - around * e[:, 1], radial * e[:, 1] + around * e[:, 0]
        return np.stack([value, x, y, sign * share], axis=1) / self._steepest

    def to_record(self) -> dict[str, Any]:
        return {"diameter": plain(self.exact_diameter), "pitch": plain(self.exact_pitch)}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Flank:
        return cls(record["diameter"], record["pitch"])


@dataclass(frozen=True, eq=False, kw_only=True)
class Wound(FacedBody):
    """The boundary of a thread from z = 0 to a height."""

    flank: Flank
    height: float
    face: str

    @property
    def extent(self) -> float:
        return max(self.height, 2 * self.flank.crest)

    def made(self, tolerance: float) -> Faces:
        """Its faces: between columns of points, at angles that include those at which an edge of the ridge ends."""
        flank, pitch = self.flank, self.flank.pitch
        step = 2 * math.acos(max(1 - tolerance / (2 * flank.crest), 0.5))
        # Diagonals on flanks turn most near the axis, by so much more than their middles as radii differ.
        rise = pitch / (4 * np.pi) * (flank.crest - flank.root) / (flank.crest + flank.root)
        step = min(step, tolerance / (2 * rise)) / (2 * math.pi)  # in turns
        edges = np.array([-3 / 8, -1 / 16, 1 / 16, 3 / 8])  # heights above the middle of the ridge, in pitches
        cuts = np.unique(np.round(np.concatenate([-edges, self.height / pitch - edges]) % 1, 12) % 1)
        parts = [np.linspace(a, b, math.ceil((b - a) / step), False) for a, b in pairwise([*cuts, cuts[0] + 1])]
        turns = np.concatenate(parts)
        rounds = np.arange(-3, math.ceil(self.height / pitch) + 3)
        heights = pitch * (turns[:, None] + (rounds[:, None] + edges).ravel())
        slack = 1e-9 * pitch
        columns, lines = heights.shape
        number = np.arange(heights.size).reshape(columns, lines) + 2 * columns
        bottom, top = np.arange(columns)[:, None], np.arange(columns, 2 * columns)[:, None]
        number = np.where(heights < slack, bottom, np.where(heights > self.height - slack, top, number))
        after = np.concatenate([number[1:, :-4], number[:1, 4:]])  # a turn on, edges are those of the next round
        flat = [
            np.column_stack([np.cos(2 * np.pi * turns), np.sin(2 * np.pi * turns), np.full(columns, z)])
            for z in (0, self.height)
        ]
        for level in flat:
            level[:, :2] *= flank.radius(flank.off(level))[:, None]
        radii = np.tile([flank.root, flank.crest, flank.crest, flank.root], len(rounds))
        angle = 2 * np.pi * np.broadcast_to(turns[:, None], heights.shape)
        wall = np.stack([radii * np.cos(angle), radii * np.sin(angle), heights], axis=-1).reshape(-1, 3)
        used = np.unique(np.concatenate([np.arange(2 * columns), number.ravel()]))
        made = Faces(np.concatenate([*flat, wall])[used], np.array([[0, 0, 0], [0, 0, self.height]]))
        number, after = (np.searchsorted(used, n) for n in (number, after))
        crest, root = (_round(r).jets for r in (flank.exact_crest, flank.exact_root))
        bands = {"crest": ([1], crest), "root": ([3], root), "flank": ([0, 2], flank.jets)}
        for name, (kinds, jets) in bands.items():
            some = np.flatnonzero(np.isin(np.arange(lines - 5) % 4, kinds))
            a, b, c, d = number[:, some], after[:, some], after[:, some + 1], number[:, some + 1]
            triangles = [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
            made.put_curved(f"{self.face} {name}", np.concatenate(triangles), jets)
        for end, sign in enumerate((-1, 1)):
            rim, center = np.arange(columns) + end * columns, np.full(columns, len(used) + end)
            fan = np.stack([rim, np.roll(rim, -sign), center], axis=1)
            made.put_flat(f"{self.face} {('start', 'end')[end]}", fan, np.array([0.0, 0.0, sign]))
        return made


def _round(radius: fmpq) -> Polynomial:
    """The cylinder of a radius about the z axis."""
    return Polynomial.from_raw(X * X + Y * Y - radius * radius)


def thread(diameter: Exact, pitch: Exact, length: Exact, face: str = "thread") -> Solid:
    """The thread of a screw about the z axis, from z = 0 to its length: that of metric screws (ISO 68-1), right-handed.

    `diameter` is that of the crest, such as 8 for M8, `pitch` the height of a turn; lengths are in the model's units.
    Flanks are at 60 degrees to one another; crests are an eighth of the pitch wide, roots a quarter.  Faces are "thread
    crest", "thread root", "thread flank", "thread start" and "thread end".  What a thread that is wider by some play
    leaves of a block is a nut; `mirror` makes a thread left-handed.

    Flanks are no polynomials: they are evaluated in doubles, and what is written is within its tolerance of them as
    measured.  Raises `ValueError` for numbers that are not positive and a pitch that leaves no core.

        solid.thread(8, "1.25", 30)
    """
    flank, height = Flank(diameter, pitch), positive(length, "length")
    ridge = combined(False, Atom(_round(flank.exact_crest), f"{face} crest"), Atom(flank, f"{face} flank"))
    ends = (-Z, "start"), (Z - height, "end")
    tree = combined(
        False,
        combined(True, Atom(_round(flank.exact_root), f"{face} root"), ridge),
        *(Atom(Polynomial.from_raw(plane), f"{face} {name}") for plane, name in ends),
    )
    return Solid(tree, (), (), Wound(flank=flank, height=to_float(height), face=face))
