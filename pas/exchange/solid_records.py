"""Solids in project files (`.pas.json`): the exact trees, functions and joints.

Guaranteed: what is read back is what was written, term by term: trees with their order and walls, polynomials with
their rational coefficients, joints, special points, and what bounds a solid, so that it is meshed as before; where
one of both was edited nothing known bounds it.  Verdicts are not kept: they are proved anew when asked for.
Functions that are no polynomials are kept where their class says how, by `to_record()` and a class method
`from_record(record)`: classes of `pas.solid` are found by their names, others once they are named to `storable`.
What bounds solids are dataclasses of `pas.solid`, kept by their annotated fields.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cache, partial
from importlib import import_module
from types import NoneType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine
from pas.algebra.inputs import whole
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational, vector
from pas.arrays import Floats
from pas.exchange.files import checksum
from pas.exchange.records import PARAMETRIC, PARTITION, SURFACE
from pas.exchange.schema import (
    ANYTHING,
    FLAG,
    NUMBER,
    POINT,
    POLYNOMIAL,
    REAL,
    TEXT,
    WHOLE,
    Form,
    Table,
    Value,
    choice,
    itself,
    later,
    list_of,
    maybe,
    read_by,
    row,
)
from pas.parametric.solids import FlatEnd, SurfaceDistance
from pas.parametric.surface import ParametricSurface
from pas.piecewise import PiecewiseSurface
from pas.solid.faces import SolidBoundary
from pas.solid.functions import Distance, Moved, Pieces
from pas.solid.joints import Joint
from pas.solid.operands import Operand
from pas.solid.shell import FaceDistance
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Function, Node, Tree, atoms, folded

TREE: Value = choice(
    "a tree: a table with a function, a union, an intersection or a branch",
    Table({"function": WHOLE, "face": TEXT}, {"outside": FLAG}),
    Table({"union": list_of(later(lambda: TREE))}),
    Table({"intersection": list_of(later(lambda: TREE))}),
    Table({"branch": WHOLE}),
)
"""How its functions and branches are numbered is said by the whole record, which reads and writes it."""

_TUBE = Table({"curve": list_of(TEXT, 3), "interval": list_of(NUMBER, 2), "radius": NUMBER}, {"round": FLAG})
_DATA = {
    "pas.solid.tube.Tube": _TUBE,
    "pas.solid.tube.End": Table({"tube": _TUBE, "side": WHOLE}),
    "pas.solid.thread.Flank": Table({"diameter": NUMBER, "pitch": NUMBER}),
}
"""The data of functions by class, where it is known."""

STORED = {"pas.solid.tube.TubeEnd": "pas.solid.tube.End"}
"""Classes of functions whose names in files are those that they had first."""

Class = TypeVar("Class", bound=type)

_named: dict[str, type] = {}


def storable(kind: Class) -> Class:
    """Name a class of functions to the reader of project files; returns the class (a decorator).

    It has `to_record()`, which returns what JSON can say, and a class method `from_record(record)`.
    Raises `TypeError` where it does not.
    """
    for method in ("to_record", "from_record"):
        if not callable(getattr(kind, method, None)):
            raise TypeError(f"{kind.__name__} has no {method}, so its functions cannot be saved")
    _named[_name(kind)] = kind
    return kind


def _tree_record(tree: Tree, numbers: dict[Function, int]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The record of a tree, and those of the branches, in turn, for which their numbers stand in later ones."""
    branches: list[dict[str, Any]] = []
    most = 32  # levels of unions and intersections that stand in one another: files are read to some depth

    def leaf(atom: Atom) -> tuple[dict[str, Any], int]:
        record: dict[str, Any] = {"function": numbers[atom.function], "face": atom.face}
        return (record | {"outside": True} if atom.outside else record), 0

    def branch(node: Node, parts: list[tuple[dict[str, Any], int]]) -> tuple[dict[str, Any], int]:
        record = {"union" if node.union else "intersection": [part for part, _ in parts]}
        level = max(h for _, h in parts)
        if level < most:
            return record, level + 1
        branches.append(record)
        return {"branch": len(branches) - 1}, 0

    return folded(tree, leaf, branch)[0], branches


def _numbered(known: Sequence[Any], number: int, what: str) -> Any:
    if not 0 <= number < len(known):
        raise ValueError(f"there is no {what} number {number}; there are {len(known)}")
    return known[number]


def _read_tree(record: dict[str, Any], functions: list[Function], branches: Sequence[Tree]) -> Tree:
    if "function" in record:
        function = _numbered(functions, record["function"], "function")
        return Atom(function, record["face"], record.get("outside", False))
    if "branch" in record:
        found: Tree = _numbered(branches, record["branch"], "branch before")
        return found
    union = "union" in record
    parts = tuple(_read_tree(part, functions, branches) for part in record["union" if union else "intersection"])
    if not parts:
        raise ValueError("a union or an intersection has no parts")
    return Node(parts, union)


