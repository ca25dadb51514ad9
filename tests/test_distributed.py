"""A network blended by workers of Dask, one of which is killed: the same to the last bit as without them."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import pytest

from pas import network

distributed = pytest.importorskip("distributed")


def wheel():
    """A hub with bends around it, so that there are blends of six classes."""
    points = [(0, 0, 0), (6, 0, 0), (6, 6, 0), (0, 6, 0), (-5, 5, 0), (-6, 0, 0), (-4, 0, 5)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6)]
    return network.Network(points, edges, ["1/2", "1/2", "3/8", "3/8", "3/8", "1/4"], "1/64")


def contents(folder):
    """What the files of a cache hold, but for the seconds that they took."""
    found = {}
    for path in Path(folder).glob("[!.]*.pas.json"):  # what a killed process had not yet written whole is hidden
        found[path.name] = json.loads(path.read_text())["content"]
        for key in ("seconds", "attempt_seconds"):
            del found[path.name]["solution"][key]
    return found


@pytest.mark.slow
def test_a_worker_that_is_killed_changes_nothing(tmp_path):
    alone = wheel().blend(1, "lowest", cache=tmp_path / "alone")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        workers = client.run(os.getpid)

        def kill():
            while not any((tmp_path / "many").glob("[!.]*.pas.json")):
                time.sleep(0.01)
            os.kill(next(iter(workers.values())), signal.SIGKILL)

        killer = Thread(target=kill, daemon=True)
        killer.start()
        many = wheel().blend(1, "lowest", cache=tmp_path / "many", map=client.map)
        killer.join(60)
        client.wait_for_workers(2, timeout=60)
        after = client.run(os.getpid)
    assert len(set(workers.values()) - set(after.values())) == 1
    assert contents(tmp_path / "many") == contents(tmp_path / "alone")
    first, second = (part.write(tmp_path / f"{n}.stl").read_bytes() for n, part in enumerate((alone, many)))
    assert first == second


@contextmanager
def served(folder, name):
    """A client of a scheduler and two workers, as processes of their own; and the scheduler's process."""
    file, quiet = folder / f"{name}.json", {"stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--dashboard-address", ":0"]
    with subprocess.Popen([*command, "--scheduler-file", str(file)], **quiet) as scheduler:
        command = [sys.executable, "-m", "distributed.cli.dask_worker", "--nworkers", "2", "--nthreads", "1"]
        command += ["--no-dashboard", "--local-directory", str(folder), "--scheduler-file", str(file)]
        with subprocess.Popen(command, **quiet) as workers:
            try:
                with distributed.Client(scheduler_file=str(file), timeout=60) as client:
                    client.wait_for_workers(2, timeout=60)
                    yield client, scheduler
            finally:
                workers.kill()
                scheduler.kill()


def hashes(folder):
    """Of all files of a folder, hidden ones too."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in Path(folder).iterdir()}


@pytest.mark.slow
def test_blocks_survive_workers_and_schedulers_that_are_killed(tmp_path):
    """Two workers and the scheduler die while a block is written; another scheduler goes on, and all is the same."""
    part = network.lattice("cubic", (8, 8, 8), "1/8").blend(1, "lowest")
    options = {"tolerance": 0.01, "struts": 40}
    paths = part.write_blocks(tmp_path / "loop", **options)
    whole, place = hashes(tmp_path / "loop"), tmp_path / "many"
    with served(tmp_path, "first") as (client, scheduler):
        pids = list(client.run(os.getpid).values())

        def kill():
            for share in (1, 2, 3):
                while len([*place.glob("block-*")]) < share * len(paths) / 8:
                    time.sleep(0.01)
                if share == 3:
                    scheduler.kill()
                else:
                    os.kill(pids[share - 1], signal.SIGKILL)

        killer = Thread(target=kill, daemon=True)
        killer.start()
        with pytest.raises(network.EngineLostError, match=r"map= was lost .* kept in .*many: run it again"):
            part.write_blocks(place, map=client.map, **options)
        killer.join(60)
    done = hashes(place)
    finished = {name for name in done if name.startswith("block-")}
    assert 3 <= len(finished) < len(paths)
    assert all(done[name] == whole[name] for name in finished)
    with served(tmp_path, "second") as (client, _):
        part.write_blocks(place, map=client.map, **options)
    assert hashes(place) == whole
