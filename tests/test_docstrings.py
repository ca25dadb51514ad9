"""Docstrings of exported functions: they name what is raised, the shapes of arrays, and every parameter has a type."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
import typing
from collections.abc import Callable, Iterator

import pytest

import pas
from pas import solid

VERBS = re.compile(r"pas\.(blend|draw|show|save|write)\w*")
"""Functions that take all kinds of things, and hand on the other parameters to what is made of them."""

CHECKS = {"ArithmeticError", "AssertionError"}
"""Errors that say that the program is wrong: no user is to reckon with them."""

SHAPE = re.compile(r"\((\.\.\.|[\w*]+)(, [\w*]+)*,?\)")
"""How a shape is written: (..., 3), (N, 3), (T,)."""

LENGTHS = {
    *("radius", "end_radius", "major", "minor", "pitch", "a", "b", "c", "tolerance", "edge_length", "thickness"),
    *("length", "distance", "sew", "lid_height"),
}
ANGLES = {"angle", "angles"}
"""Names of parameters that are lengths and angles."""

SOURCE = re.compile(r"\b[A-Z][\w'-]*[a-z](?: et al\.)?,? \(?(?:1[6-9]|20)\d\d\b")
"""An author and a year: Levin 1976, Spitzbart (1960)."""

METHODS = {"pas.contact_ideal", "pas.existence", "pas.fit_patch"}
"""Functions whose method has a source that the head of their file does not name."""


def exported() -> Iterator[tuple[str, Callable]]:
    for room, prefix in ((pas, "pas"), (solid, "solid")):
        for name in room.__all__:
            thing = getattr(room, name)
            if inspect.isfunction(thing):
                yield f"{prefix}.{name}", inspect.unwrap(thing)


FUNCTIONS = dict(exported())


def raises(function: Callable) -> bool:
    """Whether the code of a function has a `raise`."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    return any(isinstance(node, ast.Raise) for node in ast.walk(tree))


def called(function: Callable) -> Iterator[Callable]:
    """The functions of the package that a function calls by name, and what makes the objects that it makes."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    body = [node for statement in tree.body[0].body for node in ast.walk(statement)]
    for node in body:
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
            continue
        thing = inspect.unwrap(function.__globals__.get(node.func.id, len))
        if not getattr(thing, "__module__", "").startswith("pas.") or thing.__module__ == "pas.limits":
            continue
        makers = [vars(thing).get("__post_init__"), vars(thing).get("__init__")] if inspect.isclass(thing) else [thing]
        yield from (m for m in makers if inspect.isfunction(m) and "<string>" not in m.__code__.co_filename)


def test_there_are_functions():
    assert len(FUNCTIONS) > 60
    assert raises(FUNCTIONS["pas.plane"])
    assert not raises(FUNCTIONS["solid.ball"])
    assert any(raises(g) for g in called(FUNCTIONS["solid.ball"]))


def errors_are_named(name: str, function: Callable, text: str) -> Iterator[str]:
    """A function that raises, or calls what does, says so: each error of its own code by name."""
    if (raises(function) or any(raises(other) for other in called(function))) and "raises" not in text.lower():
        yield f"{name} may raise; its docstring has no `Raises ...`"
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and isinstance(node.exc.func, ast.Name):
            error = node.exc.func.id
            if error[0].isupper() and error not in CHECKS and error not in text:
                yield f"{name} raises {error}, which its docstring does not name"


def arrays_have_shapes(name: str, function: Callable, text: str) -> Iterator[str]:
    """Where an array goes in or comes out, its shape stands in the docstring, as `(..., 3)`."""
    hints = inspect.get_annotations(function)
    arrays = [n for n, hint in hints.items() if any(w in str(hint) for w in ("ArrayLike", "Floats", "ndarray"))]
    if arrays and not SHAPE.search(text):
        yield f"{name} has no shapes of {', '.join(arrays)}"


def parameters_are_not_anything(name: str, function: Callable, text: str) -> Iterator[str]:
    """`Any` says nothing of what a parameter takes."""
    for parameter, hint in inspect.get_annotations(function).items():
        if parameter != "return" and not VERBS.fullmatch(name) and hint in ("Any", typing.Any):
            yield f"{name}: {parameter} may be Any; say what it takes"


def lengths_and_angles_have_units(name: str, function: Callable, text: str) -> Iterator[str]:
    """Where a length or an angle goes in by name, the docstring says what it is counted in."""
    parameters = set(inspect.signature(function).parameters)
    if parameters & LENGTHS and "model's unit" not in text:
        yield f"{name} has no units of {', '.join(sorted(parameters & LENGTHS))}"
    if parameters & ANGLES and not re.search(r"\bradians?\b|\bdegrees?\b", text):
        yield f"{name} has no units of {', '.join(parameters & ANGLES)}"


def methods_have_sources(name: str, function: Callable, text: str) -> Iterator[str]:
    """Where a method is somebody's, the docstring of the function says whose, as the head of its file does."""
    head = inspect.getdoc(inspect.getmodule(function)) or ""
    if (SOURCE.search(head) or name in METHODS) and not SOURCE.search(text):
        yield f"{name} does not say whose method it is: {SOURCE.findall(head)}"


RULES = (
    *(errors_are_named, arrays_have_shapes, parameters_are_not_anything, lengths_and_angles_have_units),
    methods_have_sources,
)


@pytest.mark.parametrize("rule", RULES)
def test_docstrings(rule):
    wrong = [line for name, f in FUNCTIONS.items() for line in rule(name, f, inspect.getdoc(f) or "")]
    assert not wrong, "\n".join(wrong)


def without_error(radius: float, points: ArrayLike, x: Any):  # noqa: F821
    """Says nothing."""
    raise ValueError("no")


@pytest.mark.parametrize("rule", RULES[:4])
def test_rules_find_what_is_missing(rule):
    assert list(rule("without_error", without_error, inspect.getdoc(without_error)))


def test_sources_are_told_from_other_numbers():
    cited = (
        "Levin 1976",
        "Spitzbart (1960)",
        "Perez-Diaz and Sendra (2003, theorem 9)",
        "O'Shea 2015",
        "Hu et al. 2020",
    )
    assert all(SOURCE.search(text) for text in cited)
    assert not any(SOURCE.search(text) for text in ("at most 2000 triangles", "GC^2", "in 1976 steps", "Raises 10"))
