"""Runs commands of `pas` in one process with limited memory, one after another: the other half of `test_files`.

Each line on stdin is a list of seconds allowed (or null) and arguments, each reply a line of JSON: exit code (None
where an exception escaped), what was printed, and how much work it was.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import resource
import sys
import time
import traceback

MEMORY = 3 << 30
"""Bytes of address space: a corner with its mesh takes about a third of it, most for libraries that are mapped."""

HANG = 20
"""Seconds of work after which the system ends the process; a busy machine does not make them fewer."""


def run(seconds: float | None, arguments: list[str]) -> dict[str, object]:
    """One command, as the shell would run it with `--seconds`."""
    from pas.cli import main
    from pas.limits import limit

    out, err, start = io.StringIO(), io.StringIO(), time.process_time()
    resource.setrlimit(resource.RLIMIT_CPU, (int(start) + HANG + 1, resource.RLIM_INFINITY))
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            with limit(seconds=seconds):
                code: int | None = main(arguments)
        except BaseException:  # whatever escapes is what the test is about
            code = None
            traceback.print_exc()
    return {"code": code, "out": out.getvalue(), "err": err.getvalue(), "seconds": time.process_time() - start}


def serve() -> None:
    """Answer until stdin ends."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    replies = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what libraries print past Python must not get among the replies
    for line in sys.stdin:
        replies.write(json.dumps(run(*json.loads(line))) + "\n")
        replies.flush()


if __name__ == "__main__":
    serve()
