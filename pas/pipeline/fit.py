"""Choosing one member of a solution space."""

from __future__ import annotations

import time

from pas.errors import NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.solver import FitSolver
from pas.fairing.wishes import Wishes
from pas.pipeline.chosen import Attempt, B, FitSpace
from pas.pipeline.stages import Stages


def fit(space: FitSpace[B], wishes: Wishes, stages: Stages) -> B:
    """Choose the member of a space that meets the wishes best.

    Raises `NoSolutionError` for an empty space, `InfeasibleError` for wishes that contradict, `NotProvedError`.
    """
    if space.dimension == 0:
        raise NoSolutionError(f"the solution space of degree {space.degree} is empty", {space.degree: 0})
    check_wishes(wishes, space.placed)
    return choose(space, wishes.settled(space.placed), stages)


def choose(space: FitSpace[B], wishes: Wishes, stages: Stages) -> B:
    """The member for wishes that are settled and known not to contradict by themselves."""
    began = time.perf_counter()
    if wishes.basis is not None:
        space = space.restricted(wishes.basis)
    stage = "fit and prove" if wishes.prove else "fit"  # a member that is not proved is moved further in
    with stages.stage(stage, f" (degree {space.degree}, dimension {space.dimension})"):
        fitted = FitSolver(space.prepared, wishes).fitted()
    certificate = fitted.surface.certificate if wishes.prove else None
    outcome = "fitted" if certificate is None else "proved"
    attempt = Attempt(space.degree, space.dimension, outcome, time.perf_counter() - began, space.partition.title)
    result = space.blend(fitted, wishes, stages.seconds, (attempt,))
    if certificate is not None and not certificate.proved:
        failed = next(v for v in certificate.verdicts if not v.proved)
        raise NotProvedError(f"the surface of degree {space.degree} is not proved: {failed}", result)
    return result
