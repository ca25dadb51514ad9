"""One side of a header: a run's cylinder with feet on it, made of the feet's meshes and of the run between them.

The cylinder goes from one end's strip to the other's, and around the curves in which the meshes of the feet end on it:
its triangles have no other vertices than those of these curves and of two circles (see `pas.mesh.sweep`).

Each foot with its branch is within the cone of its opening, and the run is outside of all of these.  So two feet could
meet each other alone; that a plane is between them is looked at on coarse meshes, as of linked bodies.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from pas.algebra.affine import quadratic_form, slope_at
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import cross, dot, three
from pas.arrays import Floats, Integers
from pas.contacts.contact import Contact
from pas.mesh.quality import Quality
from pas.mesh.sweep import between_loops
from pas.solid.faces import COARSE, Faces
from pas.solid.sheets import ROOM, Loose, SheetBody, Side, merged
from pas.solid.strips import Chain, chain_between, go_on
from pas.solid.tree import Atom, Node, Tree, complement, parts_of


@dataclass(frozen=True, eq=False)
class RunSide:
    """A run between two `ends` with `feet`, of which chain number `openings[k]` is where foot k rises out of the run.

    The ends are chains as well: each has a strip of the run, from the circle on at which what is between the feet ends.
    """

    name: str
    ends: tuple[Chain, Chain]
    feet: tuple[Side, ...]
    openings: tuple[int, ...]

    @cached_property
    def chains(self) -> tuple[Chain, ...]:
        """The chains of both ends and of the branches."""
        branches = (f.chains[1 - opening] for f, opening in zip(self.feet, self.openings, strict=True))
        return (*self.ends, *branches)

    @cached_property
    def _chart(self) -> tuple[Floats, Floats, float]:
        """The middle (3,) of the lower circle, two unit vectors across the run and one along it (3, 3), the radius."""
        middle = self.ends[0].curve.mean(axis=0)
        along, across = self.ends[1].end.axis, self.ends[0].curve[0] - middle
        radius = float(np.linalg.norm(across))
        across /= radius
        return middle, np.stack([across, np.cross(along, across), along]), radius

    def _circle(self, chain: Chain, tolerance: float) -> Floats:
        """Points (N, 3) of the circle in which a chain begins, with chords within a tolerance of it: to first order, as
        all else is measured, these are off by R (1 - c^2)/(2 c) with the cosine c of half of their angle."""
        _, axes, radius = self._chart
        share = tolerance / radius
        number = max(8, int(np.ceil(np.pi / np.arccos(np.sqrt(1 + share * share) - share))))
        angles = 2 * np.pi * np.arange(number) / number
        way = np.cos(angles)[:, None] * axes[0] + np.sin(angles)[:, None] * axes[1]
        return np.asarray(chain.curve.mean(axis=0) + radius * way)

    @cached_property
    def apart(self) -> bool:
        """Whether planes are between any two feet, as coarse meshes show."""
        size = max(float(np.ptp(chain.curve, axis=0).max()) for chain in self.chains)
        meshes = [side.mesh(COARSE * size, Quality.BALANCED) for side in self.feet]
        known = [mesh for mesh, _ in (m for m in meshes if m is not None)]
        if len(known) != len(meshes):
            return False
        return all(
            gap_between(a.points, b.points) > ROOM * ((a.deviation or 0.0) + (b.deviation or 0.0))
            for a, b in combinations(known, 2)
        )

    def mesh(self, tolerance: float, quality: Quality, without: Collection[int] = ()) -> Loose | None:
        """Its mesh with those of chains but for some, whose numbers are given, and the loops in which these end.

        None where a foot has none, or where it is not seen that feet are apart.
        """
        made, holes, loops = Faces(), list[Integers](), list[Integers]()
        within = tolerance * (1 - 2.0**-10)  # the line that sweeps leans, by which triangles are wider than a step
        for number, (foot, opening) in enumerate(zip(self.feet, self.openings, strict=True)):
            found = foot.mesh(within, quality, (1 - opening,) if number + 2 in without else ())
            if found is None or not self.apart:
                return None
            first = made.put(found[0])
            holes.append(found[1][opening][::-1] + first)
            loops.append(found[1][1 - opening] + first)
        circles = [made.added(self._circle(chain, within)) for chain in self.ends]
        loops = [circles[0], circles[1][::-1], *loops]
        middle, axes, radius = self._chart
        x, y, heights = axes @ (made.points - middle).T / radius  # on the cylinder unrolled
        triangles = between_loops(np.stack([np.arctan2(y, x), heights], axis=1), (loops[0], loops[1]), holes)
        if triangles is None:
            return None
        made.put_curved(self.name, triangles, self.ends[0].contact.surface.jets)
        if not go_on(made, self.ends, loops, tolerance, without):
            return None
        whole = made.mesh
        return merged(whole, whole.names), loops  # the strips are of the same face


def plain_run(tree: Tree) -> SheetBody | None:
    """The boundary of a round cylinder with flat ends across it, or one less another of the same ends; else None."""
    parts, sides = parts_of(tree, union=False), list[RunSide]()
    holes = [parts_of(complement(part), union=False) for part in parts if isinstance(part, Node)]
    tubes = [tube_of(some) for some in ([part for part in parts if isinstance(part, Atom)], *holes)]
    for tube in tubes:
        if tube is None or tubes[0] is None or len(tubes) > 2:
            return None
        (surface, name, (low, high)), ends = tube, tubes[0][2]
        slope = slope_at(ends[0][0])
        feet = [
            three(-cap.raw(0, 0, 0) * s / dot(slope_at(cap), slope_at(cap)) for s in slope_at(cap)) for cap, _ in ends
        ]
        if any(cross(slope, slope_at(low[0]))) or any(end.raw(*foot) > 0 for end, _ in (low, high) for foot in feet):
            return None
        begins = [cap - Polynomial(cap.raw(*foot) / 3) for (cap, _), foot in zip(ends, feet[::-1], strict=True)]
        start, stop = (
            chain_between(Contact(surface, plane), plane, cap, (name, title))
            for plane, (cap, title) in zip(begins, ends, strict=True)
        )
        if start is None or stop is None or (sides and not sides[0].ends[0].holds(start)):
            return None
        sides.append(RunSide(name, (start, stop), (), ()))
    return SheetBody(tuple(sides))


def tube_of(parts: Sequence[Tree]) -> tuple[Polynomial, str, list[tuple[Polynomial, str]]] | None:
    """The tube of three conditions: a circular cylinder, negative inside, its name, and both ends, planes that are
    positive outside, with their names; None for others."""
    atoms = [(p.function, p) for p in parts if isinstance(p, Atom) and isinstance(p.function, Polynomial)]
    known = sorted(((-f if p.outside else f, p.face) for f, p in atoms if p.face), key=lambda some: -some[0].degree)
    if len(parts) != 3 or [f.degree for f, _ in known] != [2, 1, 1]:
        return None
    (surface, name), *ends = known
    form, slope, back = quadratic_form(surface).tolist(), *(slope_at(end) for end, _ in ends)
    size = dot(slope, slope)
    factor = sum(form[i][i] for i in range(3)) / (2 * size)
    round_ = all(form[i][j] == factor * (size * (i == j) - slope[i] * slope[j]) for i in range(3) for j in range(3))
    straight = dot(slope, form[3][:3]) == 0 and not any(cross(slope, back)) and dot(slope, back) < 0
    return (surface, name, ends) if round_ and straight and factor > 0 else None


def gap_between(one: Floats, other: Floats) -> float:
    """The distance of the farthest parallel planes between points (N, 3) and (M, 3), negative where there are none.

    By a linear programme, so it is the farthest of those whose normal is measured by its largest coordinate.
    """
    from scipy.optimize import linprog

    sides = np.concatenate([np.insert(one, 3, -1, axis=1), -np.insert(other, 3, -1, axis=1)])
    above = np.insert(sides, 4, 1, axis=1)  # normal, offset, and by how much points are on their sides
    found = linprog([0, 0, 0, 0, -1], above, np.zeros(len(above)), bounds=[*[(-1, 1)] * 3, (None, None), (None, None)])
    return float(2 * found.x[4] / np.linalg.norm(found.x[:3])) if found.status == 0 and found.x[4] > 0 else -1.0
