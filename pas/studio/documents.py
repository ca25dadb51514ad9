"""Documents: all that a page is about, as plain data that an address, a message and a project file can hold.

A document is a table with a `kind`:

    {"kind": "problem", "problem": {...}}             the tables of a problem file, exact numbers as texts
    {"kind": "teapot", "values": {...}}               the arguments of `pas.teapot`
    {"kind": "project", "name": "...", "sliders": {}} a shape from a project file, and for blends what was moved since

A kind knows how to find its shape, what may be dragged, and which texts to copy.  Nothing in a document is a path that
is opened, and nothing is executed.

The texts are problem files (TOML) and programs that make the same shape.  The studio solves what the problem file says,
read by the reader of problem files; the program says the same by the public verbs, or holds the file where it has
tables that no verb takes.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from pas.algebra.inputs import DEEPEST, depth, shown
from pas.algebra.rational import plain, rational
from pas.contacts.contact import CONTACTS
from pas.designs.teapot import teapot
from pas.errors import InputError, ProblemFileError
from pas.exchange.problem import PROBLEMS, Problem
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT, MeanAlpha
from pas.layouts.kinds import LAYOUTS
from pas.pipeline.result import Blend
from pas.registry import Registry
from pas.shape import Shape
from pas.studio import TEAPOT, Data
from pas.studio.controls import OF_DEGREE, TENSION

BARE = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML takes without quotes."""

VERBATIM = {"name", "order", "degree", "tension", "points", "tolerance", "mesh", "picture"}
"""Keys of a problem of contacts that a call of `pas.blend` says, or that do not matter to the shape."""

NONE: tuple[Any, ...] = ([], {})
"""Values that say nothing, as they are left where all of something was taken out again."""


def toml(problem: Mapping[str, Any]) -> str:
    """A problem as a problem file: numbers and texts first, then tables."""
    lines = [f"{_key(name)} = {_value(value)}" for name, value in problem.items() if not _table(value)]
    for name, value in problem.items():
        if not _table(value):
            continue
        for entry in value if isinstance(value, list) else [value]:
            title = f"[[{_key(name)}]]" if isinstance(value, list) else f"[{_key(name)}]"
            lines += ["", title, *(f"{_key(k)} = {_value(v)}" for k, v in entry.items())]
    return "\n".join(lines) + "\n"


def _table(value: Any) -> bool:
    """Whether it is a table, or a list of tables."""
    return isinstance(value, Mapping) or (isinstance(value, list) and bool(value) and isinstance(value[0], Mapping))


def _key(name: str) -> str:
    return name if BARE.fullmatch(name) else json.dumps(name)


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)  # true, false, numbers and texts are written alike


def program(problem: Mapping[str, Any]) -> str:
    """A program that makes the shape of a problem as `shape`."""
    tables = {name for name in CONTACTS if name in problem}
    layout = problem.get("partition")
    named = layout is None or (set(layout) == {"kind"} and layout["kind"] in LAYOUTS)
    if not tables or not named or not set(problem) - tables - {"partition"} <= VERBATIM:
        return _program_of_file(problem)
    if not all(CONTACTS[table].__module__.startswith("pas.") for table in tables):  # classes of a user's own
        return _program_of_file(problem)
    contacts = [f"    {_made(table, entry)}," for table in CONTACTS for entry in problem.get(table, [])]
    options = [f"order={problem['order']}"]
    options += [f"{name}={literal(problem[name])}" for name in ("degree", "tension") if name in problem]
    options += [] if layout is None else [f"partition={literal(layout['kind'])}"]
    options += [
        f"{name}={wished(name, value)}" for name, value in problem.get("points", {}).items() if value not in NONE
    ]
    lines = ["import pas", "", "contacts = [", *contacts, "]", f"shape = pas.blend(contacts, {', '.join(options)})"]
    return "\n".join([*lines, "print(shape)"]) + "\n"


def _made(table: str, entry: Mapping[str, Any]) -> str:
    arguments = ", ".join(f"{name}={literal(value)}" for name, value in entry.items())
    return f"pas.{CONTACTS[table].__name__}({arguments})"


