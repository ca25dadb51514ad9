"""What one process of the studio knows and does: it solves, follows what is dragged, proves and exports.

A desk belongs to one page.  `solve` finds the shape of a document as its problem is solved, with all proofs; `move`
gives a shape quickly that is near it (blends follow by Gauss-Newton steps), and `prove` says what holds of that very
shape.
"""

from __future__ import annotations

import hashlib
import json
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pas.algebra.rational import plain, rational
from pas.errors import InfeasibleError, InputError, NoSolutionError, NotProvedError
from pas.exchange.formats import FORMATS
from pas.exchange.problem import read_problem
from pas.exchange.tables import read_toml
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT, MeanAlpha
from pas.kinds.files import load
from pas.limits import limit
from pas.pipeline.result import Blend
from pas.shape import KINDS, Shape, kind_of
from pas.studio import documents
from pas.studio.controls import LENGTHS, SHAPE, TENSION, controls
from pas.studio.documents import Data
from pas.studio.messages import Message
from pas.studio.scene import coefficients, outline, picture, quick
from pas.studio.sections import hairs

PATIENCE = 120.0
"""Seconds after which a shape that is not found is given up."""

KEPT = 4
"""Blends that are kept to begin with, when their document comes back."""

SAMPLED = (48, 12)
"""Of a blend by a generatrix, where its largest safe lengths are looked for: about a second each."""

UNSAVED = re.compile(r"[^\w.-]+")
"""What names of files are cleared of."""

AT_REST: dict[str, Any] = {"inside": (), "outside": (), "through": (), "near": (), "near_weight": DEFAULT_NEAR_WEIGHT}
"""The sliders of a blend of which nothing is wished."""


