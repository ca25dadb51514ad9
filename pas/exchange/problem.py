"""Problem files (TOML) of every kind: one reader, exact numbers, errors with their lines, and what all have in common.

A kind of problems says which files are its own and reads them: `ProblemKind`, listed in `PROBLEMS`; what their tables
hold stands in `corner_problem`, `parametric_problem` and `part_problem`.  All may have

    name = "corner"                # of the files to write; by default that of the problem file
    tolerance = 1e-3               # of the mesh, in the model's units
    prove = true                   # true: all must be proved, false: nothing need be; else what the kind can give;
                                   # in no case may a claim be refuted, or fail as measured

    [mesh]                         # further settings of the mesh, see pas.settings.MeshSettings
    quality = "angles"

    [picture]                      # those of pas.Picture
    style = "zebra"                # plain, zebra, highlights; mean, gauss, max, min (curvature)
    view = [1, -1, "1/2"]          # the direction from where one looks
    combs = true                   # with curvature combs
"""

from __future__ import annotations

import re
import tomllib
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any, Self, TypeVar

from pas.algebra.inputs import DEEPEST, depth, shown
from pas.algebra.rational import check_tolerance, rational, read_number, to_float, to_fraction
from pas.errors import LimitError, PasError, ProblemFileError, meant
from pas.exchange.files import read_text, source
from pas.exchange.picture_options import Picture
from pas.registry import Registry
from pas.settings import MeshSettings, options
from pas.shape import Shape
from pas.verdicts import Verdicts

WORDS = {bool: "true or false", int: "a whole number", float: "a number", str: "a string", list: "a list"}

T = TypeVar("T")


def read_toml(path: str | Path) -> tuple[Path, str, dict[str, Any]]:
    """A TOML file: its path, text and data, decimals as fractions.

    Raises `ProblemFileError` with the line for syntax errors, `FileNotFoundError`.
    """
    file = source(path)
    text = read_text(file, 1 << 22, ProblemFileError)  # tomllib reads about a million a second
    try:
        data = tomllib.loads(text, parse_float=_decimal)
    except RecursionError:
        raise ProblemFileError(f"{file.name}: lists are nested more than {DEEPEST} deep") from None
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        number = int(line.group(1)) if line else text.count("\n") + 1
        reason = re.sub(r" \(at .*\)", "", str(error))
        raise ProblemFileError(f"{file.name}, line {number}: {reason[:1].lower()}{reason[1:]}", number) from None
    except ValueError as error:
        raise _bad_number(file, text, error) from None
    if depth(data) > DEEPEST:
        raise ProblemFileError(f"{file.name}: lists are nested more than {DEEPEST} deep")
    return file, text, data


Keys = Mapping[str, bool]
"""The keys that a table may have, and whether it must have them."""


