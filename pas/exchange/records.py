"""JSON-ready records of exact objects, and back; the shapes in capitals say what they look like."""

from __future__ import annotations

from typing import Any, cast

from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, plain
from pas.contacts.contact import Contact
from pas.exchange.schema import (
    NUMBER,
    POINT,
    REAL,
    TEXT,
    WHOLE,
    Table,
    equation_record,
    list_of,
    maybe,
    one_of,
    polynomial_record,
    read_polynomial,
    row,
)
from pas.fairing.wishes import (
    MeanAlpha,
    Normalization,
    PointOptions,
    SumOfCoefficients,
    UnitCoefficients,
    ValueAt,
    Wishes,
)
from pas.partition.kinds import read_partition
from pas.piecewise import PiecewiseSurface
from pas.verdicts import Status

NORMALIZATIONS = ("mean-alpha", "sum-of-coefficients", "unit-coefficients", "value-at")
NORMALIZATION = Table({"kind": one_of(NORMALIZATIONS)}, {"point": POINT, "value": NUMBER})
CONSTRAINTS = Table(
    {
        **{kind: list_of(POINT) for kind in ("inside", "outside", "through", "near")},
        "near_weight": list_of(NUMBER),
        "handles": list_of(row(row(WHOLE, list_of(WHOLE, 4)), NUMBER)),
        "margin": maybe(NUMBER),
        "normalize": NORMALIZATION,
    },
    {"coefficients": list_of(row(WHOLE, NUMBER))},
)
ENERGY = Table({"kind": TEXT}, open=True)
VERDICT = Table(
    {
        "claim": TEXT,
        "status": one_of([status.value for status in Status]),
        "reason": TEXT,
        "witness": maybe(list_of(REAL, 3)),
        "measure": WHOLE,
    }
)
CERTIFICATE = Table(
    {"contacts": list_of(VERDICT), "faces": list_of(VERDICT), "one_sheet": VERDICT, "enclosed": VERDICT},
    {"further": list_of(VERDICT)},
)


KEPT_VERDICTS = maybe(list_of(VERDICT))
"""What somebody found of a shape, for people to read; null where nothing was kept."""


def kept_verdicts(shape: Any, certificate: Any) -> list[dict[str, Any]] | None:
    """The verdicts to keep with a blend; raises `ValueError` for those of another blend.

    Verdicts on the contacts must be the same; that on regularity may be of another domain.
    """
    if certificate is None:
        return None
    other = type(certificate) is not type(shape.certificate)
    if other or certificate.contacts != shape.certificate.contacts:
        raise ValueError("certificate must be that of the blend that is saved, and it is another's")
    return [v.to_record() for v in certificate.verdicts]


def point_record(point: Vector) -> list[str]:
    """Three exact numbers as strings."""
    return [plain(c) for c in point]


def surface_record(surface: PiecewiseSurface) -> dict[str, Any]:
    """Everything that defines a surface, exact."""
    return {
        "partition": surface.partition.to_record(),
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


def constraints_record(wishes: Wishes) -> dict[str, Any]:
    """The points and the normalisation."""
    record: dict[str, Any] = {
        kind: [point_record(p) for p in getattr(wishes, kind)] for kind in ("inside", "outside", "through", "near")
    }
    record["near_weight"] = [plain(w) for w in wishes.near_weights]
    record["handles"] = [[[cell, list(index)], plain(value)] for (cell, index), value in wishes.handles]
    if wishes.coefficients:
        record["coefficients"] = [[number, plain(value)] for number, value in wishes.coefficients]
    record["margin"] = None if wishes.margin is None else plain(wishes.margin)
    record["normalize"] = normalization_record(wishes.normalize)
    return record


def read_constraints(record: dict[str, Any]) -> PointOptions:
    """The options of `constraints_record`."""
    options: Any = record | {"normalize": read_normalization(record["normalize"])}
    return cast(PointOptions, options)


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
    if kind not in NORMALIZATIONS:
        raise ValueError(f"kind must be one of {', '.join(NORMALIZATIONS)}, not {shown(kind)}")
    if kind == "value-at":
        if "point" not in record:
            raise ValueError("a normalisation by a value needs its point")
        return ValueAt(record["point"], record.get("value", -1))
    plain_kinds: dict[str, type[SumOfCoefficients] | type[UnitCoefficients]] = {
        "sum-of-coefficients": SumOfCoefficients,
        "unit-coefficients": UnitCoefficients,
    }
    return plain_kinds.get(kind, MeanAlpha)()
