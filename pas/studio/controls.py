"""The controls of a document: one description for each, from which the page makes it.

A control has a `path` into the document, a `label` and a `group`.  Its `kind` is "number" (a slider from `low` to
`high`, and a field that takes any exact number), "vector" (three of them), "choice" (of `options`, pairs of a value and
its name; the value None leaves the key out; what is at the paths `frees` goes with another choice), "text" (a formula),
or "points"; those of `pas.studio.handles` come to them.  `usual` is what holds where the document
says nothing; of `safe` ones the largest safe value can be asked for, and is marked.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, log2
from typing import Any

from pas.algebra.inputs import HIGHEST_DEGREE
from pas.algebra.rational import rational, to_float
from pas.contacts.contact import CONTACTS
from pas.studio import TEAPOT, Data

Control = dict[str, Any]

TENSION = "23/5"
FULLEST, SLIMMEST = 0, 40
"""Tensions at the ends of the slider; the usual one looks as if it were in the middle, since the slider is bent."""

HIGHEST_ORDER = 4
SIGNED = ("slope",)
"""Numbers of contacts that may be negative as well."""

OF_BOUNDARIES = ("quadric", "plane", "implicit", "other", "x", "y", "z")
OF_DEGREE = ("handles", "coefficients")
"""The wishes for members of one degree, which mean nothing in another."""

SHAPE = {"l1": (0, 5), "l2": (0, 5), "lambda1": (-2, 2), "lambda2": (-2, 2)}
LENGTHS = ("l1", "l2")
RANGES = {"lid_height": (1.1, 1.9), "spout_tilt": (-0.3, 0.5), "handle_size": (0.7, 1.3)}


def controls(document: Data) -> list[Control]:
    """All controls of a document, in the order in which they are shown."""
    return list(_OF_KIND[document["kind"]](document))


def _problem(document: Data) -> Iterator[Control]:
    problem = document["problem"]
    tables = [name for name in CONTACTS if name in problem]
    if not tables:
        yield from _generatrix(problem)
        return
    largest = _size(problem)
    for table in tables:
        for number, entry in enumerate(problem[table]):
            title = f"{getattr(CONTACTS[table], 'noun', table.removesuffix('s').replace('_', ' '))} {number + 1}"
            yield from _of_contact(entry, ["problem", table, number], title.capitalize(), largest)
    orders = [[k, f"GC{'⁰¹²³⁴'[k]}"] for k in range(1, HIGHEST_ORDER + 1)]
    others = {"kind": "choice", "group": "Surface", "frees": [["problem", "points", name] for name in OF_DEGREE]}
    yield {**others, "path": ["problem", "order"], "label": "contact", "options": orders}
    degrees: list[list[Any]] = [[None, "the fairest"], ["lowest", "the lowest"]]
    degrees += [[n, str(n)] for n in range(2 + problem.get("order", 1), min(HIGHEST_DEGREE, 10) + 1)]
    yield {**others, "path": ["problem", "degree"], "label": "degree", "options": degrees}
    curved = "energy" not in problem and problem.get("partition", {}).get("kind") != "single cell"
    yield from _shaping(["problem"], curved)


def _of_contact(entry: Data, path: list[Any], group: str, largest: float) -> Iterator[Control]:
    """Controls of a contact of any class, by what the entries of its table are: numbers, formulas, vectors."""
    numbers = [key for key, value in entry.items() if _exact(value) is not None]
    for key in numbers:
        low = -largest if key in SIGNED or _number(entry[key]) <= 0 else 0
        yield _number_control([*path, key], key, group, low, largest)
    for key, value in entry.items():
        if isinstance(value, str) and key not in numbers:
            yield _text([*path, key], key, group)
    for key, value in entry.items():
        several = isinstance(value, list) and all(map(_is_vector, value))
        for place, vector in enumerate(value if several else [value]):
            if _is_vector(vector):
                where, label = ([*path, key, place], f"{key} {place + 1}") if several else ([*path, key], key)
                yield {"kind": "vector", "path": where, "label": label, "group": group, "low": -largest,
                       "high": largest}  # fmt: skip


def _is_vector(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(_exact(part) is not None for part in value)


def _shaping(path: list[Any], tense: bool = True) -> Iterator[Control]:
    if tense:
        yield {"kind": "number", "path": [*path, "tension"], "label": "tension", "group": "Shape", "low": FULLEST,
               "high": SLIMMEST, "usual": TENSION, "bent": 3, "ends": ["full", "slim"]}  # fmt: skip
    yield {"kind": "points", "path": [*path, "points"], "label": "points", "group": "Points"}


def _generatrix(problem: Data) -> Iterator[Control]:
    if "boundaries" not in problem:
        return
    for name, (low, high) in SHAPE.items():
        usual = "1" if name in LENGTHS else "0"
        value = problem.get("shape", {}).get(name, usual)
        if not isinstance(value, list | dict):
            control = _number_control(["problem", "shape", name], name, "Generatrix", low, high)
            yield control | {"usual": usual, "safe": name in LENGTHS}
        elif isinstance(value, dict):
            for part in ("low", "high"):
                path = ["problem", "shape", name, part]
                yield _number_control(path, f"{name}, {part}", "Generatrix", low, high)

    middle = problem.get("shape", {}).get("middle")
    for place, axis in enumerate("xyz") if isinstance(middle, list) else ():
        yield _text(["problem", "shape", "middle", place], f"middle {axis}", "Generatrix")
    for number, boundary in enumerate(problem["boundaries"]):
        for key in OF_BOUNDARIES:
            if isinstance(boundary.get(key), str):
                yield _text(["problem", "boundaries", number, key], key, f"Boundary {number + 1}")


def _text(path: list[Any], label: str, group: str) -> Control:
    return {"kind": "text", "path": path, "label": label, "group": group}


def _teapot(_: Data) -> Iterator[Control]:
    for name, (low, high) in RANGES.items():
        control = _number_control(["values", name], name.replace("_", " "), "Teapot", low, high)
        yield control | {"usual": TEAPOT[name], "slow": True}


def _project(document: Data) -> Iterator[Control]:
    if document.get("blend"):
        yield from _shaping(["sliders"])


def _number_control(path: list[Any], label: str, group: str, low: float, high: float) -> Control:
    return {"kind": "number", "path": path, "label": label, "group": group, "low": low, "high": high}


def _size(problem: Data) -> float:
    """One that is not below any clip or radius."""
    numbers = [
        abs(_number(value))
        for table in CONTACTS
        for entry in problem.get(table, [])
        for value in entry.values()
        if _exact(value) is not None
    ]
    return rounded(1.2 * max([*numbers, 1e-6]))


def rounded(wide: float) -> float:
    """The power of two above, so that the ends of sliders stay when values change a little."""
    return float(2.0 ** ceil(log2(wide)))


def _number(value: Any) -> float:
    """A number as a float; 1 for what is none."""
    found = _exact(value)
    return 1.0 if found is None else found


def _exact(value: Any) -> float | None:
    """A number as a float; None for a word, a formula, or a mistake that the reader of problems names."""
    try:
        return to_float(rational(value))
    except (ValueError, TypeError):
        return None


_OF_KIND = {"problem": _problem, "teapot": _teapot, "project": _project}
