"""The state of one process of the studio: it solves, follows what is dragged, proves and exports.

A session belongs to one page.  `solve` finds the shape of a document as its problem is solved, with all proofs; `move`
gives a shape quickly that is near it (blends follow by Gauss-Newton steps), and `prove` says what holds of that very
shape.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pas.errors import InfeasibleError, InputError, MeshError, NoSolutionError, NotProvedError
from pas.exchange.formats import FORMATS, suffixes_for
from pas.exchange.problem import read_problem, read_toml
from pas.kinds.files import load
from pas.limits import limit
from pas.piecewise import PiecewiseSurface, SurfaceMesh
from pas.pipeline.result import Blend
from pas.shape import KINDS, Shape
from pas.studio import Data, Message, documents
from pas.studio.controls import LENGTHS, SHAPE, controls
from pas.studio.handles import (
    at_degree,
    can_follow,
    coefficients_of,
    handle_controls,
    pulled_by_coefficients,
    shares_of,
    with_handle,
)
from pas.studio.scene import coefficients, hairs, measures, name_of_scene, outline, picture, quick, triangles
from pas.surface.placed import PlacedContacts

PROJECT = ".pas.json"
"""The format that keeps everything exact, of all shapes."""

UNSAVED = re.compile(r"[^\w.-]+")
"""The characters that names of files are cleared of."""


class StudioSession:
    """The state of one process for one page."""

    def __init__(self, stopped: Callable[[], bool] | None = None) -> None:
        self.stopped = stopped
        self.opened: dict[str, Shape] = {}
        self.bases: dict[str, Shape] = {}
        self.seen: Shape | None = None
        self.key = self.scene = ""
        self.placed: Any = None
        self.before: Data = {}
        self.meshed: tuple[PlacedContacts, SurfaceMesh] | None = None
        self.solved: tuple[Data, Shape] | None = None

    def do(self, verb: str, *arguments: Any) -> Any:
        """The result of one of the methods below, given up after two minutes or when stopped."""
        with limit(120.0, stopped=self.stopped):
            return getattr(self, verb)(*arguments)

    def read(self, name: str, text: str) -> Data:
        """The document of a file's text: a problem, or a project, which is open from then on."""
        with TemporaryDirectory() as folder:
            path = Path(folder) / (UNSAVED.sub("_", Path(name).name)[-80:] or "file")
            path.write_text(text, encoding="utf-8")
            if path.suffix == ".toml":
                read_problem(path)
                problem = documents.plain_tables(read_toml(path)[2])
                return {"kind": "problem", "problem": {"name": path.stem, **problem}}
            return self.open(path.name, load(path))

    def open(self, name: str, shape: Shape) -> Data:
        """The document of a shape, which is open from then on."""
        self.opened[name] = shape
        return {"kind": "project", "name": name, "sliders": {}, "blend": can_follow(shape)}

    def solve(self, document: Data) -> Message:
        """The final picture of a document with its verdicts."""
        shape = self.shape_of(document)
        message, kind = picture(shape), documents.DOCUMENTS[document["kind"]]
        self.solved = (document, shape)
        return message.added(
            **_judged(shape), python=kind.python(document), toml=kind.toml(document),
            controls=[*controls(document), *handle_controls(document, shape)],
            members=coefficients_of(shape), shares=shares_of(shape), formats=formats_for(shape),
            final=True, scene=name_of_scene(message), name=name_of(document),
        )  # fmt: skip

    def kept(self, document: Data) -> tuple[str, dict[str, Any]] | None:
        """The data that another session needs to follow from a document's shape; None where that cannot be followed."""
        shape = self.shape_of(document)
        return (_key(documents.base_of(document)), KINDS["blend"].form.write(shape)) if can_follow(shape) else None

    def shape_of(self, document: Data) -> Shape:
        """The shape of a document; where it is not proved, the best that was found."""
        before, shape = self.solved or ({}, None)
        if shape is not None and before == document:
            return shape
        try:
            documents.checked(document)
            return self._refitted(before, document, shape) or documents.solve(document, self.opened)
        except NotProvedError as error:
            if error.blend is None:
                raise
            return error.blend

    def _refitted(self, before: Data, document: Data, shape: Any) -> Shape | None:
        """What `pas.blend` finds at a given degree, from the space that it was found in before; else None.

        With the degree given, a blend is the choice in its space, whatever else was tried: so only points and tension
        may differ from the document `before`.
        """
        given = document["kind"] == "problem" and isinstance(document["problem"].get("degree"), int)
        if not given or not can_follow(shape) or documents.base_of(before) != documents.base_of(document):
            return None
        problem: Any = documents.problem_of(document["problem"])
        if problem.wishes.basis is not None:
            return None
        return shape.space.fit(problem.wishes)

    def take(self, key: str, content: dict[str, Any]) -> None:
        """Begin from a blend that another session has found; a step in place prepares the first one."""
        shape: Blend = KINDS["blend"].form.read(content)
        before: Any = self.bases.get(key)
        if before is not None and before.surface.degree == shape.surface.degree:
            shape = replace(shape, find_space=before.find_space)
        self._keep(key, shape)
        with suppress(InfeasibleError):  # then the first move says so
            self._keep(key, shape.refit())

    def move(self, document: Data, scene: str = "", mesh: bool = False, anew: bool = False) -> Message:
        """A picture of a shape near that of the document; `scene` is what the page has already; with a `mesh` or not.

        Where the blend has to be solved anew, which takes longer, it is the outline of the neighbours, unless `anew`.
        """
        began = time.perf_counter()
        documents.checked(document)
        message = (None if anew else self._outline(document)) or self._moved(document, scene, mesh)
        return message.added(spent=1000 * (time.perf_counter() - began))

    def _moved(self, document: Data, scene: str, mesh: bool) -> Message:
        shape = self._followed(document)
        self.seen, self.key, self.before = shape, _key(documents.base_of(document)), document
        if not can_follow(shape):
            return quick(shape)
        surface = shape.surface  # type: ignore[attr-defined]  # of blends
        if surface.placed is self.placed and f"{surface.degree} {self.scene}" == scene:
            parts = {}
            with suppress(MeshError):  # what has no mesh is drawn by rays, however slowly
                parts = triangles(self._meshed(surface), surface) if mesh else {}
            head = {"kind": "moved", "scene": scene, "exponent": surface.scaled.exponent}
            return Message(head, {"coefficients": coefficients(surface), **parts})
        message = picture(shape)
        name = name_of_scene(message)
        self.placed, self.scene = surface.placed, name.partition(" ")[2]
        return message.added(scene=name)

    def mesh(self, document: Data) -> Message:
        """The mesh of a document's blend, in its local coordinates; raises `InputError` for other kinds."""
        shape: Any = self.shape_of(document)
        if not can_follow(shape):
            raise InputError("only blends are drawn otherwise than by their meshes")
        return Message({"kind": "mesh"}, triangles(self._meshed(shape.surface), shape.surface))

    def _meshed(self, surface: PiecewiseSurface) -> SurfaceMesh:
        """A mesh of a surface, moved from the last one where that is of a surface near by."""
        before, mesh = self.meshed or (None, None)
        near = mesh is not None and before is surface.placed
        mesh = mesh.follow(surface) if near and mesh is not None else surface.mesh()
        self.meshed = surface.placed, mesh
        return mesh

    def _outline(self, document: Data) -> Message | None:
        """The neighbours alone, where these have changed."""
        key = _key(documents.base_of(document))
        if key == self.key or key in self.bases or document["kind"] != "problem":
            return None
        problem: Any = documents.problem_of(document["problem"])
        if not hasattr(problem, "contacts"):
            return None
        return outline(problem.contacts, problem.order, problem.partition)

    def prove(self) -> Message:
        """The verdicts on the shape of the last `move`."""
        if self.seen is None:
            raise InputError("nothing was moved yet")
        return Message({"kind": "verdicts", **_judged(self.seen)})

    def measure(self, document: Data | None = None) -> Message:
        """How fair a document's shape is, or that of the last `move`."""
        shape = self.seen if document is None else self.shape_of(document)
        return measures(shape)

    def repair(self, document: Data) -> Data:
        """A document near one whose shape is refuted, of which the shape is proved; raises `InputError` for none."""
        only = "only blends can be repaired; go back to the last proved one"
        if document["kind"] != "problem":
            raise InputError(only)
        shape = self.shape_of(document)
        if not can_follow(shape):
            raise InputError(only)
        for other in documents.remedies(document, shape):
            try:
                found = documents.solve(other, self.opened)
            except (NotProvedError, InfeasibleError, NoSolutionError):
                continue
            if found.certificate.proved:
                self.solved = (other, found)
                return other
        raise InputError(
            "no repair was found: neither by guarding the witness, nor by lighter weights, nor by a higher degree"
        )

    def handle(self, document: Data, point: Any) -> Data:
        """A document with one handle more, near a point, at its value; raises `InputError` where there is none."""
        shape: Any = self.shape_of(document)
        if not pulled_by_coefficients(shape):
            raise InputError(
                "only blends of a single cell with a box have handles; for others add a point to pass through"
            )
        document = at_degree(document, shape.surface.degree)  # which may find it in another region
        return with_handle(document, self.shape_of(document), point)

    def export(self, document: Data, suffix: str) -> Message:
        """The file of a document's shape in a format that `pas` writes, or its project."""
        if suffix != PROJECT and suffix not in FORMATS:
            raise InputError(f"there is no format {suffix!r}; there are {PROJECT}, {', '.join(FORMATS)}")
        shape, name = self.shape_of(document), name_of(document) + suffix
        if suffix != PROJECT and suffix not in (known := formats_for(shape)):
            raise InputError(f"this shape cannot be written as {suffix} here; it can be as {', '.join(known)}")
        with TemporaryDirectory() as folder:
            path = Path(folder) / name
            shape.save(path) if suffix == PROJECT else shape.write(path, open=True)
            content = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        proved = shape.certificate.proved
        return Message({"kind": "file", "name": name, "proved": proved}, {"content": content})

    def safe(self, document: Data) -> Message:
        """The largest lengths up to which a blend by a generatrix is sound, each for itself; see `largest_safe`."""
        blend: Any = self.shape_of(document)
        found = {name: blend.largest_safe(number, (48, 12)) for number, name in enumerate(LENGTHS)}
        return Message({"kind": "safe", "limits": {name: most for name, most in found.items() if most < inf}})

    def combs(self, document: Data) -> Message:
        """The curvature combs of a document's shape."""
        return hairs(self.shape_of(document))

    def _followed(self, document: Data) -> Shape:
        key = _key(documents.base_of(document))
        before = self.seen if self.key == key else self.bases.get(key)
        if can_follow(before):
            return before.refit(**documents.all_sliders(before, document))  # type: ignore[union-attr]  # it is a blend
        if document["kind"] != "problem":
            return documents.solve(document, self.opened)
        shaped = _shaped(self.before, document)
        if shaped is not None and getattr(self.seen, "kind", "") == "generatrix blend":
            return self.seen.with_shape(**shaped)  # type: ignore[union-attr]  # it is such a blend
        problem: Any = documents.problem_of(document["problem"])
        wishes = getattr(problem, "wishes", None)
        if wishes is None:
            return problem.solve()
        degree = getattr(getattr(self.seen, "surface", None), "degree", None)
        same = degree is not None and self.seen.surface.placed.order == problem.order  # type: ignore[union-attr]
        held = degree if same and problem.degree is None else None
        return replace(problem, degree=held or problem.degree, wishes=wishes.changed(prove=False)).solve()

    def _keep(self, key: str, shape: Shape) -> None:
        self.bases.pop(key, None)
        self.bases[key] = self.seen = shape
        self.key = key
        while len(self.bases) > 4:  # which are enough to begin with when their documents come back
            self.bases.pop(next(iter(self.bases)))