def wished(name: str, value: Any) -> str:
    """Python for one of the points, handles or coefficients of a problem."""
    if name == "handles":
        return "{" + ", ".join(f"{literal(handle)}: {literal(number)}" for handle, number in value) + "}"
    if name == "coefficients":
        return "{" + ", ".join(f"{int(member)}: {literal(number)}" for member, number in value.items()) + "}"
    return literal(value)


def literal(value: Any) -> str:
    """Python for plain data; lists of numbers become tuples."""
    if isinstance(value, list | tuple):
        inner = ", ".join(map(literal, value))
        points = bool(value) and isinstance(value[0], list | tuple)
        return f"[{inner}]" if points else f"({inner},)" if len(value) == 1 else f"({inner})"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def _program_of_file(problem: Mapping[str, Any]) -> str:
    text, name = toml(problem), f"{problem.get('name', 'problem')}.toml"
    quoted = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    return (
        f'from pathlib import Path\n\nimport pas\n\nPath({literal(name)}).write_text("""\\\n{quoted}""")\n'
        f"shape = pas.read_problem({literal(name)}).solve()\nprint(shape)\n"
    )


SLIDERS = ("tension", "points")
"""Parts of a problem of contacts that `Blend.refit` follows."""

PLACE = re.compile(r"^problem\.toml(, line \d+)?: ")
"""The prefix of sentences of the reader of files: a page has no lines."""

Opened = Mapping[str, Shape]
"""Shapes from project files, by name."""


@dataclass(frozen=True)
class DocumentKind:
    """`solve(document, opened)`: the shape; `python`, `toml`: texts to copy, None where there is none."""

    check: Callable[[Data], None]
    solve: Callable[[Data, Opened], Shape]
    python: Callable[[Data], str]
    toml: Callable[[Data], str | None] = lambda _: None


def checked(document: Any) -> Data:
    """A document; raises `InputError` for what is none."""
    if not isinstance(document, dict) or depth(document) > DEEPEST:
        raise InputError("a document must be a table with a kind")
    kind = document.get("kind")
    if kind not in DOCUMENTS:
        raise InputError(DOCUMENTS.unknown(kind))
    DOCUMENTS[kind].check(document)
    return cast(Data, document)


def solve(document: Data, opened: Opened) -> Shape:
    """The shape of a document, as its problem is solved; raises what that raises."""
    return DOCUMENTS[document["kind"]].solve(document, opened)


def problem_of(problem: Data) -> Problem:
    """A problem as its file is read; raises `InputError` with what the reader of files says, less the line."""
    text = toml(problem)
    try:
        data = tomllib.loads(text, parse_float=Fraction)
        kind = next(kind for kind in PROBLEMS.values() if kind.fits(data))
        return kind.read(Path("problem.toml"), text, data)
    except (ProblemFileError, tomllib.TOMLDecodeError) as error:
        raise InputError(PLACE.sub("", str(error))) from None


def plain_tables(value: Any) -> Any:
    """The data of a problem file with decimals as numbers, or as texts where a double has not as many digits."""
    if isinstance(value, dict):
        return {name: plain_tables(entry) for name, entry in value.items()}
    if isinstance(value, list):
        return [plain_tables(entry) for entry in value]
    if isinstance(value, Fraction):
        return near if Fraction(repr(near := float(value))) == value else str(value)
    return value


def base_of(document: Data) -> Data:
    """The document without what can be moved on a blend that is there."""
    if document["kind"] == "problem":
        rest = {name: value for name, value in document["problem"].items() if name not in SLIDERS}
        return {**document, "problem": rest}
    return {**document, "sliders": {}} if document["kind"] == "project" else document


def sliders_of(document: Data) -> dict[str, Any]:
    """The moved sliders, as the keywords of `Blend.refit`."""
    held = document["problem"] if document["kind"] == "problem" else document.get("sliders", {})
    moved = dict(held.get("points", {}))
    moved = {name: [tuple(p) for p in value] if isinstance(value, list) and name != "near_weight" else value
             for name, value in moved.items() if value not in NONE}  # fmt: skip
    return moved | ({"tension": held["tension"]} if "tension" in held else {})