def _not_constant(polynomial: Polynomial) -> Polynomial:
    if polynomial.degree < 1:
        raise ValueError(f"a function of a solid must not be constant, and one is {polynomial}")
    return polynomial


def _moved(moved: Function, matrix: Any, shift: Any) -> Moved:
    a, b, c = (vector(row, "a row of the matrix") for row in matrix)
    place = Affine((a, b, c), vector(shift, "shift"))
    if not isinstance(moved, Distance):
        raise ValueError("a moved function is no distance; it should have been written moved")
    return Moved(moved, place, place.similarity())


def _bounded(inside: ParametricSurface) -> SurfaceDistance:
    return SurfaceDistance(inside, inside.mesh())


def _flat_end(end: int, inside: ParametricSurface) -> FlatEnd:
    """The height above the plane of one of its ends."""
    distance = _bounded(inside)
    return FlatEnd(distance, whole(end, "end", 0, len(distance.edges) - 1))


def _of_class(**entries: Any) -> Function:
    """A function of a class that says how it is read; raises `ValueError` for one that is not known."""
    name, data = entries["class"], entries["data"]
    kind: Any = _class_named(name)
    if not callable(getattr(kind, "from_record", None)):
        raise ValueError(f"functions of class {name!r} are not known; name the class to `storable` first")
    _DATA.get(name, ANYTHING).check(data, "data")
    return kind.from_record(data)


def _class_entries(function: Function) -> dict[str, Any]:
    """The class of a function that says how it is written; raises `ValueError` for others."""
    kind = type(function)
    write_it: Callable[[], Any] | None = getattr(function, "to_record", None)
    if write_it is None or not callable(getattr(kind, "from_record", None)):
        raise ValueError(
            f"a solid with a {kind.__name__} cannot be saved exactly: it is no polynomial and its class has no "
            "to_record and from_record; save a mesh of the solid with pas.write"
        )
    if _class_named(_name(kind)) is not kind:
        raise ValueError(f"a solid with a {kind.__name__} cannot be saved before its class is named to `storable`")
    return {"class": _name(kind), "data": write_it()}


FUNCTION: Value = choice(
    "a function: a table with a polynomial, pieces, what it is near or inside, what is moved, or a class",
    Table(
        {"polynomial": POLYNOMIAL},
        make=_not_constant,
        entries=lambda function: {"polynomial": function},
        of=lambda function: isinstance(function, Polynomial),
    ),
    Table(
        {"moved": later(lambda: FUNCTION), "matrix": list_of(POINT, 3), "shift": POINT},
        make=_moved,
        names={"moved": "inner", "matrix": "map.matrix", "shift": "map.shift"},
        of=lambda function: isinstance(function, Moved),
    ),
    Table(
        {"pieces": list_of(POLYNOMIAL), "partition": PARTITION},
        make=lambda pieces, partition: Pieces(partition, pieces),
        names={"pieces": "polynomials"},
        of=lambda function: isinstance(function, Pieces),
    ),
    Table(
        {"near": later(lambda: RECORD), "faces": list_of(TEXT), "thickness": REAL, "tolerance": REAL},
        make=lambda near, faces, thickness, tolerance: FaceDistance(near, faces, float(thickness), float(tolerance)),
        names={"near": "solid"},
        of=lambda function: isinstance(function, FaceDistance),
    ),
    Table(
        {"end": WHOLE, "inside": PARAMETRIC},
        make=_flat_end,
        names={"end": "number", "inside": "distance.surface"},
        of=lambda function: isinstance(function, FlatEnd),
    ),
    Table(
        {"inside": PARAMETRIC},
        make=_bounded,
        names={"inside": "surface"},
        of=lambda function: isinstance(function, SurfaceDistance),
    ),
    Table({"class": TEXT, "data": ANYTHING}, make=_of_class, entries=_class_entries),
)


_FORMS: dict[Any, Form] = {str: TEXT, bool: FLAG, int: WHOLE, Polynomial: POLYNOMIAL, PiecewiseSurface: SURFACE}
_FORMS |= {float: replace(REAL, read=float), fmpq: replace(NUMBER, read=rational), Operand: later(lambda: RECORD)}
_FORMS[Floats] = Value(
    "an array", lambda v: isinstance(v, list), read=partial(np.array, dtype=float), write=np.ndarray.tolist
)
"""The forms of fields of solids' boundaries, by their types."""


