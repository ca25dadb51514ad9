"""How long a computation may take, and how far it has come: a deadline and a progress line.

Exact computations can grow without warning.  Inside `with limit(seconds=..., progress=...)` the
long loops of this package look at the clock through `checkpoint`: past the deadline they raise
`LimitError`, which says what was being done; on the way they report to `progress`, not more
often than twice a second and only after the first second.  Without a limit nothing is said.

Nothing is half-done afterwards: results are built aside and handed over whole.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from pas.errors import LimitError

Report = Callable[[str], None]
"""Called with one line on what is being done."""

FIRST_REPORT, REPORT_EVERY = 1.0, 0.5
"""Seconds before the first progress line, and between lines."""


@dataclass
class _Limit:
    seconds: float | None
    started: float
    progress: Report | None
    next_report: float


_CURRENT: ContextVar[_Limit | None] = ContextVar("limit", default=None)


@contextmanager
def limit(seconds: float | None = None, progress: Report | None = None) -> Iterator[None]:
    """Limit what is done inside to `seconds` (None: no limit) and report to `progress`.

    An inner limit cannot outlast an outer one.  Raises `ValueError` for a limit that is not
    positive.
    """
    if seconds is not None and not seconds > 0:
        raise ValueError(f"seconds must be a positive number or None, not {seconds!r}")
    now = time.monotonic()
    outer = _CURRENT.get()
    if outer is not None and outer.seconds is not None:
        left = max(outer.started + outer.seconds - now, 1e-9)
        seconds = left if seconds is None else min(seconds, left)
    if progress is None and outer is not None:
        progress = outer.progress
    token = _CURRENT.set(_Limit(seconds, now, progress, now + FIRST_REPORT))
    try:
        yield
    finally:
        _CURRENT.reset(token)


def checkpoint(task: str, done: float | None = None) -> None:
    """Called inside long loops: raises `LimitError` past the deadline, and reports.

    `task` says what is being done ("eliminating 1620 x 1000"), `done` the share done, 0 to 1.
    """
    current = _CURRENT.get()
    if current is None:
        return
    now = time.monotonic()
    if current.seconds is not None and now > current.started + current.seconds:
        raise LimitError(f"gave up after {current.seconds:.3g} s while {task}; allow more seconds or a lower degree")
    if current.progress is not None and now >= current.next_report:
        current.next_report = now + REPORT_EVERY
        share = "" if done is None else f" ({100 * done:.0f}%)"
        current.progress(f"{task}{share}, {now - current.started:.0f} s")
