"""Where members pass levels along rays: every sign change, in order, by numpy and by compiled code the same bits."""

from __future__ import annotations

import numpy as np
import pytest

from pas.algebra.kernels import VARIABLE
from pas.fairing.kernels import ROOM, compiled
from pas.fairing.rays import CHUNK, SAMPLES, crossed

SHARES = np.arange(SAMPLES + 1) / SAMPLES


@pytest.fixture
def kernel(monkeypatch):
    monkeypatch.setenv(VARIABLE, "compiled")
    return compiled()


def rising(rays, degree):
    """Profiles that are negative at first; some never pass a level, and some pass two in a step."""
    profiles = np.random.default_rng(degree).uniform(0, 1, (degree + 1, rays))
    profiles[0] = np.linspace(-1, 0.05, rays)
    profiles[1:, ::7] = 0
    return profiles


@pytest.mark.parametrize("degree", [1, 4, 9])
@pytest.mark.parametrize("rays", [0, 1, 63, 64, CHUNK, 2 * CHUNK + 77])
def test_compiled_and_numpy_find_the_same_bits(kernel, degree, rays):
    profiles = rising(rays, degree)
    for one, other in zip(crossed(profiles, SHARES, 0.02), kernel(profiles, SHARES, 0.02), strict=True):
        assert np.array_equal(one, other)


def test_crossings_are_where_the_levels_are():
    profiles = np.array([[-0.5, -2.0, 0.3], [1.0, 1.0, -1.0]])  # t - 1/2, t - 2, 3/10 - t
    rays, shares, slopes = crossed(profiles, SHARES, 0.1)
    assert rays.tolist() == [0, 0, 0, 2, 2, 2]
    assert np.allclose(shares, [0.4, 0.5, 0.6, 0.2, 0.3, 0.4])
    assert slopes.tolist() == [1.0, 1.0, 1.0, -1.0, -1.0, -1.0]


def test_two_levels_in_one_step_are_both_found():
    rays, shares, _ = crossed(np.array([[-0.51], [1.0]]), SHARES, 0.001)
    assert rays.tolist() == [0, 0, 0]
    assert np.allclose(shares, [0.509, 0.51, 0.511])


def test_more_crossings_than_there_is_room_for_are_left_to_numpy(kernel):
    wild = np.polynomial.chebyshev.Chebyshev.basis(9, domain=[0, 1]).convert(kind=np.polynomial.Polynomial).coef
    profiles = np.repeat(wild[:, None], 100, axis=1)
    assert kernel(profiles, SHARES, 0.5) is None
    assert len(crossed(profiles, SHARES, 0.5)[0]) == 100 * 9 * 3 > ROOM * 101
