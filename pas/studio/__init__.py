"""The studio: a page on this machine in which shapes are dragged, and seen with their curvature and their proofs.

`GALLERY` are starting points: documents by name, for a page that is opened without a file.  They are nothing but plain
data, so that the server is there at once: problems stand as such in `gallery.toml`.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

Data = dict[str, Any]

TEAPOT = {"lid_height": "7/5", "spout_tilt": "0", "handle_size": "1"}
"""The teapot's parameters as they are without a word."""

_PROBLEMS = tomllib.loads(Path(__file__).with_name("gallery.toml").read_text(encoding="utf-8"))

GALLERY: dict[str, Data] = {
    **{title: {"kind": "problem", "problem": problem} for title, problem in _PROBLEMS.items()},
    "Teapot": {"kind": "teapot", "values": dict(TEAPOT)},
}
"""The documents; a test solves each."""
