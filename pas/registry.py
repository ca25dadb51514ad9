"""Registries: things by name, loaded when first asked for, and open to a user's own.

An entry is an object, or the text "module:name" of one, which is imported when it is first asked for.  So a room can
list what rooms above it hold, without importing them:

    SHAPES = Registry("a shape", {"ball": "shapes.ball:BALL"})
    SHAPES["bal"]            # ValueError: there is no shape 'bal'; is 'ball' meant?
    SHAPES.register(mine)    # under mine.name
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any, Generic, TypeVar

from pas.errors import meant

T = TypeVar("T")


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
        return f"there is no {self.noun} {name!r}{guess or '; there are ' + ', '.join(map(repr, self))}"

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
