"""Wheels for other platforms than the machine's own: the C library is compiled for each by `ziglang`.

    python build_wheels.py [-o DIR] [PLATFORM ...]

makes one wheel for each platform, for any Python, in DIR (`dist`).  It needs `pip` and `ziglang`.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from shutil import copytree, ignore_patterns

HERE = Path(__file__).resolve().parent
PLATFORMS = {
    "manylinux_2_17_x86_64": "x86_64-linux-gnu.2.17",
    "manylinux_2_17_aarch64": "aarch64-linux-gnu.2.17",
    "musllinux_1_2_x86_64": "x86_64-linux-musl",
    "musllinux_1_2_aarch64": "aarch64-linux-musl",
    "macosx_11_0_x86_64": "x86_64-macos.11.0",
    "macosx_11_0_arm64": "aarch64-macos.11.0",
    "win_amd64": "x86_64-windows-gnu",
    "win_arm64": "aarch64-windows-gnu",
}
"""The tag of a wheel's platform, and what the compiler calls it."""

LEFT_OUT = ignore_patterns(".*", "__pycache__", "*.so", "*.egg-info", "tests", "examples", "out", "build", "dist")


def zig() -> str:
    """The compiler's own file, since what pip builds in does not see other packages."""
    found = find_spec("ziglang")
    if found is None or found.origin is None:
        raise SystemExit("the compiler for other platforms is missing: pip install ziglang")
    return str(Path(found.origin).parent / "zig")


def wheel(platform: str, folder: Path) -> None:
    """Make one wheel, from a copy of the sources, so that nothing that was compiled before gets into it.

    Raises `CalledProcessError` where the compiler or pip fails.
    """
    compiler = f"{shlex.quote(zig())} cc -target {PLATFORMS[platform]} -s"
    with tempfile.TemporaryDirectory() as place:
        tree = Path(place) / "tree"
        copytree(HERE, tree, ignore=LEFT_OUT)
        pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps"]
        option = f"--config-settings=--build-option=--plat-name={platform}"
        subprocess.run([*pip, option, "-w", str(folder), str(tree)], check=True, env=os.environ | {"CC": compiler})


def main() -> None:
    """Make the wheels that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("platforms", nargs="*", metavar="PLATFORM", help=f"some of {', '.join(PLATFORMS)}")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "dist")
    options = parser.parse_args()
    if unknown := [name for name in options.platforms if name not in PLATFORMS]:
        parser.error(f"no such platform: {', '.join(unknown)}")
    for platform in options.platforms or PLATFORMS:
        wheel(platform, options.output.resolve())
        print(platform, flush=True)


if __name__ == "__main__":
    main()
