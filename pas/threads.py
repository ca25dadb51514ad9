"""Linear algebra on one thread, for results that do not depend on how many a machine has.

With more threads the library that numpy calls sums in another order, and iterations end with other last digits.  The
matrices of blends are small: more threads mostly wait, and take from those who compute beside them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

_LOCK = Lock()
_INSIDE: list[Any] = []
"""One entry for each computation under way in the process; the first knows the number of threads that there was."""


@contextmanager
def one_thread() -> Iterator[None]:
    """Inside, linear algebra runs on one thread, in the whole process; after the last to leave as before the first."""
    with _LOCK:
        if not _INSIDE:
            _release()
        _INSIDE.append(_INSIDE[0] if _INSIDE else _libraries().limit(limits=1, user_api="blas"))
    try:
        yield
    finally:
        with _LOCK:
            before = _INSIDE.pop()
            if not _INSIDE:
                _release()
                before.restore_original_limits()
                _release()


@cache
def _libraries() -> ThreadpoolController:
    """The libraries for linear algebra of numpy and of scipy, which has its own."""
    import scipy.linalg  # noqa: F401  # they are found once they are loaded
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def _release() -> None:
    """Let this thread of the program set the number, whichever did so last."""
    for library in _libraries().lib_controllers:
        if library.internal_api == "openblas":
            library.clear_controlling_thread(force=True)
