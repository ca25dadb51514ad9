"""Choosing one member of a solution space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pas.errors import NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.wishes import Wishes
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.stages import Stages

if TYPE_CHECKING:
    from pas.pipeline.space import SolutionSpace


def fit(space: SolutionSpace, wishes: Wishes, stages: Stages) -> Blend:
    """Choose the member of a space that meets the wishes best.

    Raises `NoSolutionError` for an empty space, `InfeasibleError` for wishes that contradict, `NotProvedError`.
    """
    if space.dimension == 0:
        raise NoSolutionError(f"the solution space of degree {space.degree} is empty", {space.degree: 0})
    check_wishes(wishes, space.placed)
    return choose(space, wishes, [], stages)


def choose(space: SolutionSpace, wishes: Wishes, attempts: Sequence[Attempt], stages: Stages) -> Blend:
    """The same for wishes that are known not to contradict by themselves; `attempts` are those before this one."""
    if wishes.basis is not None:
        space = space.restricted(wishes.basis)
    stage = "fit and prove" if wishes.prove else "fit"  # a member that is not proved is moved further in
    with stages.stage(stage, f" (degree {space.degree}, dimension {space.dimension})"):
        choice = space.fairing(wishes.energy).choose(wishes)
    history = (*attempts, Attempt(space.degree, space.dimension, "proved" if wishes.prove else "fitted"))
    if not wishes.prove:
        return Blend.of(space, choice, wishes, stages.seconds, history)
    certificate = choice.surface.certificate
    result = Blend.of(space, choice, wishes, stages.seconds, history)
    if not certificate.proved:
        failed = next(v for v in certificate.verdicts if not v.proved)
        raise NotProvedError(f"the surface of degree {space.degree} is not proved: {failed}", result)
    return result
