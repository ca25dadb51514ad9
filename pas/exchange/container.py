"""The container of project files: JSON with a format, a version and a checksum.

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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pas.algebra.inputs import DEEPEST, SHOWN, depth, shown
from pas.errors import LimitError, PasError, ProjectFileError
from pas.exchange.files import read_text, replacing, source, target
from pas.exchange.formats import FORMATS

FORMAT = "pas-project"
VERSION = 1
SUFFIX = ".pas.json"

MOST_BYTES = 1 << 28
"""Of a project file: a part that is a mesh of a million triangles takes half."""


def check_name(path: str | Path) -> None:
    """Raise `ValueError` unless the name ends in `.pas.json` and a file can be written there."""
    target(path, (SUFFIX,), "a project")


def write(path: str | Path, content: dict[str, Any], written_by: str) -> Path:
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


def read(path: str | Path, *, edited: bool = False) -> dict[str, Any]:
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
    """What is wrong with a content, as it is read inside, becomes a `ProjectFileError` with the file's name."""
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
