"""Project files (`.pas.json`) of shapes of every kind: everything exact, and back.

Guaranteed: what is read is equal to what was written.  Verdicts go along for people to read; no program believes them:
they are proved anew, in this process, when they are first asked for.  Files of version 1 of the format are read.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Unpack, cast

from pas._version import __version__
from pas.algebra.inputs import shown
from pas.errors import ProjectFileError
from pas.exchange.files import SUFFIX, read_project, target, understood, write_project
from pas.exchange.records import VERDICT
from pas.exchange.schema import TEXT, Table, list_of, maybe
from pas.limits import WorkLimits, limited
from pas.shape import KINDS, Kind, Shape, kind_of
from pas.verdicts import Verdicts

FIRST_KIND = "blend"
"""The kind of files of the first versions, which do not say it."""


@limited("writing a project file", "")
def save(shape: Shape, path: str | Path, certificate: Verdicts | None = None, **limits: Unpack[WorkLimits]) -> Path:
    """Write any shape as a project file (`.pas.json`), exactly; returns the path.

    `pas.load` reads it.  A blend is proved first where that has not been done; of others the `certificate`, where
    given, goes with the file for those who read it.

    Raises `ValueError` unless the name ends in `.pas.json`, for the certificate of another blend, and for what has no
    exact text: functions of classes that do not say how to save them, surfaces, boundaries and curves that are
    callables; `TypeError` for what is no shape.
    """
    target(path, (SUFFIX,), "a project")
    kind = kind_of(shape, "what to save")
    content = {"kind": kind.name, **kind.form.write(shape)}
    if kind.kept:
        content["verdicts"] = None if certificate is None else _verdicts_of(shape, certificate)
    return write_project(path, content, f"pas {__version__}")


def _verdicts_of(shape: Shape, certificate: Verdicts) -> list[dict[str, Any]]:
    """The verdicts to keep with a blend; raises `ValueError` for those of another blend.

    Verdicts on the contacts must be the same; that on regularity may be of another domain.
    """
    told, own = (cast(Any, found) for found in (certificate, shape.certificate))
    if type(told) is not type(own) or told.contacts != own.contacts:
        raise ValueError("certificate must be that of the blend that is saved, and it is another's")
    return [v.to_record() for v in certificate.verdicts]


@limited("reading a project file", "")
def load(path: str | Path, *, edited: bool = False, **limits: Unpack[WorkLimits]) -> Shape:
    """Read a project file back: a shape of whatever kind it holds, exactly as it was written.

    No verdict of a file is believed: all are proved, in this process, when they are first asked for.  A blend has those
    of its file as `stored`.  With `edited`, a file whose checksum does not match is read all the same.

    Raises `ProjectFileError` (see `pas.exchange.files.read_project`) or `FileNotFoundError`.
    """
    content, name = read_project(path, edited=edited), Path(path).name
    title = content.get("kind", FIRST_KIND)
    if not isinstance(title, str) or title not in KINDS:
        raise ProjectFileError(
            f"{name}: holds a thing of kind {shown(title)}, which this program does not know; update pas"
        )
    kind = KINDS[title]
    with understood(name):
        form = whole_form(kind)
        replace(form, may={**form.may, "kind": TEXT}).check(content, "content")
        return kind.form.read(content)


def whole_form(kind: Kind[Any]) -> Table:
    """The form of files of a kind of shapes, with verdicts where some are kept; null where none was given."""
    return (
        replace(kind.form, needs={**kind.form.needs, "verdicts": maybe(list_of(VERDICT))}) if kind.kept else kind.form
    )


save_solid = save_parametric = save
load_solid = load
"""Names of the first versions, when there was a verb for each sort of shapes."""
