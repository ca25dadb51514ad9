"""Results do not depend on how many threads linear algebra may have."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import pas
from pas.limits import one_thread


def threads() -> set[int]:
    """The numbers of threads of the libraries for linear algebra in the process that were built to have some."""
    found = [library for library in threadpool_info() if library["user_api"] == "blas"]
    return {library["num_threads"] for library in found if library.get("threading_layer") != "disabled"}


def coefficients(contacts, order):
    surface = pas.blend(contacts, order).surface
    return np.array([patch.dense(surface.degree) for patch in surface.patches])


CORNER = [
    pas.Pipe(axis=a, radius=r, clip=1)
    for a, r in zip(np.eye(3, dtype=int).tolist(), ("1/3", "1/4", "2/5"), strict=True)
]
FOUR = pas.struts([((1, 5, -3), "3/2"), ((-6, 1, 2), 1), ((4, -5, 2), "6/5"), ((0, 2, 7), 1)], 1)


@pytest.mark.parametrize("contacts", [CORNER, FOUR], ids=["corner", "four pipes"])
@pytest.mark.sampled(2)
def test_a_blend_is_the_same_on_one_thread_and_on_three(contacts):
    with threadpool_limits(1, "blas"):
        one = coefficients(contacts, 1)
    with threadpool_limits(3, "blas"):
        three = coefficients(contacts, 1)
        assert threads() == {3}
    assert np.array_equal(one, three)


def test_threads_are_as_before_after_the_last_of_several_computations():
    entered, leave = threading.Barrier(2), threading.Event()

    def other():
        with one_thread():
            entered.wait()
            leave.wait()

    beside = threading.Thread(target=other)
    with threadpool_limits(2, "blas"):
        with pytest.raises(ZeroDivisionError), one_thread():
            with one_thread():
                assert threads() == {1}
            assert threads() == {1}
            beside.start()
            entered.wait()
            raise ZeroDivisionError
        assert threads() == {1}  # the other computes on
        leave.set()
        beside.join()
        assert threads() == {2}
