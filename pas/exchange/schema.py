"""What records must look like: a small language of forms, and the check that names the place where one does not fit.

A form is a `Value` (one value), a `List`, a `Row` (a list of given entries), a `Table`, `Maybe` (or null), a `Choice`
of forms told apart by a key or a type, or `Later` (for forms within themselves).  Records are checked whole before
anything is made of them, so what reads them can take their form for granted; what the values mean, it still checks.

    check({"order": 1, "point": ["0", "1/3"]}, Table({"order": WHOLE, "point": List(NUMBER, 3)}), "problem")
    # ValueError: problem.point must be a list of 3 entries, not of 2
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from pas.algebra.inputs import shown
from pas.algebra.rational import read_number
from pas.errors import meant


class Form(Protocol):
    """Anything that a value can be held against."""

    @property
    def words(self) -> str:
        """What a value must be, in a sentence."""

    def check(self, value: Any, place: str) -> None:
        """Raise `ValueError`, naming the place, unless the value fits."""

    def fits(self, value: Any, /) -> bool:
        """Whether a value is of this sort at first sight: enough to choose among forms."""


def check(value: Any, form: Form, place: str) -> None:
    """Raise `ValueError`, naming the place within the record, unless a value fits a form."""
    form.check(value, place)


@dataclass(frozen=True)
class Value:
    """One value: `words` say what it must be ("a whole number")."""

    words: str
    fits: Callable[[Any], bool]

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        if not self.fits(value):
            raise ValueError(f"{place} must be {self.words}, not {shown(value)}")


def one_of(values: Sequence[str]) -> Value:
    """One of several words."""
    return Value(f"one of {', '.join(map(repr, values))}", lambda value: isinstance(value, str) and value in values)


def _is_number(value: Any) -> bool:
    try:
        return WHOLE.fits(value) or (isinstance(value, str) and bool(read_number(value) is not None))
    except (ValueError, ZeroDivisionError):
        return False


TEXT = Value("a text", lambda value: isinstance(value, str))
FLAG = Value("true or false", lambda value: isinstance(value, bool))
WHOLE = Value("a whole number", lambda value: isinstance(value, int) and not isinstance(value, bool))
REAL = Value("a number", lambda value: isinstance(value, int | float) and not isinstance(value, bool))
NUMBER = Value('an exact number such as "1/3"', _is_number)
ANYTHING = Value("anything", lambda value: True)


@dataclass(frozen=True)
class List:
    """A list of any number of entries of one form, or of `size` of them."""

    entry: Form
    size: int | None = None
    words: str = "a list"

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return isinstance(value, list)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        _require(self, value, place)
        if self.size is not None and len(value) != self.size:
            raise ValueError(f"{place} must be a list of {self.size} entries, not of {len(value)}")
        for i, entry in enumerate(value):
            self.entry.check(entry, f"{place}[{i}]")


@dataclass(frozen=True)
class Row:
    """A list of given entries, each of its own form."""

    entries: tuple[Form, ...]
    words: str = "a list"

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return isinstance(value, list)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        _require(self, value, place)
        if len(value) != len(self.entries):
            raise ValueError(f"{place} must be a list of {len(self.entries)} entries, not of {len(value)}")
        for i, (entry, form) in enumerate(zip(value, self.entries, strict=True)):
            form.check(entry, f"{place}[{i}]")


@dataclass(frozen=True)
class Table:
    """A table with the keys that it `needs`, those that it `may` have, and no others."""

    needs: Mapping[str, Form]
    may: Mapping[str, Form] = field(default_factory=dict)
    words: str = "a table"

    def fits(self, value: Any) -> bool:
        """See `Form`; the first key needed tells tables apart."""
        return isinstance(value, dict) and next(iter(self.needs), None) in {None, *value}

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        if not isinstance(value, dict):
            _require(self, value, place, fitting=False)
        forms = {**self.needs, **self.may}
        for key in value:
            if key not in forms:
                near = meant(key, forms) or f"; known are {', '.join(sorted(forms))}"
                raise ValueError(f"{place} has an unknown key {shown(key)}{near}")
        for key in self.needs:
            if key not in value:
                raise ValueError(f"{place} has no {key!r}, which it needs")
        for key, entry in value.items():
            forms[key].check(entry, f"{place}.{key}")


@dataclass(frozen=True)
class OpenTable(Table):
    """A table whose other keys are the business of what reads its kind."""

    def check(self, value: Any, place: str) -> None:
        """See `Shape`."""
        if isinstance(value, dict):
            value = {key: entry for key, entry in value.items() if key in {**self.needs, **self.may}}
        super().check(value, place)


@dataclass(frozen=True)
class TableOf:
    """A table of any keys with entries of one form."""

    entry: Form
    words: str = "a table"

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return isinstance(value, dict)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        _require(self, value, place)
        for key, entry in value.items():
            self.entry.check(entry, f"{place}.{key}")


@dataclass(frozen=True)
class Maybe:
    """A form, or null."""

    form: Form

    @property
    def words(self) -> str:
        """See `Form`."""
        return f"{self.form.words} or null"

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return value is None or self.form.fits(value)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        if value is not None:
            self.form.check(value, place)


@dataclass(frozen=True)
class Choice:
    """The first of several forms that fits at first sight; `words` say what there is to choose."""

    forms: tuple[Form, ...]
    words: str

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return any(form.fits(value) for form in self.forms)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        for form in self.forms:
            if form.fits(value):
                return form.check(value, place)
        raise ValueError(f"{place} must be {self.words}, not {shown(value)}")


@dataclass(frozen=True)
class Later:
    """A form that is looked up when it is needed, for forms within themselves."""

    form: Callable[[], Form]

    @property
    def words(self) -> str:
        """See `Form`."""
        return self.form().words

    def fits(self, value: Any) -> bool:
        """See `Form`."""
        return self.form().fits(value)

    def check(self, value: Any, place: str) -> None:
        """See `Form`."""
        self.form().check(value, place)


def _require(form: Form, value: Any, place: str, *, fitting: bool | None = None) -> None:
    if not (form.fits(value) if fitting is None else fitting):
        raise ValueError(f"{place} must be {form.words}, not {shown(value)}")
