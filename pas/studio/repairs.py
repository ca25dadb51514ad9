"""What may be tried where the shape of a document is refuted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pas.algebra.rational import plain, rational
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT
from pas.studio.controls import OF_DEGREE
from pas.studio.gallery import Data


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
    for more in (1, 2) if not any(points.get(name) for name in OF_DEGREE) else ():
        yield _with(document, degree=shape.surface.degree + more)


def _with(document: Data, **changed: Any) -> Data:
    return {**document, "problem": {**document["problem"], **changed}}
