"""Operations on edges of solids: fillets and chamfers of one (`pas.solid.fillets`), rounds of many
(`pas.solid.rounding`, `pas.solid.profile_rounds`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self, Unpack

from pas.algebra.polynomial import PolynomialLike
from pas.algebra.rational import Exact, positive
from pas.limits import WorkLimits, limited
from pas.registry import loaded

FILLETS, LARGEST_FILLET = "pas.solid.fillets:filled", "pas.solid.fillets:largest"
ROUNDED = "pas.solid.profile_rounds:rounded"
"""The functions that make them, in modules above."""


class WithEdges:
    """A solid, whose edges can be rounded and cut off."""

    @limited("rounding an edge", "a smaller radius")
    def fillet(
        self,
        first: str,
        second: str,
        radius: Exact,
        order: int = 1,
        *,
        within: Sequence[PolynomialLike] = (),
        face: str | None = None,
        **limits: Unpack[WorkLimits],
    ) -> Self:
        """The solid with the edges between two faces, by name, rounded with GC^`order`: filled where they go in.

        `radius` is that of a ball that touches both faces, in the mean along the edges (the model's units).  Of order 1
        the fillet of planes is a circular cylinder, and that of planes, cylinders, cones and balls about one axis the
        exact torus of a ball that rolls; `print` of the solid says so.  Its face is called "fillet", or "fillet 2",
        unless `face` names it.  `within` are polynomials that are positive where a part of the edges is to be rounded.

        Where a face goes on smoothly as another, by a claimed joint, as sides of profiles with arcs do, so does the
        fillet: all around a boss's foot, a pocket's floor, a top or a rim from one side's name, or "boss" for "boss 1",
        "boss 2", ...  One face is then a plane, the others planes and circular cylinders upright on it; of order 1 that
        gives cylinders, tori and, in arcs of the radius, spheres, of order 2 one section all along.

        Where pipes (or bores) of one radius cross, or three and more meet in a point, the blend of `pas.node` is the
        face, in the place of their crossing and of its edges: `radius` is that of a ball that touches two of them where
        it ends, seen from the side.  So it is where axes meet and the edge has no fillet of the radius, if there is no
        `within`.  The joints are claimed, and proved.  Raises `GeometryError` where the faces do not meet with an
        angle, or a joint is not proved, with the largest radius for which they are.

            solid.box((0, 0, 0), (4, 3, 2)).fillet("box x+", "box y+", radius="1/2")
        """
        made: Self = loaded(FILLETS)(self, (first, second), positive(radius, "radius"), order, within, face)
        return made

    @limited("cutting off an edge", "a smaller distance")
    def chamfer(
        self,
        first: str,
        second: str,
        distance: Exact,
        *,
        within: Sequence[PolynomialLike] = (),
        face: str | None = None,
        **limits: Unpack[WorkLimits],
    ) -> Self:
        """The solid with the edges between two faces cut off, or filled where they go in.

        By a plane between planes, by a cone about an axis of rational length that the faces have in common, and by the
        polynomial that is linear in theirs between others.
        `distance` is the radius (the model's units) of the fillet that would end in the same curves; at a right angle
        that is how far they are from the edge.  Raises `GeometryError` as `fillet` does.
        """
        made: Self = loaded(FILLETS)(self, (first, second), positive(distance, "distance"), 0, within, face)
        return made

    @limited("looking for the largest fillet", "a part of the edge by within")
    def largest_fillet(
        self,
        first: str,
        second: str,
        order: int = 1,
        *,
        within: Sequence[PolynomialLike] = (),
        **limits: Unpack[WorkLimits],
    ) -> float:
        """The largest radius, to within three hundredths of it, of a fillet whose joints are proved; see `fillet`.

        Raises `GeometryError` where the faces do not meet with an angle, or none is proved.
        """
        return float(loaded(LARGEST_FILLET)(self, (first, second), order, within))

    @limited("rounding edges", "a lower order")
    def rounded(
        self, faces: Sequence[str] | None = None, *, radius: Exact, order: int = 1, **limits: Unpack[WorkLimits]
    ) -> Self:
        """The solid with the edges between plane faces rounded with GC^`order`, and the corners where three meet.

        `faces` are the names of those all of whose common edges are rounded; by default all.  Of order 1 the rounds are
        cylinders and spheres of the `radius` (the model's units), of a higher one convex surfaces of degree 2 `order`
        that end as deep below the other faces.  They are named after the planes: "box x+ / box y+".  Their joints are
        claimed, and proved by `verdicts`.  The solid is convex with plane faces, or what other operations took away
        from such a one; its corners at rounded edges are of three planes.  Or it is extruded from a profile with arcs
        of circles that goes on smoothly: then the edges at "top" and "bottom" are rounded, of order 1 or 2, as `fillet`
        does it.  Raises `GeometryError` where it is not so, and with the largest radius where an edge is used up.

            solid.box((0, 0, 0), (4, 3, 2)).rounded(radius="1/2", order=2)
        """
        if isinstance(faces, str):
            raise TypeError(f"faces must be a sequence of names of faces, as in faces=[{faces!r}]")
        made: Self = loaded(ROUNDED)(self, faces, positive(radius, "radius"), order)
        return made
