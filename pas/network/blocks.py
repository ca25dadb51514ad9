"""Meshes of networks by blocks of struts: each a file, made by any engine, by workers that know no more than theirs.

A block has the nodes in a box, and the struts that begin there; together the files are the mesh, and the same bytes
whoever makes them.  A file takes its name when it is whole.  Beside them `blocks.json` tells of what mesh they are, so
that a folder is gone on with by the same run alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.inputs import whole
from pas.errors import PasError
from pas.exchange.files import make_folder, replacing
from pas.exchange.formats.plain import save_stl
from pas.limits import checkpoint, in_parts
from pas.network.placing import MeshShare, PlacedPieces

PLAN = "blocks.json"
"""The file that tells of what mesh the blocks of a folder are."""


class EngineLostError(PasError):
    """The engine that was given as `map` ended before the work did."""


def results(
    map_: Callable[..., Any], function: Callable[[Any], Any], items: list[Any], kept: Path | None, task: str
) -> Iterator[Any]:
    """The results of an engine's `map`, with futures waited for; raises `EngineLostError` where the engine ends."""
    done = 0
    try:
        for _, result in zip(in_parts(items, task), map_(function, items), strict=True):
            yield result.result() if hasattr(result, "result") else result
            done += 1
    except Exception as error:
        if not (isinstance(error, CancelledError | BrokenExecutor) or "distributed" in type(error).__module__):
            raise
        raise EngineLostError(
            f"the engine of map= was lost ({type(error).__name__}) with {done} of {len(items)} results; what was done "
            f"is whole, and kept in {kept}: run it again with another engine, or without one, to go on from there"
        ) from error


def written(job: tuple[Path, MeshShare]) -> Path:
    """Write a block, its part of the mesh, into its file; returns the path."""
    file, share = job
    checkpoint(f"writing {file.name}")
    with replacing(file) as path:
        save_stl(path, share.count, share.triangles())
    return file


def write_blocks(pieces: PlacedPieces, folder: Path, struts: int, map_: Callable[..., Any] = map) -> list[Path]:
    """See `NetworkPart.write_blocks`."""
    network = pieces.network
    whole(struts, "struts", 1, len(network.edges) + struts)
    sides = np.ptp(network.places, axis=0) + 1
    across = max(1, round((len(network.edges) / struts) ** (1 / 3)))
    cells = (network.places - network.places.min(axis=0)) * across // sides
    block = cells @ (across**2, across, 1)
    numbers = np.unique(block[pieces.kinds.of >= 0])
    paths = [folder / "block-{}-{}-{}.stl".format(*np.unravel_index(n, (across,) * 3)) for n in numbers.tolist()]
    _begin(folder, {"mesh": pieces.digest, "struts": struts, "blocks": [path.name for path in paths]})
    shares = zip(paths, pieces.shares(np.searchsorted(numbers, block), len(paths)), strict=True)
    jobs = [(path.absolute(), share) for path, share in shares if not path.exists()]
    for _ in results(map_, written, jobs, folder, "writing blocks"):
        pass
    return paths


def _begin(folder: Path, plan: dict[str, Any]) -> None:
    """Make the folder, or go on with it; raises `ValueError` where its blocks are those of another mesh.

    What a process that was killed had begun to write is removed.
    """
    make_folder(folder)
    for begun in folder.glob(".block-*.stl"):
        begun.unlink(missing_ok=True)
    if plan_of(folder) != plan:
        if any(folder.glob("block-*.stl")):
            raise ValueError(f"{folder} has blocks of another mesh, or cut otherwise; give another folder, or empty it")
        with replacing(folder / PLAN) as path:
            path.write_text(json.dumps(plan))


def plan_of(folder: Path) -> dict[str, Any] | None:
    """The plan that a folder of blocks holds; None where it has none."""
    try:
        plan: dict[str, Any] = json.loads((folder / PLAN).read_text())
        return plan
    except (OSError, ValueError):
        return None


def status(folder: Path) -> tuple[int, int]:
    """How many blocks of a folder are written, and how many there will be; raises `ValueError` for another folder."""
    plan = plan_of(folder)
    if plan is None or not isinstance(plan.get("blocks"), list):
        raise ValueError(f"{folder} is no folder of blocks, which has a file {PLAN}")
    return sum((folder / name).exists() for name in plan["blocks"]), len(plan["blocks"])
