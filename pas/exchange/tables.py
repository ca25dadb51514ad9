"""Reading TOML: exact numbers, and errors that name the file and the line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

from pas.errors import ProblemFileError, meant
from pas.exchange.files import source


def read_toml(path: str | Path) -> tuple[Path, str, dict[str, Any]]:
    """A TOML file: its path, text and data, decimals as fractions.

    Raises `ProblemFileError` with the line for syntax errors, `FileNotFoundError`.
    """
    file = source(path)
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise ProblemFileError(f"{file.name}: not a text file in UTF-8") from None
    try:
        data = tomllib.loads(text, parse_float=_decimal)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        number = int(line.group(1)) if line else text.count("\n") + 1
        reason = re.sub(r" \(at .*\)", "", str(error))
        raise ProblemFileError(f"{file.name}, line {number}: {_lower(reason)}", number) from None
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
        for key in self.required.get(section, set()) - set(table):
            raise self.error(f"{name} has no {key!r}, which it needs", section, index)

    def name(self, data: dict[str, Any]) -> str:
        """The problem's name, by default that of the file."""
        name: str = self.typed(data, "name", str, self.file.name.removesuffix(".toml"))
        if not name or Path(name).name != name:
            raise self.error(f"name must be a plain file name without folders, not {name!r}", "", 0, "name")
        return name

    def typed(self, data: dict[str, Any], key: str, kind: Any, default: Any) -> Any:
        """A value of the whole file, of the right type."""
        value = data.get(key, default)
        if key in data and (not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)):
            words = {int: "a whole number", str: "a string", bool: "true or false"}.get(kind, "a number")
            shown = float(value) if isinstance(value, Fraction) else value
            raise self.error(f"{key} must be {words}, not {shown!r}", "", 0, key)
        return value

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
    return float(text) if text.strip("+-") in ("nan", "inf") else Fraction(text.replace("_", ""))
