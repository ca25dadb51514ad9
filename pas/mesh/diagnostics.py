"""Why a boundary does not come out on a lattice: points where faces touch, are singular or meet too flatly, by name.

Near places where a lattice shows too little, Newton's method looks for such points on the faces' own functions:
critical points of one function, points of one surface where another's normal is parallel, common zeros of
several.  What is found is checked at the point itself: the functions vanish there, and the set depends on each
of them.  Measured, not proved; a sentence of an error stands on it, nothing else.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.field import FaceField, column_of, extent_of, label_of, place_of
from pas.mesh.projection import distances, least_solutions, newton, second_derivatives
from pas.mesh.rows import cross, dots, norms
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected

PLACES = 10
"""The number of places that are looked at, spread over those given."""

NEAR, FARTHEST = 4.0, 0.3
"""Distance, to first order and over the lattice's spacing, up to which a face counts as there; and how far from
the place a point may be found, over the extent of the box."""

STEPS = 40
"""The most steps of Newton's method."""

ZERO, PARALLEL = 1e-7, 1e-5
"""Distance over the extent of the box up to which a function vanishes at a point; sine of the angle up to which
normals are parallel there."""

FLAT = 12.0
"""Degrees: a wedge with less can hardly be shown by a lattice."""

WORDS = {
    "singular": "{} is singular",
    "thin": "{} touch, and the solid has no thickness between them there; let them cross, or leave a wall between them",
    "gap": "{} touch, and the parts that they bound do not overlap there; let them cross, keep them apart, "
    "or join them by a blend",
    "touch": "{} touch; claim the curve as a joint if they are to go on smoothly, let them cross, or keep them apart",
    "itself": "the solid touches itself along an edge of {}; let its parts overlap, or keep them apart",
    "curve": "{} touch, or meet in one curve; move one of them a little",
    "flat": f"{{}} meet at an angle below {FLAT:.0f} degrees",
    "many": "{} meet in one point",
    "close": "{} come very close",
    "bent": "{} is bent very sharply",
}
"""The kinds of faults in words, the gravest first."""

PASSING = ("close", "bent", "many")
"""The faults that go away on a lattice that is fine enough; many faces meet in nodes."""


@dataclass(frozen=True)
class Diagnosis:
    """A fault and its place: "near (0, 0, 1) the faces 'a' and 'b' touch".  `stays` says whether every finer lattice
    has it, and near most of the places looked at."""

    sentence: str
    stays: bool


def diagnosis(field: FaceField, places: Floats, spacing: float) -> Diagnosis | None:
    """The trouble that most of some places (K, 3) are near to, on a lattice of a given spacing; None if unknown."""
    checkpoint("looking at where the boundary is not clear")
    chosen = places[np.unique(np.linspace(0, len(places) - 1, min(len(places), PLACES)).astype(int))]
    with np.errstate(all="ignore"):
        found = [f for place in chosen if (f := _Place(field, place, spacing).worst) is not None]
    if not found:
        return None
    times = Counter((kind, names) for kind, names, _ in found)
    kind, names = max(times, key=lambda k: (k[0] not in PASSING, times[k]))
    point = next(point for *what, point in found if what == [kind, names])
    lasting = sum(n for (other, _), n in times.items() if other not in PASSING)
    return Diagnosis(f"near {place_of(field, point)} {WORDS[kind].format(names)}", 2 * lasting > len(chosen))


def touching(field: FaceField, point: Floats, a: int, b: int, apart: bool) -> str:
    """The fault at a point (3,) where the faces of two columns touch, with parts of the set `apart` or no wall."""
    place = _Place(field, point, extent_of(field) / 1000)
    depth = (1 - np.cos(np.radians(FLAT))) / sum(1 / place._radii[c] for c in (a, b)) * field.scale
    words = WORDS["gap" if apart else "thin"].format(place._names([a, b]))
    return f"near {place_of(field, point)} {words} (to cross at {FLAT:.0f} degrees, move one by {depth:.2g})"


Found = tuple[str, str, Floats]
"""A kind of trouble, the faces in words, and the point (3,)."""


