"""Verdicts and certificates: what was promised of a surface, and what the proofs came to."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from pas.bernstein.signs import Status

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Verdict:
    """The outcome of one proof.

    `claim` says what was to be proved, `reason` in words why it is so; `witness` is a point
    (x, y, z) where a refuted claim fails, None where there is no single such point.
    `measure` counts the simplices that branch and bound examined (0 for exact algebra alone).
    A claim that was only measured is neither proved nor refuted, whatever the samples say: its status says so.
    """

    status: Status
    claim: str
    reason: str
    witness: Point | None = None
    measure: int = 0

    @property
    def proved(self) -> bool:
        """Whether the claim holds beyond doubt."""
        return self.status is Status.PROVED

    @property
    def measured(self) -> bool:
        """Whether the verdict rests on samples alone, so that it proves nothing either way."""
        return self.status in (Status.HOLDS_MEASURED, Status.FAILS_MEASURED)

    @property
    def failed(self) -> bool:
        """Whether the claim is refuted, or fails as measured."""
        return self.status in (Status.REFUTED, Status.FAILS_MEASURED)

    def __bool__(self) -> bool:
        raise TypeError("a verdict is proved, refuted or undecided; ask for .proved or .status")

    def __str__(self) -> str:
        at = "" if self.witness is None else " at ({:.6g}, {:.6g}, {:.6g})".format(*self.witness)
        return f"{self.claim}: {self.status.value}{at}; {self.reason}"

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form."""
        return {
            "claim": self.claim,
            "status": self.status.value,
            "reason": self.reason,
            "witness": None if self.witness is None else list(self.witness),
            "measure": self.measure,
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Verdict:
        """The verdict that `to_record` wrote."""
        witness = record["witness"]
        return cls(
            Status(record["status"]),
            record["claim"],
            record["reason"],
            None if witness is None else (witness[0], witness[1], witness[2]),
            record["measure"],
        )


class Verdicts(ABC):
    """Several verdicts about one thing."""

    @property
    @abstractmethod
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of proof."""

    @property
    def proved(self) -> bool:
        """Whether every verdict is proved."""
        return all(verdict.proved for verdict in self.verdicts)

    @property
    def refuted(self) -> tuple[Verdict, ...]:
        """The verdicts whose claim is false beyond doubt."""
        return tuple(v for v in self.verdicts if v.status is Status.REFUTED)

    @property
    def failed(self) -> tuple[Verdict, ...]:
        """The verdicts whose claim is refuted, or fails as measured."""
        return tuple(v for v in self.verdicts if v.failed)

    def __bool__(self) -> bool:
        raise TypeError("a certificate has several verdicts; ask for .proved or .refuted")

    def __str__(self) -> str:
        return "\n".join(map(str, self.verdicts))


@dataclass(frozen=True)
class Certificate(Verdicts):
    """All verdicts about one surface.

    `contacts`: one for each contact: exact GC^k, alpha > 0 on its curve, the curve closed and
    regular inside its clip face (or inside the region, where the clip is none of its faces).
    `faces`: one for each interior face: exact C^k.  `one_sheet`: every ray from the centre meets
    the surface at most once, transversally.  `enclosed`: the surface leaves the region through the
    contact curves only.
    """

    contacts: tuple[Verdict, ...]
    faces: tuple[Verdict, ...]
    one_sheet: Verdict
    enclosed: Verdict

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of proof."""
        return (*self.contacts, *self.faces, self.one_sheet, self.enclosed)

    def __str__(self) -> str:
        width = max(len(verdict.claim) for verdict in self.verdicts)
        lines = []
        for verdict in self.verdicts:
            at = ""
            if verdict.witness is not None:
                at = " at ({:.5g}, {:.5g}, {:.5g})".format(*verdict.witness)
            lines.append(f"{verdict.claim:<{width}}  {verdict.status.value:<9} {verdict.reason}{at}")
        return "\n".join(lines)

    def differences(self, stored: Certificate) -> tuple[str, ...]:
        """Where stored verdicts say other than these, which were proved: one sentence each."""
        found = {verdict.claim: verdict.status.value for verdict in self.verdicts}
        said = {verdict.claim: verdict.status.value for verdict in stored.verdicts}
        missing = [f"{claim}: {status}; nothing is stored" for claim, status in found.items() if claim not in said]
        others = [
            f"{claim}: {found[claim]}; stored as {status}"
            if claim in found
            else f"{claim}: no claim; stored as {status}"
            for claim, status in said.items()
            if found.get(claim) != status
        ]
        return (*missing, *others)

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form."""
        return {
            "contacts": [v.to_record() for v in self.contacts],
            "faces": [v.to_record() for v in self.faces],
            "one_sheet": self.one_sheet.to_record(),
            "enclosed": self.enclosed.to_record(),
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Certificate:
        """The certificate that `to_record` wrote."""
        return cls(
            tuple(Verdict.from_record(v) for v in record["contacts"]),
            tuple(Verdict.from_record(v) for v in record["faces"]),
            Verdict.from_record(record["one_sheet"]),
            Verdict.from_record(record["enclosed"]),
        )
