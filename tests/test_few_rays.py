"""The way to a fair surface begins along few rays: it ends where the way along all of them does."""

from __future__ import annotations

import pytest

import pas
from pas.fairing.fair import FairSearch
from pas.fairing.settling import Settling

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def settled(monkeypatch, degree: int, few: bool) -> tuple[float, list[int]]:
    """The energy of a corner, and along how many rays each step was taken."""
    rays: list[int] = []
    step = Settling._step

    def seen(self, state, damping):
        rays.append(len(state.look.view.distances))
        return step(self, state, damping)

    with monkeypatch.context() as patched:
        patched.setattr(Settling, "_step", seen)
        if not few:
            patched.setattr(FairSearch, "_nearer", lambda self, search, state: state)
        pipes = [pas.Pipe(axis, radius, 1) for axis, radius in zip(AXES, ("1/3", "1/4", "2/5"), strict=True)]
        blend = pas.blend(pipes, 1, degree=degree)
    return blend.energy, rays


@pytest.mark.parametrize("degree", [4, 5])
def test_few_rays_lead_to_the_same_surface_in_fewer_steps_along_all(monkeypatch, degree):
    energy, along = settled(monkeypatch, degree, few=True)
    wanted, other = settled(monkeypatch, degree, few=False)
    assert energy == pytest.approx(wanted, rel=2e-3)
    assert along[0] < max(along) / 2
    assert along.count(max(along)) < other.count(max(other))
