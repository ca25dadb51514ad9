"""Plane profiles as values, from which solids are extruded and revolved.

    plate = solid.rounded_rectangle(40, 30, 5) - solid.circle((10, 10), 3)
    plate.extrude(5)

A profile is a set of points of the plane, in x and y, between loops of straight edges and arcs of conics, all exact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NoReturn

from flint import fmpq

from pas.algebra.affine import Affine, numbered, reflection, rotation, scaling, translation, translations, turns
from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, rational
from pas.arrays import Floats
from pas.errors import GeometryError, missing
from pas.solid.edges import Loop, PlaneEdge, Point
from pas.solid.extrusion import extruded
from pas.solid.formulas import PlaneSet
from pas.solid.revolution import revolved
from pas.solid.solid import Solid


@dataclass(frozen=True, eq=False, repr=False)
class Profile(PlaneSet):
    """A set of points of the plane; made by the functions of `pas.solid`.

    `a | b`, `a & b` and `a - b` are union, intersection and difference.
    """

    def __or__(self, other: Profile) -> Profile:
        return self._with(other, union=True)

    def __and__(self, other: Profile) -> Profile:
        return self._with(other, union=False)

    def __sub__(self, other: Profile) -> Profile:
        return self._with(other, union=False, less=True)

    def _with(self, other: Profile, union: bool, less: bool = False) -> Profile:
        if not isinstance(other, Profile):
            raise TypeError(
                f"|, & and - take two profiles, not a profile and {shown(other)}; extrude the profile first"
            )
        return Profile(None, (self, replace(other, outside=not other.outside) if less else other), union)

    if not TYPE_CHECKING:  # else every name would be known

        def __getattr__(self, name: str) -> NoReturn:
            """Raises `AttributeError` with the nearest name; of what solids have it says that a profile is flat."""
            error = missing("a profile", name, dir(Profile))
            raise AttributeError(f"{error}; it is flat: extrude or revolve it first") if hasattr(Solid, name) else error

    def translate(self, x: Exact, y: Exact) -> Profile:
        """The profile moved by two numbers (the model's units)."""
        return self._moved(translation((x, y, 0)))

    def rotate(self, degrees: Exact, center: Sequence[Exact] = (0, 0)) -> Profile:
        """The profile turned counterclockwise about a point of the plane; see `Solid.rotate` for the angle."""
        return self._moved(rotation((0, 0, 1), degrees, (*plane_point(center, "center"), 0)))

    def scale(self, factor: Exact, center: Sequence[Exact] = (0, 0)) -> Profile:
        """The profile scaled by a positive number, with `center` kept in place."""
        return self._moved(scaling(factor, (*plane_point(center, "center"), 0)))

    def mirror(self, normal: Sequence[Exact], center: Sequence[Exact] = (0, 0)) -> Profile:
        """The profile reflected in the line through `center` with a normal."""
        n = plane_point(normal, "normal")
        return self._moved(reflection((*n, 0), (*plane_point(center, "center"), 0)))

    def pattern(self, count: int, offset: Sequence[Exact]) -> Profile:
        """`count` copies as one profile, each moved by `offset`, two numbers; see `Solid.pattern`."""
        return self._patterned(translations(count, (*plane_point(offset, "offset"), 0)))

    def circular_pattern(self, count: int, center: Sequence[Exact] = (0, 0), step: Exact | None = None) -> Profile:
        """`count` copies turned about a point, evenly all around, or by `step` degrees; see `Solid.pattern`."""
        return self._patterned(turns(count, (0, 0, 1), (*plane_point(center, "center"), 0), step))

    def _patterned(self, maps: Sequence[Affine]) -> Profile:
        names = {edge.name for loop in self.all_loops for edge in loop.edges}
        copies = (self, *(self._moved(map_)._called(numbered(names, k)) for k, map_ in enumerate(maps, start=2)))
        return Profile(None, copies, union=True) if maps else self

    def _called(self, names: Mapping[str, str]) -> Profile:
        def called(loop: Loop) -> Loop:
            return replace(loop, edges=tuple(replace(edge, name=names[edge.name]) for edge in loop.edges))

        return self._with_loops(called)

    def _moved(self, map_: Affine) -> Profile:
        return self._with_loops(lambda loop: moved_loop(loop, map_))

    def _with_loops(self, change: Callable[[Loop], Loop]) -> Profile:
        parts = tuple(part._with_loops(change) for part in self.parts)
        return replace(self, loop=self.loop and change(self.loop), parts=parts)

    def extrude(self, height: Exact, taper: Exact = 0) -> Solid:
        """The solid between z = 0 and z = height (the model's units) over the profile.

        Its faces are named as the edges, "bottom" and "top".  With a `taper` in degrees, below 90 and not 0, its sides
        lean inwards, or outwards where that is negative; then arcs must be of circles and go on in their neighbours'
        direction.  Raises `ValueError` for a height that is not positive, `GeometryError` where a tapered solid has no
        top of the profile's form.
        """
        return extruded(self, rational(height, "height"), rational(taper, "taper"))

    def revolve(self, degrees: Exact = 360) -> Solid:
        """The solid that the profile sweeps out as it turns about its y axis, which becomes the z axis in space.

        The profile's x is the distance from the axis and must not be negative.  Where it turns by less than 360
        degrees, counterclockwise from the half plane y = 0, the flat ends are called "start" and "end".  Raises
        `GeometryError` where the profile passes the axis.
        """
        return revolved(self, rational(degrees, "degrees"))

    def polygons(self, tolerance: float) -> list[Floats]:
        """Points (N, 2) of each loop of its boundary, whose chords are within a tolerance (the model's units) of it.

        Counterclockwise around what is inside.  Raises `GeometryError` where loops of parts cross.
        """
        if self.boundary is None:
            raise GeometryError("the loops of the profile's parts cross or touch: they have no common polygon")
        return [loop.polygon(tolerance / loop.size)[0] for loop in self.boundary]

    def __repr__(self) -> str:
        edges = sum(len(loop.edges) for loop in self.all_loops)
        return f"<Profile of {edges} edges in {len([*self.all_loops])} loops>"


def plane_point(value: Sequence[Exact], name: str) -> Point:
    """Two exact numbers; raises `TypeError` or `ValueError` for anything else, which is called `name`."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be two numbers, not {shown(value)}")
    if len(value) != 2:
        raise ValueError(f"{name} must be two numbers, not {len(value)}: {shown(value)}")
    return rational(value[0], f"{name}[0]"), rational(value[1], f"{name}[1]")


def moved_loop(loop: Loop, map_: Affine) -> Loop:
    """The image of a loop under a map of the plane, in the other direction where that turns the orientation round."""

    def moved(point: Point) -> Point:
        x, y, _ = map_.exact((*point, fmpq(0)))
        return x, y

    def image(edge: PlaneEdge) -> PlaneEdge:
        start, end = moved(edge.start), moved(edge.end)
        if edge.control is None:
            return PlaneEdge.straight(start, end, edge.name)
        return PlaneEdge(start, end, moved(edge.control), map_.polynomial(edge.curve), edge.name)

    made, ((a, b, _), (c, d, _), _) = replace(loop, edges=tuple(map(image, loop.edges))), map_.matrix
    return made.reversed if a * d < b * c else made
