"""Problem files (TOML) of corners and other contacts: what to blend, and how.

    order = 2                      # the k of GC^k
    degree = 5                     # optional; "lowest" for the lowest that is proved; without, raised until it is fair
    # tension = 5                  # optional, instead of [energy]: from 0 (full) over 23/5 (as usual) up (slim)
    # name, tolerance, prove, [mesh] and [picture] are those of every problem, see pas.exchange.problem

    [[pipes]]                      # or any other table of pas.contacts.contact.CONTACTS, whose keys are the arguments
                                   # of its class: [[cones]], [[spheres]], ..., [[contacts]] of bare polynomials
    axis = [1, 0, 0]
    radius = "1/3"                 # exact: a string, an integer, or the decimal as written
    clip = 1                       # or "auto" for pipes, cones, elliptic pipes and hyperboloids: where there is room
    point = [0, 0, 0]              # optional

    [partition]                    # optional; its kind is "fan", "strips" or "planes", "layout" with rays and pieces,
                                   # or that of a partition: "six tetrahedra" without one
    center = [0, 0, 0]
    legs = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

    [limits]                       # optional; up to what the surface counts as fair, see pas.FairnessLimits
    hollowness = 1.5

    [energy]                       # optional; of the surface's curvature without; by its kind, "thin-plate" without one
    lower = ["1/4", "-2/5", "-2/5"]
    upper = ["3/5", "2/5", "2/5"]  # one patch over a box instead of all over cells
    piece = 0

    [points]                       # optional
    inside = [["1/2", "1/2", "1/2"]]
    outside = []
    through = []
    near = []
    near_weight = 100
    margin = "1/1000"              # of inside and outside points, in the model's units
    handles = [[[0, [1, 2, 1, 1]], "1/3"]]           # B-coefficients by cell and multi-index, of the degree
    coefficients = { 0 = "1/2", 3 = 2 }              # of members of the basis, numbered from 0

    [normalize]                    # optional
    kind = "mean-alpha"            # or "sum-of-coefficients", or "value-at" with point and value

`basis` (a list of members, each a list of one polynomial a cell) restricts the solutions to a
given basis; `prove = false` and `guard = false` are as in `pas.blend`.  The command's exit code is 1 where a claim is
refuted, whatever `prove` says.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, Self

from pas.algebra.inputs import check_order
from pas.algebra.polynomial import Polynomial
from pas.blending.place import PartitionLike
from pas.contacts.contact import CONTACTS, Contact, HasContact
from pas.exchange.problem import COMMON, COMMON_TABLES, Problem, ProblemKind, TableReader, common
from pas.exchange.records import normalization
from pas.fairing.energy import ENERGIES, read_energy
from pas.fairing.wishes import PointOptions, Wishes, tensed
from pas.layouts.kinds import partition_keys, read_partition_like
from pas.pipeline.blend import blend
from pas.pipeline.result import Blend
from pas.pipeline.search import check_wanted_degree
from pas.registry import constructor_keys, keys_of
from pas.settings import MeshSettings
from pas.surface.fairness_limits import FairnessLimits

OWN = ("degree", "guard", "basis", "partition", "energy", "tension", "limits", "points", "normalize")
"""Keys of the whole file that need not be."""


@dataclass(frozen=True)
class CornerProblem(Problem):
    """A problem as read from a file; the fields are the arguments of `pas.blend`, and those of every problem."""

    contacts: tuple[Contact | HasContact, ...]
    order: int
    degree: int | Literal["lowest"] | None
    partition: PartitionLike | None
    wishes: Wishes

    @property
    def options(self) -> dict[str, Any]:
        """The keyword arguments of `pas.blend` beside contacts, order and degree."""
        return {"partition": self.partition, "wishes": self.wishes}

    def changed(self, **changes: Any) -> Self:
        """See `Problem.changed`; the tension is one of the wishes."""
        tension = changes.pop("tension", None)
        wishes = None if tension is None else self.wishes.changed(tension=tension)
        return super().changed(**changes, wishes=wishes)

    def solve(self) -> Blend:
        return blend(self.contacts, self.order, self.degree, **self.options)


def _keys() -> dict[str, dict[str, bool]]:
    """The keys of all tables, whatever has been registered since."""
    tables = {table: constructor_keys(made) for table, made in CONTACTS.items()}
    return {
        "": COMMON | dict.fromkeys((*OWN, *tables), False) | {"order": True},
        **COMMON_TABLES,
        "points": {name: False for name in PointOptions.__annotations__ if name != "normalize"},
        "normalize": {"kind": True, "point": False, "value": False},
        "limits": {f.name: False for f in fields(FairnessLimits)},
        "partition": dict.fromkeys(partition_keys(), False),
        "energy": dict.fromkeys(keys_of(ENERGIES), False),
        **tables,
    }


def _read(file: Path, text: str, data: dict[str, Any]) -> CornerProblem:
    reader = TableReader(file, text, _keys(), tuple(CONTACTS))
    reader.check(data)
    items = [item for table, made in CONTACTS.items() for item in _contacts(reader, data, table, made)]
    if not items:
        raise reader.error(f"gives no contacts: none of {', '.join(f'[[{t}]]' for t in CONTACTS)}")
    wishes = _wishes(reader, data)
    return CornerProblem(
        **common(reader, data, MeshSettings(), "plain"),
        prove=wishes.prove,
        contacts=tuple(items),
        order=reader.checked(data, "order", check_order),
        degree=reader.checked(data, "degree", check_wanted_degree),
        partition=reader.table(data, "partition", read_partition_like),
        wishes=wishes,
    )


def _contacts(reader: TableReader, data: dict[str, Any], table: str, made: type[Any]) -> list[Any]:
    noun = getattr(made, "noun", table.removesuffix("s").replace("_", " "))
    return reader.each(data, table, lambda entry: made(**entry), noun)


def _wishes(reader: TableReader, data: dict[str, Any]) -> Wishes:
    points = reader.table(data, "points", lambda table: Wishes(**table)) or Wishes()
    energy = reader.table(data, "energy", read_energy)
    if "tension" in data:
        energy = reader.checked(data, "tension", lambda tension: tensed(energy, tension))
    return points.changed(
        energy=energy,
        limits=reader.table(data, "limits", lambda table: FairnessLimits(**table)),
        normalize=reader.table(data, "normalize", lambda table: normalization(**table)),
        basis=reader.checked(data, "basis", _basis),
        prove=reader.typed(data, "prove", bool, True),
        guard=reader.typed(data, "guard", bool, True),
    )


def _basis(members: Any) -> tuple[tuple[Polynomial, ...], ...]:
    if not isinstance(members, list) or not all(isinstance(member, list) for member in members):
        raise ValueError("basis must be a list of members, each a list of polynomials")
    try:
        return tuple(tuple(Polynomial(p) for p in member) for member in members)
    except (ValueError, TypeError) as error:
        raise ValueError(f"basis: {error}") from None


def _fits(data: dict[str, Any]) -> bool:
    return bool(set(CONTACTS) & data.keys()) or not {"surfaces", "boundaries", "method", "solid"} & data.keys()


PROBLEM = ProblemKind("corner", _fits, _read)
