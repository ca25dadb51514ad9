"""What is measured: cases in suites, and the other programs that do the same work.

A case is prepared outside the clock (imports, data, the problem) and gives the work itself, which is run again and
again.  A peer does the same work in another program; where it does not the same, the case says so.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from pas.registry import Registry

Work = Callable[[], Any]
Prepare = Callable[[], Work]


@dataclass(frozen=True)
class Peer:
    """Another program: a package that Python imports, or a command."""

    name: str
    package: str = ""
    command: str = ""

    @property
    def found(self) -> str | None:
        """Its version, or where it is; None where it is not installed."""
        if self.command:
            return shutil.which(self.command)
        try:
            return version(self.package)
        except PackageNotFoundError:
            return None


PEERS = {
    peer.name: peer
    for peer in (
        Peer("sympy", "sympy"),
        Peer("numpy", "numpy"),
        Peer("cvxpy", "cvxpy"),
        Peer("VTK flying edges", "vtk"),
        Peer("scikit-image", "scikit-image"),
        Peer("manifold3d", "manifold3d"),
        Peer("Singular", command="Singular"),
        Peer("Macaulay2", command="M2"),
    )
}
"""Those that cases are compared with, by name."""


@dataclass(frozen=True)
class Case:
    """One piece of work, and the same by peers; `about` says in words what it is, and how far peers do the same."""

    name: str
    prepare: Prepare
    peers: Mapping[str, Prepare] = field(default_factory=dict)
    about: str = ""


@dataclass(frozen=True)
class Suite:
    """Cases of one subject."""

    name: str
    about: str
    cases: Callable[[], Sequence[Case]]


SUITES: Registry[Suite] = Registry(
    "suite",
    {
        "algebra": "pas.bench.suites.algebra:ALGEBRA",
        "fit": "pas.bench.suites.fit:FIT",
        "eval": "pas.bench.suites.evaluation:EVALUATION",
        "mesh": "pas.bench.suites.meshing:MESHING",
        "blend": "pas.bench.suites.blending:BLENDING",
        "node": "pas.bench.suites.nodes:NODES",
        "parametric": "pas.bench.suites.parametric:PARAMETRIC",
        "solid": "pas.bench.suites.solids:SOLIDS",
    },
)
"""The suites of `pas bench` by name."""
