"""Reading TOML: exact numbers, and errors that name the file and the line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

from pas.algebra.inputs import DEEPEST, depth, shown
from pas.algebra.rational import rational, read_number, to_float, to_fraction
from pas.errors import ProblemFileError, meant
from pas.exchange.files import read_text, source

MOST_BYTES = 1 << 22
"""Of a problem file: the longest example has 5000, and tomllib reads about a million a second."""


def read_toml(path: str | Path) -> tuple[Path, str, dict[str, Any]]:
    """A TOML file: its path, text and data, decimals as fractions.

    Raises `ProblemFileError` with the line for syntax errors, `FileNotFoundError`.
    """
    file = source(path)
    text = read_text(file, MOST_BYTES, ProblemFileError)
    try:
        data = tomllib.loads(text, parse_float=_decimal)
    except RecursionError:
        raise ProblemFileError(f"{file.name}: lists are nested more than {DEEPEST} deep") from None
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        number = int(line.group(1)) if line else text.count("\n") + 1
        reason = re.sub(r" \(at .*\)", "", str(error))
        raise ProblemFileError(f"{file.name}, line {number}: {_lower(reason)}", number) from None
    except ValueError as error:
        raise _bad_number(file, text, error) from None
    if depth(data) > DEEPEST:
        raise ProblemFileError(f"{file.name}: lists are nested more than {DEEPEST} deep")
    return file, text, data


class TableReader:
    """What readers of problem files share.

    By section ("" is the whole file): the `keys` that there are and those `required`; `lists` are keys of lists of
    tables.
    """

    keys: ClassVar[Mapping[str, set[str]]]
    required: ClassVar[Mapping[str, set[str]]]
    lists: ClassVar[set[str]]

    def __init__(self, file: Path, text: str) -> None:
        self.file, self.lines = file, text.splitlines()

    def check(self, table: Any, section: str, index: int) -> None:
        """That a table is one, has only known keys and all that it needs, of the right shape."""
        name = f"[{section}]" if section else "the file"
        if not isinstance(table, dict):
            raise self.error(f"{section} must be a table, written [{section}] or [[{section}]]", "", 0, section)
        for key, value in table.items():
            if key not in self.keys[section]:
                near = meant(key, self.keys[section]) or f"; known are {', '.join(sorted(self.keys[section]))}"
                raise self.error(f"unknown key {key!r} in {name}{near}", section, index, key)
            if not section and key in self.lists and not isinstance(value, list):
                raise self.error(f"{key} must be a list of tables, written [[{key}]]", "", 0, key)
        for key in sorted(self.required.get(section, set()) - set(table)):
            raise self.error(f"{name} has no {key!r}, which it needs", section, index)

    def name(self, data: dict[str, Any]) -> str:
        """The problem's name, by default that of the file."""
        name: str = self.typed(data, "name", str, self.file.name.removesuffix(".toml"))
        if Path(name).name != name or name in ("", ".", "..") or not name.isprintable():
            raise self.error(f"name must be a plain file name without folders, not {shown(name)}", "", 0, "name")
        return name

    def typed(self, data: dict[str, Any], key: str, kind: Any, default: Any) -> Any:
        """A value of the whole file, of the right type."""
        value = data.get(key, default)
        if key in data and (not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)):
            words = {int: "a whole number", str: "a string", bool: "true or false"}.get(kind, "a number")
            raise self.error(f"{key} must be {words}, not {shown(_as_written(value))}", "", 0, key)
        return value

    def checked(self, data: dict[str, Any], key: str, door: Callable[[Any], Any], default: Any) -> Any:
        """A value of the whole file as a door of `pas.algebra.inputs` lets it in."""
        if key not in data:
            return default
        try:
            return door(_as_written(data[key]))
        except (ValueError, TypeError) as error:
            raise self.error(str(error), "", 0, key) from None

    def error(self, reason: str, section: str, index: int, key: str | None = None) -> ProblemFileError:
        """An error that names the file and, where it can be found, the line."""
        line = self._line(section, index, key)
        place = f", line {line}" if line else ""
        return ProblemFileError(f"{self.file.name}{place}: {reason}", line)

    def _line(self, section: str, index: int, key: str | None) -> int | None:
        """The 1-based line of a key, or of its table's heading, as far as it can be found."""
        current, heading = "", None
        seen: dict[str, int] = {}
        for number, line in enumerate(self.lines, start=1):
            header = re.match(r"\s*\[\[?\s*([\w.-]+)\s*\]\]?", line)
            if header:
                current = header.group(1)
                seen[current] = seen.get(current, -1) + 1
                if key == current and not section:
                    return number
            if current == section and seen.get(current, 0) == index:
                heading = heading or number
                if key and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
                    return number
        return heading if section else None


def _lower(text: str) -> str:
    return text[:1].lower() + text[1:]


def _decimal(text: str) -> Fraction | float:
    """A decimal exactly as written; nan and inf are left for those who use them to refuse."""
    if text.strip("+-") in ("nan", "inf"):
        return float(text)
    try:
        return to_fraction(read_number(text))
    except ValueError as error:
        raise ValueError(f"the number {shown(text)} {error}", text) from None


def _bad_number(file: Path, text: str, error: ValueError) -> ProblemFileError:
    """The error for a number that Python or `_decimal` does not take, with its line."""
    long = re.search(r"[0-9][0-9_]{4300,}", text)
    reason, literal = error.args if len(error.args) == 2 else ("a whole number has more than 4300 digits", "")
    literal = literal or (long.group() if long else "")
    number = text[: text.find(literal)].count("\n") + 1
    return ProblemFileError(f"{file.name}, line {number}: {reason}", number)


def _as_written(value: Any) -> Any:
    """A decimal as a double, in which tolerances and sentences have it."""
    return to_float(rational(value)) if isinstance(value, Fraction) else value
