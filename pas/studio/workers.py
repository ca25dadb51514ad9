"""Processes in which sessions work, so that the page is answered at all times and what is not wanted is stopped.

Processes are spawned, end with the server, whatever ends it (they watch it), and leave Ctrl-C to it.
"""

from __future__ import annotations

import asyncio
import ctypes
import gc
import multiprocessing
import os
import signal
import sys
import threading
import traceback
from multiprocessing.connection import Connection, wait
from typing import Any

from pas.errors import LimitError, PasError

SPAWN = multiprocessing.get_context("spawn")

INSIDE = "something went wrong inside the program; the last picture stays"
"""What the page is told of an error that is no user's."""


class RefusedError(Exception):
    """What a session could not do, in one sentence."""


class StoppedError(Exception):
    """What a session was told to stop."""


class Worker:
    """One process with one session; one thing is done at a time, and `doing` says what: a verb and its arguments."""

    def __init__(self) -> None:
        self._lock = asyncio.Lock()
        self.doing: tuple[Any, ...] = ()
        self._start()

    def _start(self) -> None:
        self._stop: Any = SPAWN.RawValue(ctypes.c_bool, False)
        self._pipe, other = SPAWN.Pipe()
        # read when libraries are loaded: matrices here are small, and several processes and the browser compute at once
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        self._process = SPAWN.Process(target=work, args=(other, self._stop), daemon=True)
        self._process.start()
        other.close()

    async def ask(self, verb: str, *arguments: Any) -> Any:
        """What the session's method gives; raises `RefusedError`, and `StoppedError` after `stop`."""
        async with self._lock:
            self.doing, self._stop.value = (verb, *arguments), False
            try:
                return await asyncio.to_thread(self.call, verb, *arguments)
            finally:
                self.doing = ()

    def stop(self) -> None:
        """End what is being done, at its next look."""
        self._stop.value = True

    def call(self, verb: str, *arguments: Any) -> Any:
        """What the method gives to a caller that waits, while nobody else asks; raises what `ask` raises."""
        try:
            self._pipe.send((verb, arguments))
            outcome, value = self._pipe.recv()
        except (EOFError, OSError):  # it was killed, perhaps for memory
            if self._process.is_alive():
                self._process.kill()
            if not self._ended:
                self._start()
            raise RefusedError("the computing process ended unexpectedly; move something to try again") from None
        if outcome == "stopped":
            raise StoppedError
        if outcome == "refused":
            raise RefusedError(value)
        return value

    _ended = False

    def end(self) -> None:
        """End the process at once."""
        self._ended = True
        self._process.kill()
        self._process.join(5)


def work(pipe: Connection, stop: Any) -> None:
    """What a process does: it answers until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    from pas.studio.session import StudioSession

    session = StudioSession(lambda: bool(stop.value))
    gc.freeze()  # what is loaded is never looked through again
    while True:
        try:
            verb, arguments = pipe.recv()
        except EOFError:
            return
        pipe.send(_answer(session, verb, arguments, stop))
        gc.collect()  # shapes refer to themselves: by its own rules Python would keep many of them, with their arrays


def _answer(session: Any, verb: str, arguments: tuple[Any, ...], stop: Any) -> tuple[str, Any]:
    try:
        return "done", session.do(verb, *arguments)
    except LimitError as error:
        return ("stopped", "") if stop.value else ("refused", str(error))
    except (PasError, ValueError, TypeError, OSError) as error:
        return "refused", str(error)
    except Exception:  # the page is told, the terminal shows where
        traceback.print_exc(file=sys.stderr)
        return "refused", INSIDE


def _leave_with_parent() -> None:
    """End this process as soon as the server has ended, however that came."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(0)
