"""The container of project files: JSON with a format, a version and a checksum.

`{"format": "pas-project", "version": 1, "written_by": ..., "sha256": ..., "content": {...}}`; the
checksum is that of the content in canonical form, so that a file changed by hand or damaged is
noticed before its verdicts are believed.  The content has a `kind` ("blend", "solid", "assembly", "parametric surface",
"parametric blend", "generatrix blend"); without one it is a blend.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from pas.errors import ProjectFileError
from pas.exchange.files import replacing, source, target

FORMAT = "pas-project"
VERSION = 1
SUFFIX = ".pas.json"


def check_name(path: str | Path) -> None:
    """Raise `ValueError` unless the name ends in `.pas.json` and a file can be written there."""
    target(path, (SUFFIX,), "a project")


def write(path: str | Path, content: dict[str, Any], written_by: str) -> Path:
    """Write a project file; returns its path."""
    record = {
        "format": FORMAT,
        "version": VERSION,
        "written_by": written_by,
        "sha256": checksum(content),
        "content": content,
    }
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return Path(path)


def read(path: str | Path, *, edited: bool = False) -> dict[str, Any]:
    """The content of a project file.

    Raises `ProjectFileError` for a file that is no project file, was truncated, comes from a
    newer version, or (unless `edited`) does not match its checksum; `FileNotFoundError`.
    """
    file = source(path)
    name = file.name
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise ProjectFileError(
            f"{name}: not readable as JSON at line {error.lineno} ({error.msg}); the file was truncated or edited; "
            "write it again"
        ) from None
    except UnicodeDecodeError:
        raise ProjectFileError(f"{name}: not a text file, so no project file") from None
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise ProjectFileError(f"{name}: not a project file of pas (its format is not {FORMAT!r})")
    version = record.get("version")
    if not isinstance(version, int) or version > VERSION:
        raise ProjectFileError(
            f"{name}: written in version {version} of the format by {record.get('written_by', 'an unknown program')}, "
            f"but this program reads up to version {VERSION}; update pas"
        )
    content = record.get("content")
    if not isinstance(content, dict):
        raise ProjectFileError(f"{name}: has no content; the file was truncated or edited")
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