class TableReader:
    """Reads the tables of a problem file; what is wrong becomes a `ProblemFileError` with the line.

    `keys` are those of each section, "" for the whole file; `lists` are sections that are lists of tables.
    """

    def __init__(self, file: Path, text: str, keys: Mapping[str, Keys], lists: Collection[str] = ()) -> None:
        self.file, self.lines, self.keys, self.lists = file, text.splitlines(), keys, lists

    def check(self, table: Any, section: str = "", index: int = 0) -> None:
        """Check that a table is one, has only known keys and all that it needs, of the right shape.

        In sections with no known keys, the keys are left to whatever is made of the table.
        """
        name, known = f"[{section}]" if section else "the file", self.keys.get(section, table)
        if not isinstance(table, dict):
            raise self.error(f"{section} must be a table, written [{section}] or [[{section}]]", key=section)
        for key, value in table.items():
            if key not in known:
                near = meant(key, known) or f"; known are {', '.join(sorted(known))}"
                raise self.error(f"unknown key {key!r} in {name}{near}", section, index, key)
            if not section and key in self.lists and not isinstance(value, list):
                raise self.error(f"{key} must be a list of tables, written [[{key}]]", key=key)
        for key in sorted(key for key, needed in known.items() if needed and key not in table):
            raise self.error(f"{name} has no {key!r}, which it needs", section, index)

    def typed(self, data: dict[str, Any], key: str, kind: type, default: Any, section: str = "") -> Any:
        """A value of the right type: bool, int, float (any number), str or list."""
        if key not in data:
            return default
        value = data[key]
        number = isinstance(value, int | float | Fraction) and not isinstance(value, bool)
        if not (number if kind is float else isinstance(value, kind) and (kind is bool) == isinstance(value, bool)):
            raise self.error(f"{key} must be {WORDS[kind]}, not {shown(as_written(value))}", section, key=key)
        return value

    def checked(self, data: dict[str, Any], key: str, check: Callable[[Any], Any], default: Any = None) -> Any:
        """A value of the whole file, as a check, such as those of `pas.algebra.inputs`, returns it."""
        if key not in data:
            return default
        try:
            return check(as_written(data[key]))
        except (LimitError, ProblemFileError):
            raise
        except (ValueError, TypeError, PasError) as error:
            raise self.error(str(error), key=key) from None

    def made(self, make: Callable[[dict[str, Any]], T], table: Any, section: str, index: int = 0, title: str = "") -> T:
        """The object that `make` makes of one table; its errors get the line of the first key that they name."""
        self.check(table, section, index)
        try:
            return make(table)
        except (LimitError, ProblemFileError):
            raise
        except (ValueError, TypeError, PasError, FileNotFoundError) as error:
            places = {key: found.start() for key in table if (found := re.search(rf"\b{key}\b", str(error)))}
            key = min(places, key=places.__getitem__) if places else None
            raise self.error(f"{title}{error}", section, index, key) from None

    def table(self, data: dict[str, Any], section: str, make: Callable[[dict[str, Any]], T]) -> T | None:
        """The object made of an optional table, None without it."""
        return self.made(make, data[section], section, 0, f"[{section}]: ") if section in data else None

    def each(self, data: dict[str, Any], section: str, make: Callable[[dict[str, Any]], T], noun: str) -> list[T]:
        """The object made of each table of a list."""
        entries = enumerate(data.get(section, []))
        return [self.made(make, entry, section, i, f"{noun} {i + 1}: ") for i, entry in entries]

    def error(self, reason: str, section: str = "", index: int = 0, key: str | None = None) -> ProblemFileError:
        """An error that names the file and, where it can be found, the line."""
        line = self._line(section, index, key)
        place = f", line {line}" if line else ""
        return ProblemFileError(f"{self.file.name}{place}: {reason}", line)

    def within(self, section: str, index: int) -> TableReader:
        """A reader of what stands in one table of a list: its lines as if they were the file."""
        heading = re.compile(rf"\s*\[\[\s*{re.escape(section)}\s*\]\]")
        starts = [number for number, line in enumerate(self.lines) if heading.match(line)] + [len(self.lines)]
        own = range(starts[index] + 1, starts[index + 1]) if index + 1 < len(starts) else range(0)
        inner = re.compile(rf"^(\s*\[\[?\s*){re.escape(section)}\.")
        lines = [inner.sub(r"\1", line) if n in own else "" for n, line in enumerate(self.lines)]
        return TableReader(self.file, "\n".join(lines), {})

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
        return heading or self._inline(section, index) if section else None

    def _inline(self, section: str, index: int) -> int | None:
        """The line of a table in braces, one of a list."""
        begin = next((n for n, line in enumerate(self.lines) if re.match(rf"\s*{re.escape(section)}\s*=", line)), None)
        if begin is None:
            return None
        braces = (n for n, line in enumerate(self.lines[begin:], begin + 1) for _ in range(line.count("{")))
        return next(islice(braces, index, None), begin + 1)


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


def as_written(value: Any) -> Any:
    """A decimal as a double, in which tolerances and sentences have it."""
    return to_float(rational(value)) if isinstance(value, Fraction) else value


Settings = TypeVar("Settings", MeshSettings, Picture)

COMMON = dict.fromkeys(("name", "tolerance", "prove", "mesh", "picture"), False)
"""The keys that all files may have."""

COMMON_TABLES = {
    "mesh": {f.name: False for f in options(MeshSettings, "file")},
    "picture": {f.name: False for f in options(Picture, "file")},
}


