"""What is done to edges of solids: fillets and chamfers; how is said in `pas.solid.fillets`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, TypeVar, Unpack

from pas.algebra.polynomial import PolynomialLike
from pas.algebra.rational import Exact, positive
from pas.limits import WorkLimits, limited
from pas.registry import loaded

FILLETS, LARGEST_FILLET = "pas.solid.fillets:filled", "pas.solid.fillets:largest"
"""What makes fillets, in a module above."""

S = TypeVar("S")


class WithEdges(Generic[S]):
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
    ) -> S:
        """The solid with the edges between two faces, by name, rounded with GC^`order`: filled where they go in.

        `radius` is that of a ball that touches both faces, in the mean along the edges (the model's units); between
        planes at order 1 the fillet is a circular cylinder.  Its face is called "fillet", or "fillet 2", unless `face`
        names it.  `within` are polynomials that are positive where a part of
        the edges is to be rounded.  The two joints are claimed, and proved.  Raises `GeometryError` where the faces do
        not meet with an angle, or a joint is not proved, with the largest radius for which both are.

            solid.box((0, 0, 0), (4, 3, 2)).fillet("box x+", "box y+", radius="1/2")
        """
        made: S = loaded(FILLETS)(self, (first, second), positive(radius, "radius"), order, within, face)
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
    ) -> S:
        """The solid with the edges between two faces cut off flatly, or filled where they go in.

        `distance` is the radius (the model's units) of the fillet that would end in the same curves; at a right angle
        that is how far they are from the edge.  Raises `GeometryError` as `fillet` does.
        """
        made: S = loaded(FILLETS)(self, (first, second), positive(distance, "distance"), 0, within, face)
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
