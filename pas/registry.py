"""Registries: things by name, loaded when first asked for, and open to a user's own; and things made from tables.

An entry is an object, or the text "module:name" of one, which is imported when it is first asked for.  So a layer
can list what layers above it hold, without importing them:

    SHAPES = Registry("a shape", {"ball": "shapes.ball:BALL"})
    SHAPES["bal"]            # ValueError: there is no shape 'bal'; is 'ball' meant?
    SHAPES.register(mine)    # under mine.name

Project files and problem files hold tables of plain data.  A table's "kind" is the name of a registered class that is
`Serialisable`; the other keys are that class's own, so a new kind needs no change in any reader.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from inspect import Parameter, signature
from typing import Any, Generic, Self, TypeVar

from pas.errors import meant

T = TypeVar("T")


class Serialisable:
    """A class that is made from tables: unless it says otherwise, these hold the arguments of its constructor."""

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        """The keys that its tables may have besides the kind, and whether they must have them."""
        return constructor_keys(cls)

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        """The thing that a table (without its kind) describes; raises as the constructor does for wrong values."""
        return cls(**record)


D = TypeVar("D", bound=Serialisable)


def loaded(text: str) -> Any:
    """The object of a text "module:name"."""
    module, _, name = text.partition(":")
    return getattr(import_module(module), name)


class Registry(Mapping[str, T], Generic[T]):
    """Entries by name; `noun` says in sentences what one of them is, `key` which attribute is its name."""

    def __init__(self, noun: str, entries: Mapping[str, T | str] | None = None, key: str = "name") -> None:
        self.noun, self.key = noun, key
        self._entries: dict[str, T | str] = dict(entries or {})

    def __getitem__(self, name: Any) -> T:
        """The entry of a name; raises `ValueError` with a guess for another name."""
        if not isinstance(name, str) or name not in self._entries:
            raise ValueError(self.unknown(name))
        entry = self._entries[name]
        if isinstance(entry, str):
            entry = self._entries[name] = loaded(entry)
        return entry

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def unknown(self, name: Any) -> str:
        """The sentence about a name that is none of these."""
        guess = meant(name, self) if isinstance(name, str) else ""
        known = ", ".join(map(repr, self))
        return f"there is no {self.noun} {name!r}{guess or f'; there are {known}'}"

    def register(self, entry: T) -> T:
        """Add an entry under its own name; returns it, so that this is a decorator, too.

        Raises `ValueError` for a name that is taken, `TypeError` for an entry that has none.
        """
        name = getattr(entry, self.key, None)
        if not isinstance(name, str) or not name:
            raise TypeError(f"a {self.noun} to register needs a text as its {self.key}, not {name!r}")
        if name in self._entries:
            raise ValueError(f"there is a {self.noun} {name!r} already; choose another {self.key}")
        self._entries[name] = entry
        return entry


def read_record(registry: Registry[type[D]], record: Mapping[str, Any], kind: str | None = None) -> D:
    """The thing that a table describes; `kind` is that of a table that does not say.

    Raises `ValueError`, whose sentence begins with the key at fault, for an unknown kind, and for
    keys that do not belong to the kind or are missing; what the class raises for wrong values.
    """
    name = record.get("kind", kind)
    if name not in registry:
        raise ValueError(f"kind: {registry.unknown(name)}")
    return read_as(registry[name], f"{registry.noun} {name!r}", record)


def read_as(made: type[D], called: str, record: Mapping[str, Any]) -> D:
    """The thing of a known class, called so in sentences, that a table describes; raises as `read_record` does."""
    data = {key: value for key, value in record.items() if key != "kind"}
    check_keys(made.keys(), called, data)
    return made.from_record(data)


def check_keys(known: Mapping[str, bool], called: str, record: Mapping[str, Any]) -> None:
    """Raise `ValueError`, naming the nearest, for a key that is not known, and for one that is needed and not there."""
    for key in record:
        if key not in known:
            raise ValueError(f"{key!r} does not belong to the {called}{meant(key, known)}")
    for key, needed in known.items():
        if needed and key not in record:
            raise ValueError(f"the {called} needs {key!r}")


def constructor_keys(made: type[Any]) -> dict[str, bool]:
    """The arguments of a class's constructor: needed are those without a default."""
    arguments = list(signature(made.__init__).parameters.values())[1:]
    return {a.name: a.default is Parameter.empty for a in arguments if a.kind is not Parameter.VAR_KEYWORD}


def keys_of(registry: Registry[type[D]]) -> set[str]:
    """All keys that a table of any registered kind may have."""
    return {"kind"}.union(*(made.keys() for made in registry.values()))
