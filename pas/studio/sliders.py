"""What a document says of a blend beside its problem: where its sliders stand, and what may be tried where it fails."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pas.algebra.rational import plain, rational
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT, MeanAlpha
from pas.studio import documents
from pas.studio.controls import OF_DEGREE, TENSION
from pas.studio.gallery import Data

AT_REST: dict[str, Any] = {"inside": (), "outside": (), "through": (), "near": (), "near_weight": DEFAULT_NEAR_WEIGHT,
                           "handles": (), "coefficients": ()}  # fmt: skip
"""The sliders of a blend of which nothing is wished."""


def sliders_of(blend: Any, document: Data) -> dict[str, Any]:
    """All sliders of a document, those that it does not name at rest."""
    tense = {"tension": TENSION} if isinstance(blend.plate, CurvatureVariation) else {}
    usual = {**AT_REST, **tense}
    if document["kind"] == "project":  # the file's own wishes
        usual = {}
    elif isinstance(blend.wishes.normalize, MeanAlpha):
        usual["margin"] = None
    return usual | documents.sliders_of(document)


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
