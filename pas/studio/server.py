"""The studio's server: on this machine only, for the pages that know its token.

It listens on the loopback address, answers only requests to itself (Host) and conversations of its own pages (Origin,
and a token that no address of a request ever holds), and lets the page talk to nobody else.  It writes no file.
"""

from __future__ import annotations

import asyncio
import secrets
import socket
import webbrowser
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import Any

from pas.errors import InputError, library
from pas.studio import GALLERY, Data, Message, refusal
from pas.studio.conversation import LONGEST_FILE, Conversation, RefusedError, StoppedError, Worker

PAGE = Path(__file__).parent / "page"

LOOPBACK = "127.0.0.1"

TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}

REFUSED, BUSY = 4403, 4429
"""Codes with which conversations are closed: not allowed, and too many."""


def policy(port: int) -> dict[str, str]:
    """The headers of every answer."""
    own = f"ws://{LOOPBACK}:{port} ws://localhost:{port}"
    return {
        "Content-Security-Policy": (
            f"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
            f"connect-src 'self' {own}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        ),
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Cross-Origin-Opener-Policy": "same-origin",
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cache-Control": "no-store",
    }


class Studio:
    """The state that all pages of one server share: the file that was opened, spare processes, the token."""

    def __init__(self, file: Path | None, port: int, token: str | None = None) -> None:
        self.file, self.port = file, port
        self.token = secrets.token_urlsafe(24) if token is None else token
        self.spare: tuple[Worker, Worker] | None = None
        self.first: Data = next(iter(GALLERY.values()))
        self.closing = False
        self.pages: dict[Conversation, Callable[[Message], Awaitable[None]]] = {}

    @property
    def address(self) -> str:
        """The address of the page; the token stands where browsers send it to nobody."""
        return f"http://{LOOPBACK}:{self.port}/#token={self.token}"

    def own(self, host: str | None) -> bool:
        """Whether a Host, or an Origin without its scheme, is this server."""
        return host in (f"{LOOPBACK}:{self.port}", f"localhost:{self.port}")

    def admits(self, headers: Any, offered: list[str]) -> bool:
        """Whether a conversation may begin."""
        origin = str(headers.get("origin", ""))
        known = any(secrets.compare_digest(o.encode(), self.token.encode()) for o in offered)
        return known and self.own(headers.get("host")) and origin.startswith("http://") and self.own(origin[7:])

    async def talk(self, socket: Any) -> None:
        """One conversation, from the first word to the last."""
        from starlette.websockets import WebSocketDisconnect

        if not self.admits(socket.headers, socket.scope.get("subprotocols", [])):
            await socket.close(REFUSED)
            return
        await socket.accept("pas")
        if len(self.pages) >= 6:  # each has two processes
            await socket.close(BUSY)
            return
        sending = asyncio.Lock()

        async def send(message: Message) -> None:
            async with sending:
                with suppress(RuntimeError, WebSocketDisconnect):  # the page has gone
                    await socket.send_bytes(message.packed())

        ready, self.spare = self.spare or (Worker(), Worker()), None
        conversation = Conversation(send, *ready)
        self.pages[conversation] = send
        running = asyncio.create_task(conversation.run())
        try:
            await self.open(conversation, send)
            while True:
                await conversation.receive(await socket.receive_text())
        except (WebSocketDisconnect, RuntimeError, KeyError):  # gone, or bytes instead of text
            pass
        finally:
            running.cancel()
            self.pages.pop(conversation, None)
            conversation.end()
            if not self.closing:
                self.spare = self.spare or (Worker(), Worker())

    @contextmanager
    def begun(self) -> Iterator[None]:
        """Inside, processes for the first page work; raises `InputError` for a file that is wrong, before all else."""
        self.spare = Worker(), Worker()
        try:
            if self.file is not None:
                self.first = self.spare[1].call("read", self.file.name, self.file.read_text(encoding="utf-8"))
            yield
        except RefusedError as error:
            raise InputError(str(error)) from None
        finally:
            self.end()

    def end(self) -> None:
        """End all processes."""
        self.closing = True
        for conversation in self.pages:
            conversation.end()
        for worker in self.spare or ():
            worker.end()

    async def warm(self) -> None:
        """Solve what the first page shows while its browser starts."""
        if self.spare is not None:
            with suppress(RefusedError, StoppedError):  # the page says what is wrong
                await self.spare[1].ask("solve", self.first)

    async def watch(self) -> None:
        """Tell all pages when the file changes."""
        if self.file is None:
            return
        before = stamp(self.file)
        while True:
            await asyncio.sleep(0.5)
            now = stamp(self.file)
            if now == before or now is None:
                continue
            before = now
            for page, send in list(self.pages.items()):
                with suppress(Exception):  # a page that has just gone
                    await self.open(page, send, changed=True)

    async def open(self, page: Conversation, send: Callable[[Message], Awaitable[None]], changed: bool = False) -> None:
        """Send the document of the file, or what is wrong with it; without one, the starting points.

        A page that has a document already keeps it, unless the file has `changed`.
        """
        if self.file is None:
            await page.receive('{"do": "gallery"}')
            return
        try:
            text = await asyncio.to_thread(self.file.read_text, encoding="utf-8")
            document = await page.read(self.file.name, text)
            head = {"kind": "document", "document": document, "file": self.file.name, "kept": not changed}
            await send(Message(head))
        except (RefusedError, OSError, UnicodeDecodeError) as error:
            await send(refusal(error))


def stamp(file: Path) -> tuple[int, int] | None:
    """When a file was changed, and its size; None where it is gone."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def application(studio: Studio) -> Any:
    """The application that serves the page and its conversations."""
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.middleware.base import BaseHTTPMiddleware
    from starlette.middleware.gzip import GZipMiddleware
    from starlette.responses import PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute

    async def page(request: Any) -> Response:
        name = request.path_params.get("name") or "index.html"
        known = {path.name for path in PAGE.iterdir() if path.suffix in TYPES}
        if name not in known:
            return PlainTextResponse("there is no such page here", 404)
        return Response((PAGE / name).read_bytes(), media_type=TYPES[Path(name).suffix])

    async def guarded(request: Any, call: Any) -> Any:
        answer = await call(request) if studio.own(request.headers.get("host")) else PlainTextResponse("not here", 403)
        answer.headers.update(policy(studio.port))
        return answer

    @asynccontextmanager
    async def lifespan(_: Any) -> AsyncIterator[None]:
        tasks = [asyncio.create_task(work) for work in (studio.watch(), studio.warm())]
        yield
        for task in tasks:
            task.cancel()
        studio.end()

    return Starlette(
        routes=[Route("/", page), Route("/{name}", page), WebSocketRoute("/talk", studio.talk)],
        middleware=[Middleware(GZipMiddleware), Middleware(BaseHTTPMiddleware, dispatch=guarded)],
        lifespan=lifespan,
    )


def listening(port: int) -> socket.socket:
    """A socket on the loopback address; raises `ValueError` for a port that cannot be had."""
    if not 0 <= port <= 65535:
        raise ValueError(f"port must be a whole number from 0 to 65535, not {port}")
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((LOOPBACK, port))
        made.listen(16)
    except OSError:
        made.close()
        raise ValueError(f"port {port} is in use or not allowed; choose another one, or none with --port 0") from None
    return made


def serve(file: Path | None, port: int, tell: Callable[[str], Any], browser: bool = True) -> None:
    """Serve the studio until it is interrupted; `tell` is told the address.

    Raises `ValueError` for a port that is in use, `MissingLibraryError` without the libraries of `pas[studio]`,
    and what reading the file raises.
    """
    if file is not None and not file.name.endswith((".toml", ".pas.json")):
        raise InputError(f"{file} is neither a problem file (.toml) nor a project (.pas.json)")
    door = listening(port)
    studio = Studio(file, door.getsockname()[1])
    with door, studio.begun():
        uvicorn = library("uvicorn", 'the studio needs three small libraries: pip install "pas[studio]"')
        config = uvicorn.Config(
            application(studio), log_level="critical", ws="websockets-sansio", ws_max_size=LONGEST_FILE,
            timeout_graceful_shutdown=1, access_log=False,
        )  # fmt: skip
        tell(f"the studio is at {studio.address} (Ctrl-C ends it)")
        if browser and not webbrowser.open(studio.address):
            tell("there is no browser to open here; copy the address into one on this machine")
        with suppress(KeyboardInterrupt):
            asyncio.run(uvicorn.Server(config).serve(sockets=[door]))
