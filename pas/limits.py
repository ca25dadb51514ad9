"""Time limits, progress and interruption of computations: a deadline, a progress line, and a way to stop it.

Exact computations and meshes can grow without warning.  Inside `with limit(seconds=..., progress=...)`
the long loops of this package look at the clock through `checkpoint`: past the deadline they raise
`LimitError`, which says what was being done and what helps; on the way they report to `progress`, not
more often than twice a second and only after the first second.  Without a limit nothing is said.

Long public functions are `limited`: they take `seconds` and `progress` themselves, and their linear algebra runs on
one thread, so that results do not depend on how many a machine has: with more, the library that numpy calls sums in
another order, and iterations end with other last digits.  The matrices of blends are small: more threads mostly wait.

Nothing is half-done afterwards: results are built aside and handed over whole.  Between two looks at the clock
lies one call of a library or one pass over large arrays, some tenths of a second as a rule.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache, cached_property, wraps
from numbers import Real
from threading import Lock
from typing import TYPE_CHECKING, Any, ClassVar, ParamSpec, TypedDict, TypeVar

from pas.errors import LimitError

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

Report = Callable[[str], Any] | Callable[[float, str], Any]
"""Called with one line on what is being done, such as `print`; or, where it has two arguments, with the share of the
whole call that is done and with what is being done, for progress bars.  The share never falls, and is 1 at the end.  It
is an estimate: `part` says how it is made."""

FIRST_REPORT, REPORT_EVERY = 1.0, 0.5
"""Seconds before the first progress line, and between lines."""

NO_DIGITS = str.maketrans("", "", "0123456789")
"""The translation that leaves the numbers out of a text."""

LIMITED = "Gives up after `seconds` and reports to `progress`, as inside `pas.limit(seconds, progress)`."
"""Added to the docstrings of limited functions."""


class WorkLimits(TypedDict, total=False):
    """The two keywords of limited functions: seconds after which they give up, and a listener to their progress."""

    seconds: float | None
    progress: Report | None


KEYWORDS = [
    inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind.__forward_arg__)
    for name, kind in WorkLimits.__annotations__.items()
]
"""These two, as they are seen in the signatures of limited functions."""


@dataclass
class _Reports:
    """A listener, when it began to listen, and when it is told next; the share that is `done`, that at the `end` of the
    part which is being done, the task in it with its share, and where that task `ends`."""

    listener: Callable[..., Any]
    started: float
    next_one: float
    done: float = 0.0
    end: float = 1.0
    task: str = ""
    began: float = 0.0
    ends: float = 0.0
    tasks: ClassVar[int] = 8
    """How many tasks of the size of the first are thought to fill a part."""

    @cached_property
    def takes_shares(self) -> bool:
        return _takes(self.listener, 0.0, "") and not _takes(self.listener, "")

    def tell(self, words: str, seconds: float | None = None) -> None:
        """Hand on what is being done, as the listener takes it."""
        if self.takes_shares:
            self.listener(self.done, words)
            return
        share = f" ({100 * self.done:.0f}%)" if self.done else ""
        self.listener(words if seconds is None else f"{words}{share}, {seconds:.0f} s")

    def advance(self, task: str, share: float) -> None:
        """Take note of how far a task is: another one than before, by its words, or one that begins anew ends that."""
        words = task.translate(NO_DIGITS)
        now = self.began + share * (self.ends - self.began)
        if words != self.task or now < self.done:
            self.task, self.began = words, self.ends
            self.ends += (self.end - self.ends) / self.tasks
            now = self.began + share * (self.ends - self.began)
        self.done = now


@dataclass
class _Limit:
    """The state inside a `limit`: `seconds` is the limit that set the deadline, `task` the one reported last."""

    seconds: float | None
    deadline: float
    reports: _Reports | None
    work: str
    advice: str
    task: str
    stopped: Callable[[], bool] | None = None


_CURRENT: ContextVar[_Limit | None] = ContextVar("limit", default=None)


@contextmanager
def limit(
    seconds: float | None = None, progress: Report | None = None, stopped: Callable[[], bool] | None = None
) -> Iterator[None]:
    """Limit what is done inside to `seconds` (None: no limit), report to `progress`, and end it once `stopped()`.

    An inner limit cannot outlast an outer one; without a `progress` of its own it reports to the outer one's.  What is
    stopped raises `LimitError`; `stopped` is asked often, and must answer at once.
    Raises `ValueError` for a limit that is not positive, `TypeError` for one that is no number, for a `stopped` that
    cannot be called, and for a `progress` that takes neither one line of text nor a fraction and a text.
    """
    if stopped is not None and not callable(stopped):
        raise TypeError(f"stopped must be a function without arguments, not {stopped!r}")
    with _limit(seconds, progress, stopped=stopped):
        yield


def limited(work: str, advice: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A decorator: what the function does is limited by its own arguments `seconds` and `progress`.

    `work` says what it does ("meshing a solid"), `advice` what makes it faster ("a coarser tolerance"); both are
    for the sentence of a `LimitError`.  The function takes `**limits: Unpack[WorkLimits]`, which are its two keywords
    for whoever calls it or asks for its signature, or has these by name; it need not look at them.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        own = inspect.signature(function)
        shown = [p for p in own.parameters.values() if p.annotation != "Unpack[WorkLimits]"]
        if len(shown) < len(own.parameters):
            shown += KEYWORDS
        if not {p.name for p in KEYWORDS} <= {p.name for p in shown if p.kind is p.KEYWORD_ONLY}:
            raise TypeError(f"{function.__qualname__} must take the keywords seconds and progress to be limited")
        names = None if any(p.kind is p.VAR_KEYWORD for p in shown) else {p.name for p in shown}

        @wraps(function)
        def run(*args: P.args, **kwargs: P.kwargs) -> R:
            for name in () if names is None else kwargs.keys() - names:
                raise TypeError(f"{function.__qualname__}() got an unexpected keyword argument {name!r}")
            seconds, progress = kwargs.get("seconds"), kwargs.get("progress")
            with one_thread(), _limit(seconds, progress, work, advice):  # type: ignore[arg-type]
                checkpoint()
                return function(*args, **kwargs)

        run.__signature__ = own.replace(parameters=shown)  # type: ignore[attr-defined]
        run.__doc__ = f"{inspect.getdoc(function)}\n\n{LIMITED}"
        return run

    return decorate


def checkpoint(task: str = "", done: float | None = None) -> None:
    """Called inside long loops: raises `LimitError` past the deadline, and reports.

    `task` says what is being done ("eliminating 1620 x 1000"), `done` the share done, 0 to 1.  Loops far below,
    which do not know what they are part of, give no task: then what was said last still holds.
    """
    current = _CURRENT.get()
    if current is None:
        return
    named = task or current.task
    task = current.task = named or current.work or "computing"
    if current.stopped is not None and current.stopped():
        raise LimitError(f"stopped while {task}")
    now = time.monotonic()
    if now > current.deadline:
        work = f"{current.work} ({task})" if current.work not in ("", task) else task
        raise LimitError(
            f"gave up after {float(current.seconds or 0):.3g} s while {work}; allow more seconds{current.advice}"
        )
    reports = current.reports
    if reports is not None and named:
        reports.advance(named, done or 0.0)
    if reports is not None and now >= reports.next_one:
        reports.next_one = now + REPORT_EVERY
        work = f"{current.work}: {task}" if current.work not in ("", task) else task
        reports.tell(work, now - reports.started)


def blocks(number: int, size: int, task: str = "") -> Iterator[slice]:
    """Slices of a `number` of things, `size` at a time, with a look at the clock before each."""
    for start in range(0, number, size):
        checkpoint(task)
        yield slice(start, start + size)


@contextmanager
def part(share: float) -> Iterator[None]:
    """What is done inside is so large a share of what is left of the part around it, the first of which is the call.

    The fractions that `progress` is told count such parts, by shares that were measured.  In a part each task, as it is
    said to `checkpoint`, is taken for an eighth of what is left: so a fraction moves with every task, never falls, and
    is 1 at the end of the call only.
    """
    current = _CURRENT.get()
    reports = None if current is None else current.reports
    if reports is None:
        yield
        return
    end = reports.end
    reports.end = here = reports.done + share * (end - reports.done)
    reports.task, reports.ends = "", reports.done
    try:
        yield
    finally:
        reports.task, reports.done, reports.ends, reports.end = "", here, here, end


def in_parts(things: Collection[T], task: str) -> Iterator[T]:
    """Things one by one, each an equal part of all but the last eighth of the work, which `task` names; it is told how
    many are done, and how long the others take if they take as long."""
    began, many = time.monotonic(), len(things)
    with part(1 - 1 / _Reports.tasks):
        for number, thing in enumerate(things):
            left = (time.monotonic() - began) * (many - number) / max(number, 1)
            checkpoint(f"{task}: {number} of {many}, some {left:.0f} s left" if number else task)
            with part(1 / (len(things) - number)):
                yield thing


def note(line: str) -> None:
    """Report something that is done, at once, but for what was quick: the first second passes without a word."""
    current = _CURRENT.get()
    reports = None if current is None else current.reports
    if reports is not None and time.monotonic() >= reports.started + FIRST_REPORT:
        reports.tell(line)


def stage_line(stage: str, seconds: float) -> str:
    """How a stage that is done and its seconds are reported."""
    return f"{stage:<48} {seconds:7.2f} s"


@contextmanager
def _limit(
    seconds: float | None,
    progress: Report | None,
    work: str = "",
    advice: str = "",
    stopped: Callable[[], bool] | None = None,
) -> Iterator[None]:
    _check(seconds, progress)
    now = time.monotonic()
    outer = _CURRENT.get()
    deadline = float("inf") if seconds is None else now + float(seconds)
    reports = None if progress is None else _Reports(progress, now, now + FIRST_REPORT)
    inner = _Limit(seconds, deadline, reports, work, f" or {advice}" if advice else "", "", stopped)
    if outer is not None:
        inner.stopped = stopped or outer.stopped
        if outer.deadline < deadline:
            inner.seconds, inner.deadline = outer.seconds, outer.deadline
        inner.reports = reports or outer.reports
        if not work:
            inner.work, inner.advice, inner.task = outer.work, outer.advice, outer.task
    token = _CURRENT.set(inner)
    try:
        yield
    finally:
        _CURRENT.reset(token)
    if reports is not None and reports.takes_shares:
        reports.done = 1.0
        reports.tell(work or inner.task or "done")


def _check(seconds: Any, progress: Any) -> None:
    if seconds is not None and (isinstance(seconds, bool) or not isinstance(seconds, Real)):
        raise TypeError(f"seconds must be a positive number, not {seconds!r}")
    if seconds is not None and not float(seconds) > 0:
        raise ValueError(f"seconds must be a positive number, not {seconds!r}")
    if progress is not None and not (callable(progress) and (_takes(progress, "") or _takes(progress, 0.0, ""))):
        right = "a function of one line of text, such as print, or of a fraction and a text"
        raise TypeError(f"progress must be {right}, not {progress!r}")


def _takes(function: Callable[..., Any], *arguments: Any) -> bool:
    try:
        inspect.signature(function).bind(*arguments)
    except TypeError:
        return False
    except ValueError:  # a builtin that does not say what it takes
        return len(arguments) == 1
    return True


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
