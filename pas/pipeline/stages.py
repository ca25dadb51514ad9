"""Seconds spent in each stage of the method, told as they pass."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from pas.algebra.inputs import shown
from pas.limits import checkpoint, note, stage_line

OnStage = Callable[[str, float], None]
"""Called at the end of each stage with its name and seconds."""


@dataclass
class Stages:
    """Seconds spent in each stage, told to a listener as they end."""

    listener: OnStage | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.listener is not None and not callable(self.listener):
            raise TypeError(f"on_stage must be a function of a stage's name and seconds, not {shown(self.listener)}")

    @contextmanager
    def stage(self, name: str, detail: str = "") -> Iterator[None]:
        """Count the time of a block as stage `name`."""
        checkpoint(f"{name}{detail}")
        start = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - start
            self.seconds[name] = self.seconds.get(name, 0.0) + spent
            note(stage_line(f"{name}{detail}", spent))
            if self.listener is not None:
                self.listener(f"{name}{detail}", spent)
