"""The compiled library of the package: one shared library, `pas/kernels/_library.so`, which ctypes loads.

It is no extension module of Python: it knows nothing of its versions, so that a wheel is one for each platform.
"""

from __future__ import annotations

from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

from build_backend import compile_library

HERE = Path(__file__).parent
SOURCES = sorted(str(path.relative_to(HERE)) for path in (HERE / "pas" / "kernels").glob("*.c"))


class BuildLibrary(build_ext):
    """Compiles all sources into one library."""

    def get_ext_filename(self, fullname: str) -> str:
        """The library's file, without the names of versions that extension modules have."""
        return str(Path(*fullname.split(".")).with_suffix(".so"))

    def get_export_symbols(self, ext: Extension) -> list[str]:
        """None: there is no initialisation of a module."""
        return []

    def build_extension(self, ext: Extension) -> None:
        """Run the compiler; raises `CalledProcessError` where it fails."""
        compile_library(ext.sources, Path(self.get_ext_fullpath(ext.name)))


class PlatformWheel(bdist_wheel):
    """A wheel for a platform and any Python."""

    def get_tag(self) -> tuple[str, str, str]:
        """As `py3-none-linux_x86_64`."""
        return ("py3", "none", super().get_tag()[2])


setup(
    ext_modules=[Extension("pas.kernels._library", SOURCES)],
    cmdclass={"build_ext": BuildLibrary, "bdist_wheel": PlatformWheel},
)