@dataclass(frozen=True, kw_only=True)
class Problem(ABC):
    """A problem as read from a file; `prove` is None where the file does not say whether all must be proved.

    `model_unit` is that of its lengths, for the kinds whose files may tell it.
    """

    name: str
    prove: bool | None = None
    model_unit: str | None = None
    mesh: MeshSettings = field(default_factory=MeshSettings)
    picture: Picture = field(default_factory=Picture)

    @property
    def fixed(self) -> str:
        """The sentence for an option to be changed that such a problem does not have."""
        return "there is nothing to change in such a problem"

    @abstractmethod
    def solve(self) -> Shape:
        """The shape that was asked for; raises what finding it raises."""

    def changed(self, **changes: Any) -> Self:
        """The problem with other values for those of its fields, and its mesh's settings, that are not None.

        Raises `ValueError` for what is neither.
        """
        wanted = {name: value for name, value in changes.items() if value is not None}
        of_mesh = {f.name: wanted.pop(f.name) for f in fields(MeshSettings) if f.name in wanted}
        known = {field.name for field in fields(self)}
        for name in wanted:
            if name not in known:
                raise ValueError(f"{self.fixed}; leave out --{name}")
        return replace(self, **wanted, mesh=replace(self.mesh, **of_mesh))

    def satisfied(self, certificate: Verdicts) -> bool:
        """Whether a certificate is as the file wants it: nothing is refuted, and proved is what was to be proved."""
        if certificate.failed:
            return False
        return certificate.holds if self.prove is None else certificate.proved or not self.prove


def common(reader: TableReader, data: dict[str, Any], usual: MeshSettings, style: str = "zebra") -> dict[str, Any]:
    """The fields that every problem has, as a file says them; else the usual mesh and style of the kind."""
    name = reader.typed(data, "name", str, reader.file.name.removesuffix(".toml"))
    if Path(name).name != name or name in ("", ".", "..") or not name.isprintable():
        raise reader.error(f"name must be a plain file name without folders, not {shown(name)}", key="name")
    tolerance = reader.checked(data, "tolerance", check_tolerance, usual.tolerance)
    mesh = _settings(reader, data.get("mesh", {}), "mesh", replace(usual, tolerance=tolerance))
    picture = _settings(reader, data.get("picture", {}), "picture", Picture(style=style))
    return {"name": name, "mesh": mesh, "picture": picture}


def _settings(reader: TableReader, table: Any, section: str, usual: Settings) -> Settings:
    def make(table: dict[str, Any]) -> Settings:
        kinds = {f.name: f.metadata["kind"] for f in options(type(usual), "file")}
        worded = {f.name for f in options(type(usual), "file") if f.metadata["metavar"]}
        kinds |= {key: str for key in worded & table.keys() if isinstance(table[key], str)}  # as on the command line
        given = {key: reader.typed(table, key, kinds[key], None, section) for key in table}
        return replace(usual, **given)

    return reader.made(make, table, section)


@dataclass(frozen=True)
class ProblemKind:
    """`fits(data)`: whether a file's data are such a problem; `read(file, text, data)` makes it."""

    name: str
    fits: Callable[[dict[str, Any]], bool]
    read: Callable[[Path, str, dict[str, Any]], Problem]


PROBLEMS: Registry[ProblemKind] = Registry(
    "kind of problem",
    {
        "generatrix": "pas.exchange.parametric_problem:GENERATRIX",
        "parametric": "pas.exchange.parametric_problem:PROBLEM",
        "part": "pas.exchange.part_problem:PROBLEM",
        "corner": "pas.exchange.corner_problem:PROBLEM",
    },
)
"""In the order in which they are asked; the last one takes what no other wants."""

PARAMETRIC = ("generatrix", "parametric")


def read_problem(path: str | Path, kinds: Sequence[str] | None = None) -> Problem:
    """Read a problem file of any kind, or of some `kinds` of `PROBLEMS`.

    Raises `ProblemFileError` with the line for syntax errors, unknown or missing keys, wrong types and values, and for
    a problem of another kind; `FileNotFoundError`.
    """
    file, text, data = read_toml(path)
    fitting = [kind for kind in PROBLEMS.values() if kind.fits(data)]
    if not any(kinds is None or kind.name in kinds for kind in fitting):
        raise ProblemFileError(
            f"{file.name}: this is a problem of the kind {fitting[0].name!r}, not {' or '.join(map(repr, kinds or ()))}"
        )
    kind = next(kind for kind in fitting if kinds is None or kind.name in kinds)
    return kind.read(file, text, data)


def read_parametric_problem(path: str | Path) -> Problem:
    """`read_problem` of a parametric blend or one by a generatrix; raises `ProblemFileError` for other problems."""
    return read_problem(path, PARAMETRIC)
