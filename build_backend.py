"""The package's build: that of setuptools, which asks for a C compiler in a wheel where the machine has none."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403  # the hooks of PEP 517 and 660

COMPILERS = ("cc", "gcc", "clang")
"""Tried in this order, after `$CC`."""

OPTIONS = ("-O3", "-fPIC", "-shared", "-ffp-contract=off")
"""No contraction: a product and a sum in one rounding would give other results on other machines."""

WHEEL = "ziglang>=0.13"
"""A C compiler that installs like any package."""


def found() -> str | None:
    """The machine's C compiler, with its options; None where there is none."""
    return os.environ.get("CC") or next((name for name in COMPILERS if shutil.which(name)), None)


def compile_library(sources: Iterable[str | Path], place: Path) -> None:
    """Make one shared library of C sources.  Raises `CalledProcessError` where the compiler fails."""
    place.parent.mkdir(parents=True, exist_ok=True)
    made = place.with_suffix(".new")
    compiler = found() or f"{sys.executable} -m ziglang cc"
    subprocess.run([*shlex.split(compiler), *OPTIONS, "-o", str(made), *map(str, sources), "-lm"], check=True)
    made.replace(place)  # at once: what has it loaded keeps the old one


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What a build needs besides setuptools."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *([] if found() else [WHEEL])]


def get_requires_for_build_editable(config_settings: Any = None) -> list[str]:
    """What an editable installation needs besides setuptools."""
    return [*build_meta.get_requires_for_build_editable(config_settings), *([] if found() else [WHEEL])]
