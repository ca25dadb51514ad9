"""Problem files (TOML) of corners and other contacts: what to blend, and how.

    order = 2                      # the k of GC^k
    degree = 5                     # optional; "lowest" for the lowest that is proved; without, raised until it is fair
    # tension = 5                  # optional, instead of [energy]: from 0 (full) over 23/5 (as usual) up (slim)
    tolerance = 1e-3               # optional; of the mesh, in the model's units

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

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Self

from pas.algebra.inputs import check_order, check_tolerance, shown
from pas.algebra.polynomial import Polynomial
from pas.blending.place import PartitionLike
from pas.contacts.contact import CONTACTS, Contact, HasContact
from pas.errors import LimitError, PasError
from pas.exchange.picture_options import PICTURE_KEYS, PictureReader, View
from pas.exchange.problem import Problem, ProblemKind
from pas.exchange.records import NORMALIZATIONS, read_normalization
from pas.fairing.energy import ENERGIES, read_energy
from pas.fairing.wishes import Normalization, Wishes, tensed
from pas.layouts.kinds import partition_keys, read_partition_like
from pas.pipeline.blend import blend, check_wanted_degree
from pas.pipeline.result import Blend
from pas.registry import constructor_keys, keys_of
from pas.surface.fairness_limits import FairnessLimits

KEYS = {
    "": {
        "name",
        "order",
        "degree",
        "tolerance",
        "prove",
        "guard",
        "basis",
        "partition",
        "energy",
        "tension",
        "limits",
        "points",
        "normalize",
        "picture",
    },
    "points": {"inside", "outside", "through", "near", "near_weight", "margin", "handles", "coefficients"},
    "normalize": {"kind", "point", "value"},
    "limits": {"sharpness", "hollowness", "bulge", "wrong_sign"},
    "picture": PICTURE_KEYS,
}
REQUIRED = {
    "": {"order"},
    "normalize": {"kind"},
}

DEFAULT_TOLERANCE = 1e-3
"""Of the mesh, in the model's units."""


@dataclass(frozen=True)
class CornerProblem(Problem):
    """A problem as read from a file; the fields are the arguments of `pas.blend`, and those of every problem."""

    name: str
    contacts: tuple[Contact | HasContact, ...]
    order: int
    degree: int | Literal["lowest"] | None
    tolerance: float
    partition: PartitionLike | None
    wishes: Wishes
    style: str = "plain"
    view: View | None = None
    combs: bool = False

    @property
    def prove(self) -> bool:  # type: ignore[override]  # a field of other problems
        """Whether all must be proved."""
        return self.wishes.prove

    @property
    def options(self) -> dict[str, Any]:
        """The keyword arguments of `pas.blend` beside contacts, order and degree."""
        return {"partition": self.partition, "wishes": self.wishes}

    def changed(self, **options: Any) -> Self:
        """See `Problem.changed`; the tension is one of the wishes."""
        tension = options.pop("tension", None)
        wishes = None if tension is None else self.wishes.changed(tension=tension)
        return super().changed(**options, wishes=wishes)

    def solve(self) -> Blend:
        """The blend; raises what `pas.blend` raises."""
        return blend(self.contacts, self.order, self.degree, **self.options)


