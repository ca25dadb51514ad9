"""One page's conversation: what is asked last is answered first, and what is not wanted any more is stopped.

The page numbers its states.  "move" asks for a picture quickly, of the newest state only; after a rest its verdicts
follow.  "rest" asks for the final shape with all proofs.  Every picture has a number of its own, its `shot`, and every
verdict says to which shot it belongs: so none is ever shown for another picture.

Sessions work in processes of their own, so that the page is answered at all times and what is not wanted is stopped.
They are spawned, end with the server, whatever ends it (they watch it), and leave Ctrl-C to it.
"""

from __future__ import annotations

import asyncio
import ctypes
import gc
import json
import multiprocessing
import os
import signal
import sys
import threading
import traceback
from collections.abc import Awaitable, Callable, Coroutine
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any

from pas.errors import LimitError, PasError
from pas.studio import GALLERY, Message, refusal

SPAWN = multiprocessing.get_context("spawn")

INSIDE = "something went wrong inside the program; the last picture stays"
"""The sentence for an error that is no user's."""


class RefusedError(Exception):
    """A refusal by a session, in one sentence."""


class StoppedError(Exception):
    """A task that a session was told to stop."""


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
    """The loop of a process: it answers until the other end is closed."""
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


REST = 0.08
"""Seconds without a move after which what is seen is proved."""

LONGEST_FILE = 1 << 23

Send = Callable[[Message], Awaitable[None]]
Request = dict[str, Any]


class Conversation:
    """A page, and the two processes that work for it: `quick` follows what is dragged, `final` solves and exports."""

    def __init__(self, send: Send, quick: Worker, final: Worker) -> None:
        self._send, self.quick, self.final = send, quick, final
        self._shot = self._seen = self._proved = 0
        self._move: Request | None = None
        self._rest: Request | None = None
        self._moved, self._rested = asyncio.Event(), asyncio.Event()
        self._others: set[asyncio.Task[None]] = set()
        self._taken: asyncio.Task[None] | None = None
        self._proving = False
        self._early: dict[str, Any] | None = None

    async def run(self) -> None:
        """Work until cancelled."""
        async with asyncio.TaskGroup() as group:
            group.create_task(self._moving())
            group.create_task(self._resting())

    def end(self) -> None:
        """End both processes."""
        self.quick.end()
        self.final.end()

    async def receive(self, text: str) -> None:
        """Take one request; one that is none is refused in a sentence."""
        try:
            request = request_of(text)
        except ValueError as error:
            await self._send(refusal(error))
            return
        verb = request["do"]
        if verb == "move":
            self._move = request
            self._moved.set()
            if self._proving:
                self.quick.stop()
            if self._early is not None:
                self.final.stop()
        elif verb == "rest":
            self._rest, self._move, self._early = request, None, None
            verb, *document = self.final.doing or ("",)
            if verb in STOPPABLE and document != [request["document"]]:
                self.final.stop()
            self._rested.set()
            self._begin(self._prove_once(request))
        else:
            self._begin(self._answer(request, self._do(request)))

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._others.add(task)
        task.add_done_callback(self._others.discard)

    async def read(self, name: str, text: str) -> dict[str, Any]:
        """The document of a file's text; a project is open in both processes then."""
        document: dict[str, Any] = await self.final.ask("read", name, text)
        if document["kind"] == "project":
            await self.quick.ask("read", name, text)
        return document

    async def _moving(self) -> None:
        while True:
            await self._moved.wait()
            self._moved.clear()
            request, self._move = self._move, None
            if request is None:
                continue
            await self._answer(request, self._follow(request))
            try:
                await asyncio.wait_for(self._moved.wait(), REST)
            except TimeoutError:
                self._begin(self._ahead(request["document"]))
                await self._prove_once(request)

    async def _follow(self, request: Request) -> None:
        asked = ("move", request["document"], str(request.get("scene", "")), bool(request.get("mesh")))
        message = await self.quick.ask(*asked)
        anew = message.head["kind"] == "outline"  # of what has to be solved anew, which takes longer
        if anew:
            await self._send(message.added(seq=request.get("seq", 0)))
            message = await self.quick.ask(*asked, True)
        await self._picture(message, request)
        self._seen = self._shot
        if anew:  # measuring takes less: so a hand that does not rest is told how fair what it made is
            await self._tell("measure", self._shot)

    async def _prove_once(self, request: Request) -> None:
        """Prove what is seen, unless that was done, or it is a final picture, which has its verdicts."""
        if self._seen == self._shot and self._proved != self._shot:
            self._proved = self._shot
            await self._answer(request, self._prove(self._shot))

    async def _prove(self, shot: int) -> None:
        self._proving = True
        try:
            for verb in ("prove", "measure"):
                await self._tell(verb, shot)
        finally:
            self._proving = False

    async def _tell(self, verb: str, shot: int) -> None:
        """Send what is known of the shape of the last move, which a shot shows."""
        message: Message = await self.quick.ask(verb)
        await self._send(message.added(shot=shot))

    async def _ahead(self, document: dict[str, Any]) -> None:
        """Solve where the hand rests, before it lets go: the answer is kept by the session, and sent when asked for."""
        if self._move is None and self._rest is None and not self.final.doing:
            self._early = document
            with suppress(RefusedError, StoppedError):
                await self.final.ask("solve", document)
            self._early = None

    async def _resting(self) -> None:
        while True:
            await self._rested.wait()
            self._rested.clear()
            request, self._rest = self._rest, None
            if request is not None:
                await self._answer(request, self._solve(request))

    async def _solve(self, request: Request) -> None:
        document = request["document"]
        await self._picture(await self.final.ask("solve", document), request)
        shot = self._shot
        if (kept := await self.final.ask("kept", document)) is not None and self._rest is None:
            self._taken = asyncio.create_task(self._take(kept))
        measures: Message = await self.final.ask("measure", document)
        await self._send(measures.added(shot=shot))

    async def _take(self, kept: tuple[str, dict[str, Any]]) -> None:
        with suppress(RefusedError, StoppedError):  # then the first move begins anew, and says what is wrong
            await self.quick.ask("take", *kept)

    async def _picture(self, message: Message, request: Request) -> None:
        self._shot += 1
        await self._send(message.added(shot=self._shot, seq=request.get("seq", 0)))

    async def _answer(self, request: Request, work: Awaitable[None]) -> None:
        """Do it; what is refused is said, and of which request; what was stopped is not."""
        try:
            await work
        except StoppedError:
            pass
        except Exception as error:
            if not isinstance(error, RefusedError):  # no user's: the page is told, the terminal shows where
                traceback.print_exc(file=sys.stderr)
            refused = refusal(error if isinstance(error, RefusedError) else RefusedError(INSIDE))
            await self._send(refused.added(seq=request.get("seq", 0), of=request["do"]))

    async def _do(self, request: Request) -> None:
        if request["do"] == "gallery":
            await self._send(Message({"kind": "gallery", "documents": GALLERY}))
            return
        verb, *arguments = asked(request)
        found = await (self.read(*arguments) if verb == "read" else self.final.ask(verb, *arguments))
        await self._send(answer(verb, found).added(seq=request.get("seq", 0)))


