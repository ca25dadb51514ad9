"""Problem files (TOML) of parts: solids from primitives, profiles, set operations and edges, without a program.

    unit = "mm"                    # optional: that of the lengths, which the written files tell
    # name, tolerance, prove, [mesh] and [picture] are those of every problem, see pas.exchange.problem

    [[solid]]                      # each table makes a thing: its kind is a function of pas.solid, ...
    name = "plate"
    kind = "box"
    lower = [0, 0, 0]              # ... and the other keys are the arguments of that
    upper = [40, 30, 5]
    face = "plate"                 # exact numbers: "1/3", integers, decimals as written

    [[solid]]
    name = "boss"
    kind = "circle"                # a profile, ...
    center = [20, 15]
    radius = 6
    face = "boss"
    then = [{ kind = "extrude", height = 20 }]         # ... and what is done next: methods, with their arguments

    [[solid]]
    name = "bracket"
    kind = "union"                 # or "intersection", or "difference": of the first and those after it
    of = ["plate", "boss"]         # tables above
    color = "#7d9db5"              # optional

    [[solid.then]]                 # steps may be tables of their own, too
    kind = "fillet"
    first = "plate z+"
    second = "boss"
    radius = 3

    [[solid]]
    name = "corner"
    kind = "blend"                 # the solid of a blend; its other keys and tables are those of a problem file of
    order = 1                      # such, see pas.exchange.corner_problem, and length, that of its neighbours, and
                                   # wall, the thickness of a hollow one
    pipes = [
      { axis = [1, 0, 0], radius = "1/3", clip = 1 },
      { axis = [0, 1, 0], radius = "1/3", clip = 1 },
      { axis = [0, 0, 1], radius = "1/3", clip = 1 },
    ]
    partition = { kind = "fan" }
    then = [{ kind = "translate", offset = [60, 0, 0] }]

Tables that no other uses are the parts: one is a solid, several are an assembly.  `MAKERS` are the kinds of tables,
`steps_of` those of steps; both derive from the functions and methods themselves.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial, reduce
from inspect import BoundArguments, Parameter, Signature, getmembers, isfunction, signature
from pathlib import Path
from typing import Any

import pas.solid
from pas.algebra.inputs import shown
from pas.errors import meant
from pas.exchange.formats import unit_named
from pas.exchange.problem import (
    COMMON,
    COMMON_TABLES,
    PROBLEMS,
    WORDS,
    Problem,
    ProblemKind,
    TableReader,
    as_written,
    common,
)
from pas.limits import WorkLimits
from pas.registry import Registry, check_keys
from pas.settings import MeshSettings
from pas.solid.assembly import Assembly, assembly, check_color
from pas.solid.solid import Solid
from pas.verdicts import Verdicts

CLASSES = {made.__name__: made for made in (pas.solid.Solid, pas.solid.Profile, pas.solid.Sketch)}
OWN = {"S", "M", "Self"}
"""How methods say that they give what they are called on."""


@dataclass(frozen=True)
class Maker:
    """A function, or a method, that a table may call, with the keys as its arguments.

    `gives` names the class of the result, "" where that is the class of what it is called on.
    """

    name: str
    function: Callable[..., Any]
    gives: str
    method: bool = False

    @property
    def keys(self) -> dict[str, bool]:
        """Its arguments, and whether they are needed."""
        found = list(signature(self.function).parameters.values())[self.method :]
        left = {"others", *WorkLimits.__annotations__}
        return {p.name: p.default is p.empty and p.kind is not p.VAR_POSITIONAL for p in found if p.name not in left}

    def __call__(self, taken: Any, record: Mapping[str, Any]) -> Any:
        """The result, of an object for a method; raises `TypeError` for an argument that is no list, text or flag."""
        form = signature(self.function)
        values = {name: as_written(value) if _hinted(form, name, "int") else value for name, value in record.items()}
        for name, value in values.items():
            for hint, made in (("Sequence", list), ("str", str), ("bool", bool)):
                if _hinted(form, name, hint) and not isinstance(value, made):
                    raise TypeError(f"{name} must be {WORDS[made]}, not {shown(value)}")
        first = {next(iter(form.parameters)): taken} if self.method else {}
        call = BoundArguments(form, {**first, **values})
        return self.function(*call.args, **call.kwargs)


def _hinted(form: Signature, name: str, hint: str) -> bool:
    """Whether the annotation of a parameter begins with a word; what takes several arguments is a sequence."""
    parameter = form.parameters[name]
    several = parameter.kind is Parameter.VAR_POSITIONAL
    return hint == "Sequence" if several else re.match(rf"{hint}\b", str(parameter.annotation)) is not None


def _reduced(take: Callable[[Any, Any], Any], of: Sequence[Any]) -> Any:
    return reduce(take, of)


SET_OPERATIONS = {
    name: Maker(name, partial(_reduced, take), "")
    for name, take in (("union", operator.or_), ("intersection", operator.and_), ("difference", operator.sub))
}
"""Their argument `of` holds names of tables above."""


def _made_by(owner: Any) -> dict[str, Maker]:
    """The functions, or methods of a class, that return a thing of `CLASSES`."""
    found = {}
    for name, function in getmembers(owner, isfunction):
        gives = getattr(function, "__annotations__", {}).get("return", "")
        own = isinstance(owner, type) and gives in OWN
        if not name.startswith("_") and (own or gives in CLASSES):
            found[name] = Maker(name, function, "" if own else gives, isinstance(owner, type))
    return found


MAKERS: Registry[Maker] = Registry(
    "kind of solid or profile",
    {n: m for n, m in _made_by(pas.solid).items() if n not in ("patch", *SET_OPERATIONS)}
    | SET_OPERATIONS
    | {"blend": Maker("blend", lambda **table: None, "Solid")},
)
"""All functions of `pas.solid` that make solids, profiles and sketches, set operations, and blends."""


@cache
def steps_of(name: str) -> Registry[Maker]:
    """The methods that a step may call on a thing, by the name of its class."""
    return Registry(f"step for a {name.lower()}", _made_by(CLASSES[name]) | SET_OPERATIONS)


@dataclass(frozen=True)
class Call:
    """A table that was read: what it asks for with which arguments, and where errors of these are."""

    maker: Maker
    record: dict[str, Any]
    reader: TableReader
    place: tuple[str, int, str]

    def done(self, things: Mapping[str, Any], taken: Any = None) -> Any:
        """The result, given things by name; raises `ProblemFileError` with what making it raises, and the line."""

        def make(record: dict[str, Any]) -> Any:
            if self.maker.name not in SET_OPERATIONS:
                return self.maker(taken, record)
            return self.maker(None, {"of": [*([] if taken is None else [taken]), *(things[n] for n in record["of"])]})

        return self.reader.made(make, self.record, *self.place)


@dataclass(frozen=True)
class NamedTable:
    """A table `[[solid]]` that was read: how its thing is made, of which class it is, and what others it uses."""

    name: str
    color: str | None
    calls: tuple[Call, ...]
    gives: str
    uses: frozenset[str]


@dataclass(frozen=True)
class PartProblem(Problem):
    """A part, or several, as read from a file."""

    tables: tuple[NamedTable, ...]

    def satisfied(self, certificate: Verdicts) -> bool:
        """See `Problem.satisfied`; where no joints are claimed nothing is to be proved."""
        return not certificate.verdicts or super().satisfied(certificate)

    def solve(self) -> Solid | Assembly:
        """The solid, or the assembly of several parts; raises `ProblemFileError` where one cannot be made."""
        things: dict[str, Any] = {}
        for table in self.tables:
            thing = None
            for call in table.calls:
                thing = call.done(things, thing)
            things[table.name] = thing
        used = frozenset().union(*(table.uses for table in self.tables))
        parts = [table for table in self.tables if table.name not in used]
        if len(parts) == 1 and parts[0].color is None:
            return things[parts[0].name]
        return assembly({t.name: things[t.name] if t.color is None else (things[t.name], t.color) for t in parts})


def _table(reader: TableReader, table: dict[str, Any], index: int, known: Mapping[str, NamedTable]) -> NamedTable:
    """One table; raises `ValueError` beginning with the key at fault, or `ProblemFileError` for one of its steps."""
    name = reader.typed(table, "name", str, "", "solid")
    if not name or name in known:
        raise ValueError(f"name must be one of its own, not {shown(name)}" if name else "a solid needs a name")
    title, inner = f"solid {name!r}: ", reader.within("solid", index)
    own = {key: value for key, value in table.items() if key not in ("name", "kind", "color", "then")}
    try:
        color = None if "color" not in table else check_color(table["color"], name)
    except ValueError as error:
        raise reader.error(str(error), "solid", index, "color") from None
    maker = _kind(MAKERS, table)
    if maker.name == "blend":
        own, maker = {}, Maker("blend", _blend(inner, own), "Solid")
    calls, gives = [Call(maker, own, reader, ("solid", index, title))], maker.gives
    _check(maker, f"kind {maker.name!r}", own, known)
    gives = gives or known[own["of"][0]].gives
    for number, step in enumerate(reader.typed(table, "then", list, [], "solid")):
        place = ("then", number, f"solid {name!r}, step {number + 1}: ")
        maker, rest = inner.made(partial(_step, known=known, gives=gives), step, *place)
        calls.append(Call(maker, rest, inner, place))
        gives = maker.gives or gives
    uses = frozenset(n for call in calls if call.maker.name in SET_OPERATIONS for n in call.record["of"])
    return NamedTable(name, color, tuple(calls), gives, uses)


def _kind(kinds: Registry[Maker], table: Mapping[str, Any]) -> Maker:
    if "kind" not in table:
        raise ValueError(f"there is no 'kind', which says what is made or done; there are {', '.join(kinds)}")
    return kinds[table["kind"]]


def _step(step: dict[str, Any], known: Mapping[str, NamedTable], gives: str) -> tuple[Maker, dict[str, Any]]:
    maker = _kind(steps_of(gives), step)
    rest = {key: value for key, value in step.items() if key != "kind"}
    _check(maker, f"step {maker.name!r}", rest, known, gives)
    return maker, rest


def _check(
    maker: Maker, called: str, record: Mapping[str, Any], known: Mapping[str, NamedTable], gives: str = ""
) -> None:
    """Raise `ValueError` for keys that are unknown or missing, and for names of things that are not there."""
    check_keys(maker.keys, called, record)
    if maker.name not in SET_OPERATIONS:
        return
    if not isinstance(record["of"], list) or not record["of"]:
        raise ValueError(f"of must be a list of names of tables above, not {shown(record['of'])}")
    for name in record["of"]:
        if not isinstance(name, str) or name not in known:
            near = meant(name, known) if isinstance(name, str) else ""
            raise ValueError(f"of: there is no solid {shown(name)} above{near}")
        gives = gives or known[name].gives
        if known[name].gives != gives or gives == "Sketch":
            raise ValueError(f"of: {name!r} is a {known[name].gives.lower()}; take solids alone, or profiles alone")


def _blend(reader: TableReader, table: dict[str, Any]) -> Callable[[], Solid]:
    """A function that makes the solid of a blend; raises `ProblemFileError` as the reader of such problems does."""
    for key in ("tolerance", "mesh", "picture"):
        if key in table:
            raise ValueError(f"{key} is that of the whole file")
    length, wall = table.pop("length", None), table.pop("wall", None)
    problem: Any = PROBLEMS["corner"].read(reader.file, "\n".join(reader.lines), table)
    return lambda: (problem.solve() if wall is None else problem.solve().hollow(wall)).solid(length)


def _read(file: Path, text: str, data: dict[str, Any]) -> PartProblem:
    keys = {"": COMMON | {"solid": True, "unit": False}, **COMMON_TABLES}
    reader = TableReader(file, text, keys, ("solid",))
    reader.check(data)
    known: dict[str, NamedTable] = {}
    for index, entry in enumerate(data["solid"]):
        title = f"solid {index + 1}: "
        made = reader.made(partial(_table, reader, index=index, known=known), entry, "solid", index, title)
        known[made.name] = made
    if not known:
        raise reader.error("gives no solids: [[solid]] is empty", key="solid")
    used = frozenset().union(*(table.uses for table in known.values()))
    for index, table in enumerate(known.values()):
        if table.name not in used and table.gives != "Solid":
            how = "close it, and extrude or revolve it" if table.gives == "Sketch" else "extrude or revolve it"
            raise reader.error(f"{table.name!r} is a {table.gives.lower()} that nothing uses; {how}", "solid", index)
    return PartProblem(
        **common(reader, data, MeshSettings(), "plain"),
        prove=reader.typed(data, "prove", bool, None),
        model_unit=reader.checked(data, "unit", unit_named),
        tables=tuple(known.values()),
    )


PROBLEM = ProblemKind("part", lambda data: "solid" in data, _read)
