"""Every number and text of every kind of project file, changed by itself: refused, found anew, or what a user may say.

`KEPT` lists what a file may say otherwise, with the reason why nothing is claimed then that is not proved of it.
"""

from __future__ import annotations

import copy
import fnmatch
import json
from collections.abc import Iterator
from fractions import Fraction
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import pytest
from file_cases import Base, further, projects
from file_mutations import as_project

import pas
from pas.shape import KINDS

DEFINES = "defines another shape, of which all is proved anew"
WISH = "what was asked of the choice, which is claimed nowhere"
NAME = "a name, a title or a colour"
GIVEN = "how a curve may have been given, which is turned to run as it does"
TOLD = "marked where it is printed as what the file tells"

SURFACE = {
    "partition.title": NAME,
    "partition.*": DEFINES,
    "contacts.*": DEFINES,
    "order": DEFINES,
    "degree": DEFINES,
    "patches.*": DEFINES,
}
BLEND = {
    **{f"surface.{path}": reason for path, reason in SURFACE.items()},
    "problem.*": WISH,
    "solution.energy": TOLD,
    "solution.attempts.*": TOLD,
    "solution.attempt_seconds.*": TOLD,
    "solution.attempt_partitions.*": TOLD,
    "solution.seconds.*": TOLD,
}
SOLID = {
    "functions.*": DEFINES,
    "tree.*": DEFINES,
    "joints.*": DEFINES,
    "special_points.*": DEFINES,
}
MESH = {"names.*": NAME, "*": DEFINES}
PART = {
    "name": NAME,
    "color": NAME,
    **{f"solid.{path}": reason for path, reason in SOLID.items()},
    **{f"mesh.{path}": reason for path, reason in MESH.items()},
}
PARAMETRIC = {"parameters.*": NAME, "*": DEFINES}
GENERATRIX = {"table.name": NAME, "*": DEFINES}

KEPT: dict[str, dict[str, str]] = {
    "blend": BLEND,
    "hollow blend": {f"{side}.{path}": reason for side in ("outer", "inner") for path, reason in BLEND.items()},
    "surface": {f"surface.{path}": reason for path, reason in SURFACE.items()},
    "layout": {"layout.name": NAME, "layout.*": DEFINES},
    "mesh": {f"mesh.{path}": reason for path, reason in MESH.items()},
    "solid": {f"solid.{path}": reason for path, reason in SOLID.items()},
    "assembly": {f"parts.N.{path}": reason for path, reason in PART.items()},
    "part": {f"part.{path}": reason for path, reason in PART.items()},
    "teapot": {f"{name}.{path}": r for name in ("solid", "pot", "lid") for path, r in SOLID.items()} | {"style": NAME},
    "parametric surface": {f"surface.{path}": reason for path, reason in PARAMETRIC.items()},
    "parametric blend": {
        **{f"surfaces.N.{path}": reason for path, reason in PARAMETRIC.items()},
        **dict.fromkeys(("values.*", "order", "options.*", "domain.*", "components.*"), DEFINES),
    },
    "rational patch": dict.fromkeys(("points.*", "weights.*", "knots.*"), DEFINES),
    "generatrix blend": {
        **{f"boundaries.N.{path}": reason for path, reason in GENERATRIX.items()},
        **dict.fromkeys(("signs.*", "unit", "shape.*"), DEFINES),
        **dict.fromkeys(("alignment.reversed", "alignment.shift"), GIVEN),
    },
    "network": {
        **{f"blends.N.{path}": reason for path, reason in BLEND.items()},
        **dict.fromkeys(("grid", "points.*", "edges.*", "radii.*", "sizes.*", "order"), DEFINES),
    },
    "sphere blend": {
        **{f"boundaries.N.{path}": reason for path, reason in GENERATRIX.items()},
        **dict.fromkeys(("center.*", "radius", "angles.*", "shapes.*"), DEFINES),
    },
}
"""By kind and path (N for any place in a list, * for any path); what is not here is refused or found anew."""

SLOW = ("hollow", "teapot", "elbow", "node", "given", "hollow blend", "hollow blend of given contacts")
"""Files that take long to read or to prove, of kinds of which there is another."""


@cache
def bases() -> dict[str, Base]:
    """The good files by name."""
    return {base.name.removesuffix(".pas.json"): base for base in (*projects(), *further())}


NAMES = (
    *("corner", "elbow", "joined", "part", "bent", "hollow", "body", "assembly", "surface", "waves", "neck"),
    *("weighted", "quadrics", "patches", "through", "net", "tetra", "hollow blend", "hollow blend of given contacts"),
    *("wished", "given", "layout", "node", "a part", "teapot", "network"),
)


