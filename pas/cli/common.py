"""What the commands share: exit codes, progress, checks of arguments."""

from __future__ import annotations

import sys
from pathlib import Path

DONE, FAILED, WRONG = 0, 1, 2


def output_folder(name: str) -> Path:
    """The folder to write to, which need not exist; raises `ValueError` for a file."""
    folder = Path(name)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is not a folder; -o names the folder to write to")
    return folder


def checked_tolerance(tolerance: float) -> float:
    """A positive tolerance; raises `ValueError` for another."""
    if not 0 < tolerance < float("inf"):
        raise ValueError(f"the tolerance must be a positive number, not {tolerance}")
    return tolerance


def progress(stage: str, seconds: float) -> None:
    """Say on stderr how long a stage took."""
    print(f"{stage:<48} {seconds:7.2f} s", file=sys.stderr, flush=True)
