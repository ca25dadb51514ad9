"""Ten million struts as blocks, by a loop and by workers of Dask that are killed: the same to the last bit.

    python benchmarks/cluster.py FOLDER [--cells 108] [--struts 20000]

writes the blocks of BCC in a loop; then by two workers, of which one is killed after an eighth of the blocks, another
after a quarter, and the scheduler after three eighths; then goes on where that ended, with another scheduler.  It
prints seconds of processor time and the most memory of this process and of the workers, how much was done when the
scheduler died, and whether nothing was half written and all hashes are the same.  Each block is replaced by its hash
as soon as it is whole, so that the disk holds few at a time.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any

from distributed import Client

from pas import network

TOLERANCE = 1 / 40
"""A fifth of the radius: the blocks of ten million struts are 43 GB then."""


def hashed(function: Callable[[Any], Path], job: Any) -> Path:
    """Write a block, and put its hash in its place."""
    path = function(job)
    with path.open("rb") as stream:
        told = hashlib.file_digest(stream, "sha256").hexdigest()
    begun = path.with_name(f".{path.name}")
    begun.write_text(told)
    return begun.replace(path)


def most_memory() -> float:
    """Of this process so far, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@contextmanager
def served(folder: Path, name: str) -> Iterator[tuple[Client, subprocess.Popen[bytes]]]:
    """A client of a scheduler and two workers, as processes of their own; and the scheduler's process."""
    file, dask = folder / f"{name}.json", [sys.executable, "-m"]
    log = (folder / f"{name}.log").open("w")
    scheduler = [*dask, "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard"]
    workers = [*dask, "distributed.cli.dask_worker", "--nworkers", "2", "--nthreads", "1", "--no-dashboard"]
    with (
        log,
        subprocess.Popen([*scheduler, "--scheduler-file", str(file)], stderr=log) as first,
        subprocess.Popen(
            [*workers, "--local-directory", str(folder), "--scheduler-file", str(file)], stderr=log
        ) as second,
    ):
        try:
            with Client(scheduler_file=str(file), timeout=120) as client:
                client.wait_for_workers(2, timeout=120)
                yield client, first
        finally:
            second.terminate()
            first.kill()


def killed(folder: Path, count: int, workers: list[int], scheduler: subprocess.Popen[bytes]) -> None:
    """Kill the workers, one after an eighth of the blocks and one after two, and after three the scheduler."""
    for share in (1, 2, 3):
        while len([*folder.glob("block-*")]) < share * count / 8:
            time.sleep(0.1)
        if share == 3:
            scheduler.kill()
        else:
            os.kill(workers[share - 1], signal.SIGKILL)
        print(f"  killed {'the scheduler' if share == 3 else f'worker {share}'}", flush=True)


def main() -> None:
    """Print the three runs and what they agree in."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cells", type=int, default=108)
    parser.add_argument("--struts", type=int, default=20_000, help="of a block")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    place = options.folder.absolute()
    before, start = os.times(), time.perf_counter()

    def say(what: str) -> None:
        nonlocal before, start
        now = os.times()
        seconds, others = sum(now[:2]) - sum(before[:2]), sum(now[2:4]) - sum(before[2:4])
        took = (
            f"{seconds:.0f} s here, {others:.0f} s of processes that ended, {time.perf_counter() - start:.0f} s in all"
        )
        print(f"{what}: {took}; at most {most_memory():.0f} MB", flush=True)
        before, start = now, time.perf_counter()

    net = network.lattice("BCC", options.cells, "1/8")
    say(f"{net}")
    part = net.blend(cache=place / "kept")
    say("checked and blended")
    write = partial(part.write_blocks, tolerance=TOLERANCE, struts=options.struts)
    paths = write(place / "loop", map=lambda function, jobs: map(partial(hashed, function), jobs))
    say(f"{len(paths)} blocks in a loop")
    with served(place, "first") as (client, scheduler):
        workers = list(client.run(os.getpid).values())
        Thread(target=killed, args=(place / "many", len(paths), workers, scheduler), daemon=True).start()
        try:
            write(place / "many", map=lambda function, jobs: client.map(partial(hashed, function), jobs))
        except network.EngineLostError as error:
            print(f"  {error}")
    done = {path.name for path in (place / "many").glob("block-*")}
    say(f"{len(done)} blocks by workers that are killed")
    with served(place, "second") as (client, _):
        write(place / "many", map=lambda function, jobs: client.map(partial(hashed, function), jobs))
        print(f"  workers take at most {max(client.run(most_memory).values()):.0f} MB")
    say(f"the {len(paths) - len(done)} others")
    hidden = [path.name for folder in ("loop", "many") for path in (place / folder).glob(".*")]
    for path in (place / "many").glob("block-*"):
        if path.stat().st_size != hashlib.sha256().digest_size * 2:  # written whole, and its worker killed then
            hashed(lambda same: same, path)
    same = [path.read_text() == (place / "many" / path.name).read_text() for path in paths]
    print(f"{sum(same)} of {len(paths)} hashes are the same; left half written: {hidden or 'nothing'}")


if __name__ == "__main__":
    main()
