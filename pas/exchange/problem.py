"""Problem files (TOML): what to blend, and how.

    order = 2                      # the k of GC^k
    degree = 5                     # optional; raised until the proofs pass without
    tolerance = 1e-3               # optional; of the mesh, in the model's units

    [[pipes]]                      # or [[contacts]] with surface and clip as polynomials
    axis = [1, 0, 0]
    radius = "1/3"                 # exact: a string, an integer, or the decimal as written
    clip = 1
    point = [0, 0, 0]              # optional

    [partition]                    # optional
    center = [0, 0, 0]
    legs = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

    [energy]                       # optional: one patch over a box instead of all over cells
    lower = ["1/4", "-2/5", "-2/5"]
    upper = ["3/5", "2/5", "2/5"]
    cell = 0

    [points]                       # optional
    inside = [["1/2", "1/2", "1/2"]]
    outside = []
    through = []
    near = []
    near_weight = 100
    margin = "1/1000"              # of inside and outside points, in the model's units

    [normalize]                    # optional
    kind = "mean-alpha"            # or "sum-of-coefficients", or "value-at" with point and value

`basis` (a list of members, each a list of one polynomial a cell) restricts the solutions to a
given basis; `prove = false` and `guard = false` are as in `pas.blend`.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.errors import PasError, ProblemFileError
from pas.exchange.records import read_energy, read_normalization
from pas.fairing.constraints import Normalization
from pas.fairing.energy import ThinPlate
from pas.partition.cells import Partition
from pas.partition.single_cell import SingleCell
from pas.partition.six_tetrahedra import SixTetrahedra
from pas.surface.contact import Contact, Pipe

KEYS = {
    "": {
        "name",
        "order",
        "degree",
        "tolerance",
        "prove",
        "guard",
        "basis",
        "pipes",
        "contacts",
        "partition",
        "energy",
        "points",
        "normalize",
    },
    "pipes": {"axis", "radius", "clip", "point"},
    "contacts": {"surface", "clip"},
    "partition": {"kind", "center", "legs", "lower", "upper"},
    "energy": {"kind", "lower", "upper", "piece", "weight"},
    "points": {"inside", "outside", "through", "near", "near_weight", "margin"},
    "normalize": {"kind", "point", "value"},
}
REQUIRED = {
    "": {"order"},
    "pipes": {"axis", "radius", "clip"},
    "contacts": {"surface", "clip"},
    "normalize": {"kind"},
}
LISTS = {"pipes", "contacts"}
NORMALIZATIONS = ("mean-alpha", "sum-of-coefficients", "unit-coefficients", "value-at")


@dataclass(frozen=True)
class Problem:
    """A problem as read from a file; the fields are the arguments of `pas.blend`."""

    name: str
    contacts: tuple[Pipe | Contact, ...]
    order: int
    degree: int | None
    tolerance: float
    partition: Partition | None
    energy: ThinPlate
    points: dict[str, Any]
    normalize: Normalization | None
    basis: tuple[tuple[Polynomial, ...], ...] | None
    prove: bool
    guard: bool

    @property
    def options(self) -> dict[str, Any]:
        """The keyword arguments of `pas.blend` beside contacts, order and degree."""
        names = ("partition", "energy", "normalize", "basis", "prove", "guard")
        return {name: getattr(self, name) for name in names} | self.points


def read_problem(path: str | Path) -> Problem:
    """Read a problem file.

    Raises `ProblemFileError` with the line for syntax errors, unknown or missing keys, wrong
    types and values; `FileNotFoundError`.
    """
    file = Path(path)
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
    return _Reader(file, text).problem(data)


class _Reader:
    def __init__(self, file: Path, text: str) -> None:
        self.file, self.lines = file, text.splitlines()

    def problem(self, data: dict[str, Any]) -> Problem:
        self._check(data, "", 0)
        items = [
            self._item(kind, i, entry) for kind in ("pipes", "contacts") for i, entry in enumerate(data.get(kind, []))
        ]
        if not items:
            raise self._error("gives no [[pipes]] and no [[contacts]]; a corner needs three", "", 0)
        name = self._typed(data, "name", str, self.file.name.removesuffix(".toml"))
        if not name or Path(name).name != name:
            raise self._error(f"name must be a plain file name without folders, not {name!r}", "", 0, "name")
        return Problem(
            name=name,
            contacts=tuple(items),
            order=self._typed(data, "order", int, None),
            degree=self._typed(data, "degree", int, None),
            tolerance=float(self._typed(data, "tolerance", (int, float, Fraction), Fraction(1, 1000))),
            partition=self._made("partition", data, self._partition),
            energy=self._made("energy", data, self._energy) or ThinPlate(),
            points=self._made("points", data, dict) or {},
            normalize=self._made("normalize", data, self._normalization),
            basis=self._basis(data),
            prove=self._typed(data, "prove", bool, True),
            guard=self._typed(data, "guard", bool, True),
        )

    def _item(self, kind: str, index: int, entry: dict[str, Any]) -> Pipe | Contact:
        self._check(entry, kind, index)
        make: Callable[..., Pipe | Contact] = Pipe if kind == "pipes" else Contact
        try:
            return make(**entry)
        except (ValueError, TypeError, PasError) as error:
            places = {k: found.start() for k in entry if (found := re.search(rf"\b{k}\b", str(error)))}
            key = min(places, key=places.__getitem__) if places else None
            raise self._error(f"{kind[:-1]} {index + 1}: {error}", kind, index, key) from None

    def _made(self, table: str, data: dict[str, Any], make: Callable[[dict[str, Any]], Any]) -> Any:
        if table not in data:
            return None
        self._check(data[table], table, 0)
        try:
            return make(data[table])
        except (ValueError, TypeError, PasError) as error:
            raise self._error(f"[{table}]: {error}", table, 0) from None

    @staticmethod
    def _partition(table: dict[str, Any]) -> Partition:
        kind = table.get("kind", SixTetrahedra.name)
        wrong = {SixTetrahedra.name: ("lower", "upper"), SingleCell.name: ("legs",)}
        if kind not in wrong:
            raise ValueError(f"kind must be one of {', '.join(map(repr, wrong))}, not {kind!r}")
        for key in wrong[kind]:
            if key in table:
                raise ValueError(f"{key!r} does not belong to kind {kind!r}")
        if kind == SingleCell.name:
            return SingleCell(table.get("lower"), table.get("upper"), table.get("center"))
        if "legs" not in table:
            raise ValueError("the six-tetrahedra corner needs 'legs'")
        return SixTetrahedra(table.get("center", (0, 0, 0)), table["legs"])

    @staticmethod
    def _energy(table: dict[str, Any]) -> ThinPlate:
        if table.get("kind", "thin-plate") != "thin-plate":
            raise ValueError(f"kind must be 'thin-plate', not {table['kind']!r}")
        if ("lower" in table) != ("upper" in table):
            raise ValueError("a box needs both lower and upper")
        return read_energy(table)

    @staticmethod
    def _normalization(table: dict[str, Any]) -> Normalization:
        if table["kind"] not in NORMALIZATIONS:
            raise ValueError(f"kind must be one of {', '.join(NORMALIZATIONS)}, not {table['kind']!r}")
        if table["kind"] == "value-at" and "point" not in table:
            raise ValueError("'value-at' needs a point")
        return read_normalization(table)

    def _basis(self, data: dict[str, Any]) -> tuple[tuple[Polynomial, ...], ...] | None:
        if "basis" not in data:
            return None
        try:
            return tuple(tuple(Polynomial(p) for p in member) for member in data["basis"])
        except (ValueError, TypeError) as error:
            raise self._error(f"basis: {error}", "", 0, "basis") from None

    def _check(self, table: Any, section: str, index: int) -> None:
        """That a table is one, has only known keys and all that it needs, of the right shape."""
        name = f"[{section}]" if section else "the file"
        if not isinstance(table, dict):
            raise self._error(f"{section} must be a table, written [{section}] or [[{section}]]", "", 0, section)
        for key, value in table.items():
            if key not in KEYS[section]:
                known = ", ".join(sorted(KEYS[section]))
                raise self._error(f"unknown key {key!r} in {name}; known are {known}", section, index, key)
            if not section and key in LISTS and not isinstance(value, list):
                raise self._error(f"{key} must be a list of tables, written [[{key}]]", "", 0, key)
        for key in REQUIRED.get(section, set()) - set(table):
            raise self._error(f"{name} has no {key!r}, which it needs", section, index)

    def _typed(self, data: dict[str, Any], key: str, kind: Any, default: Any) -> Any:
        value = data.get(key, default)
        if key in data and (not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)):
            words = {int: "a whole number", str: "a string", bool: "true or false"}.get(kind, "a number")
            shown = float(value) if isinstance(value, Fraction) else value
            raise self._error(f"{key} must be {words}, not {shown!r}", "", 0, key)
        return value

    def _error(self, reason: str, section: str, index: int, key: str | None = None) -> ProblemFileError:
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
