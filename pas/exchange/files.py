"""Names of files, checked before any work, writing files whole or not at all, and the container of project files.

A project file is JSON with a format, a version and a checksum:
`{"format": "pas-project", "version": 1, "written_by": ..., "sha256": ..., "content": {...}}`; the checksum is that of
the content in canonical form, so that a file changed by hand or damaged is noticed before anything is made of it.  It
is no proof of who wrote the file: verdicts in it are not believed.  The content has a `kind` ("blend", "solid",
"assembly", "parametric surface", "parametric blend", "generatrix blend"); without one it is a blend.

Only strict JSON is read: no key twice, no NaN, no infinity, nothing nested deeper than `inputs.DEEPEST`.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from errno import EDQUOT, EFBIG, ENOSPC
from pathlib import Path
from secrets import token_hex
from typing import Any

from pas.algebra.inputs import DEEPEST, SHOWN, depth, shown
from pas.errors import LimitError, PasError, ProjectFileError
from pas.exchange.formats import FORMATS


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


def make_folder(folder: Path) -> None:
    """Make a folder where there is none; raises `ValueError` where there is a file, or nothing can be written."""
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"a folder is needed, and {folder} is a file; give another name")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"the folder {folder} cannot be made: {error.strerror}") from None
    check_folder(folder)


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`, with its suffix, that takes its place when the block ends.

    When the block raises, the temporary file is removed and an older file at `path` stays.
    """
    target = source(path)
    check_place(target)
    suffix = "".join(target.suffixes[-2:]) if target.name.endswith(".pas.json") else target.suffix
    temporary = target.with_name(f".{target.stem}-{token_hex(8)}{suffix}")
    temporary.touch(exist_ok=False)
    try:
        yield temporary
        temporary.replace(target)
    except OSError as error:
        if error.errno in (ENOSPC, EFBIG, EDQUOT):
            raise OSError(error.errno, f"{error.strerror}, so that nothing was written to", str(target)) from error
        raise
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


FORMAT = "pas-project"
VERSION = 1
SUFFIX = ".pas.json"

MOST_BYTES = 1 << 28
"""The most bytes of a project file: a part that is a mesh of a million triangles takes half."""


def write_project(path: str | Path, content: dict[str, Any], written_by: str) -> Path:
    """Write a project file; returns its path.

    Raises `ValueError` for content that could not be read again: nested too deeply, or with numbers that are not
    finite.
    """
    if depth(content) > DEEPEST - 1:
        raise ValueError(f"what is to be saved is nested more than {DEEPEST - 1} deep; save its parts by themselves")
    record = {
        "format": FORMAT,
        "version": VERSION,
        "written_by": written_by,
        "sha256": checksum(content),
        "content": content,
    }
    try:
        text = json.dumps(record, indent=1, allow_nan=False)
    except ValueError:
        raise ValueError("what is to be saved has numbers that are not finite, so it could not be read again") from None
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")
    return Path(path)


def read_project(path: str | Path, *, edited: bool = False) -> dict[str, Any]:
    """The content of a project file.

    Raises `ProjectFileError` for a file that is no project file, was truncated, comes from a
    newer version, or (unless `edited`) does not match its checksum; `FileNotFoundError`.
    """
    file = source(path)
    name = file.name
    if file.suffix.lower() in FORMATS:
        raise ProjectFileError(
            f"{name}: {file.suffix} files are written and not read; what is read are project files (.pas.json), "
            "which shape.save writes"
        )
    if not file.exists():
        raise FileNotFoundError(f"No such file or directory: {file}; give the path of a project file (.pas.json)")
    text = read_text(file, MOST_BYTES, ProjectFileError)
    if file.suffix.lower() == ".toml":
        raise ProjectFileError(f"{name}: is a problem file; read it with pas.read_problem, and solve it")
    if text.strip() and not text.lstrip().startswith(("{", "[")):
        raise ProjectFileError(f"{name}: not a project file of pas (.pas.json), which shape.save writes")
    record = _parsed(text, name)
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise ProjectFileError(f"{name}: not a project file of pas (its format is not {FORMAT!r})")
    version = record.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise ProjectFileError(f"{name}: its version must be a whole number from 1 to {VERSION}, not {shown(version)}")
    if version > VERSION:
        author = str(record.get("written_by", "an unknown program"))[:SHOWN]
        raise ProjectFileError(
            f"{name}: written in version {shown(version)} of the format by {author}, "
            f"but this program reads up to version {VERSION}; update pas"
        )
    content = record.get("content")
    if not isinstance(content, dict):
        raise ProjectFileError(f"{name}: has no content; the file was truncated or edited")
    if depth(content) > DEEPEST:
        raise ProjectFileError(f"{name}: its content is nested more than {DEEPEST} deep")
    if not edited and record.get("sha256") != checksum(content):
        raise ProjectFileError(
            f"{name}: its content does not match its checksum, so it was edited or damaged after it was written; "
            "write it again, or prove what it says now with `pas check --edited`"
        )
    return content


def checksum(content: dict[str, Any]) -> str:
    """SHA-256 of the content in canonical form."""
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode("ascii")).hexdigest()


@contextmanager
def understood(name: str) -> Iterator[None]:
    """Errors inside, of reading a content, become a `ProjectFileError` with the file's name."""
    try:
        yield
    except (LimitError, ProjectFileError):
        raise
    except (ValueError, TypeError, PasError) as error:
        raise ProjectFileError(f"{name}: the content cannot be understood: {error}") from None


def _parsed(text: str, name: str) -> Any:
    """The data of a JSON text; raises `ProjectFileError`."""
    try:
        record = json.loads(
            text, parse_int=_whole, parse_float=_real, parse_constant=_refuse, object_pairs_hook=_without_repeats
        )
        json.dumps(record, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        raise ProjectFileError(
            f"{name}: not readable as JSON at line {error.lineno} ({error.msg}); the file was truncated or edited; "
            "write it again"
        ) from None
    except RecursionError:
        raise ProjectFileError(f"{name}: nested more than {DEEPEST} deep, so no project file") from None
    except UnicodeEncodeError:
        raise ProjectFileError(f"{name}: has half a character in a text; the file was damaged or edited") from None
    except ValueError as error:
        raise ProjectFileError(f"{name}: {error}; the file was edited") from None
    return record


def _whole(text: str) -> int:
    if len(text) > 20:  # counts and indices are shorter, exact numbers are texts
        raise ValueError(f"a whole number of {len(text)} digits is written without quotes")
    return int(text)


def _real(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse(text)


def _refuse(text: str) -> float:
    raise ValueError(f"{text[:SHOWN]} is no finite number")


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"the key {shown(next(k for k in keys if keys.count(k) > 1))} stands twice in one table")
    return table
