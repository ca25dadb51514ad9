"""`pas network`: graphs of struts checked, repaired and made into bodies."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pas.algebra.inputs import whole
from pas.algebra.rational import positive
from pas.cli.commands import write_outputs
from pas.cli.common import DONE, FAILED, Clock, CommandResult, settings_of, verdict_record, written_lines
from pas.errors import library, meant
from pas.exchange.files import make_folder, target
from pas.exchange.formats import suffixes_of, unit_named
from pas.limits import part as share
from pas.settings import MeshSettings

if TYPE_CHECKING:
    from pas.network.network import Network
    from pas.network.part import NetworkPart


def run_network(options: argparse.Namespace) -> CommandResult:
    """`pas network check`, `classes`, `build` or `status`."""
    action = _ACTIONS.get(options.action)
    if action is None:
        guess = meant(options.action, _ACTIONS) or f"; there are {', '.join(_ACTIONS)}"
        raise ValueError(f"there is no action {options.action!r} on networks{guess}")
    if action is not _build and options.output:
        raise ValueError(f"pas network {options.action} writes nothing; -o is for pas network build")
    return _status(options) if action is _status else action(_network(options), options)


def _network(options: argparse.Namespace) -> Network:
    """The network of a file, or the block of cells whose name stands in the place of one."""
    from pas.network.lattices import UNIT_CELLS, lattice
    from pas.network.network import Network

    if "." not in Path(options.source).name:
        cells = str(options.cells or 1).split(",")
        if len(cells) not in (1, 3) or not all(n.strip().isdecimal() for n in cells):
            raise ValueError(f"--cells must be one whole number or three, as 4 or 4,4,2, not {options.cells}")
        numbers = [int(n) for n in cells] * (3 // len(cells))
        return lattice(options.source, numbers, options.radius or "1/20", positive(options.cell_size, "--cell-size"))
    if options.cells:
        raise ValueError(f"--cells is for unit cells by name ({', '.join(UNIT_CELLS)}), not for {options.source}")
    return Network.read(options.source, options.radius, options.grid)


def _check(network: Network, options: argparse.Namespace) -> CommandResult:
    problems = network.check(whole=options.whole)
    lines = [f"{network!r}"[1:-1], *map(str, problems), f"{len(problems) or 'no'} problem{'s' * (len(problems) != 1)}"]
    record = {"problems": [vars(problem) for problem in problems]}
    return CommandResult("\n".join(lines), record, FAILED if problems else DONE)


def _classes(network: Network, options: argparse.Namespace) -> CommandResult:
    found = network.classes()
    record = [
        {"count": one.count, "symmetries": one.symmetries, "struts": [[*way, *map(str, r)] for way, *r in one.struts]}
        for one in found
    ]
    return CommandResult("\n".join([f"{network!r}"[1:-1], *map(str, found)]), {"classes": record})


def _build(network: Network, options: argparse.Namespace) -> CommandResult:
    outputs = [Path(name) for name in options.output]
    for path in outputs:
        target(path, (".npz", ".csv", ".pas.json", ".png", *suffixes_of("triangles")), "a network")
    unit = unit_named(options.unit) if options.unit else None
    if options.blocks:
        make_folder(Path(options.blocks))  # that it cannot is said before hours of work
        if not options.resume and any(Path(options.blocks).glob("block-*.stl")):
            raise ValueError(f"{options.blocks} has blocks of an earlier run; go on with it by --resume, or empty it")
    clock, mesh = Clock(), settings_of(MeshSettings, options)
    with _engine(options) as map_:
        with share(1 / 3):  # of the time, as blends, proofs and files of large networks take it
            part, network, changes = _blended(network, options, map_)
        clock.passed("blend")
        with share(1 / 2):
            certificate = part.certificate
        clock.passed("prove")
        write_outputs(part, outputs, mesh, unit, clock, npz=network.write, csv=network.write)
        blocks = part.write_blocks(options.blocks, mesh.tolerance, map=map_) if options.blocks else ()
    written = [*outputs, *blocks]
    record = {
        "changes": list(changes),
        "density": part.density,
        "genus": part.genus,
        **verdict_record(certificate),
        "unproved": [vars(problem) for problem in part.unproved],
        "written": list(map(str, written)),
    }
    lines = [*changes, str(part), *(f"not proved: {problem}" for problem in part.unproved), *written_lines(written)]
    return CommandResult("\n".join(lines), record, DONE if certificate.proved else FAILED)


def _blended(
    network: Network, options: argparse.Namespace, map_: Callable[..., Any]
) -> tuple[NetworkPart, Network, tuple[str, ...]]:
    """The body of a network that is repaired as wished, this one, and what was changed."""
    from pas.network.graph import NetworkError

    changes: tuple[str, ...] = ()
    if options.collapse or options.join:
        network, changes = network.repair(collapse=options.collapse, join=options.join)
    while True:
        try:
            how = {"wall": options.wall, "cache": options.cache, "map": map_}
            return network.blend(options.order, options.degree, **how), network, changes
        except NetworkError as error:
            if not options.collapse or not all(problem.struts for problem in error.problems):
                raise
            network, more = network.repair(collapse=error.struts, join=options.join)
            changes += more


@contextmanager
def _engine(options: argparse.Namespace) -> Iterator[Callable[..., Any]]:
    """The `map` that solves and writes: a loop, or workers of Dask; raises `ValueError` and `MissingLibraryError`."""
    if options.workers is None and options.scheduler is None:
        yield map
        return
    if options.workers is not None and options.scheduler is not None:
        raise ValueError("--workers starts processes here, --scheduler takes those of another: give one of them")
    if not options.cache:
        raise ValueError("workers hand blends over in files: give a folder that all of them see as --cache")
    distributed = library("distributed", "workers need Dask: pip install 'pas[distributed]'")
    if options.workers is not None:
        count = whole(options.workers, "--workers", 1, 10_000)
        where = distributed.LocalCluster(count, threads_per_worker=1, dashboard_address=None)
    with nullcontext(options.scheduler) if options.workers is None else where as address:
        try:
            client = distributed.Client(address)
        except (OSError, ValueError) as error:
            raise ValueError(f"there is no scheduler at {address}: {error}") from None
        with client:
            yield client.map


def _status(options: argparse.Namespace) -> CommandResult:
    from pas.network.blocks import status

    done, most = status(Path(options.source))
    return CommandResult(f"{done} of {most} blocks are written", {"written": done, "blocks": most})


_ACTIONS: dict[str, Callable[..., CommandResult]] = {
    "status": _status,
    "check": _check,
    "classes": _classes,
    "build": _build,
}
