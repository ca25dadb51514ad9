"""Solids in project files (`.pas.json`): the exact trees, functions and joints.

Guaranteed: what is read back is what was written, term by term: trees with their order and walls,
polynomials with their rational coefficients, joints, special points.  Verdicts are not kept: they are proved
anew when asked for.  Functions that are no polynomials are kept where their class says how, by `to_record()` and a
class method `from_record(record)`: classes of `pas.solid` are found by their names, others once they are named to
`storable`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeVar

from pas.algebra.affine import Affine
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import plain, vector
from pas.exchange.schema import (
    ANYTHING,
    FLAG,
    NUMBER,
    PARTITION,
    POINT,
    POLYNOMIAL,
    REAL,
    TEXT,
    WHOLE,
    Table,
    Value,
    choice,
    later,
    list_of,
    polynomial_record,
    read_polynomial,
)
from pas.partition.kinds import read_partition
from pas.solid.functions import Distance, Moved, Pieces
from pas.solid.joints import Joint
from pas.solid.shell import FaceDistance, Hollowable
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Function, Node, Tree, atoms

TREE: Value = choice(
    "a tree: a table with a function, a union or an intersection",
    Table({"function": WHOLE, "face": TEXT}, {"outside": FLAG}),
    Table({"union": list_of(later(lambda: TREE))}),
    Table({"intersection": list_of(later(lambda: TREE))}),
)
FUNCTION: Value = choice(
    "a function: a table with a polynomial, pieces, what it is near, what is moved, or a class",
    Table({"polynomial": POLYNOMIAL}),
    Table({"moved": later(lambda: FUNCTION), "matrix": list_of(POINT, 3), "shift": POINT}),
    Table({"pieces": list_of(POLYNOMIAL), "partition": PARTITION}),
    Table({"near": later(lambda: RECORD), "faces": list_of(TEXT), "thickness": REAL, "tolerance": REAL}),
    Table({"class": TEXT, "data": ANYTHING}),
)
RECORD: Table = Table(
    {
        "functions": list_of(FUNCTION),
        "tree": TREE,
        "joints": list_of(Table({"first": TEXT, "second": TEXT, "along": list_of(POLYNOMIAL, 2), "order": WHOLE})),
        "special_points": list_of(list_of(REAL, 3)),
    }
)

_TUBE = Table({"curve": list_of(TEXT, 3), "interval": list_of(NUMBER, 2), "radius": NUMBER})
_DATA = {"pas.solid.tube.Tube": _TUBE, "pas.solid.tube.End": Table({"tube": _TUBE, "side": WHOLE})}
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


def solid_record(solid: Hollowable) -> dict[str, Any]:
    """Everything that defines a solid, exact; each function is written once."""
    numbers: dict[Function, int] = {}
    for atom in atoms(solid.tree):
        numbers.setdefault(atom.function, len(numbers))
    return {
        "functions": [function_record(f) for f in numbers],
        "tree": _tree_record(solid.tree, numbers),
        "joints": [
            {"first": j.first, "second": j.second, "along": [polynomial_record(p) for p in j.along], "order": j.order}
            for j in solid.joints
        ],
        "special_points": [list(p) for p in solid.special_points],
    }


def read_solid(record: dict[str, Any]) -> Solid:
    """The solid of `solid_record`, exactly."""
    functions = [read_function(f) for f in record["functions"]]
    joints = [
        Joint(j["first"], j["second"], [read_polynomial(p) for p in j["along"]], j["order"]) for j in record["joints"]
    ]
    points = tuple((float(x), float(y), float(z)) for x, y, z in record["special_points"])
    return Solid(_read_tree(record["tree"], functions), tuple(joints), points)


def _tree_record(tree: Tree, numbers: dict[Function, int]) -> dict[str, Any]:
    if isinstance(tree, Node):
        return {"union" if tree.union else "intersection": [_tree_record(p, numbers) for p in tree.parts]}
    record: dict[str, Any] = {"function": numbers[tree.function], "face": tree.face}
    return record | {"outside": True} if tree.outside else record


def _read_tree(record: dict[str, Any], functions: list[Function]) -> Tree:
    if "function" in record:
        number = record["function"]
        if not 0 <= number < len(functions):
            raise ValueError(f"there is no function number {number}; there are {len(functions)}")
        return Atom(functions[number], record["face"], record.get("outside", False))
    union = "union" in record
    parts = tuple(_read_tree(part, functions) for part in record["union" if union else "intersection"])
    if not parts:
        raise ValueError("a union or an intersection has no parts")
    return Node(parts, union)


def function_record(function: Function) -> dict[str, Any]:
    """A polynomial, a piecewise one, a moved distance, or one whose class has `to_record` and `from_record`.

    Raises `ValueError` for others.
    """
    if isinstance(function, Polynomial):
        return {"polynomial": polynomial_record(function)}
    if isinstance(function, Moved):
        rows = [[plain(c) for c in row] for row in function.map.matrix]
        shift = [plain(c) for c in function.map.shift]
        return {"moved": function_record(function.inner), "matrix": rows, "shift": shift}
    if isinstance(function, Pieces):
        polynomials = [polynomial_record(p) for p in function.polynomials]
        return {"pieces": polynomials, "partition": function.partition.to_record()}
    if isinstance(function, FaceDistance):
        return {
            "near": solid_record(function.solid),
            "faces": list(function.faces),
            "thickness": function.thickness,
            "tolerance": function.tolerance,
        }
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


def read_function(record: dict[str, Any]) -> Function:
    """The function of `function_record`."""
    if "polynomial" in record:
        polynomial = read_polynomial(record["polynomial"])
        if polynomial.degree < 1:
            raise ValueError(f"a function of a solid must not be constant, and one is {polynomial}")
        return polynomial
    if "moved" in record:
        a, b, c = (vector(row, "a row of the matrix") for row in record["matrix"])
        place = Affine((a, b, c), vector(record["shift"], "shift"))
        inner = read_function(record["moved"])
        if not isinstance(inner, Distance):
            raise ValueError("a moved function is no distance; it should have been written moved")
        return Moved(inner, place, place.similarity())
    if "pieces" in record:
        return Pieces(read_partition(record["partition"]), [read_polynomial(p) for p in record["pieces"]])
    if "near" in record:
        return FaceDistance(
            read_solid(record["near"]), record["faces"], float(record["thickness"]), float(record["tolerance"])
        )
    kind: Any = _class_named(record["class"])
    if kind is None:
        raise ValueError(f"functions of class {record['class']!r} are not known; name the class to `storable` first")
    _DATA.get(record["class"], ANYTHING).check(record["data"], "data")
    return kind.from_record(record["data"])


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
    return kind if isinstance(kind, type) and callable(getattr(kind, "from_record", None)) else None