class Desk:
    """The state of one process for one page."""

    def __init__(self, stopped: Callable[[], bool] | None = None) -> None:
        self.stopped = stopped
        self.opened: dict[str, Shape] = {}
        self.bases: dict[str, Shape] = {}
        self.seen: Shape | None = None
        self.key = self.scene = ""
        self.placed: Any = None
        self.before: Data = {}
        self.solved: tuple[str, Shape] | None = None

    def read(self, name: str, text: str) -> Data:
        """The document of a file's text: a problem, or a project, which is open from then on."""
        with TemporaryDirectory() as folder:
            path = Path(folder) / (UNSAVED.sub("_", Path(name).name)[-80:] or "file")
            path.write_text(text, encoding="utf-8")
            if path.suffix == ".toml":
                read_problem(path)
                problem = documents.plain_tables(read_toml(path)[2])
                return {"kind": "problem", "problem": {"name": path.stem, **problem}}
            shape = self.opened[path.name] = load(path)
            return {"kind": "project", "name": path.name, "sliders": {}, "blend": can_follow(shape)}

    def solve(self, document: Data) -> tuple[Message, tuple[str, dict[str, Any]] | None]:
        """The final picture of a document with its verdicts, and what another desk needs to follow from there."""
        with limit(PATIENCE, stopped=self.stopped):
            shape = self.shape_of(document)
            message = picture(shape)
            head = {**message.head, **_judged(shape), **_texts(document), "controls": controls(document),
                    "final": True, "scene": scene_of(message), "name": name_of(document)}  # fmt: skip
        self.solved = (_key(document), shape)
        kept = (_key(documents.base_of(document)), KINDS["blend"].record(shape, None)) if can_follow(shape) else None
        return Message(head, message.arrays), kept

    def shape_of(self, document: Data) -> Shape:
        """The shape of a document; where it is not proved, the best that was found."""
        if self.solved is not None and self.solved[0] == _key(document):
            return self.solved[1]
        try:
            return documents.solve(documents.checked(document), self.opened)
        except NotProvedError as error:
            if error.blend is None:
                raise
            found: Shape = error.blend
            return found

    def take(self, key: str, content: dict[str, Any]) -> None:
        """Begin from a blend that another desk has found; its first step is prepared."""
        shape: Blend = KINDS["blend"].read(content)
        self._keep(key, shape)
        if shape.standing != "refuted":
            shape.space.fairing(shape.plate)

    def move(self, document: Data, scene: str = "") -> Message:
        """A picture of a shape near that of the document; `scene` is what the page has already."""
        began = time.perf_counter()
        message = self._moved(document, scene)
        return Message({**message.head, "spent": 1000 * (time.perf_counter() - began)}, message.arrays)

    def _moved(self, document: Data, scene: str) -> Message:
        with limit(PATIENCE, stopped=self.stopped):
            documents.checked(document)
            shape = self._followed(document)
            self.seen, self.key, self.before = shape, _key(documents.base_of(document)), document
            if not can_follow(shape):
                return quick(shape)
            surface = shape.surface  # type: ignore[attr-defined]  # of blends
            if surface.placed is self.placed and f"{surface.degree} {self.scene}" == scene:
                return Message({"kind": "moved", "scene": scene}, {"coefficients": coefficients(surface)})
            message = picture(shape)
            name = scene_of(message)
            self.placed, self.scene = surface.placed, name.partition(" ")[2]
            return Message({**message.head, "scene": name}, message.arrays)

    def outline(self, document: Data) -> Message | None:
        """The neighbours alone, where these have changed and the blend has to be solved anew, which takes longer."""
        documents.checked(document)
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
        with limit(PATIENCE, stopped=self.stopped):
            return Message({"kind": "verdicts", **_judged(self.seen)})

    def repair(self, document: Data) -> Data:
        """A document near one whose shape is refuted, of which the shape is proved; raises `InputError` for none."""
        only = "only blends can be repaired; go back to the last proved one"
        if document["kind"] != "problem":
            raise InputError(only)
        shape = self.shape_of(document)
        if not can_follow(shape):
            raise InputError(only)
        with limit(PATIENCE, stopped=self.stopped):
            for other in remedies(document, shape):
                try:
                    found = documents.solve(other, self.opened)
                except (NotProvedError, InfeasibleError, NoSolutionError):
                    continue
                if found.certificate.proved:
                    self.solved = (_key(other), found)
                    return other
        raise InputError(
            "no repair was found: neither by guarding the witness, nor by lighter weights, nor by a higher degree"
        )

    def export(self, document: Data, suffix: str) -> Message:
        """The file of a document's shape in a format that `pas` writes, or its project."""
        if suffix != ".pas.json" and suffix not in FORMATS:
            raise InputError(f"there is no format {suffix!r}; there are .pas.json, {', '.join(FORMATS)}")
        shape, name = self.shape_of(document), name_of(document) + suffix
        with TemporaryDirectory() as folder, limit(PATIENCE, stopped=self.stopped):
            path = Path(folder) / name
            shape.save(path) if suffix == ".pas.json" else shape.write(path)
            content = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        proved = shape.certificate.proved
        return Message({"kind": "file", "name": name, "proved": proved}, {"content": content})

    def safe(self, document: Data) -> Message:
        """The largest lengths up to which a blend by a generatrix is sound, each for itself; see `largest_safe`."""
        blend: Any = self.shape_of(document)
        with limit(PATIENCE, stopped=self.stopped):
            found = {name: blend.largest_safe(number, SAMPLED) for number, name in enumerate(LENGTHS)}
        return Message({"kind": "safe", "limits": {name: most for name, most in found.items() if most < inf}})

    def combs(self, document: Data) -> Message:
        """The curvature combs of a document's shape."""
        with limit(PATIENCE, stopped=self.stopped):
            return hairs(self.shape_of(document))

    def _followed(self, document: Data) -> Shape:
        key = _key(documents.base_of(document))
        before = self.seen if self.key == key else self.bases.get(key)
        if can_follow(before):
            return before.refit(**_sliders(before, document))  # type: ignore[union-attr]  # it is a blend
        if document["kind"] != "problem":
            return documents.solve(document, self.opened)
        shaped = _shaped(self.before, document)
        if shaped is not None and getattr(self.seen, "kind", "") == "generatrix blend":
            other: Shape = self.seen.with_shape(**shaped)  # type: ignore[union-attr]  # it is such a blend
            return other
        problem: Any = documents.problem_of(document["problem"])
        wishes = getattr(problem, "wishes", None)
        if wishes is None:
            found: Shape = problem.solve()
            return found
        degree = getattr(getattr(self.seen, "surface", None), "degree", None)
        held = degree if document["problem"].get("degree") is None and self._same_order(document) else None
        return replace(problem, degree=held or problem.degree, wishes=wishes.changed(prove=False)).solve()

    def _same_order(self, document: Data) -> bool:
        surface = getattr(self.seen, "surface", None)
        return surface is not None and surface.placed.order == document["problem"].get("order")

    def _keep(self, key: str, shape: Shape) -> None:
        self.bases.pop(key, None)
        self.bases[key] = self.seen = shape
        self.key = key
        while len(self.bases) > KEPT:
            self.bases.pop(next(iter(self.bases)))


