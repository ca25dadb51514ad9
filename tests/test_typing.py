"""Public names say what they take and give: `Any` only where a value is really of any kind, each with its reason."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from functools import cache

import pas
from pas import solid

TABLE = "a table of JSON or TOML: texts, numbers, lists and tables, as its schema says"
FORWARDED = "options of the verb that a room above has; they differ by kind and are checked there"
BY_KIND = "of the kind's own types: a kind is what ties them together"
SERIES = "an array where it gets arrays, a jet where it gets jets"
BELOW = "its room stands below that of the type"
UNSAID = "a type could say more, and is to say it when its room is worked on"

MAY_BE_ANY = {
    "AlfeldSplit.to_record": TABLE,
    **dict.fromkeys(
        ("ConvexProblem.missed", "ConvexProblem.solve", "ConvexProblem.values"),
        "expressions of cvxpy, which has no types",
    ),
    "Region.to_record": TABLE,
    "Layout.dimensions": BELOW,
    "Layout.mesh": BELOW,
    "Layout.picture": FORWARDED,
    "Boundary.source": TABLE,
    "boundary_from": TABLE,
    "Certificate.from_record": TABLE,
    "Certificate.to_record": TABLE,
    "Energy.to_record": TABLE,
    "Fairness.to_record": TABLE,
    "KuhnCube.to_record": TABLE,
    "Layout.to_record": TABLE,
    "Membrane.from_record": TABLE,
    "Membrane.to_record": TABLE,
    "Partition.to_record": TABLE,
    "SingleCell.to_record": TABLE,
    "SixTetrahedra.to_record": TABLE,
    "ThinPlate.from_record": TABLE,
    "ThinPlate.to_record": TABLE,
    "Verdict.from_record": TABLE,
    "Verdict.to_record": TABLE,
    "Verdicts.to_record": TABLE,
    "Polynomial.surface": BELOW,
    "Shape.__or__": "solids and meshes say what they give",
    "Shape.draw": FORWARDED,
    "Shape.save": FORWARDED,
    "Shape.show": FORWARDED,
    "Shape.studio": "a widget of a library that need not be there",
    "Shape.write": FORWARDED,
    "write_mesh": FORWARDED,
    "table": "a DataFrame of pandas where that is there, which it need not be",
    "Kind.body": BY_KIND,
    "Kind.solid": BY_KIND,
    "Kind.facts": BY_KIND,
    "Kind.form": BY_KIND,
    "Kind.layers": BY_KIND,
    "Kind.mesh": BY_KIND,
    "Kind.parts": BY_KIND,
    "Kind.patches": BY_KIND,
    "Kind.piecewise": BY_KIND,
    "Kind.placed": BY_KIND,
    "RationalFunction.__call__": SERIES,
    "Weights.__call__": SERIES,
    "NotProvedError.__init__": BELOW,
    "Shape.mesh": BELOW,
    "Shape.meshed": BELOW,
    "Picture.coloring": BELOW,
    "Picture.domain": UNSAID,
    "Picture.of": UNSAID,
    "Wishes.basis": UNSAID,
}
"""Where `Any` stands in what is public, and why."""


def exported() -> Iterator[tuple[str, object]]:
    """All public functions and classes by their own names, those of `pas.solid` with its name before them."""
    for room, prefix in ((pas, ""), (solid, "solid.")):
        for thing in (getattr(room, name) for name in room.__all__):
            if inspect.isclass(thing):
                yield thing.__name__, thing
            elif inspect.isfunction(thing):
                yield prefix + thing.__name__, thing


def has_any(annotation: ast.AST | None) -> bool:
    """Whether `Any` stands in an annotation, which may be written as a text or with the module's name."""
    return annotation is not None and re.search(r"\bAny\b", ast.unparse(annotation)) is not None


def annotations(function: ast.FunctionDef) -> list[ast.expr | None]:
    """The annotations of all parameters, self and cls aside, and of what is returned."""
    given = function.args
    own = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return [*(a.annotation for a in own if a is not None and a.arg not in ("self", "cls")), function.returns]


def parts(name: str, thing: object) -> Iterator[tuple[str, list[ast.expr | None]]]:
    """What is public of a name, with its annotations: a function, or the methods and fields of a class and of bases
    in its room that have no public name; the class's own are the last."""
    if inspect.isclass(thing):
        room = thing.__module__.split(".")[:2]
        for base in reversed(thing.__mro__):
            if base is thing or (base.__module__.split(".")[:2] == room and base.__name__ not in NAMED):
                yield from members(name, base)
        return
    (node,) = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(thing)))).body
    assert isinstance(node, ast.FunctionDef)
    yield name, annotations(node)


def members(name: str, owner: type) -> Iterator[tuple[str, list[ast.expr | None]]]:
    """The methods and fields that stand in a class itself, under a name of their own."""
    (node,) = ast.parse(textwrap.dedent(inspect.getsource(owner))).body
    assert isinstance(node, ast.ClassDef)
    for item in node.body:
        if isinstance(item, ast.FunctionDef) and (not item.name.startswith("_") or item.name.endswith("__")):
            yield f"{name}.{item.name}", annotations(item)
        elif isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name) and item.target.id[0] != "_":
            yield f"{name}.{item.target.id}", [item.annotation]


NAMED = {*pas.__all__, *solid.__all__}


@cache
def public() -> dict[str, list[ast.expr | None]]:
    """The annotations of all that is public, by name."""
    return {name: hints for home, thing in exported() for name, hints in parts(home, thing)}


def test_there_are_public_names():
    assert len(public()) > 600
    assert {"blend", "Blend.solid", "Boundary.source", "Polynomial.__call__", "solid.ball"} <= set(public())
    assert has_any(ast.parse("dict[str, Any] | None", mode="eval").body)
    assert has_any(ast.parse("list['typing.Any']", mode="eval").body)
    assert not has_any(ast.parse("Anything | None", mode="eval").body)


def test_any_stands_only_where_a_value_is_of_any_kind():
    found = {name for name, hints in public().items() if any(map(has_any, hints))}
    assert not found - set(MAY_BE_ANY), sorted(found - set(MAY_BE_ANY))
    assert not {name for name, why in MAY_BE_ANY.items() if why != UNSAID} - found, "the table has names that are typed"


def test_every_parameter_and_result_has_a_type():
    assert not [name for name, hints in public().items() if None in hints]
