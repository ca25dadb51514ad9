"""Seeded changes of files: of what they say, with the checksum made right, and of their characters."""

from __future__ import annotations

import contextlib
import copy
import json
import math
import random
import sys
from collections.abc import Iterator
from typing import Any

from file_cases import Base

from pas.exchange.files import checksum

TOWER = "((((9^60)^60)^60)^60)"
NUMBERS: tuple[Any, ...] = (
    *(0, 1, -1, 2, 3, 7, 9, 12, 13, 50, 2001, 10**6, 2**63, -(2**63), 10**30, 10**400),
    *(0.5, -0.5, 1e-3, 1e-10, 1e-40, 1e-300, 5e-324, 1e300, -1e300, 1.7976931348623157e308, 0.1),
    *(math.nan, math.inf, -math.inf),
)
TEXTS: tuple[str, ...] = (
    *("", " ", "0", "1", "-1", "1/3", "-7/2", "1/0", "0/0", "1e99999999", "1e-99999999", "1e400", "1e-400", "0.1"),
    *(
        "nan",
        "inf",
        "-inf",
        "1/3/5",
        "1_0",
        "0x10",
        "\u0661",
        "9" * 5000,
        "1/" + "7" * 5000,
        "x",
        "y",
        "t",
        "h",
        "s",
        "w",
    ),
    *(
        TOWER,
        f"x*{TOWER}",
        "x^1000000",
        "x^60*y^60*z^60",
        "(x+y+z+1)^60",
        "x^60",
        "t^60*h^60",
        "t^1000000",
        "2^-99999999",
    ),
    *(
        "x^2 + y^2 - 1/9",
        "x - 1",
        "1 - x",
        "x*y",
        "x^2",
        "(x-1)*(2*x-1)",
        "z - x^2",
        "1/x",
        "x/0",
        "1/(t-t)",
        "sqrt(t)",
    ),
    *("sin(t)", "cos(2*pi*s)", "log(0)", "exp(exp(exp(t)))", "exp(1000*t)", "x == y", "import os", "__import__('os')"),
    *("[" * 500, "(" * 500 + "x" + ")" * 500, "-" * 3000 + "x", "+".join(["x"] * 5000), "a" * 100_000, "**", "x y"),
    *("\0", "a\0b", "\ud800", "é", "\U0001f600", "../a", "/tmp/a", "a/b", ".", "..", "\n", "a\nb", "\x1b[31m"),
    *("true", "none", "null", "proved", "refuted", "single cell", "six tetrahedra", "mean-alpha", "unit-coefficients"),
    *("hermite", "weighted", "generatrix", "quadrics", "blend", "solid", "assembly", "#000000", "#00000g", "top"),
)

DEEP = 20_000
"""Calls within calls while files are made, since some are nested deeply; the worker has what Python gives it."""


