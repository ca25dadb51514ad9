"""Shapes: the base of everything that has a surface, and the kinds of shapes.

A `Shape` gives its certificate and its mesh; saving, writing, drawing, showing are the same for all and are found by
name, in layers above, when they are asked for, so that an object never knows who saves, prints or draws it.  What
differs from kind to kind stands in one `Kind` each, in `pas.kinds`, listed in `KINDS` and found by a shape's `kind`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NoReturn, Self, SupportsIndex, TypeVar

import numpy as np

from pas.algebra.inputs import shown
from pas.arrays import Floats
from pas.errors import missing
from pas.registry import Registry, loaded
from pas.settings import MeshSettings, given
from pas.verdicts import Verdicts

S = TypeVar("S", bound="Shape")


class Shape(ABC):
    """Anything with a surface: it can be proved, meshed, drawn, saved, written and shown."""

    kind: ClassVar[str]
    """The name of its `Kind` in `KINDS`."""

    @property
    @abstractmethod
    def certificate(self) -> Verdicts:
        """The verdicts about it, worked out when first asked for, and kept."""

    @abstractmethod
    def mesh(self, tolerance: Any = None, *, quality: Any = "balanced") -> Any:
        """Its `pas.Mesh`, within `tolerance` (the model's units) of the surface; None: as fine as is usual.

        The `quality` "angles" prefers triangles that are not long, "count" few (see `pas.mesh.quality`).
        """

    def meshed(self, settings: MeshSettings) -> Any:
        """Its `pas.Mesh` by settings; raises `ValueError` for one that means nothing to this kind of shape."""
        takes, wanted = signature(self.mesh).parameters, given(settings)
        for name in wanted:
            if name not in takes:
                owner = "a parametric surface" if name == "domain" else "a shape of another kind"
                raise ValueError(f"{name} is that of {owner}, which {self!r} is not")
        return self.mesh(**wanted)

    @property
    def bounding_box(self) -> Floats:
        """Two corners (2, 3) of the smallest box with sides along the axes, up to the default tolerance."""
        points: Floats = self.mesh().points
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @cached_property
    def _last_mesh(self) -> dict[Any, Any]:
        """The mesh that was made last, by what it was made for."""
        return {}

    def _kept(self, wanted: tuple[Any, ...], make: Callable[[], S]) -> S:
        """The mesh of what is wanted: the one made last, where that is it, so that two files hold one mesh."""
        if wanted not in self._last_mesh:
            made = make()
            self._last_mesh.clear()
            self._last_mesh[wanted] = made
        return self._last_mesh[wanted]

    @abstractmethod
    def __str__(self) -> str:
        """A description for people; of some kinds with the verdicts."""

    @property
    def description(self) -> str:
        """A description for people, without the verdicts: for where these are shown in another way."""
        return str(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {str(self).splitlines()[0]}>"

    def __copy__(self) -> Self:
        """The shape itself, which nothing changes."""
        return self

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __getstate__(self) -> dict[str, object]:
        """What it was made of; what was worked out of that, proofs too, is worked out anew."""
        worked_out = {n for c in type(self).__mro__ for n, a in vars(c).items() if isinstance(a, cached_property)}
        return {name: value for name, value in vars(self).items() if name not in worked_out}

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[object, ...]:
        """As its project file would have it; raises `ValueError` where it has none.

        Meshes, and what is more than its kind keeps, such as a fitted patch with its distance, are all that they are.
        """
        kind = kind_of(self)
        if kind.meshed or type(self) is not kind.type:
            return super().__reduce_ex__(protocol)
        return _unpickled, (type(self), kind.form.write(self))

    if not TYPE_CHECKING:  # else every name would be known

        def __getattr__(self, name: str) -> NoReturn:
            """Raises `AttributeError` with the nearest name that the shape has."""
            if not name.startswith("__") and hasattr(type(self), name):
                return object.__getattribute__(self, name)  # raised in a property, which says why
            raise missing(one(type(self).kind), name, dir(type(self)))

    def __add__(self, other: object) -> NoReturn:
        raise TypeError(
            "shapes cannot be added by + or sum: a | b is the union of two solids or two meshes, "
            "solid.union(a, b, ...) that of several solids, and solid.assembly(first=a, second=b) keeps them apart"
        )

    __radd__ = __add__

    def __or__(self, other: Any) -> Any:
        """The union of two solids or two meshes; raises `TypeError` for other shapes, as & and - do."""
        refuse_mixed(self, other)

    __and__ = __sub__ = __ror__ = __rand__ = __rsub__ = __or__

    def save(self, path: str | Path, **options: Any) -> Path:
        """Write the exact project file (`.pas.json`); returns its path.  See `pas.save`."""
        return loaded("pas.kinds.files:save")(self, path, **options)

    def write(self, path: str | Path, **options: Any) -> Path:
        """Write a file of another format, which the suffix says; returns its path.  See `pas.write`."""
        return loaded("pas.exchange.write:write")(self, path, **options)

    def draw(self, path: str | Path, **options: Any) -> Path:
        """Draw a picture (`.png`); returns its path.  See `pas.draw`."""
        return loaded("pas.render.drawing:draw")(self, path, **options)

    def show(self, **options: Any) -> None:
        """Show it in a window.  See `pas.show`."""
        loaded("pas.render.drawing:show")(self, **options)

    def studio(self) -> Any:
        """A widget for notebooks in which it is dragged and proved; needs `pas[notebook]`.

        `.shape` of the widget is what is seen at rest.  Raises `MissingLibraryError` without the library.
        """
        return loaded("pas.studio.widget:studio")(self)

    def _repr_html_(self) -> str:
        """A table and a picture, for notebooks."""
        return str(loaded("pas.render.drawing:html")(self))


def _unpickled(cls: type[Shape], record: dict[str, Any]) -> Any:
    """The shape of a record; its class comes with it, so that the module that registers its kind is imported."""
    return KINDS[cls.kind].form.read(record)


def refuse_mixed(first: Shape, second: object) -> NoReturn:
    """Raise `TypeError` for an operation of a solid or mesh and what is not of its kind."""
    if not isinstance(second, Shape):
        raise TypeError(f"|, & and - take two solids or two meshes, not {one(first.kind)} and {shown(second)}")
    other: Any = next((s for s in (first, second) if s.kind not in ("solid", "mesh")), second)
    if "mesh" in (first.kind, second.kind):
        meshless = first if second.kind == "mesh" else second
        hint = f"take the mesh of the {meshless.kind} first, as in shape.mesh(tolerance)"
    elif other.kind == "assembly" or hasattr(other, "solid"):
        part = "assembly[name].shape is" if other.kind == "assembly" else "shape.solid() is"
        hint = f"make a solid of the {other.kind} first, as {part}"
    else:
        hint = f"no solid can be made of a {other.kind}: take the meshes of both, as in a.mesh(tolerance)"
    raise TypeError(f"|, & and - take two solids or two meshes, not {one(first.kind)} and {one(second.kind)}; {hint}")


def one(kind: str) -> str:
    """A kind of shape with its article."""
    return f"an {kind}" if kind.startswith("a") else f"a {kind}"


def _nothing(shape: Any) -> dict[str, Any]:
    """No facts beside the verdicts."""
    return {}


@dataclass(frozen=True)
class Kind(Generic[S]):
    """What differs from one kind of shapes to the next.

    `form`, a `pas.exchange.schema.Table`, writes the table that a project file keeps and makes the shape of it again.
    `layers(shape, scene)` adds to the scene of a picture (see `pas.render.scene`) what is to be seen.

    What most kinds need not say: `facts`, what programs read of a shape beside its verdicts; for files, `kept`, whether
    project files have verdicts that are found before, for people to read, beside the table;
    `mesh(shape, settings)`, its triangles; `parts` by name, each with a colour; `patches(shape, domain)`, which are
    exact; `piecewise`, the piecewise surface that it is, at which rays can be cast instead of meshing it;
    `body(shape, length)`, the solid with it in its boundary; `solid(shape)`, the solid that it is; `placed(shape,
    settings)`, closed meshes with the shifts (M, 3) to where they stand, of what consists of a few in many places.
    `meshed` says that it is a mesh already, for which tolerances mean nothing; `open` that it always ends at edges, so
    that it bounds no body; `curved` that its layers know the curvature of the surface, for colours and combs.
    """

    name: str
    type: type[S]
    form: Any
    layers: Callable[[S, Any], None]
    facts: Callable[[S], dict[str, Any]] = _nothing
    mesh: Callable[[S, MeshSettings], Any] = Shape.meshed
    parts: Callable[[S], Mapping[str, Any]] | None = None
    patches: Callable[[S, Any], Sequence[Any]] | None = None
    piecewise: Callable[[S], Any] | None = None
    body: Callable[[S, Any], Any] | None = None
    placed: Callable[[S, MeshSettings], Sequence[tuple[Any, Floats]]] | None = None
    solid: Callable[[S], Any] | None = None
    meshed: bool = False
    open: bool = False
    curved: bool = False
    kept: bool = False

    def text(self, shape: S) -> str:
        """All that is to be said of a shape, verdicts included, which some shapes say of themselves."""
        assert isinstance(shape, Shape)
        said = str(shape)
        return said if said != shape.description else f"{said}\n\n{shape.certificate}"

    def __repr__(self) -> str:
        return f"<Kind {self.name!r} of {self.type.__name__}>"


KINDS: Registry[Kind[Any]] = Registry(
    "kind of shape",
    {
        "blend": "pas.kinds.piecewise:BLEND",
        "hollow blend": "pas.kinds.piecewise:HOLLOW_BLEND",
        "surface": "pas.kinds.piecewise:SURFACE",
        "solid": "pas.kinds.solids:SOLID",
        "part": "pas.kinds.solids:PART",
        "assembly": "pas.kinds.solids:ASSEMBLY",
        "teapot": "pas.kinds.solids:TEAPOT",
        "parametric surface": "pas.kinds.parametric:SURFACE",
        "parametric blend": "pas.kinds.parametric:BLEND",
        "generatrix blend": "pas.kinds.generatrix:BLEND",
        "sphere blend": "pas.kinds.generatrix:SPHERE_BLEND",
        "rational patch": "pas.kinds.parametric:PATCH",
        "mesh": "pas.kinds.solids:MESH",
        "layout": "pas.kinds.piecewise:LAYOUT",
        "network": "pas.kinds.networks:NETWORK",
    },
)
"""All kinds of shapes; a user's own is added by `KINDS.register(Kind(...))`."""


def kind_of(shape: Any, what: str = "this") -> Kind[Any]:
    """The kind of a shape; raises `TypeError` for what is no shape, `what` names the argument."""
    name = getattr(type(shape), "kind", None)
    if not isinstance(shape, Shape) or not isinstance(name, str):
        raise TypeError(f"{what} must be a mesh, a solid, an assembly, a surface or a blend, not {shape!r}")
    return KINDS[name]
