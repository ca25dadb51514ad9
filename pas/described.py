"""Things that describe themselves by a table of plain data, and are made from one again.

Project files and problem files hold such tables.  A table's "kind" is the name of a registered
class; the other keys are that class's own, so a new kind needs no change in any reader.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from inspect import Parameter, signature
from typing import Any, Protocol, TypeVar

from pas.errors import meant
from pas.registry import Registry


class Described(Protocol):
    """A class that is made from tables."""

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        """The keys that its tables may have, and whether they must have them."""

    @classmethod
    def from_record(cls, record: Mapping[str, Any], /) -> Any:
        """The thing that a table (without its kind) describes; `ValueError` or `TypeError` for a wrong one."""


D = TypeVar("D", bound=Described)


def described(registry: Registry[type[D]], record: Mapping[str, Any], kind: str | None = None) -> D:
    """The thing that a table describes; `kind` is that of a table that does not say.

    Raises `ValueError`, whose sentence begins with the key at fault, for an unknown kind, and for
    keys that do not belong to the kind or are missing; what the class raises for wrong values.
    """
    name = record.get("kind", kind)
    if name not in registry:
        raise ValueError(f"kind: {registry.unknown(name)}")
    made = registry[name]
    data = {key: value for key, value in record.items() if key != "kind"}
    known = made.keys()
    for key in data:
        if key not in known:
            raise ValueError(f"{key!r} does not belong to the {registry.noun} {name!r}{meant(key, known)}")
    for key, needed in known.items():
        if needed and key not in data:
            raise ValueError(f"the {registry.noun} {name!r} needs {key!r}")
    thing: D = made.from_record(data)
    return thing


def constructor_keys(made: type[Any]) -> dict[str, bool]:
    """The keys of a class whose tables hold the arguments of its constructor: needed are those without a default."""
    return dict(_arguments(made.__init__))


@cache
def _arguments(constructor: Callable[..., None]) -> dict[str, bool]:
    arguments = list(signature(constructor).parameters.values())[1:]
    return {a.name: a.default is Parameter.empty for a in arguments if a.kind is not Parameter.VAR_KEYWORD}


def keys_of(registry: Registry[type[D]]) -> set[str]:
    """All keys that a table of any registered kind may have."""
    return {"kind"}.union(*(made.keys() for made in registry.values()))
