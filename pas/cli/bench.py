"""`pas bench`."""

from __future__ import annotations

import argparse
from pathlib import Path

from pas.cli.common import Outcome


def run_bench(options: argparse.Namespace) -> Outcome:
    """Measure, compare with the last run, keep it, and write a page where that is asked for."""
    from pas.bench.run import default_history, run
    from pas.exchange.files import check_place, replacing

    page = None if options.readme is None else Path(options.readme)
    if page is not None:
        check_place(page)
    history = default_history() if options.history is None else Path(options.history)
    report = run(options.suite, options.quick, history)
    if page is not None:
        with replacing(page) as path:
            path.write_text(report.page() + "\n", encoding="utf-8")
    return Outcome(str(report), report.record())
