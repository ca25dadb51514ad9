"""Verdicts and certificates: claims about a thing, and the outcomes of their proofs.

One protocol for all kinds: `verdicts`, `proved`, `holds`, `str(...)`, `to_record()`, and a table in notebooks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from html import escape
from typing import Any

Point = tuple[float, float, float]


class Status(Enum):
    """The outcome of a proof or, where only samples were taken, whether they agree with the claim."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    HOLDS_MEASURED = "holds, measured"
    FAILS_MEASURED = "fails, measured"


COUNTED = {
    Status.PROVED: "proved",
    Status.REFUTED: "refuted",
    Status.UNDECIDED: "undecided",
    Status.HOLDS_MEASURED: "measured to hold",
    Status.FAILS_MEASURED: "measured to fail",
}
"""The words for several verdicts of a status."""


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
        told = {"status": Status(record["status"]), "witness": None if witness is None else tuple(witness)}
        return cls(**{**record, **told})


class Verdicts(ABC):
    """Several verdicts about one thing: its certificate."""

    partly_measured: bool = False
    """Whether some claims about this kind of thing can only be measured, so that not all can be proved."""

    @property
    @abstractmethod
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of proof."""

    @property
    def proved(self) -> bool:
        """Whether there are verdicts, and every one is proved."""
        return bool(self.verdicts) and all(verdict.proved for verdict in self.verdicts)

    @property
    def holds(self) -> bool:
        """Whether the thing is as good as its kind can be: all proved or, where much can only be measured, none failed.

        Exit codes of the command line ask for this.
        """
        return self.proved or (self.partly_measured and not self.failed)

    @property
    def refuted(self) -> tuple[Verdict, ...]:
        """The verdicts whose claim is false beyond doubt."""
        return tuple(v for v in self.verdicts if v.status is Status.REFUTED)

    @property
    def failed(self) -> tuple[Verdict, ...]:
        """The verdicts whose claim is refuted, or fails as measured."""
        return tuple(v for v in self.verdicts if v.failed)

    @property
    def counts(self) -> str:
        """How many claims are proved, hold or fail as measured, and so on; "all proved" where they are."""
        if self.proved:
            return "all proved"
        found = Counter(v.status for v in self.verdicts)
        return "; ".join(f"{found[s]} {COUNTED[s]}" for s in Status if found[s]) or "nothing claimed, nothing proved"

    def differences(self, stored: Verdicts) -> tuple[str, ...]:
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

    def __bool__(self) -> bool:
        raise TypeError("a certificate has several verdicts; ask for .proved, .holds or .refuted")

    def __str__(self) -> str:
        return "\n".join(map(str, self.verdicts))

    def to_record(self) -> Any:
        """A JSON-ready form: the list of verdicts, unless a class says otherwise."""
        return [verdict.to_record() for verdict in self.verdicts]

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(v.claim)}</td><td>{escape(v.status.value)}</td><td>{escape(v.reason)}</td></tr>"
            for v in self.verdicts
        )
        head = "<tr><th>claim</th><th>verdict</th><th>reason</th></tr>"
        return f"<table>{head}{rows}</table><p>{escape(self.counts)}</p>"


@dataclass(frozen=True)
class Findings(Verdicts):
    """A plain list of verdicts as a certificate."""

    verdicts: tuple[Verdict, ...] = ()
    partly_measured: bool = False

    @classmethod
    def of_parts(cls, parts: Mapping[str, Verdicts]) -> Findings:
        """All verdicts about the parts of a thing, their claims headed by the parts' names."""
        found = tuple(replace(v, claim=f"{name}: {v.claim}") for name, part in parts.items() for v in part.verdicts)
        return cls(found, any(part.partly_measured for part in parts.values()))

    def __str__(self) -> str:
        return "\n".join(map(str, self.verdicts)) or "nothing is claimed, so nothing is proved"