class _Place:
    """One place (3,) and the faults near it."""

    def __init__(self, field: FaceField, place: Floats, spacing: float) -> None:
        self.field, self.place, self.spacing = field, place, spacing
        self.extent = extent_of(field)
        every = np.arange(len(field.signs(place[None])))
        self.near: list[int] = every[self._distances(place, every) < NEAR * spacing].tolist()

    @property
    def worst(self) -> Found | None:
        """The gravest fault; of equals the one found first."""
        order = list(WORDS)
        return min(self._all(), key=lambda found: order.index(found[0]), default=None)

    def _all(self) -> Iterator[Found]:
        for column, point in zip(self.near, self._critical, strict=True):
            if point is not None and column in self._deciding(point, [column]):
                yield "singular", self._names([column]), point
            elif self._radii[column] < self.spacing:
                yield "bent", self._names([column]), self.place
        pairs = [*combinations(self.near, 2)]
        for (a, b), point in zip(pairs, self._parallel(pairs), strict=True):
            if point is not None and {a, b} <= {*self._deciding(point, [a, b])}:
                touching = self._distances(point, [a])[0] <= ZERO * self.extent
                kind = self._tangency(point, a, b) if touching else "close"
                if kind:
                    yield kind, self._names([a, b]), point
        for groups in ([self.near], pairs) if len(self.near) > 1 else ():
            found = [(group, p) for group, p in zip(groups, self._common(groups), strict=True) if p is not None]
            close = self._vanishing(np.array([p for _, p in found]).reshape(-1, 3))
            for (group, point), zero in zip(found, close, strict=True):
                yield from self._meeting(group, point, zero)

    def _meeting(self, group: Sequence[int], point: Floats, close: Bools) -> Iterator[Found]:
        """The faults at a point where functions vanish together, those of `near` that are `close` (n,)."""
        deciding = self._deciding(point, group, close)
        normals = np.array([self._normal(point, c) for c in deciding]).reshape(-1, 3)
        if len(deciding) == 2:
            kind = self._edge(point, deciding, normals)
        elif len(deciding) > 2 and np.linalg.svd(normals, compute_uv=False)[2] < PARALLEL:
            kind = "" if self._on_seam(point, deciding) or self._all_joined(deciding) else "curve"
        else:
            kind = "many" if len(deciding) > 3 else ""
        if kind:
            yield kind, self._names(deciding), point

    def _edge(self, point: Floats, pair: Sequence[int], normals: Floats) -> str:
        """The fault of an edge of two faces, by which of the four wedges around it are inside."""
        both, first, second, neither = self._patterns(point, pair)
        if both == neither and first == second:
            return "itself" if both != first else ""
        angle = float(np.degrees(np.arccos(np.clip(normals[0] @ normals[1], -1, 1))))
        alone = [both, first, second, neither]
        if sum(alone) not in (1, 3):
            return ""
        odd = alone.index(sum(alone) == 1)
        return "flat" if (180 - angle if odd in (0, 3) else angle) < FLAT else ""

    def _tangency(self, point: Floats, a: int, b: int) -> str:
        """The fault where two surfaces touch, by the two sides that are not between them; none on a known seam along
        which the boundary continues from one to the other."""
        zero = [c for c, vanishes in zip(self.near, self._vanishing(point[None])[0], strict=True) if vanishes]
        if len({a, b, *zero}) > 2 and self._all_joined([a, b, *zero]):
            return ""  # a corner of smooth faces
        both, first, second, neither = self._patterns(point, (a, b))
        alike = float(self._normal(point, a) @ self._normal(point, b)) > 0
        beside = (both, neither) if alike else (first, second)
        if beside[0] == beside[1]:
            return "gap" if beside[0] else "thin"
        return "" if self._joined(a, b) else "touch"

    def _all_joined(self, columns: Sequence[int]) -> bool:
        """Whether surfaces continue one another along known seams, over others of them."""
        distinct = list(dict.fromkeys(columns))
        pairs = [pair for pair in combinations(range(len(distinct)), 2) if self._joined(*(distinct[k] for k in pair))]
        return bool(connected(np.array(pairs, dtype=np.intp).reshape(-1, 2), len(distinct)).max() == 0)

    def _joined(self, a: int, b: int) -> bool:
        """Whether two surfaces touch along a known seam."""
        pair = label_of(min(a, b)), label_of(max(a, b))
        return a != b and self.field.functions(pair) != pair

    def _on_seam(self, point: Floats, columns: Sequence[int]) -> bool:
        """Whether two of some surfaces touch along a known seam that the others pass through as well."""
        labels = tuple(map(label_of, sorted(columns)))
        placing = self.field.functions(labels)
        normals = np.array([self._normal(point, column_of(label)) for label in placing])
        return placing != labels and bool((np.linalg.svd(normals, compute_uv=False)[2:] < PARALLEL).all())

    def _vanishing(self, points: Floats) -> Bools:
        """Which functions of `near` vanish at points (K, 3), (K, n)."""
        far = self._distances(np.repeat(points, len(self.near), axis=0), np.tile(self.near, len(points)))
        return np.asarray(far.reshape(len(points), len(self.near)) <= ZERO * self.extent)

    def _deciding(self, point: Floats, group: Sequence[int], close: Bools | None = None) -> list[int]:
        """The functions that vanish at a point, those `close` (n,) or of a group, and decide there what is inside."""
        close = self._vanishing(point[None])[0] if close is None else close
        zero = [c for c, vanishes in zip(self.near, close, strict=True) if c in group or vanishes]
        most_active = 8  # functions that vanish at one point, of which all signs are tried
        if len(zero) > most_active:
            return []
        inside = np.array(self._patterns(point, zero)).reshape((2,) * len(zero))
        return [c for axis, c in enumerate(zero) if (inside != np.flip(inside, axis)).any()]

    def _patterns(self, point: Floats, columns: Sequence[int]) -> list[bool]:
        """Whether it is inside with each of the given functions negative (first) or positive."""
        sides = np.array(list(product((True, False), repeat=len(columns)))).T
        signs = np.repeat(self.field.signs(point[None]), sides.shape[1], axis=1)
        signs[list(columns)] = sides
        return [bool(v) for v in self.field.inside(signs)]

    @cached_property
    def _critical(self) -> list[Floats | None]:
        """For each function of `near` a point where it and its gradient vanish, or None."""
        columns, close = np.array(self.near, dtype=np.intp), ZERO * self.extent
        starts = np.tile(self.place, (len(columns), 1))

        def step(points: Floats, rows: Integers) -> Floats:
            return least_solutions(self._slopes(points, columns[rows]), self._jets(points, columns[rows])[:, 1:])

        rows, ends = self._followed(starts, step)
        both = (starts[rows], ends)
        sizes = np.maximum(*(np.abs(self._slopes(points, columns[rows])).max(axis=(1, 2)) for points in both))
        jets = np.abs(self._jets(ends, columns[rows])) <= sizes[:, None] * close * np.array([close, 1, 1, 1])
        return _placed(len(columns), rows, ends, jets.all(axis=1))

    def _parallel(self, pairs: Sequence[tuple[int, int]]) -> list[Floats | None]:
        """For each pair a point on the second surface with the normal of a point of the first within the spacing.

        None where they bend too little for their normals to become parallel.
        """
        with_foot = np.array([self._feet[b] is not None for _, b in pairs], dtype=np.bool_)
        chosen, both = np.flatnonzero(with_foot), np.array(pairs, dtype=np.intp).reshape(-1, 2)[with_foot]
        feet = np.array([self._feet[b] for b in both[:, 1]], dtype=np.float64).reshape(-1, 3)
        bends = (1 / np.array([[self._radii[c] for c in pair] for pair in both]).reshape(-1, 2)).sum(axis=1)
        able = self._sines(feet, both) <= 2 * FARTHEST * self.extent * bends
        chosen, both, feet = chosen[able], both[able], feet[able]
        scales = 1 / np.maximum(np.stack([norms(self._jets(feet, c)[:, 1:]) for c in both.T]), 1e-300)

        def step(points: Floats, rows: Integers) -> Floats:
            """Newton's for a multiple of one gradient that is the other, and the second function's zero."""
            columns, sizes = both[rows].T, scales[:, rows]
            f, g = (self._jets(points, c) * size[:, None] for c, size in zip(columns, sizes, strict=True))
            bend_f, bend_g = (
                self._slopes(points, c) * size[:, None, None] for c, size in zip(columns, sizes, strict=True)
            )
            shares = dots(f[:, 1:], g[:, 1:]) / np.maximum(dots(g[:, 1:], g[:, 1:]), 1e-300)
            matrix = np.zeros((len(rows), 4, 4))
            matrix[:, :3, :3], matrix[:, :3, 3] = bend_f - shares[:, None, None] * bend_g, -g[:, 1:]
            matrix[:, 3, :3] = g[:, 1:]
            right = np.concatenate([f[:, 1:] - shares[:, None] * g[:, 1:], g[:, :1]], axis=1)
            return least_solutions(matrix, right)[:, :3]

        rows, ends = self._followed(feet, step)
        first, second = (self._distances(ends, columns) for columns in both[rows].T)
        touching = (second < ZERO * self.extent) & (self._sines(ends, both[rows]) < PARALLEL) & (first < self.spacing)
        return _placed(len(pairs), chosen[rows], ends, touching)

    def _followed(self, points: Floats, step: Callable[[Floats, Integers], Floats]) -> tuple[Integers, Floats]:
        """Where steps against those given of some points (n, 3), with their rows (n,), lead to from points (N, 3), and
        which rows do not lead far away; none is longer than the reach of the place."""
        points, active, near = points.copy(), np.arange(len(points)), np.ones(len(points), dtype=np.bool_)
        for _ in range(STEPS):
            if not len(active):
                break
            moves = step(points[active], active)
            moves *= np.minimum(1.0, NEAR * self.spacing / np.maximum(norms(moves), 1e-300))[:, None]
            points[active] -= moves
            near[active] = norms(points[active] - self.place) <= FARTHEST * self.extent  # not where it is no number
            active = active[near[active] & (np.abs(moves).max(axis=1) >= ZERO * self.spacing)]
        return np.flatnonzero(near), points[near]

    @cached_property
    def _feet(self) -> dict[int, Floats | None]:
        """A point of each surface near the place."""
        return dict(zip(self.near, self._common([[c] for c in self.near]), strict=True))

    def _common(self, groups: Sequence[Sequence[int]]) -> list[Floats | None]:
        """A common zero of the functions of each group, all of one length; None where there is none nearby."""
        starts, reach = np.tile(self.place, (len(groups), 1)), np.full(len(groups), NEAR * self.spacing)
        points = newton(starts, self.field, label_of(np.array(groups, dtype=np.intp)), reach, STEPS)
        near = norms(points - self.place) <= FARTHEST * self.extent  # not where it is no number
        return [
            point if close and self._distances(point, group).max() <= ZERO * self.extent else None
            for point, group, close in zip(points, groups, near, strict=True)
        ]

    def _jets(self, points: Floats, columns: Integers) -> Floats:
        """Values and gradients (N, 4) of functions (N,) at points (N, 3)."""
        return self.field.jets(points, label_of(columns))

    def _distances(self, points: Floats, columns: Sequence[int] | Integers) -> Floats:
        """First-order distances (N,) of points (N, 3), or of one, from the surfaces of functions (N,)."""
        labels = label_of(np.asarray(columns, dtype=np.intp))
        return distances(self.field, np.broadcast_to(points, (len(labels), 3)), labels)

    def _normal(self, point: Floats, column: int) -> Floats:
        return unit_rows(self._jets(point[None], np.array([column]))[0, 1:])

    def _sines(self, points: Floats, pairs: Integers) -> Floats:
        """Sines (N,) of the angles between the normals of two surfaces each (N, 2) at points (N, 3)."""
        first, second = (unit_rows(self._jets(points, columns)[:, 1:]) for columns in pairs.T)
        return norms(cross(first, second))

    def _slopes(self, points: Floats, columns: Integers) -> Floats:
        """Second derivatives (N, 3, 3) of functions (N,) at points (N, 3)."""
        return np.asarray(second_derivatives(self.field, points, label_of(columns)))

    @cached_property
    def _radii(self) -> dict[int, float]:
        """The radius of curvature of each surface where it bends most."""
        columns = np.array(self.near, dtype=np.intp)
        places = np.tile(self.place, (len(columns), 1))
        bends = np.abs(self._slopes(places, columns)).max(axis=(1, 2))
        radii = norms(self._jets(places, columns)[:, 1:]) / np.maximum(bends, 1e-300)
        return dict(zip(self.near, radii.tolist(), strict=True))

    def _names(self, columns: Sequence[int]) -> str:
        """The faces in words; walls, which nobody may have named, where there are no two faces."""
        walls = [c for c, wall in zip(columns, self.field.walls(label_of(np.array(columns))), strict=True) if wall]
        times = Counter(self.field.face(label_of(c)) for c in columns if c not in walls)
        words = [f"{name!r}" if n == 1 else f"{name!r} ({n} times)" for name, n in times.items()]
        if times.total() < 2:
            words += [f"the wall {self.field.face(label_of(c))}" for c in walls]
        listed = " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
        return listed if not times else f"the face{'s' if times.total() > 1 else ''} {listed}"


def _placed(count: int, rows: Integers, points: Floats, right: Bools) -> list[Floats | None]:
    """Points (n, 3) in a list by their rows (n,), where they are right (n,)."""
    found = list[Floats | None]([None]) * count
    for row, point in zip(rows[right].tolist(), points[right], strict=True):
        found[row] = point
    return found
