"""pas: a modeler of piecewise algebraic surfaces.

    import pas

    pipes = [pas.Pipe(axis=(1, 0, 0), radius="1/3", clip=1),
             pas.Pipe(axis=(0, 1, 0), radius="1/4", clip=1),
             pas.Pipe(axis=(0, 0, 1), radius="2/5", clip=1)]
    blend = pas.blend(pipes, order=2)

The way of the data: problem (contacts, order) -> partition -> solution space -> fit -> surface and
certificate -> mesh -> file.  Public names stand in `__init__.pyi`, one line each, with their homes; they
are loaded when first used, so the import is fast.
"""

from typing import Any

import lazy_loader

_named, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """The object of a public name; raises `AttributeError` with the nearest for any other."""
    if name in __all__ or name.startswith("_"):
        return _named(name)
    try:
        return _named(name)  # a subpackage
    except AttributeError:
        from pas.errors import missing

        raise missing("pas", name, [*(f"solid.{n}" for n in _named("solid").__all__), *__all__]) from None