@cache
def _form_of(kind: Any) -> Form:
    """The form of the values of an annotated type: of a dataclass its fields, of a protocol a class and its fields."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind in _FORMS:
        return _FORMS[kind]
    if NoneType in inner:
        return maybe(_form_of(inner[0]))
    if origin is Mapping:
        pairs = list_of(row(*map(_form_of, inner)))
        return read_by(pairs, lambda value: dict(pairs.read(value)), lambda table: pairs.write([*table.items()]))
    if origin is tuple:
        form = list_of(_form_of(inner[0])) if inner[-1] is Ellipsis else row(*map(_form_of, inner))
        return read_by(form, lambda value: tuple(form.read(value)), form.write)
    if hasattr(kind, "from_record"):
        return FUNCTION
    if not is_dataclass(kind):
        known = Table({"class": TEXT, "data": ANYTHING}, make=partial(_body, kind))
        return replace(known, entries=lambda b: {"class": _name(b.__class__), "data": _form_of(b.__class__).write(b)})
    types, made = get_type_hints(kind), cast("Callable[..., Any]", kind)
    return Table({f.name: later(partial(_form_of, types[f.name])) for f in fields(kind) if f.init}, make=made)


def _body(protocol: type, **entries: Any) -> Any:
    """The object of a dataclass of `pas.solid` that implements a protocol; raises `ValueError` for others."""
    kind = _class_named(entries["class"])
    asked = {name for name in vars(protocol) if not name.startswith("_")}
    if kind is None or not is_dataclass(kind) or not asked <= {*dir(kind), *kind.__dataclass_fields__}:
        raise ValueError(f"what bounds a solid is of no class {entries['class']!r}")
    form = _form_of(kind)
    form.check(entries["data"], "data")
    return form.read(entries["data"])


_BODY = _form_of(SolidBoundary)


def _sum_of(functions: Sequence[Function], **records: Any) -> str:
    """A checksum of the records of a solid's inequalities and of its boundary, which must be from one solid."""
    return checksum({"functions": [FUNCTION.write(function) for function in functions], **records})


def _solid(
    functions: list[Function], tree: Any, joints: Any, special_points: Any, sheets: Any = None, branches: Any = None
) -> Solid:
    points = tuple((float(x), float(y), float(z)) for x, y, z in special_points)
    records = {"tree": tree} if branches is None else {"tree": tree, "branches": branches}
    known = sheets is not None and sheets["of"] == _sum_of(functions, body=sheets["body"], **records)
    read = list[Tree]()
    for branch in branches or ():
        read.append(_read_tree(branch, functions, read))
    body = _BODY.read(sheets["body"]) if known else None
    return Solid(_read_tree(tree, functions, read), tuple(joints), points, body)


def _solid_entries(solid: Solid) -> dict[str, Any]:
    """Everything that defines a solid, exact; each function is written once."""
    numbers: dict[Function, int] = {}
    for atom in atoms(solid.tree):
        numbers.setdefault(atom.function, len(numbers))
    tree, branches = _tree_record(solid.tree, numbers)
    records = {"tree": tree, "branches": branches} if branches else {"tree": tree}
    entries = {"functions": numbers, **records, "joints": solid.joints, "special_points": solid.special_points}
    if solid.sheets is None:
        return entries
    body = _BODY.write(solid.sheets)
    return {**entries, "sheets": {"of": _sum_of([*numbers], body=body, **records), "body": body}}


JOINT = Table(
    {"first": TEXT, "second": TEXT, "along": list_of(POLYNOMIAL, 2), "order": WHOLE},
    {"within": list_of(POLYNOMIAL)},
    make=Joint,
)
RECORD: Table = Table(
    {
        "functions": list_of(FUNCTION),
        "tree": read_by(TREE, itself, itself),
        "joints": list_of(JOINT),
        "special_points": list_of(list_of(REAL, 3)),
    },
    {"sheets": Table({"of": TEXT, "body": read_by(_BODY, itself, itself)}), "branches": list_of(TREE)},
    make=_solid,
    entries=_solid_entries,
)


def _name(kind: type) -> str:
    name = f"{kind.__module__}.{kind.__qualname__}"
    return STORED.get(name, name)


def _class_named(name: str) -> type | None:
    """The class of a name, where it may be used; nothing outside `pas.solid` is imported for a file."""
    if name in _named:
        return _named[name]
    now = {stored: full for full, stored in STORED.items()}
    module, _, title = now.get(name, name).rpartition(".")
    if not re.fullmatch(r"pas\.solid\.[a-z_]+", module):
        return None
    try:
        kind = getattr(import_module(module), title, None)
    except ImportError:
        return None
    return kind if isinstance(kind, type) else None