class _Reader(PictureReader):
    """Knows the tables that there are, whatever has been registered since."""

    usual_style = "plain"

    @property
    def lists(self) -> set[str]:  # type: ignore[override]
        """The tables of contacts."""
        return set(CONTACTS)

    @property
    def keys(self) -> dict[str, set[str]]:  # type: ignore[override]
        """The keys by table."""
        tables = {table: set(constructor_keys(made)) for table, made in CONTACTS.items()}
        others = {"": KEYS[""] | self.lists, "partition": partition_keys(), "energy": keys_of(ENERGIES)}
        return KEYS | others | tables

    @property
    def required(self) -> dict[str, set[str]]:  # type: ignore[override]
        """The keys that must be, by table."""
        arguments = {table: constructor_keys(made) for table, made in CONTACTS.items()}
        return REQUIRED | {table: {k for k, needed in known.items() if needed} for table, known in arguments.items()}

    def problem(self, data: dict[str, Any]) -> CornerProblem:
        self.check(data, "", 0)
        items = [self._item(table, i, entry) for table in CONTACTS for i, entry in enumerate(data.get(table, []))]
        if not items:
            raise self.error(f"gives no contacts: none of {', '.join(f'[[{t}]]' for t in CONTACTS)}", "", 0)
        return CornerProblem(
            name=self.name(data),
            contacts=tuple(items),
            order=self.checked(data, "order", check_order, None),
            degree=self.checked(data, "degree", check_wanted_degree, None),
            tolerance=self.checked(data, "tolerance", check_tolerance, DEFAULT_TOLERANCE),
            partition=self._made("partition", data, read_partition_like),
            wishes=self._wishes(data),
            **self.picture(data),
        )

    def _wishes(self, data: dict[str, Any]) -> Wishes:
        points = self._made("points", data, lambda table: Wishes(**table)) or Wishes()
        energy = self._made("energy", data, read_energy)
        if "tension" in data:
            energy = self.checked(data, "tension", lambda tension: tensed(energy, tension), None)
        return points.changed(
            energy=energy,
            limits=self._made("limits", data, lambda table: FairnessLimits(**table)),
            normalize=self._made("normalize", data, self._normalization),
            basis=self._basis(data),
            prove=self.typed(data, "prove", bool, True),
            guard=self.typed(data, "guard", bool, True),
        )

    def _item(self, kind: str, index: int, entry: dict[str, Any]) -> Contact | HasContact:
        self.check(entry, kind, index)
        made: Contact | HasContact
        try:
            made = CONTACTS[kind](**entry)
        except LimitError:
            raise
        except (ValueError, TypeError, PasError) as error:
            places = {k: found.start() for k in entry if (found := re.search(rf"\b{k}\b", str(error)))}
            key = min(places, key=places.__getitem__) if places else None
            raise self.error(f"{_noun(kind)} {index + 1}: {error}", kind, index, key) from None
        return made

    def _made(self, table: str, data: dict[str, Any], make: Callable[[dict[str, Any]], Any]) -> Any:
        if table not in data:
            return None
        self.check(data[table], table, 0)
        try:
            return make(data[table])
        except LimitError:
            raise
        except (ValueError, TypeError, PasError) as error:
            key = next((k for k in data[table] if re.match(rf"'?{k}\b", str(error))), None)
            raise self.error(f"[{table}]: {error}", table, 0, key) from None

    @staticmethod
    def _normalization(table: dict[str, Any]) -> Normalization:
        if table["kind"] not in NORMALIZATIONS:
            raise ValueError(f"kind must be one of {', '.join(NORMALIZATIONS)}, not {shown(table['kind'])}")
        return read_normalization(table)

    def _basis(self, data: dict[str, Any]) -> tuple[tuple[Polynomial, ...], ...] | None:
        if "basis" not in data:
            return None
        members = data["basis"]
        if not isinstance(members, list) or not all(isinstance(member, list) for member in members):
            raise self.error("basis must be a list of members, each a list of polynomials", "", 0, "basis")
        try:
            return tuple(tuple(Polynomial(p) for p in member) for member in members)
        except (ValueError, TypeError) as error:
            raise self.error(f"basis: {error}", "", 0, "basis") from None


def _noun(table: str) -> str:
    """What one entry of a table of contacts is called."""
    return str(getattr(CONTACTS[table], "noun", table.removesuffix("s").replace("_", " ")))


def _fits(data: dict[str, Any]) -> bool:
    return bool(set(CONTACTS) & data.keys()) or not {"surfaces", "boundaries", "method"} & data.keys()


def _read(file: Path, text: str, data: dict[str, Any]) -> CornerProblem:
    return _Reader(file, text).problem(data)


PROBLEM = ProblemKind("corner", _fits, _read)
