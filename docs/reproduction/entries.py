"""Rows of the reproduction report: what a work prints, and the function that computes it.

A script beside this file makes a `Work` and adds one row for each number, polynomial, count or picture of that work:

    work.agrees("example 4.1", "equations", 40, lambda: system.distinct)

says that what is computed equals what is printed.  `work.misprint` says that it does not, and what decides: `holds`
is true of the computed value and false of the printed one.  `work.differs` says that it does not, and why: `facts`
computes whether each thing is true that the reason rests on.
Each of the three is checked whenever the report is made, so no row can be wrong and stay.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from numbers import Rational
from time import perf_counter
from typing import Any

LONGEST, LONG = 76, 18
"""Characters of a value that a table shows, and of a fraction that is shown as one."""


@dataclass(frozen=True)
class Row:
    """What came out for an entry; `failure` says what is wrong with it, if anything is."""

    computed: Any
    seconds: float
    reason: str
    failure: str


@dataclass(frozen=True)
class Entry:
    """One thing that is printed.

    `where` and `what` say which; `compute` makes it; `verdict` is "agrees", "misprint" or "differs".  `reason` is a
    sentence or computes one, `holds` decides between two values, `facts` are what a reason rests on and whether each
    is true, `printed_seconds` is the time that the work gives, `picture` a file beside the page.  Slow entries are left
    out of the tests.
    """

    where: str
    what: str
    printed: Any
    compute: Callable[[], Any]
    verdict: str
    reason: str | Callable[[], str] = ""
    holds: Callable[[Any], bool] | None = None
    facts: Callable[[], dict[str, bool]] | None = None
    printed_seconds: str = ""
    picture: str = ""
    slow: bool = False

    def run(self) -> Row:
        """Compute it and hold it against what is printed and said."""
        start = perf_counter()
        computed = self.compute()
        seconds = perf_counter() - start
        equal = bool(computed == self.printed)
        failure = ""
        if self.verdict == "agrees" and not equal:
            failure = f"printed {show(self.printed)}, computed {show(computed)}"
        if self.verdict != "agrees" and equal:
            failure = f"what is computed is what is printed, {show(computed)}, so it is no {self.verdict}"
        if self.verdict == "misprint" and not failure:
            assert self.holds is not None, f"{self.where}, {self.what}: a misprint needs a condition"
            if self.holds(self.printed) or not self.holds(computed):
                failure = "the condition does not tell the printed value from the computed one"
        if self.verdict == "differs" and not failure:
            assert self.facts is not None, f"{self.where}, {self.what}: a reason needs facts"
            false = [fact for fact, true in self.facts().items() if not true]
            failure = f"the reason is wrong, as it is not true that {' and that '.join(false)}" if false else ""
        reason = self.reason if isinstance(self.reason, str) else self.reason()
        if self.verdict != "agrees" and not reason:
            failure = failure or "no reason is given"
        return Row(computed, seconds, reason, failure)


@dataclass
class Work:
    """A published work, and its rows in the order in which it prints them."""

    name: str
    title: str
    words: str
    entries: list[Entry] = field(default_factory=list)

    def agrees(
        self,
        where: str,
        what: str,
        printed: Any,
        compute: Callable[[], Any],
        note: str | Callable[[], str] = "",
        **more: Any,
    ) -> None:
        """A row whose two values are equal."""
        self.entries.append(Entry(where, what, printed, compute, "agrees", note, **more))

    def misprint(
        self, where: str, what: str, printed: Any, compute: Callable[[], Any], why: str | Callable[[], str],
        holds: Callable[[Any], bool], **more: Any,
    ) -> None:  # fmt: skip
        """A row whose printed value is wrong: `holds` says so, and that the computed one is right."""
        self.entries.append(Entry(where, what, printed, compute, "misprint", why, holds, **more))

    def differs(
        self, where: str, what: str, printed: Any, compute: Callable[[], Any], why: Callable[[], str],
        facts: Callable[[], dict[str, bool]], **more: Any,
    ) -> None:  # fmt: skip
        """A row whose values are not the same, for a reason all facts of which are computed."""
        self.entries.append(Entry(where, what, printed, compute, "differs", why, facts=facts, **more))


def show(value: Any) -> str:
    """A value on one line, shortened."""
    text = whole(value) or "none"
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 16]} ... ({len(text)} characters)"


def whole(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Rational) and len(str(value)) > LONG:
        return f"{float(value):.10g}"
    if isinstance(value, float):
        return f"{value:.6g}"
    several = isinstance(value, Sequence) and not isinstance(value, str)
    return ", ".join(map(whole, value)) if several else str(value)
