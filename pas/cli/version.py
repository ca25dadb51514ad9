"""What `pas --version` says, and with `--verbose` of what the program is made here."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from pas._version import __version__

LIBRARIES = ("numpy", "scipy", "sympy", "python-flint", "cvxpy", "clarabel", "daqp", "pyvista", "vtk", "manifold3d")
"""Those on which results and their speed depend."""


def version_text(verbose: bool) -> str:
    """The version; with `verbose` also that of Python and of libraries."""
    if not verbose:
        return f"pas {__version__}"
    lines = [f"pas {__version__}", f"Python {platform.python_version()} on {platform.platform()}"]
    lines += [f"{name} {_installed(name)}" for name in LIBRARIES]
    return "\n".join(lines)


def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "is not installed"
