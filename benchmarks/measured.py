"""Benchmarks as tables: each case with the programs that do the same work, `pas` first, as tests for pytest-benchmark.

A case is prepared outside the clock (imports, data, the problem) and gives the work itself, which is run again and
again.  Programs that are not installed are skipped.  Seconds are of the processor, child processes included.
"""

from __future__ import annotations

import shutil
import subprocess
import time
from collections.abc import Callable, Mapping
from typing import Any

import pytest

Work = Callable[[], Any]
Prepare = Callable[[], Work]
Cases = Mapping[str, Mapping[str, Prepare]]
"""Of each case, by its name, the preparation by each program, by its name."""


def spent() -> float:
    """Seconds of processors that this process and those it waited for have used."""
    try:
        import resource  # not on every system
    except ImportError:
        return time.process_time()
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def measured(cases: Cases) -> Callable[..., None]:
    """The test of a table of cases."""
    rows = [
        pytest.param(case, program, prepare, id=f"{case}: {program}")
        for case, programs in cases.items()
        for program, prepare in programs.items()
    ]

    @pytest.mark.benchmark(timer=spent)
    @pytest.mark.parametrize(("case", "program", "prepare"), rows)
    def test(benchmark: Any, case: str, program: str, prepare: Prepare) -> None:
        try:
            work = prepare()
        except ImportError as error:
            pytest.skip(f"{program} is not installed: {error}")
        benchmark.group, benchmark.extra_info["program"] = case, program
        benchmark(work)

    return test


def command(*words: str) -> Prepare:
    """The work of a program that is run as a command, its start included."""

    def prepare() -> Work:
        if shutil.which(words[0]) is None:
            raise ImportError(f"there is no command {words[0]}")
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return lambda: subprocess.run(words, check=True, **quiet)

    return prepare
