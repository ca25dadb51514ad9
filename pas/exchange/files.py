"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`, with its suffix, that takes its place when the block ends.

    When the block raises, the temporary file is removed and an older file at `path` stays.
    """
    target = Path(path)
    if target.is_dir():
        raise ValueError(f"{target} is a folder; name the file to write")
    if not target.parent.is_dir():
        raise ValueError(f"the folder {target.parent} of {target.name} does not exist")
    suffix = "".join(target.suffixes[-2:]) if target.name.endswith(".pas.json") else target.suffix
    handle, name = tempfile.mkstemp(prefix=f".{target.stem}-", suffix=suffix, dir=target.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