def changed(base: Base, rng: random.Random) -> bytes:
    """A file made from a good one."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(DEEP)
    try:
        if rng.random() < 0.12:
            return _scribbled(base, rng)
        data = copy.deepcopy(base.data)
        for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 5))):
            data = _changed_data(data, rng)
        return as_project(data, rng) if base.is_project else as_toml(data)
    finally:
        sys.setrecursionlimit(before)


def as_project(content: Any, rng: random.Random | None = None) -> bytes:
    """A project file with a right checksum, now and then of another version."""
    record = {"format": "pas-project", "version": 1, "written_by": "pas 0", "content": content}
    if rng is not None and rng.random() < 0.03:
        record[rng.choice(list(record))] = _value(rng)
    try:
        record["sha256"] = checksum(record["content"])
    except (TypeError, ValueError, RecursionError):
        record["sha256"] = "0"
    return json.dumps(record).encode()


def as_toml(data: Any) -> bytes:
    """The text of a problem file; what TOML cannot say is left out."""
    if not isinstance(data, dict):
        data = {"order": data}
    lines = [f"{_key(k)} = {_toml(v)}" for k, v in data.items() if v is not None]
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def _key(key: Any) -> str:
    return json.dumps(str(key), ensure_ascii=False)


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_toml(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_toml(v) for v in value if v is not None) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value, ensure_ascii=True).replace("NaN", "nan").replace("Infinity", "inf").replace("e+", "e")


def _scribbled(base: Base, rng: random.Random) -> bytes:
    """The characters changed; a project file keeps its old checksum or gets a right one where it still can."""
    text = base.text
    for _ in range(rng.choice((1, 1, 2, 4))):
        place = rng.randrange(len(text) + 1)
        kind = rng.randrange(7)
        if kind == 0:
            text = text[:place]
        elif kind == 1:
            text = text[:place] + text[place + rng.randrange(1, 40) :]
        elif kind == 2:
            text = (
                text[:place]
                + rng.choice(('"', "{", "}", "[", "]", ",", "=", "\0", "1", "-", "e", "\n", "é"))
                + text[place:]
            )
        elif kind == 3:
            other = rng.randrange(len(text) + 1)
            text = text[:place] + text[other : other + rng.randrange(1, 200)] + text[place:]
        elif kind == 4:
            text = text[:place] + rng.choice("[{") * rng.choice((50, 500, 20_000)) + text[place:]
        elif kind == 5:
            old = rng.choice(("1", '"1/3"', "0", "order", "[", ": ", "x"))
            text = text.replace(
                old, rng.choice(("NaN", "nan", "1e999", "Infinity", '"', "-1", "true", "null", "[[")), 1
            )
        else:
            lines = text.splitlines(keepends=True)
            lines.insert(rng.randrange(len(lines) + 1), rng.choice(lines or [""]))
            text = "".join(lines)
    if base.is_project and rng.random() < 0.7:
        try:
            record = json.loads(text)
            record["sha256"] = checksum(record["content"])
            text = json.dumps(record)
        except (ValueError, TypeError, KeyError, RecursionError):
            pass
    made = text.encode("utf-8", "surrogatepass")
    return made + rng.choice((b"", b"", b"", b"\0", b"\xff\xfe", b"\xef\xbb\xbf"))


def _changed_data(data: Any, rng: random.Random) -> Any:
    places = list(_places(data))
    if not places:
        return _value(rng)
    holder, key = rng.choice(places)
    kind = rng.randrange(12)
    old = holder[key]
    if kind <= 3:
        holder[key] = _value(rng)
    elif kind <= 6:
        holder[key] = _near(old, rng)
    elif kind == 7:
        del holder[key]
    elif kind == 8:
        other, place = rng.choice(places)
        holder[key] = copy.deepcopy(other[place])
    elif kind == 9 and isinstance(holder, list):
        holder[key:key] = [copy.deepcopy(old)] * rng.choice((1, 2, 1000))
    elif kind == 10 and isinstance(holder, dict):
        name = rng.choice(("order", "degree", "kind", "extra", "", *map(str, holder)))
        holder[name] = holder.pop(key) if rng.random() < 0.5 else copy.deepcopy(old)
    else:
        other, place = rng.choice(places)
        with contextlib.suppress(KeyError, IndexError):
            holder[key], other[place] = other[place], copy.deepcopy(old)
    return data


def _places(data: Any) -> Iterator[tuple[Any, Any]]:
    """Every (holder, key) in it; of long lists a part, lest all changes fall on one."""
    items = list(data.items()) if isinstance(data, dict) else list(enumerate(data)) if isinstance(data, list) else []
    if len(items) > 12:
        items = [*items[:4], *items[4 :: len(items) // 6], items[-1]]
    for key, value in items:
        yield data, key
        yield from _places(value)


def _near(old: Any, rng: random.Random) -> Any:
    """Something like it: a number slightly off, a list with less or more, another text."""
    if isinstance(old, bool):
        return not old
    if isinstance(old, int):
        return rng.choice((old + 1, old - 1, -old, old * 2, old * 10**6, str(old), bool(old), 0.5))
    if isinstance(old, float):
        return rng.choice(
            (-old, old * 2, old * 1e-12, old * 1e12, old + 1, str(old), int(old) if math.isfinite(old) else 0)
        )
    if isinstance(old, str):
        off = f"{old} + 1e-40", f"{old}/3", f"-({old})", f"{old}*1e40", f"({old})^3", f"{old}{old}", old[:-1], old[::-1]
        return rng.choice((*off, f"-{old}", old.upper(), [old], old + "\0"))
    if isinstance(old, list):
        return rng.choice(
            (old[:-1], old[::-1], old + old, old * 50, [old], [], old[0] if old else 0, dict(enumerate(old)))
        )
    if isinstance(old, dict):
        return rng.choice(({}, [old], list(old.values()), list(old), {**old, "extra": 1}))
    return _value(rng)


def _value(rng: random.Random) -> Any:
    kind = rng.randrange(10)
    if kind <= 3:
        return rng.choice(NUMBERS)
    if kind <= 7:
        return rng.choice(TEXTS)
    if kind == 8:
        return rng.choice(
            (True, False, None, [], {}, [[]], [None], {"a": 1}, [0, 0, 0], [1, 2], [[0, 0, 0]], ["1/3"] * 3)
        )
    nested: Any = rng.choice((1, "x", []))
    for _ in range(rng.choice((3, 30, 300))):
        nested = [nested] if rng.random() < 0.8 else {"a": nested}
    return rng.choice((nested, [0] * 100_000, ["1/3"] * 3000, {str(i): i for i in range(3000)}))
