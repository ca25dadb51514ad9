"""JSON-ready records of exact objects, and back; the shapes in capitals say what they look like."""

from __future__ import annotations

from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, plain
from pas.bernstein.signs import Status
from pas.exchange.schema import NUMBER, REAL, TEXT, WHOLE, List, Maybe, Row, Table, one_of
from pas.exchange.shapes import POINT, equation_record, polynomial_record, read_polynomial
from pas.fairing.constraints import (
    Constraints,
    MeanAlpha,
    Normalization,
    SumOfCoefficients,
    UnitCoefficients,
    ValueAt,
)
from pas.fairing.energy import Box, ThinPlate
from pas.partition.cells import Partition
from pas.partition.single_cell import SingleCell
from pas.partition.six_tetrahedra import SixTetrahedra
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface

NORMALIZATIONS = ("mean-alpha", "sum-of-coefficients", "unit-coefficients", "value-at")
NORMALIZATION = Table({"kind": one_of(NORMALIZATIONS)}, {"point": POINT, "value": NUMBER})
CONSTRAINTS = Table(
    {
        **{kind: List(POINT) for kind in ("inside", "outside", "through", "near")},
        "near_weight": List(NUMBER),
        "handles": List(Row((Row((WHOLE, List(WHOLE, 4))), NUMBER))),
        "margin": Maybe(NUMBER),
        "normalize": NORMALIZATION,
    }
)
ENERGY = Table({"kind": one_of(("thin-plate",))}, {"weight": NUMBER, "piece": WHOLE, "lower": POINT, "upper": POINT})
VERDICT = Table(
    {
        "claim": TEXT,
        "status": one_of([status.value for status in Status]),
        "reason": TEXT,
        "witness": Maybe(List(REAL, 3)),
        "measure": WHOLE,
    }
)
CERTIFICATE = Table({"contacts": List(VERDICT), "faces": List(VERDICT), "one_sheet": VERDICT, "enclosed": VERDICT})


def point_record(point: Vector) -> list[str]:
    """Three exact numbers as strings."""
    return [plain(c) for c in point]


def partition_record(partition: Partition) -> dict[str, Any]:
    """The kind and exact data of a partition."""
    center = partition.center
    record: dict[str, Any] = {"kind": partition.name, "center": None if center is None else point_record(center)}
    if isinstance(partition, SixTetrahedra):
        record["legs"] = [point_record(leg) for leg in partition.legs]
    elif isinstance(partition, SingleCell):
        if partition.box is not None:
            record["lower"], record["upper"] = map(point_record, partition.box)
    else:
        record["vertices"] = [point_record(v) for v in partition.vertices]
        record["cells"] = [list(cell) for cell in partition.cells]
        record["pieces"] = [list(piece) for piece in partition.pieces]
    return record


def read_partition(record: dict[str, Any]) -> Partition:
    """The partition of `partition_record`."""
    kinds = {SixTetrahedra.name: ("legs",), SingleCell.name: (), Partition.name: ("vertices", "cells", "pieces")}
    if record["kind"] not in kinds:
        raise ValueError(f"the partition's kind must be one of {', '.join(kinds)}, not {shown(record['kind'])}")
    for key in kinds[record["kind"]]:
        if key not in record:
            raise ValueError(f"a partition of the kind {record['kind']!r} needs {key!r}")
    if record["kind"] == SixTetrahedra.name:
        return SixTetrahedra(record["center"], record["legs"])
    if record["kind"] == SingleCell.name:
        return SingleCell(record.get("lower"), record.get("upper"), record["center"])
    return Partition(record["vertices"], record["cells"], record["center"], record["pieces"])


def surface_record(surface: PiecewiseSurface) -> dict[str, Any]:
    """Everything that defines a surface, exact."""
    return {
        "partition": partition_record(surface.partition),
        "contacts": [
            {"surface": equation_record(c.surface), "clip": equation_record(c.clip)} for c in surface.contacts
        ],
        "order": surface.order,
        "degree": surface.degree,
        "patches": [polynomial_record(p) for p in surface.polynomials],
    }


def read_surface(record: dict[str, Any]) -> PiecewiseSurface:
    """The surface of `surface_record`, exactly."""
    partition = read_partition(record["partition"])
    contacts = [Contact(read_polynomial(c["surface"]), read_polynomial(c["clip"])) for c in record["contacts"]]
    return PiecewiseSurface.from_polynomials(
        partition, contacts, record["order"], map(read_polynomial, record["patches"]), record["degree"]
    )


def constraints_record(constraints: Constraints) -> dict[str, Any]:
    """The points and the normalisation."""
    record: dict[str, Any] = {
        kind: [point_record(p) for p in getattr(constraints, kind)] for kind in ("inside", "outside", "through", "near")
    }
    record["near_weight"] = [plain(w) for w in constraints.near_weights]
    record["handles"] = [[[cell, list(index)], plain(value)] for (cell, index), value in constraints.handles]
    record["margin"] = None if constraints.margin is None else plain(constraints.margin)
    record["normalize"] = normalization_record(constraints.normalize)
    return record


def read_constraints(record: dict[str, Any]) -> Constraints:
    """The constraints of `constraints_record`."""
    return Constraints.of(**(record | {"normalize": read_normalization(record["normalize"])}))


def normalization_record(normalization: Normalization) -> dict[str, Any]:
    """The kind of normalisation and its data."""
    if isinstance(normalization, ValueAt):
        return {
            "kind": "value-at",
            "point": point_record(normalization.point),
            "value": plain(normalization.value),
        }
    kinds = {MeanAlpha: "mean-alpha", SumOfCoefficients: "sum-of-coefficients", UnitCoefficients: "unit-coefficients"}
    return {"kind": kinds[type(normalization)]}


def read_normalization(record: dict[str, Any]) -> Normalization:
    """The normalisation of `normalization_record`."""
    kind = record["kind"]
    if kind == "value-at":
        if "point" not in record:
            raise ValueError("a normalisation by a value needs its point")
        return ValueAt(record["point"], record.get("value", -1))
    plain_kinds: dict[str, type[SumOfCoefficients] | type[UnitCoefficients]] = {
        "sum-of-coefficients": SumOfCoefficients,
        "unit-coefficients": UnitCoefficients,
    }
    return plain_kinds.get(kind, MeanAlpha)()


def energy_record(energy: ThinPlate) -> dict[str, Any]:
    """The energy and its domain."""
    record: dict[str, Any] = {"kind": "thin-plate", "weight": plain(energy.weight)}
    if energy.domain is None:
        return record
    box = energy.domain
    return record | {
        "piece": energy.piece,
        "lower": point_record(box.lower),
        "upper": point_record(box.upper),
    }


def read_energy(record: dict[str, Any]) -> ThinPlate:
    """The energy of `energy_record`."""
    weight = record.get("weight", 1)
    if ("lower" in record) != ("upper" in record):
        raise ValueError("a box needs both lower and upper")
    if "lower" not in record:
        return ThinPlate(weight=weight)
    return ThinPlate(Box(record["lower"], record["upper"]), record.get("piece", 0), weight)