def remedies(document: Data, shape: Any) -> Iterator[Data]:
    """What may be tried in turn: to ask for proofs, to guard the witness, lighter weights, higher degrees."""
    problem = {name: value for name, value in document["problem"].items() if name not in ("prove", "guard")}
    document = {**document, "problem": problem}
    yield document
    points = problem.get("points", {})
    failed = [v.witness for v in shape.certificate.verdicts if v.failed and v.witness is not None]
    for kind in ("outside", "inside") if failed else ():
        witnesses = [[repr(round(c, 6)) for c in place] for place in failed]
        yield _with(document, points={**points, kind: [*points.get(kind, []), *witnesses]})
    if points.get("near") and not isinstance(points.get("near_weight", ""), list):
        for share in (10, 100):
            weight = rational(points.get("near_weight", DEFAULT_NEAR_WEIGHT)) / share
            yield _with(document, points={**points, "near_weight": plain(weight)})
    for more in (1, 2):
        yield _with(document, degree=shape.surface.degree + more)


def _with(document: Data, **changed: Any) -> Data:
    return {**document, "problem": {**document["problem"], **changed}}


def _texts(document: Data) -> dict[str, Any]:
    """The program and the problem file to copy."""
    kind = documents.DOCUMENTS[document["kind"]]
    return {"python": kind.python(document), "toml": kind.toml(document)}


def name_of(document: Data) -> str:
    """A plain name for files of a document."""
    given = document["problem"].get("name", "shape") if document["kind"] == "problem" else document.get("name")
    name = str(given or document["kind"]).removesuffix(".pas.json")
    return UNSAVED.sub("_", name)[:80]


def scene_of(message: Message) -> str:
    """What makes two pictures differ in coefficients alone."""
    if message.head["how"] != "cast":
        return ""
    digest = hashlib.sha256(json.dumps(message.head["beyond"]).encode())
    for name in ("vertices", "cells", "pieces", "neighbours"):
        digest.update(message.arrays[name].tobytes())
    return f"{message.head['degree']} {digest.hexdigest()[:16]}"


def _judged(shape: Shape) -> dict[str, Any]:
    """The verdicts, and what the kind of shape says of itself."""
    certificate, facts = shape.certificate, kind_of(shape).facts(shape)
    told = {name: facts[name] for name in ("degree", "dimension", "fairness", "beyond") if name in facts}
    limits = getattr(shape, "limits", None)
    return {
        "proved": certificate.proved,
        "counts": certificate.counts,
        "verdicts": [verdict.to_record() for verdict in certificate.verdicts],
        "facts": told | ({} if limits is None else {"limits": vars(limits)}),
    }


def _shaped(before: Data, document: Data) -> dict[str, Any] | None:
    """The shape values of a blend by a generatrix, where only such numbers differ from the document before."""
    old, new = before.get("problem", {}), document["problem"]
    if "shape" not in old or {**old, "shape": 0} != {**new, "shape": 0} or set(old["shape"]) != set(new["shape"]):
        return None
    moved = {name: value for name, value in new["shape"].items() if value != old["shape"][name]}
    plain_ones = all(name in SHAPE and not isinstance(value, list | dict) for name, value in moved.items())
    return moved if plain_ones else None


def can_follow(shape: Any) -> bool:
    """Whether other sliders can be followed from it."""
    return getattr(shape, "kind", "") == "blend"


def _sliders(blend: Any, document: Data) -> dict[str, Any]:
    """All sliders of a document, those that it does not name at rest."""
    tense = {"tension": TENSION} if isinstance(blend.plate, CurvatureVariation) else {}
    usual = {**AT_REST, **tense}
    if document["kind"] == "project":  # the file's own wishes
        usual = {}
    elif isinstance(blend.wishes.normalize, MeanAlpha):
        usual["margin"] = None
    return usual | documents.sliders_of(document)


def _key(document: Data) -> str:
    return json.dumps(document, sort_keys=True)