def formats_for(shape: Shape) -> list[str]:
    """The suffixes of the files that a shape can be exported to."""
    return [PROJECT, *suffixes_for(shape)]


def name_of(document: Data) -> str:
    """A plain name for files of a document."""
    given = document["problem"].get("name", "shape") if document["kind"] == "problem" else document.get("name")
    name = str(given or document["kind"]).removesuffix(".pas.json")
    return UNSAVED.sub("_", name)[:80]


def _judged(shape: Shape) -> dict[str, Any]:
    certificate = shape.certificate
    return {
        "proved": certificate.proved,
        "counts": certificate.counts,
        "verdicts": [verdict.to_record() for verdict in certificate.verdicts],
    }


def _shaped(before: Data, document: Data) -> dict[str, Any] | None:
    """The shape values of a blend by a generatrix, where only such numbers differ from the document before."""
    old, new = before.get("problem", {}), document["problem"]
    if "shape" not in old or {**old, "shape": 0} != {**new, "shape": 0} or set(old["shape"]) != set(new["shape"]):
        return None
    moved = {name: value for name, value in new["shape"].items() if value != old["shape"][name]}
    plain_ones = all(name in SHAPE and not isinstance(value, list | dict) for name, value in moved.items())
    return moved if plain_ones else None


def _key(document: Data) -> str:
    return json.dumps(document, sort_keys=True)
