"""How a blend follows a document whose sliders and points were moved: by one step, or anew where that is too long."""

from __future__ import annotations

from typing import Any

from pas.errors import InfeasibleError
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import DEFAULT_NEAR_WEIGHT, MeanAlpha
from pas.shape import Shape
from pas.studio import documents
from pas.studio.controls import TENSION
from pas.studio.gallery import Data

AT_REST: dict[str, Any] = {"inside": (), "outside": (), "through": (), "near": (), "near_weight": DEFAULT_NEAR_WEIGHT,
                           "handles": (), "coefficients": ()}  # fmt: skip
"""The sliders of a blend of which nothing is wished."""


def followed(blend: Any, document: Data) -> Shape:
    """The shape of a document one step from a blend.

    Where that step is too long, as on a machine that had no time for those in between, it is found anew in the same
    space.  Raises `InfeasibleError` where no member does what the document wishes.
    """
    sliders = sliders_of(blend, document)
    found: Shape
    try:
        found = blend.refit(**sliders)
    except InfeasibleError:
        found = blend.space.fit(blend.wishes.changed(**sliders, prove=False))
    return found


def sliders_of(blend: Any, document: Data) -> dict[str, Any]:
    """All sliders of a document, those that it does not name at rest."""
    tense = {"tension": TENSION} if isinstance(blend.plate, CurvatureVariation) else {}
    usual = {**AT_REST, **tense}
    if document["kind"] == "project":  # the file's own wishes
        usual = {}
    elif isinstance(blend.wishes.normalize, MeanAlpha):
        usual["margin"] = None
    return usual | documents.sliders_of(document)
