"""Seconds of a processor that work takes, its child processes included."""

from __future__ import annotations

import time
from dataclasses import dataclass
from statistics import median

from pas.bench.case import Case, Prepare, Work
from pas.limits import checkpoint

ENOUGH, MOST, LEAST = 1.0, 50, 3
"""Work is repeated until it took so many seconds in all, at most so often, at least so often unless it is slow."""

SLOW = 4.0
"""Work that takes longer is run once."""


@dataclass(frozen=True)
class Timing:
    """Seconds of one processor: the median and the least of some runs."""

    median: float
    least: float
    runs: int


@dataclass(frozen=True)
class Result:
    """What a case came to: its timing, and those of the peers that are installed."""

    suite: str
    case: str
    about: str
    timing: Timing
    peers: dict[str, Timing]

    @property
    def ratios(self) -> dict[str, float]:
        """How many times as long each peer takes."""
        return {name: peer.median / max(self.timing.median, 1e-9) for name, peer in self.peers.items()}


def spent() -> float:
    """Seconds of processors that this process and those it waited for have used."""
    try:
        import resource  # not on every system
    except ImportError:
        return time.process_time()
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def timed(work: Work, quick: bool = False) -> Timing:
    """Run work until its time is known; `quick` once only."""
    found: list[float] = []
    while True:
        start = spent()
        work()
        found.append(spent() - start)
        few = len(found) < LEAST and found[0] < SLOW
        if quick or len(found) >= MOST or not (few or sum(found) < ENOUGH):
            return Timing(median(found), min(found), len(found))


def measured(suite: str, case: Case, quick: bool = False) -> Result:
    """A case and its peers that are installed, in one run."""

    def time_of(prepare: Prepare) -> Timing:
        checkpoint(f"measuring {suite}: {case.name}")
        work = prepare()
        if not quick:
            work()  # what is made once, and caches
        return timed(work, quick)

    own = time_of(case.prepare)
    return Result(suite, case.name, case.about, own, {name: time_of(made) for name, made in case.peers.items()})
