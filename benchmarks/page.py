"""A page of one run of the benchmarks.

python -m pytest benchmarks --benchmark-json=FILE.json
python benchmarks/page.py FILE.json > PAGE.md
"""

from __future__ import annotations

import ast
import json
import sys
from itertools import groupby
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent


def shown(seconds: float) -> str:
    """With three digits and a unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} us"


def row(runs: list[dict[str, Any]]) -> str:
    """One case: our median, and those of the peers beside it."""
    medians = {run["extra_info"]["program"]: run["stats"]["median"] for run in runs}
    own = medians.pop("pas")
    peers = (f"{name} {shown(median)} ({median / own:.3g} times as long)" for name, median in medians.items())
    return f"| {runs[0]['group']} | {shown(own)} | {'; '.join(peers)} |"


def page(record: dict[str, Any]) -> str:
    """The whole page, in the order in which the benchmarks ran."""
    machine = record["machine_info"]
    lines = [
        f"{record['datetime'][:10]}; processor {machine['cpu'].get('brand_raw', machine['processor'])}, "
        f"Python {machine['python_version']}.",
        "",
    ]
    for file, runs in groupby(record["benchmarks"], lambda run: run["fullname"].split("::")[0]):
        about = ast.get_docstring(ast.parse((HERE / Path(file).name).read_text(encoding="utf-8"))) or ""
        lines += [f"## {about.splitlines()[0]}", "", "| case | pas | peers |", "|---|---|---|"]
        lines += [row(list(group)) for _, group in groupby(runs, lambda run: run["group"])]
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    print(page(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))))
