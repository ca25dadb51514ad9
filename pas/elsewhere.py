"""Functions of other libraries in a process of their own: what cannot be interrupted, or crashes."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pas.limits import checkpoint

WORK = """
import pickle, pkgutil
with open("given", "rb") as given:
    name, arguments, options = pickle.load(given)
found = pkgutil.resolve_name(name)(*arguments, **options)
with open("found", "wb") as place:
    pickle.dump(found, place)
"""
"""The program of the other process in its folder."""


def elsewhere(task: str, function: str, *arguments: Any, **options: Any) -> Any:
    """The result of a function, named as `module:name`, in a process of its own, which ends with the limit.

    For libraries that cannot be interrupted, that crash, or that leave files where they work.  Raises
    `subprocess.CalledProcessError`, with what was written to the standard error stream, where the process fails.
    """
    with TemporaryDirectory(prefix="pas-") as name:
        folder = Path(name)
        (folder / "given").write_bytes(pickle.dumps((function, arguments, options)))
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(str(Path(p).resolve()) for p in sys.path)}
        command, quiet = [sys.executable, "-P", "-c", WORK], subprocess.DEVNULL
        with (
            open(folder / "said", "wb") as said,
            subprocess.Popen(command, cwd=folder, env=environment, stdout=quiet, stderr=said) as process,
        ):
            try:
                while process.poll() is None:
                    checkpoint(task)
                    with suppress(subprocess.TimeoutExpired):
                        process.wait(0.2)
            except BaseException:
                process.kill()
                raise
        if process.returncode:
            errors = (folder / "said").read_text("utf-8", "replace")
            raise subprocess.CalledProcessError(process.returncode, function, stderr=errors)
        return pickle.loads((folder / "found").read_bytes())
