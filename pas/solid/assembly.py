"""Several solids: unions and intersections, and assemblies of named parts kept apart, each with a colour."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from types import MappingProxyType
from typing import Any, Never, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.affine import Affine, AffineShape, numbered
from pas.algebra.brief import brief, listed
from pas.algebra.inputs import shown
from pas.algebra.rational import Exact
from pas.arrays import Bools, Floats
from pas.limits import WorkLimits, in_parts, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.shape import Shape
from pas.solid.bounds import hull
from pas.solid.measures import Measures, PartList, flat_measures
from pas.solid.solid import Solid
from pas.verdicts import Findings, Verdicts

COLORS = ("#e8a33d", "#7d9db5", "#b85c5c", "#7fa66b", "#9a7fb0", "#c9b458")
"""The colours of parts that were given none, in turn."""


@dataclass(frozen=True, repr=False)
class Part(AffineShape["Part"], Shape):
    """A solid (or a closed mesh) with its colour, `#rrggbb`."""

    shape: Solid | Mesh
    color: str
    kind = "part"

    @property
    def certificate(self) -> Verdicts:
        """The certificate of its solid or mesh."""
        return self.shape.certificate

    @property
    def description(self) -> str:
        """Its shape in words, and its colour."""
        return f"{self.shape.description} in {self.color}"

    def __str__(self) -> str:
        return f"{self.shape} in {self.color}"

    __repr__ = brief

    @limited("meshing a part", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> Mesh:
        """The part's mesh; see `Solid.mesh`."""
        return self.shape.mesh(tolerance, quality=quality)

    @limited("measuring a part", "a coarser tolerance")
    def measures(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> Measures:
        """Volume, area, centre and moments of its solid, or of what its mesh encloses; see `Solid.measures`."""
        return self.shape.measures(tolerance) if isinstance(self.shape, Solid) else flat_measures(self.shape)

    def _moved(self, map_: Affine) -> Part:
        return replace(self, shape=self.shape._moved(map_))

    def _patterned(self, maps: Sequence[Affine]) -> Part:
        return replace(self, shape=self.shape._patterned(maps))


@dataclass(frozen=True, eq=False)
class Assembly(AffineShape["Assembly"], Shape):
    """Named parts; `parts` maps names to `Part`.  Made by `pas.solid.assembly`."""

    parts: Mapping[str, Part]
    kind = "assembly"

    @cached_property
    def certificate(self) -> Findings:
        """The verdicts on the joints of all parts that are solids."""
        return Findings.of_parts({n: p.certificate for n, p in self.parts.items() if isinstance(p.shape, Solid)})

    def __getitem__(self, name: str) -> Part:
        if name not in self.parts:
            raise KeyError(f"the assembly has no part {name!r}; its parts are {', '.join(self.parts)}")
        return self.parts[name]

    @limited("meshing an assembly", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> Mesh:
        """All parts as one mesh, whose faces are named "part: face"; each part as `Part.mesh` gives it."""
        return Mesh.together(self.meshes(tolerance, quality=quality))

    @limited("meshing an assembly", "a coarser tolerance")
    def meshes(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> dict[str, Mesh]:
        """The mesh of each part."""
        return {
            name: self.parts[name].mesh(tolerance, quality=quality) for name in in_parts(self.parts, "meshing parts")
        }

    @limited("measuring an assembly", "a coarser tolerance")
    def part_list(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> PartList:
        """What each part measures, by its name; the `whole` of it is what all do together.

        `print(assembly.part_list())` shows a table; `assembly.write("parts.csv")` writes one.
        """
        return PartList(
            {name: self.parts[name].measures(tolerance) for name in in_parts(self.parts, "measuring parts")}
        )

    def colored(self, **colors: str) -> Assembly:
        """The assembly with other colours, `#rrggbb`, for some parts."""
        for name in colors:
            self[name]
        changed = {n: replace(p, color=check_color(colors.get(n, p.color), n)) for n, p in self.parts.items()}
        return Assembly(MappingProxyType(changed))

    def moved(self, change: Callable[[str, Solid], Solid]) -> Assembly:
        """The assembly with `change(name, solid)` for each part that is a solid."""
        parts = {
            n: replace(p, shape=change(n, p.shape)) if isinstance(p.shape, Solid) else p for n, p in self.parts.items()
        }
        return Assembly(MappingProxyType(parts))

    def contains(self, points: ArrayLike) -> Bools:
        """Whether points (..., 3) are in some part that is a solid, shape (...)."""
        solids = [p.shape for p in self.parts.values() if isinstance(p.shape, Solid)]
        return np.any([s.contains(points) for s in solids], axis=0)

    @property
    def box(self) -> Floats:
        """Two corners (2, 3) of a box that holds all parts."""
        return hull([p.shape.box for p in self.parts.values()])

    def _moved(self, map_: Affine) -> Assembly:
        return Assembly(MappingProxyType({name: part._moved(map_) for name, part in self.parts.items()}))

    def _patterned(self, maps: Sequence[Affine]) -> Assembly:
        copies = [self, *(self._moved(map_) for map_ in maps)]
        names = (name for k in range(1, len(copies) + 1) for name in numbered(self.parts, k).values())
        parts = dict(zip(names, (part for copy in copies for part in copy.parts.values()), strict=True))
        return Assembly(MappingProxyType(parts))

    @property
    def proved(self) -> bool:
        """Whether some joint is claimed and all joints of all parts are proved."""
        return self.certificate.proved

    @property
    def description(self) -> str:
        """The parts in words."""
        return "\n\n".join(f"{name} ({part.color})\n{part.shape.description}" for name, part in self.parts.items())

    def __str__(self) -> str:
        return "\n\n".join(f"{name} ({part.color})\n{part.shape}" for name, part in self.parts.items())

    def __repr__(self) -> str:
        return listed("<Assembly of", self.parts)


PartLike: TypeAlias = Solid | Mesh | tuple[Solid | Mesh, str]
"""What is taken for a part: a solid or closed mesh, or that and its colour."""


def assembly(parts: Mapping[str, PartLike] | None = None, *unnamed: Never, **named: PartLike) -> Assembly:
    """An assembly of solids or closed meshes by name: `assembly(pot=..., lid=...)`.

    A value may be a pair (solid, colour) with the colour as `#rrggbb`.  Raises `TypeError` and
    `ValueError` naming the part.
    """
    if unnamed or not isinstance(parts, Mapping | None):
        raise TypeError(
            "the parts of an assembly have names, as in assembly(pot=a, lid=b) or assembly({'pot': a, 'lid': b}); "
            f"{shown((parts, *unnamed) if unnamed else parts)} has none"
        )
    given = {**(parts or {}), **named}
    if not given:
        raise ValueError("an assembly needs at least one part")
    result = {}
    for number, (name, value) in enumerate(given.items()):
        shape, color = value if isinstance(value, tuple) else (value, COLORS[number % len(COLORS)])
        if not isinstance(shape, Solid | Mesh):
            raise TypeError(f"the part {name!r} must be a solid or a Mesh, not {shape!r}; of a surface take its mesh")
        result[name] = Part(shape, check_color(color, name))
    return Assembly(MappingProxyType(result))


def check_color(color: Any, name: str) -> str:
    """The colour of a part, by its name; raises `ValueError` for one that is not written #rrggbb."""
    if not isinstance(color, str) or not re.fullmatch(r"#[0-9a-fA-F]{6}", color):
        raise ValueError(f"the colour of {name!r} must be written #rrggbb, not {color!r}")
    return color


def union(solids: Solid | Sequence[Solid] = (), *others: Solid) -> Solid:
    """The union of at least one solid: `union(a, b)` or `union([a, b])`.

    Raises `ValueError` where there is none, `TypeError` for what is no solid.
    """
    return reduce(Solid.__or__, _solids(solids, others, "union"))


def intersection(solids: Solid | Sequence[Solid] = (), *others: Solid) -> Solid:
    """The intersection of at least one solid: `intersection(a, b)` or `intersection([a, b])`.

    Raises `ValueError` where there is none, `TypeError` for what is no solid.
    """
    return reduce(Solid.__and__, _solids(solids, others, "intersection"))


def _solids(first: Any, others: Sequence[Any], name: str) -> list[Solid]:
    """The solids of a call, in one sequence or one by one."""
    items = list(first) if isinstance(first, Iterable) and not others else [first, *others]
    if not items:
        raise ValueError("there must be at least one solid")
    return only_solids(items, f"{name} takes solids, as in {name}(a, b) or {name}([a, b])")


def only_solids(items: list[Any], rule: str) -> list[Solid]:
    """Solids that they are; raises `TypeError` with a rule for one that is none."""
    for item in items:
        if not isinstance(item, Solid):
            raise TypeError(f"{rule}, not {shown(item)}")
    return items