def leaves(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all numbers, texts and truth values."""
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from leaves(value, (*path, key))
    elif data is not None:
        yield path


MANY, EVERY = 30, 9
"""Of more fields than that, one in so many is changed where few are asked for."""


def chosen(content: Any, few: bool) -> list[tuple[Any, ...]]:
    """Of fields that differ in their places in lists alone, the first one, or also the last."""
    by_pattern: dict[str, list[tuple[Any, ...]]] = {}
    for path in leaves(content):
        by_pattern.setdefault(pattern(path), []).append(path)
    if few:
        first = [same[0] for same in by_pattern.values()]
        return first[:: EVERY if len(first) > MANY else 1]
    return [path for same in by_pattern.values() for path in dict.fromkeys((same[0], same[-1]))]


def pattern(path: tuple[Any, ...]) -> str:
    return ".".join("N" if isinstance(key, int) else str(key) for key in path)


def others(value: Any) -> tuple[Any, ...]:
    """Other values of a field, a near one and one of another sign or sort."""
    if isinstance(value, bool):
        return (not value,)
    if isinstance(value, int | float):
        return value + 1, -value - 1
    number = exact(value)
    if number is not None:
        return str(number + Fraction(1, 7)), str(-number - 1)
    middle = len(value) // 2
    return value + "1", value[:middle] + ("B" if value[middle : middle + 1] == "A" else "A") + value[middle + 1 :]


def exact(text: str) -> Fraction | None:
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None


def at(content: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        content = content[key]
    return content


def put(content: Any, path: tuple[Any, ...], value: Any) -> Any:
    changed = copy.deepcopy(content)
    at(changed, path[:-1])[path[-1]] = value
    return changed


def reason(kind: str, path: str) -> str:
    """Why a file may say otherwise there; empty where it may not."""
    return next((why for known, why in KEPT[kind].items() if fnmatch.fnmatchcase(path, known)), "")


def outcome(content: Any, path: tuple[Any, ...], value: Any, folder: Path) -> str:
    """What is wrong with how a changed file is read; empty where it is refused, found anew, or may be kept."""
    file, kind = folder / "a.pas.json", content["kind"]
    file.write_bytes(as_project(put(content, path, value)))
    try:
        shape = pas.load(file)
    except pas.ProjectFileError as error:
        return "" if len(str(error)) > 30 else f"refused in few words: {error}"
    why = reason(kind, pattern(path))
    if why in (DEFINES, NAME, WISH, GIVEN):
        return ""
    again = json.loads(shape.save(folder / "b.pas.json").read_text())["content"]
    if why == TOLD:
        before = lines(printed(json.dumps(content), folder))
        new = [line for line in lines(str(shape)) if not any(old.startswith(line) for old in before)]  # or says less
        unmarked = [line for line in new if "as its file tells" not in line]
        return f"printed as if it were so: {unmarked}" if unmarked else ""
    return "" if again == content else f"kept, and nobody knows why: {value!r}"


def lines(text: str) -> list[str]:
    """The lines of a summary, however wide its columns are."""
    return [" ".join(line.split()) for line in text.splitlines()]


@lru_cache(maxsize=1)
def printed(content: str, folder: Path) -> str:
    """What is printed of a file as it was."""
    (folder / "c.pas.json").write_bytes(as_project(json.loads(content)))
    return str(pas.load(folder / "c.pas.json"))


def wrongs(name: str, folder: Path, few: bool) -> list[str]:
    """What is wrong with the changes of a file: those of the first of many places and to one value, or more."""
    content = bases()[name].data
    return [
        f"{'.'.join(map(str, path))}: {words}"
        for path in chosen(content, few)
        if path != ("kind",)
        for value in others(at(content, path))[: 1 if few else None]
        if (words := outcome(content, path, value, folder))
    ]


@pytest.mark.parametrize("name", [n for n in NAMES if n not in SLOW])
def test_every_field_is_refused_found_anew_or_may_be_said(name, tmp_path):
    assert not wrongs(name, tmp_path, few=True)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_field_changed_in_several_ways(name, tmp_path):
    assert not wrongs(name, tmp_path, few=False)


def test_every_kind_has_a_file_and_says_what_it_keeps():
    assert set(NAMES) == set(bases())
    assert {base.data["kind"] for base in bases().values()} == set(KEPT) == set(KINDS)
