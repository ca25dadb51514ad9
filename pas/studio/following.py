"""Where the sliders of a document stand, for the blend that follows them."""

from __future__ import annotations

from typing import Any

from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT, MeanAlpha
from pas.studio import documents
from pas.studio.controls import TENSION
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