def asked(request: Request) -> list[Any]:
    """The method of a session, and its arguments, for a request other than "move" and "rest"."""
    if request["do"] == "read":
        return ["read", str(request.get("name")), str(request.get("text"))]
    more: dict[str, list[Any]] = {"handle": [request.get("at")], "export": [str(request.get("format"))]}
    return [request["do"], request["document"], *more.get(request["do"], [])]


def answer(verb: str, found: Any) -> Message:
    """The message for a page about a session's result."""
    kind = {"read": "document", "repair": "changed", "handle": "changed"}.get(verb)
    return found if kind is None else Message({"kind": kind, "document": found})


STOPPABLE = {"solve", "measure", "repair"}
"""The requests that are worthless once another document is final."""

VERBS = {"move", "rest", "gallery", "read", "repair", "handle", "export", "combs", "safe", "mesh"}
WITH_DOCUMENT = VERBS - {"gallery", "read"}


def request_of(text: str) -> Request:
    """A request; raises `ValueError` with one sentence for what is none."""
    try:
        request = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError("a request must be JSON") from None
    if not isinstance(request, dict) or request.get("do") not in VERBS:
        raise ValueError(f"a request says what to do: one of {', '.join(sorted(VERBS))}")
    longest_request = 1 << 18  # characters of a request; those that bring a file may have `LONGEST_FILE`
    if len(text) > (LONGEST_FILE if request["do"] == "read" else longest_request):
        raise ValueError("the request is too long")
    if request["do"] in WITH_DOCUMENT and not isinstance(request.get("document"), dict):
        raise ValueError("the request has no document")
    seq = request.get("seq", 0)
    if not isinstance(seq, int) or isinstance(seq, bool):
        raise ValueError("seq must be a whole number")
    return request
