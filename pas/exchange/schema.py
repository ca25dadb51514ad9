"""What records must look like: a small language of forms, whose checks name the place where one does not fit, and which
read what fits and write it again; and the forms of polynomials, partitions and surfaces.

A form is one value (`TEXT`, `NUMBER`, ...), a list, a row of given entries, a `Table`, a form or null, or a choice of
forms told apart by a key or a type.  Records are checked whole before anything is made of them, so what reads them can
take their form for granted; what the values mean, it still checks.

    from pas.exchange.schema import NUMBER, WHOLE, Table, list_of

    form = Table({"order": WHOLE, "point": list_of(NUMBER, 3)})
    form.check({"order": 1, "point": ["0", "1/3"]}, "problem")
    # ValueError: problem.point must be a list of 3 entries, not of 2

What an entry stands for is said once, with its form: `read` makes a thing of a checked value, `write` gives the
value of a thing; without a word the value is the thing itself.  A `Table` makes its thing of its entries by name, and
writes its attributes of these names:

    from pas import ValueAt
    from pas.exchange.schema import NUMBER, Table, list_of

    form = Table({"point": list_of(NUMBER, 3), "value": NUMBER}, make=ValueAt)
    assert form.write(ValueAt((0, 0, "1/3"), 1)) == {"point": ["0", "0", "1/3"], "value": "1"}
    assert form.read({"point": ["0", "0", "1/3"], "value": "1"}) == ValueAt((0, 0, "1/3"), 1)

Libraries that check types (pydantic, msgspec) were weighed: exact numbers as texts, keys that are guessed ("is 'order'
meant") and the one sentence with the place would all have to be added to them.

Nothing but polynomials is made here, so that the independent checker reads files by the same rules and makes of them
what it will.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any, TypeAlias

from flint import fmpq

from pas.algebra.inputs import HIGHEST_POWER, shown
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import plain, rational, read_number
from pas.errors import meant


def itself(value: Any) -> Any:
    """A value, which is what it stands for."""
    return value


def _anything(value: Any) -> bool:
    return True


@dataclass(frozen=True)
class Value:
    """A value; `words` say in a sentence what it must be.

    `fits` says of a value whether it is of this sort at first sight, enough to choose among forms, and `inside` checks
    its entries; `read` gives the thing that a checked value stands for, `write` the value, of what JSON can say, that
    stands for a thing; `of` says of a thing whether it is one that this form writes.
    """

    words: str
    fits: Callable[[Any], bool]
    inside: Callable[[Any, str], None] = lambda value, place: None
    read: Callable[[Any], Any] = itself
    write: Callable[[Any], Any] = itself
    of: Callable[[Any], bool] = _anything

    def check(self, value: Any, place: str) -> None:
        """Raise `ValueError`, naming the place within the record, unless the value fits."""
        if not self.fits(value):
            raise ValueError(f"{place} must be {self.words}, not {shown(value)}")
        self.inside(value, place)


@dataclass(frozen=True)
class Table:
    """A table with the keys that it `needs` and those that it `may` have.

    It has no others, unless it is `open`: these are the business of what reads its kind then.  `make` is called with
    the entries by name, `entries` gives those of a thing in the order in which they are written: without it those that
    it needs, and of others what is not empty, are its attributes of these names, or of the `names` that they have.
    """

    needs: Mapping[str, Form]
    may: Mapping[str, Form] = field(default_factory=dict)
    open: bool = False
    words: str = "a table"
    make: Callable[..., Any] = dict
    entries: Callable[[Any], Mapping[str, Any]] | None = None
    of: Callable[[Any], bool] = _anything
    names: Mapping[str, str] = field(default_factory=dict)

    def fits(self, value: Any) -> bool:
        """As of a `Value`; the first key needed tells tables apart."""
        return isinstance(value, dict) and next(iter(self.needs), None) in {None, *value}

    def check(self, value: Any, place: str) -> None:
        """Raise `ValueError`, naming the place within the record, unless the value fits."""
        if not isinstance(value, dict):
            raise ValueError(f"{place} must be {self.words}, not {shown(value)}")
        forms = {**self.needs, **self.may}
        strange = [] if self.open else [key for key in value if key not in forms]
        for key in strange[:1]:
            near = meant(key, forms) or f"; known are {', '.join(sorted(forms))}"
            raise ValueError(f"{place} has an unknown key {shown(key)}{near}")
        for key in self.needs:
            if key not in value:
                raise ValueError(f"{place} has no {key!r}, which it needs")
        for key, entry in value.items():
            if key in forms:
                forms[key].check(entry, f"{place}.{key}")

    def read(self, value: Mapping[str, Any]) -> Any:
        """The thing of a checked table; what it does not know is left out, unless it is open."""
        forms = {**self.needs, **self.may}
        known = {key: entry for key, entry in value.items() if key in forms or self.open}
        return self.make(**{key: forms[key].read(part) if key in forms else part for key, part in known.items()})

    def write(self, thing: Any) -> dict[str, Any]:
        """The table that stands for a thing."""
        forms = {**self.needs, **self.may}
        if self.entries is not None:
            thing = self.entries(thing)
        elif not isinstance(thing, Mapping):
            found = {key: attrgetter(self.names.get(key, key))(thing) for key in forms}
            thing = {key: part for key, part in found.items() if key in self.needs or part}
        return {key: forms[key].write(part) if key in forms else part for key, part in thing.items()}


Form: TypeAlias = Value | Table
"""Anything that a value can be held against."""


def alone(name: str, form: Form) -> Table:
    """A table with one entry, which is the thing."""
    return Table({name: form}, make=lambda **entries: entries[name], entries=lambda thing: {name: thing})


def _is_number(value: Any) -> bool:
    try:
        return WHOLE.fits(value) or (isinstance(value, str) and bool(read_number(value) is not None))
    except (ValueError, ZeroDivisionError):
        return False


TEXT = Value("a text", lambda value: isinstance(value, str))
FLAG = Value("true or false", lambda value: isinstance(value, bool))
WHOLE = Value("a whole number", lambda value: isinstance(value, int) and not isinstance(value, bool))
REAL = Value("a number", lambda value: isinstance(value, int | float) and not isinstance(value, bool))
NUMBER = Value('an exact number such as "1/3"', _is_number, write=lambda number: plain(rational(number)))
ANYTHING = Value("anything", _anything)


def one_of(values: Sequence[Any]) -> Value:
    """One of several words or whole numbers."""
    kind = type(values[0])
    return Value(f"one of {', '.join(map(repr, values))}", lambda value: type(value) is kind and value in values)


def list_of(entry: Form, size: int | None = None, words: str = "a list") -> Value:
    """A list of any number of entries of one form, or of `size` of them."""
    return _list(lambda number: [entry] * (number if size is None else size), words)


def row(*entries: Form) -> Value:
    """A list of given entries, each of its own form."""
    return _list(lambda _: entries, "a list")


def _list(parts_of: Callable[[int], Sequence[Form]], words: str) -> Value:
    """A list whose entries have the forms that `parts_of` gives for its length."""

    def inside(value: Any, place: str) -> None:
        wanted = parts_of(len(value))
        if len(value) != len(wanted):
            raise ValueError(f"{place} must be a list of {len(wanted)} entries, not of {len(value)}")
        for i, (part, entry) in enumerate(zip(value, wanted, strict=True)):
            entry.check(part, f"{place}[{i}]")

    return Value(
        words,
        lambda value: isinstance(value, list),
        inside,
        lambda value: [entry.read(part) for part, entry in zip(value, parts_of(len(value)), strict=True)],
        lambda things: [entry.write(thing) for thing, entry in zip(things, parts_of(len(things)), strict=True)],
    )


def table_of(entry: Form) -> Value:
    """A table of any keys with entries of one form."""

    def inside(value: Any, place: str) -> None:
        for key, part in value.items():
            entry.check(part, f"{place}.{key}")

    return Value("a table", lambda value: isinstance(value, dict), inside)


def maybe(form: Form) -> Value:
    """A form, or null."""
    return Value(
        form.words,
        _anything,
        lambda value, place: None if value is None else form.check(value, place),
        lambda value: None if value is None else form.read(value),
        lambda thing: None if thing is None else form.write(thing),
    )


def choice(words: str, *forms: Form) -> Value:
    """The first of several forms that fits at first sight, or that is `of` a thing to write; `words` say what there is
    to choose."""

    def fitting(value: Any) -> Form:
        return next(form for form in forms if form.fits(value))

    return Value(
        words,
        lambda value: any(form.fits(value) for form in forms),
        lambda value, place: fitting(value).check(value, place),
        lambda value: fitting(value).read(value),
        lambda thing: next(form for form in forms if form.of(thing)).write(thing),
    )


def read_by(form: Form, read: Callable[[Any], Any], write: Callable[[Any], Any]) -> Value:
    """A form of things that are read whole, and written whole, by functions."""
    return Value(form.words, _anything, form.check, read, write)


def later(find: Callable[[], Form]) -> Value:
    """A form that is looked up when it is needed, for forms within themselves."""
    return Value(
        "",
        _anything,
        lambda value, place: find().check(value, place),
        lambda value: find().read(value),
        lambda thing: find().write(thing),
    )


def terms_record(raw: Any) -> list[list[Any]]:
    """Terms [i, j, ..., "p/q"] of x^i y^j ... of a polynomial of python-flint."""
    return [[*map(int, e), plain(c)] for e, c in raw.to_dict().items()]


def read_terms(record: Any, of: str = "a polynomial") -> dict[tuple[int, ...], fmpq]:
    """The coefficients of `terms_record` by exponents, of any degree that can be evaluated."""
    terms: dict[tuple[int, ...], fmpq] = {}
    for *exponents, coefficient in record:
        key = tuple(exponents)
        if min(key) < 0 or sum(key) > HIGHEST_POWER or key in terms:
            wrong = "stands twice" if key in terms else f"must have exponents >= 0 of sum up to {HIGHEST_POWER}"
            raise ValueError(f"the term {shown([*key, coefficient])} of {of} {wrong}")
        terms[key] = rational(coefficient, "a coefficient")
    return terms


def read_polynomial(record: Any) -> Polynomial:
    """The polynomial of terms, or of a formula."""
    return Polynomial(record) if isinstance(record, str) else Polynomial.from_raw(RING.from_dict(read_terms(record)))


def equation_record(polynomial: Polynomial) -> str | list[list[Any]]:
    """A formula for people to read where it has up to 1000 characters, else terms."""
    text = str(polynomial)
    return text if len(text) <= 1000 else terms_record(polynomial.raw)


TERMS = list_of(row(WHOLE, WHOLE, WHOLE, NUMBER), words="a list of terms")
POLYNOMIAL = replace(TERMS, read=read_polynomial, write=lambda polynomial: terms_record(polynomial.raw))
EQUATION = replace(choice("a polynomial", TEXT, POLYNOMIAL), read=read_polynomial, write=equation_record)
POINT = list_of(NUMBER, 3, words="a point of three numbers")
_PARTITION_DATA = {"legs": list_of(POINT, 3), "lower": POINT, "upper": POINT, "vertices": list_of(POINT)}
PARTITION = Table(
    {"kind": TEXT, "center": maybe(POINT)},
    {**_PARTITION_DATA, "cells": list_of(list_of(WHOLE, 4)), "pieces": list_of(list_of(WHOLE))},
    open=True,
)
SURFACE = Table(
    {
        "partition": PARTITION,
        "contacts": list_of(Table({"surface": EQUATION, "clip": EQUATION})),
        "order": WHOLE,
        "degree": WHOLE,
        "patches": list_of(POLYNOMIAL),
    }
)
