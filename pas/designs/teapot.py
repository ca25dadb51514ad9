"""Two teapots: that of Lou, Feng, Chen and Deng (2002), of 8 patches, and one of 12, all joined, and hollow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, is_dataclass, replace
from typing import Protocol, TypeVar, Unpack, cast, runtime_checkable

from pas.algebra.affine import Affine, AffineShape
from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact
from pas.designs.body import Body, below
from pas.designs.exact import number
from pas.designs.handle import Handle, PaperHandle
from pas.designs.lid import Lid
from pas.designs.spout import PaperSpout, Spout
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.shape import Shape
from pas.solid.assembly import Assembly, assembly
from pas.solid.solid import Solid
from pas.verdicts import Findings

POT_COLOR, LID_COLOR = "#7d9db5", "#e8a33d"


@runtime_checkable
class HandleShape(Protocol):
    """The interface of a handle, and of a spout as well."""

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at it: polynomials that are positive on the body's side."""

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with this one and its joints."""


@runtime_checkable
class SpoutShape(HandleShape, Protocol):
    """The interface of a spout."""

    def channel(self) -> Solid | None:
        """The room inside, from the room of the body to beyond the mouth; None for a pot that is not hollow."""


STYLES: dict[str, tuple[Callable[[], SpoutShape], Callable[[], HandleShape]]] = {
    "paper": (PaperSpout, PaperHandle),
    "better": (Spout, Handle),
}
"""Spout and handle of each style."""


@dataclass(frozen=True, repr=False)
class Teapot(AffineShape["Teapot"], Shape):
    """A closed solid with all its joints, and the same in parts: the pot, hollow if its spout is, and its lid."""

    style: str
    solid: Solid
    pot: Solid
    lid: Solid
    kind = "teapot"

    @property
    def certificate(self) -> Findings:
        """The verdicts on the joints of the closed solid."""
        return self.solid.certificate

    def _moved(self, map_: Affine) -> Teapot:
        return Teapot(self.style, *(solid._moved(map_) for solid in (self.solid, self.pot, self.lid)))

    @limited("meshing a teapot", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> Mesh:
        """The mesh of the closed solid; see `Solid.mesh`."""
        return self.solid.mesh(tolerance, quality=quality)

    @property
    def description(self) -> str:
        """The faces with their degrees."""
        return self.solid.description

    def __str__(self) -> str:
        return str(self.solid)

    def __repr__(self) -> str:
        return f"<Teapot of style {self.style!r}>"

    @property
    def assembly(self) -> Assembly:
        """Pot and lid as named, coloured parts."""
        return assembly(pot=(self.pot, POT_COLOR), lid=(self.lid, LID_COLOR))


@limited("building the teapot", "")
def teapot(
    style: str = "better",
    *,
    body: Body | None = None,
    spout: SpoutShape | None = None,
    handle: HandleShape | None = None,
    lid: Lid | None = None,
    lid_height: Exact | None = None,
    spout_tilt: Exact | None = None,
    handle_size: Exact | None = None,
    **limits: Unpack[WorkLimits],
) -> Teapot:
    """A teapot of a style, about 5 units long, of which each part can be given another design.

    "paper" is that of Lou, Feng, Chen and Deng (2002), "better" has all parts joined and is hollow.  `body`, `spout`,
    `handle` and `lid` are objects of the classes of `pas.designs`; `lid_height` is the height of the knob's top (the
    model's units), `spout_tilt` how far the spout leans outwards for each unit of height, `handle_size` scales the
    handle (the same as `Lid(height=...)`, `Spout(tilt=...)`, `Handle(size=...)`).  All joints are proved.

    Raises `GeometryError` naming the joint that cannot be made or is not there, `ValueError` for an unknown style,
    `TypeError` for a part that is no design.
    """
    if style not in STYLES:
        raise ValueError(f"style must be one of {', '.join(map(repr, STYLES))}, not {shown(style)}")
    spout_of, handle_of = STYLES[style]
    base = _part("body", body, Body(), Body)
    nose = _changed(_part("spout", spout, spout_of(), SpoutShape), "tilt", spout_tilt, "spout_tilt")
    grip = _changed(_part("handle", handle, handle_of(), HandleShape), "size", handle_size, "handle_size")
    top = _changed(_part("lid", lid, Lid(), Lid), "height", lid_height, "lid_height")
    cover = top.solid(base)

    upper_walls, lower_walls = (a + b for a, b in zip(nose.walls(), grip.walls(), strict=True))
    pot = grip.attached(nose.attached(base.solid(upper_walls, lower_walls), base), base)
    pot = pot.cap(-below(base.bottom), "bottom disc")
    whole = (pot | cover).joined("lid dome", "body upper", base.rim_curve, 0)
    for verdict in (verdict for verdict in whole.verdicts if not verdict.proved):
        room = (
            "; a fillet needs room on the lower body: a thinner tube, a higher one, or smaller tube_side and body_side"
        )
        raise GeometryError(f"joint not there: {verdict}{room if 'fillet' in verdict.claim else ''}")
    hollow = pot.cap(-below(base.top), "rim")
    channel = nose.channel()
    if channel is None:
        return Teapot(style, whole, hollow, top.closed(base))
    return Teapot(style, whole, hollow - (base.room() | channel), top.seated(base))


Part = TypeVar("Part")


def _part(name: str, given: Part | None, default: Part, kind: type[object]) -> Part:
    """The design that is given, or the style's own."""
    if given is not None and (isinstance(given, type) or not isinstance(given, kind)):
        raise TypeError(f"{name} must be a design such as pas.designs.{type(default).__name__}(), not {shown(given)}")
    return default if given is None else given


def _changed(part: Part, name: str, value: Exact | None, option: str) -> Part:
    """The design with a field of another value, if one is given."""
    if value is None:
        return part
    if not is_dataclass(part) or not hasattr(part, name):
        raise TypeError(f"{option} changes designs with a field {name}, which {shown(part)} has not")
    return cast(Part, replace(part, **{name: number(value, option)}))  # type: ignore[type-var]
