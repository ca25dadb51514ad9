"""Documents as text to copy: problem files (TOML) and programs that make the same shape.

The studio solves what the problem file says, read by the reader of problem files; the program says the same by the
public verbs, or holds the file where it has tables that no verb takes.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from pas.contacts.contact import CONTACTS
from pas.layouts.kinds import LAYOUTS

BARE = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML takes without quotes."""

VERBATIM = {"name", "order", "degree", "tension", "points", "tolerance", "mesh", "picture"}
"""Keys of a problem of contacts that a call of `pas.blend` says, or that do not matter to the shape."""

NONE: tuple[Any, ...] = ([], {})
"""What says nothing, as it is left where all of something was taken out again."""


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
