"""Names of files, checked before any work, and writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pas.errors import PasError


def source(path: Any) -> Path:
    """The path of a file to be read; raises `TypeError` for what is no path, `ValueError` for no possible one."""
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"the file must be given by its name, not by {path!r}")
    if "\0" in os.fspath(path):
        raise ValueError(f"the file name {os.fspath(path)!r} has a null character in it")
    if any(len(os.fsencode(part)) > 255 for part in Path(path).parts):
        raise ValueError(f"the file name {_short(Path(path).name)} is too long")
    return Path(path)


def read_text(file: Path, most: int, error: type[PasError]) -> str:
    """The text of a file of at most `most` bytes; raises `error` for a longer one and for what is no text."""
    with file.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise error(f"{file.name}: is larger than {most >> 20} MB, so it is no such file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise error(f"{file.name}: not a text file in UTF-8") from None


def target(path: Any, suffixes: Sequence[str], what: str, elsewhere: Mapping[str, str] | None = None) -> str:
    """The suffix, in small letters, of a file to be written; call it before the work that makes the content.

    `what` says what is to be written ("a mesh"), `elsewhere` how it can be had with other suffixes.  Raises
    `ValueError` for another suffix, for a folder that does not exist or takes no files, `TypeError` for no path.
    """
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"{what} is written to a path such as 'name{suffixes[0]}', not to {path!r}")
    place = source(path)
    suffix = next((s for s in suffixes if place.name.lower().endswith(s)), None)
    if suffix is None:
        known = ("one of " if len(suffixes) > 1 else "") + ", ".join(suffixes)
        hint = (elsewhere or {}).get(place.suffix.lower(), "")
        raise ValueError(f"cannot write {what} as {_short(place.name)}; the suffix must be {known}{hint}")
    check_place(place)
    return suffix


def check_place(target: Path) -> None:
    """Raise `ValueError` unless a file can be written at `target`."""
    if len(os.fsencode(target.name)) > 200:  # most systems take 255, of which the name while writing needs some more
        raise ValueError(f"the file name {_short(target.name)} is too long; it may have 200 characters")
    if target.is_dir():
        raise ValueError(f"{target} is a folder; name the file to write")
    if not target.parent.is_dir():
        raise ValueError(f"the folder {target.parent} of {target.name} does not exist")
    check_folder(target.parent)


def check_folder(folder: Path) -> None:
    """Raise `ValueError` unless files can be written in an existing folder."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            return
    except OSError as error:
        reason = "the system allows no files there" if isinstance(error, FileNotFoundError) else error.strerror
        raise ValueError(f"nothing can be written to the folder {folder}: {reason}") from None


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`, with its suffix, that takes its place when the block ends.

    When the block raises, the temporary file is removed and an older file at `path` stays.
    """
    target = source(path)
    check_place(target)
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


@contextmanager
def together(folder: Path) -> Iterator[Path]:
    """A temporary folder whose files move to `folder`, which need not exist, when the block ends.

    When the block raises, none of them does.
    """
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    with tempfile.TemporaryDirectory(prefix=".pas-", dir=existing) as name:
        yield Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        for file in Path(name).iterdir():
            file.replace(folder / file.name)


def _short(name: str) -> str:
    return repr(name if len(name) <= 60 else f"{name[:40]}...{name[-17:]}")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
