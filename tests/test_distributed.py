"""A network blended by workers of Dask, one of which is killed: the same to the last bit as without them."""

from __future__ import annotations

import json
import os
import signal
import time
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
