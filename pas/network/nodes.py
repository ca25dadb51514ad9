"""The nodes of networks by classes: where their struts begin, and one proved blend for each class.

Clips are first placed as `pas.struts` does, as near as a fair blend leaves room for.  Where those at both ends leave
less than 1/32 of a strut between them, they share the strut in their proportion, none nearer than a blend needs, and
the other clips are placed again, until no strut is short.  Every such round fixes two clips at least, so it ends.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pas.algebra.inputs import check_order
from pas.algebra.rational import rational
from pas.arrays import Floats
from pas.blending.place import place
from pas.contacts.contact import Contact, as_contact
from pas.contacts.endless import Cone, Pipe
from pas.errors import GeometryError, PasError, ProjectFileError
from pas.exchange.files import make_folder
from pas.layouts.clips import has_layout, with_clips
from pas.limits import checkpoint
from pas.network.blocks import results
from pas.network.classes import AUTO, Kinds, NodeClass, NodeKind, kinds_of
from pas.network.graph import NetworkError, NetworkProblem, StrutGraph
from pas.network.problems import graph_problems, nearest
from pas.pipeline.blend import blend
from pas.pipeline.hollow import HollowBlend
from pas.pipeline.result import Blend
from pas.registry import loaded

PARTS, STRAIGHT = 64, 2
"""Shared clips are whole 64ths of a strut, of which at least two remain straight."""

LOAD = "pas.kinds.files:load"
"""Where project files are read, in a layer above."""

Degree = int | Literal["lowest"] | None
Node = Blend | HollowBlend[Blend]


def placed_ends(network: StrutGraph, order: int) -> Kinds:
    """The kinds of all nodes with the ends of their arms, see above.

    Raises `NetworkError` for what is no graph of struts, as with two in one place, and for nodes that have no room.
    """
    check_order(order)
    if wrong := tuple(graph_problems(network)):
        raise NetworkError(wrong)
    clips = np.zeros((len(network.edges), 2), dtype=np.int32)
    known: dict[Any, _Ends] = {}
    seen: dict[NodeKind, NodeKind] = {}  # whose forms are known from the rounds before
    while True:
        kinds = kinds_of(network, clips)
        kinds = replace(kinds, kinds=tuple(seen.setdefault(kind, kind) for kind in kinds.kinds))
        kinds = replace(kinds, arm_ends=_arm_ends(kinds, order, known))
        at = kinds.ends
        short = at.sum(axis=1) > (PARTS - STRAIGHT) / PARTS
        if not short.any():
            _check_layouts(kinds, order, known)
            return kinds
        needed = nearest(kinds)[short] / network.lengths[short, None]
        least = np.ceil(PARTS * np.minimum(needed, at[short]))
        shared = (PARTS - STRAIGHT) * at[short] / at[short].sum(axis=1, keepdims=True)
        shared = np.floor(np.minimum(np.maximum(shared, least), PARTS - STRAIGHT - least[:, ::-1])).astype(np.int32)
        if (fixed := (clips[short] == shared).all(axis=1)).any():
            numbers = np.flatnonzero(short)[fixed].tolist()
            said = "strut {} from point {} to {} is too short for the blends at its ends"
            told = [(n, said.format(n, *network.edges[n].tolist())) for n in numbers]
            raise NetworkError([NetworkProblem("too short", (n,), sentence, (n,)) for n, sentence in told])
        clips[short] = np.maximum(shared, at[short] > 0)


@dataclass(frozen=True)
class _Ends:
    """Where the arms of a class end, in the order of its form, and whether a layout keeps them apart."""

    parts: tuple[float, ...]
    apart: bool


def _arm_ends(kinds: Kinds, order: int, known: dict[Any, _Ends]) -> Floats:
    """The ends of all kinds (K, most arms), those of a class found once; raises `NetworkError`."""
    table = np.zeros((len(kinds.kinds), max((len(kind.arms) for kind in kinds.kinds), default=0)))
    problems = []
    for key, one in kinds.classes.items():
        if key not in known:
            checkpoint(f"placing the ends of {len(kinds.classes)} classes of nodes")
            try:
                arms = _arms(one, [clip / PARTS if clip != AUTO else None for *_, clip in one.kind.arms])
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", UserWarning)  # on clips that are far out, which networks share
                    pipes = with_clips(arms, order)
                parts = tuple(float(pipes[i].clip) for i in one.kind.form.order)
                known[key] = _Ends(parts, not one.blended or has_layout(arms, order))
            except PasError as error:
                problems.append(no_blend(one, error))
                continue
        for number in one.numbers:
            table[number, list(kinds.kinds[number].form.order)] = known[key].parts
    if problems:
        raise NetworkError(problems)
    return table


def _check_layouts(kinds: Kinds, order: int, known: dict[Any, _Ends]) -> None:
    """Raise `NetworkError` for the classes whose arms no layout keeps apart where they end: blends, which take much
    longer than finding that, have none either."""
    problems = []
    for key, one in kinds.classes.items():
        if not known[key].apart:
            try:
                place(pipes_of(one), order)
            except GeometryError as error:
                problems.append(no_blend(one, error))
    if problems:
        raise NetworkError(problems)


def of_nodes(kind: str, one: NodeClass, said: object, struts: tuple[int, ...] = ()) -> NetworkProblem:
    """The problem of the nodes of a class, with the numbers of the first three in the sentence."""
    nodes = tuple(one.nodes.tolist())
    told = ", ".join(map(str, nodes[:3])) + (f" and {len(nodes) - 3} more" if len(nodes) > 3 else "")
    return NetworkProblem(kind, nodes, f"the node{'s' * (len(nodes) > 1)} {told}: {said}", struts)


def no_blend(one: NodeClass, why: object) -> NetworkProblem:
    """The problem that the nodes of a class have no blend; the shortest strut of each may become a point."""
    struts = tuple(np.unique(one.kinds.network.shortest[one.nodes]).tolist())
    advice = (
        "thinner struts may fit, or the shortest there may become a point: repair(collapse=error.struts), --collapse"
    )
    return of_nodes("no blend", one, f"{why}; {advice}", struts)


def pipes_of(one: NodeClass) -> list[Pipe | Cone]:
    """The arms of a class that was placed as pipes or cones with their ends, in steps of the grid."""
    assert one.ends is not None
    return _arms(one, one.ends)


def _arms(one: NodeClass, ends: Sequence[float | None]) -> list[Pipe | Cone]:
    """The arms of a class, in steps of the grid, with ends in parts of their vectors; where a node that takes a blend
    has none, wherever there is room."""
    network = one.kinds.network
    radii, items = [radius / network.grid for radius in network.radii], list[Pipe | Cone]()
    for (vector, size, far, _), end in zip(one.kind.arms, ends, strict=True):
        cone = size != far
        arm = Cone(vector, radii[size], "auto", radii[far] - radii[size]) if cone else Pipe(vector, radii[size], "auto")
        items.append(arm if end is None and one.blended else arm.clipped(Fraction(end or 0)))
    return items


def blends(
    kinds: Kinds, order: int, degree: Degree, wall: Fraction | None, cache: Any, map_: Any
) -> dict[tuple[Any, ...], Node]:
    """A proved blend for the first kind of each class that takes one, hollow with a `wall`, by the class's key.

    Raises `NetworkError` with all nodes for which there is none.
    """
    folder = None if cache is None else Path(cache).absolute()  # workers may run in folders of their own
    if folder is not None:
        make_folder(folder)
    elif map_ is not map:
        raise ValueError("the map of another engine hands blends over in files: give the folder as cache=")
    wanted = _jobs(kinds, order, degree, folder, wall)
    found: dict[tuple[Any, ...], Node] = {}
    problems = []
    given = results(map_, solved, list(wanted.values()), folder, "blending nodes")
    for key, result in zip(wanted, given, strict=True):
        if isinstance(result, str):
            problems.append(no_blend(kinds.classes[key], result))
        else:
            found[key] = _kept(result, wanted[key]) if isinstance(result, Path) else result
    if problems:
        raise NetworkError(problems)
    return found


def _kept(path: Path, job: Job) -> Any:
    """The blend of a file of the cache; raises `ProjectFileError` where it is not that of the node's struts."""
    found: Any = loaded(LOAD)(path)
    kind = "blend" if job.wall is None else "hollow blend"
    if found.kind != kind or met(found, job.wall) != job.meets:
        raise ProjectFileError(f"{path} is no blend of the struts after which it is named; remove it")
    return found