def all_sliders(blend: Any, document: Data) -> dict[str, Any]:
    """All sliders of a document, those that it does not name at rest."""
    usual: dict[str, Any] = {}
    if document["kind"] != "project":  # a file has its own wishes
        points = dict.fromkeys(("inside", "outside", "through", "near", "handles", "coefficients"), ())
        tense = {"tension": TENSION} if isinstance(blend.plate, CurvatureVariation) else {}
        usual = {**points, "near_weight": DEFAULT_NEAR_WEIGHT, **tense}
    if document["kind"] != "project" and isinstance(blend.wishes.normalize, MeanAlpha):
        usual["margin"] = None
    return usual | sliders_of(document)


def remedies(document: Data, shape: Any) -> Iterator[Data]:
    """Documents to try in turn: with proofs asked for, a guarded witness, lighter weights, higher degrees."""
    problem = {name: value for name, value in document["problem"].items() if name not in ("prove", "guard")}
    document = {**document, "problem": problem}
    yield document
    points = problem.get("points", {})
    failed = [v.witness for v in shape.certificate.verdicts if v.failed and v.witness is not None]
    for kind in ("outside", "inside") if failed else ():
        witnesses = [[repr(round(c, 6)) for c in place] for place in failed]
        yield _with(document, points={**points, kind: [*points.get(kind, []), *witnesses]})
    if points.get("near") and not isinstance(points.get("near_weight", ""), list):
        for share in (10, 100):
            weight = rational(points.get("near_weight", DEFAULT_NEAR_WEIGHT)) / share
            yield _with(document, points={**points, "near_weight": plain(weight)})
    for more in (1, 2) if not any(points.get(name) for name in OF_DEGREE) else ():
        yield _with(document, degree=shape.surface.degree + more)


def _with(document: Data, **changed: Any) -> Data:
    return {**document, "problem": {**document["problem"], **changed}}


def _check_problem(document: Data) -> None:
    if not isinstance(document.get("problem"), dict):
        raise InputError(f"a problem must be a table, not {shown(document.get('problem'))}")


def _check_teapot(document: Data) -> None:
    values = document.get("values")
    if not isinstance(values, dict) or not set(values) <= set(TEAPOT):
        raise InputError(f"a teapot has the values {', '.join(TEAPOT)}, not {shown(values)}")


def _check_project(document: Data) -> None:
    if not isinstance(document.get("name"), str) or not isinstance(document.get("sliders", {}), dict):
        raise InputError("a project has a name, and sliders as a table")


def _solve_project(document: Data, opened: Opened) -> Shape:
    if document["name"] not in opened:
        raise InputError(f"the project {document['name']} is not open here; open its file again")
    shape, moved = opened[document["name"]], sliders_of(document)
    return cast(Blend, shape).refit(steps=None, **moved) if moved else shape


def _project_program(document: Data) -> str:
    moved = ", ".join(f"{name}={wished(name, value)}" for name, value in sliders_of(document).items())
    refit = f".refit(steps=None, {moved})" if moved else ""
    return f"import pas\n\nshape = pas.load({literal(document['name'])}){refit}\nprint(shape)\n"


def _teapot_program(document: Data) -> str:
    options = ", ".join(f"{name}={literal(value)}" for name, value in document["values"].items())
    return f"import pas\n\nshape = pas.teapot({options})\nprint(shape)\n"


DOCUMENTS: Registry[DocumentKind] = Registry(
    "kind of document",
    {
        "problem": DocumentKind(
            _check_problem,
            lambda document, _: problem_of(document["problem"]).solve(),
            lambda document: program(document["problem"]),
            lambda document: toml(document["problem"]),
        ),
        "teapot": DocumentKind(
            _check_teapot, lambda document, _: teapot(**(TEAPOT | document["values"])), _teapot_program
        ),
        "project": DocumentKind(_check_project, _solve_project, _project_program),
    },
)
"""All kinds of documents."""
