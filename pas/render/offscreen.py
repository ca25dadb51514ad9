"""Drawing without a screen: checks for the system's OpenGL libraries before VTK needs them.

VTK ends the whole process when it finds no OpenGL, so the libraries are looked for first.
"""

from __future__ import annotations

import ctypes
import os
from typing import Any

from pas.errors import MissingLibraryError
from pas.limits import checkpoint

LIBRARIES = {"libGL.so.1": "libgl1", "libEGL.so.1": "libegl1"}
"""The shared libraries that drawing needs, and Debian's packages of them."""


def offscreen_pyvista() -> Any:
    """The pyvista module, ready to draw without a screen.

    Raises `MissingLibraryError` naming the packages to install.
    """
    missing = [package for library, package in LIBRARIES.items() if not _loads(library)]
    if missing:
        raise MissingLibraryError(
            f"pictures need OpenGL, which is not installed; on Debian: apt-get install {' '.join(missing)}"
        )
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    checkpoint("loading the graphics library")  # which takes seconds on slow machines: looked at between its halves
    import pyvista

    checkpoint()
    import pyvista.plotting

    checkpoint()
    pyvista.OFF_SCREEN = True
    return pyvista


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