def met(found: Any, wall: Fraction | None) -> tuple[Any, ...]:
    """The order of a blend and the contacts that it meets, with a wall those of its cavity after the outer ones."""
    outer = (found if wall is None else found.outer).surface
    return outer.order, outer.contacts, *(() if wall is None else (found.inner.surface.contacts,))


def _jobs(kinds: Kinds, order: int, *how: Any) -> dict[tuple[Any, ...], Job]:
    """The blend that is to be found for the first kind of each class that takes one, by the class's key."""
    return {key: Job(tuple(pipes_of(one)), order, *how) for key, one in kinds.classes.items() if one.blended}


def matched(
    kinds: Kinds, order: int, found: Sequence[Node], wall: Fraction | None = None
) -> dict[tuple[Any, ...], Node]:
    """Which of some blends is that of which class; raises `ValueError` for a class of which none is."""
    known = {met(blend, wall): blend for blend in found}
    jobs = _jobs(kinds, order, None, None, wall)
    for key, job in jobs.items():
        if job.meets not in known:
            raise ValueError(f"blends has none for the node {kinds.classes[key].nodes[0]}")
    return {key: known[job.meets] for key, job in jobs.items()}


@dataclass(frozen=True)
class Job:
    """One blend to be found: the pipes and cones, the order, the degree, the folder in which it is kept, and for a
    hollow one the wall of its struts, in the model's units over the grid, measured across their axes."""

    pipes: tuple[Pipe | Cone, ...]
    order: int
    degree: Degree
    folder: Path | None
    wall: Fraction | None

    @property
    def inner(self) -> tuple[Contact, ...]:
        """The contacts of a cavity: thinner pipes and cones, with the same ends."""
        wall = rational(self.wall or 0)
        return tuple(as_contact(replace(pipe, radius=rational(pipe.radius) - wall)) for pipe in self.pipes)

    @property
    def meets(self) -> tuple[Any, ...]:
        """The key by which a blend is recognised as that of these pipes, see `met`."""
        outer = self.order, tuple(map(as_contact, self.pipes))
        return outer if self.wall is None else (*outer, self.inner)

    @cached_property
    def path(self) -> Path | None:
        """The file that keeps it."""
        if self.folder is None:
            return None
        told = repr([(tuple(map(str, p.axis)), str(p.radius), str(p.clip), str(p.slope)) for p in self.pipes])
        hollow = "" if self.wall is None else f" {self.wall}"
        name = hashlib.sha256(f"{told} {self.order} {self.degree}{hollow}".encode()).hexdigest()[:32]
        return self.folder / f"{name}.pas.json"


def solved(job: Job) -> Node | Path | str:
    """The blend of a job, or the file that keeps it; of a node without one the sentence that says why."""
    if job.path is not None and job.path.exists():
        return job.path
    try:
        outer = blend(job.pipes, job.order, job.degree)
        found: Node = outer if job.wall is None else outer.hollow(inner=job.inner)
    except PasError as error:
        return str(error)
    return found if job.path is None else found.save(job.path)
