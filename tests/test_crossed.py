"""Where polynomials pass levels along rays: every sign change, in order."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from pas.fairing.constraints import SAMPLES, crossed

SHARES = np.arange(SAMPLES + 1) / SAMPLES


def one_by_one(profiles, band):
    """Columns, shares and slopes in the order in which they are asked for, ray by ray."""
    found = []
    for ray, profile in enumerate(profiles.T.tolist()):
        values = [0.0] * len(SHARES)
        for coefficient in reversed(profile):
            values = [v * s + coefficient for v, s in zip(values, SHARES.tolist(), strict=True)]
        for step, (low, high) in enumerate(pairwise(values)):
            for level in (-band, 0.0, band):
                if (low >= level) != (high >= level):
                    share, slope = (step + (low - level) / ((low - level) - (high - level))) / SAMPLES, 0.0
                    for power in range(len(profile) - 1, 0, -1):
                        slope = slope * share + power * profile[power]
                    found.append((ray, share, slope))
    return np.array(found).reshape(-1, 3).T


def rising(rays, degree):
    """Profiles that are negative at first; some never pass a level, and some pass two in a step."""
    profiles = np.random.default_rng(degree).uniform(0, 1, (degree + 1, rays))
    profiles[0] = np.linspace(-1, 0.05, rays)
    profiles[1:, ::7] = 0
    return profiles


@pytest.mark.parametrize("degree", [0, 1, 4, 9])
@pytest.mark.parametrize("rays", [0, 1, 63, 64, 200])
def test_crossings_are_those_that_are_found_one_by_one(degree, rays):
    profiles = rising(rays, degree)
    for found, expected in zip(crossed(profiles, SHARES, 0.02), one_by_one(profiles, 0.02), strict=True):
        assert np.array_equal(found, expected)


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


def test_there_is_room_for_every_level_in_every_step():
    wild = np.polynomial.chebyshev.Chebyshev.basis(9, domain=[0, 1]).convert(kind=np.polynomial.Polynomial).coef
    rays, _, _ = crossed(np.repeat(wild[:, None], 100, axis=1), SHARES, 0.5)
    assert np.bincount(rays).tolist() == [9 * 3] * 100
    every = crossed(np.array([[-1.0], [4.0]]), np.arange(2) / 2, 0.5)  # three levels in the only step
    assert [part.tolist() for part in every] == [[0, 0, 0], [0.125, 0.25, 0.375], [4.0, 4.0, 4.0]]
