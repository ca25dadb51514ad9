"""Running suites, and what comes of it as a record, as text and as a page; and the runs before."""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from pas._version import __version__
from pas.bench.case import PEERS, SUITES
from pas.bench.measure import Result, measured

CHANGED = 1.25
"""A median that differs from the last one by such a factor is marked; shared machines differ by less between runs."""


@dataclass(frozen=True)
class Report:
    """Results on one machine, on one day, and the medians of the run before by (suite, case)."""

    machine: dict[str, str]
    day: str
    results: tuple[Result, ...]
    before: dict[str, float]
    before_day: str = ""

    def record(self) -> dict[str, Any]:
        """All of it, for JSON."""
        rows = [asdict(r) | {"ratios": r.ratios, "before": self.before.get(key(r))} for r in self.results]
        return {"pas": __version__, "day": self.day, "machine": self.machine, "results": rows}

    def __str__(self) -> str:
        lines = [f"pas {__version__}, {self.day}; " + ", ".join(f"{k} {v}" for k, v in self.machine.items())]
        for result in self.results:
            rows = [(result.suite, result.case, result.timing.median, self._change(result))]
            rows += [("", f"  {n}", t.median, f"  {_times(result.ratios[n])}") for n, t in result.peers.items()]
            lines += [f"{suite:<11}{case:<72}{_seconds(median):>9}{more}" for suite, case, median, more in rows]
        return "\n".join(lines)

    def page(self) -> str:
        """The same as Markdown."""
        lines = [
            "# Benchmarks", "",
            "Made by `pas bench --readme benchmarks/README.md`: medians of processor seconds, each beside other",
            "programs where these are installed, in the same run. Above 1 time as long, `pas` is faster.", "",
            f"pas {__version__}, {self.day}; " + ", ".join(f"{k} {v}" for k, v in self.machine.items()) + ".", "",
        ]  # fmt: skip
        for name in dict.fromkeys(result.suite for result in self.results):
            lines += [f"## {name}: {SUITES[name].about}", "", "| case | pas | peers |", "|---|---|---|"]
            for result in (r for r in self.results if r.suite == name):
                peers = "; ".join(
                    f"{peer} {_seconds(t.median)} ({_times(result.ratios[peer])})" for peer, t in result.peers.items()
                )
                about = f" ({result.about})" if result.about else ""
                lines.append(f"| {result.case}{about} | {_seconds(result.timing.median)} | {peers} |")
            lines.append("")
        return "\n".join(lines)

    def _change(self, result: Result) -> str:
        known = self.before.get(key(result))
        if not known:
            return ""
        factor = result.timing.median / known
        mark = " (!)" if not 1 / CHANGED < factor < CHANGED else ""
        return f"  {factor:.2f} of {self.before_day}{mark}"


def run(names: Sequence[str] = (), quick: bool = False, history: Path | None = None) -> Report:
    """Measure suites (all, if none is named), compare with the last run on this machine and add to the history.

    Raises `ValueError` for a suite that there is not.
    """
    chosen_suites = [SUITES[name] for name in names or SUITES]
    machine = this_machine()
    known = {} if history is None else _last(history, machine)
    results = tuple(_all(chosen_suites, quick))
    report = Report(machine, time.strftime("%Y-%m-%d"), results, known.get("medians", {}), known.get("day", ""))
    if history is not None and not quick:
        _keep(history, report, known.get("medians", {}))
    return report


def _all(suites: Sequence[Any], quick: bool) -> Iterator[Result]:
    for suite in suites:
        for case in suite.cases():
            there = {name: made for name, made in case.peers.items() if PEERS[name].found is not None}
            yield measured(suite.name, replace(case, peers=there), quick)


def key(result: Result) -> str:
    """By what a result is known in the history."""
    return f"{result.suite}: {result.case}"


def this_machine() -> dict[str, str]:
    """What speed depends on."""
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "Python": platform.python_version(),
    }


def default_history() -> Path:
    """Where runs are kept for a user."""
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "pas" / "bench.jsonl"


def _last(history: Path, machine: dict[str, str]) -> dict[str, Any]:
    """The last run on such a machine; raises `ValueError` where the file holds something else."""
    if not history.exists():
        return {}
    try:
        runs = [json.loads(line) for line in history.read_text(encoding="utf-8").splitlines() if line.strip()]
        here = [run for run in runs if run["machine"] == machine and run["medians"] and run["day"]]
    except (ValueError, KeyError, TypeError):
        raise ValueError(f"{history} is no history of benchmarks; name another file, or remove it") from None
    return here[-1] if here else {}


def _keep(history: Path, report: Report, known: dict[str, float]) -> None:
    medians = known | {key(result): result.timing.median for result in report.results}
    history.parent.mkdir(parents=True, exist_ok=True)
    with history.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"day": report.day, "machine": report.machine, "medians": medians}) + "\n")


def _processor() -> str:
    try:
        with Path("/proc/cpuinfo").open(encoding="utf-8") as file:
            return next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def _seconds(value: float) -> str:
    if value < 1e-3:
        return f"{value * 1e6:.0f} us"
    return f"{value * 1e3:.3g} ms" if value < 1 else f"{value:.3g} s"


def _times(ratio: float) -> str:
    return f"{ratio:.3g} times as long"
