"""Recomputes everything that five published works print, and writes a page for each and one table of all.

    python docs/reproduction/reproduce.py [WORK ...] [--update] [--pictures]

A row is wrong where its verdict is, and has drifted where it is not what the page beside this file has; times may
change.  Wrong rows and drift are printed and make the exit code 1; nothing is written then, except drift with
`--update`.  `--pictures` draws the pictures again.
"""

from __future__ import annotations

import argparse
import difflib
import importlib
import re
import sys
from collections import Counter
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from entries import Entry, Row, Work, show  # noqa: E402

WORKS = ("yu_sun_ma", "lou_feng_chen_deng", "xu_chen_deng", "perez_diaz_sendra", "cheng_gao")
VERDICTS = ("agrees", "misprint", "differs")

HEAD = """# Reproduction of published results

Every number, polynomial, degree, count and picture that five works print, recomputed by `pas`: what is printed, what is
computed, and whether they agree.  A *misprint* comes with the condition that the printed value fails and the computed
one satisfies; where the two *differ*, every fact that the reason rests on is computed.  `make reproduce` does all of it
and fails where anything has drifted from these pages; a part of it is in `make test`.  Times are seconds on one core,
beside those that are printed; what an earlier row has computed is not computed again.
"""


def work_of(name: str) -> Work:
    """The rows of a script beside this file."""
    return importlib.import_module(name).work


def cell(text: str) -> str:
    """What may stand between two bars of a table."""
    return text.replace("|", "\\|").replace("\n", " ")


def line(entry: Entry, row: Row, number: int) -> str:
    """The row of a table; `number` counts the reasons below it, 0 for none."""
    link = f" ([{number}])" if number else ""
    what = f"{entry.what} ([picture]({entry.picture}))" if entry.picture else entry.what
    times = f"{row.seconds:.3f}" + (f" ({entry.printed_seconds})" if entry.printed_seconds else "")
    values = (f"`{show(value)}`" for value in (entry.printed, row.computed))
    cells = (entry.where, what, *values, entry.verdict + link, times)
    return "| " + " | ".join(map(cell, cells)) + " |"


def page_of(name: str, work: Work, rows: list[Row]) -> str:
    """The page of one work."""
    lines, reasons, shown = [], [], []
    for entry, row in zip(work.entries, rows, strict=True):
        if row.reason:
            reasons.append(f"{len(reasons) + 1}. {entry.where}, {entry.what}: {row.reason}")
        lines.append(line(entry, row, len(reasons) if row.reason else 0))
        if entry.picture and entry.picture not in shown:
            shown.append(entry.picture)
    counts = Counter(entry.verdict for entry in work.entries)
    parts = [
        f"# {work.name}",
        f"*{work.title}*.  {work.words}" if work.title else work.words,
        f"{len(lines)} rows: "
        + ", ".join(f"{counts[v]} {v}" for v in VERDICTS)
        + f".  Script: [{name}.py]({name}.py).",
        "\n".join(
            ["| where | what | printed | computed | verdict | seconds (printed) |", "|---|---|---|---|---|---|", *lines]
        ),
        "## Proofs, reasons and notes",
        "\n".join(reasons),
        "## Pictures" if shown else "",
        "\n".join(f"![{Path(p).stem}]({p})" for p in shown),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def index_of(works: dict[str, Work], seconds: dict[str, float]) -> str:
    """The table of all works."""
    lines = ["| work | rows | agree | misprints | differ | seconds |", "|---|---|---|---|---|---|"]
    total: Counter[str] = Counter()
    for name, work in works.items():
        counts = Counter(entry.verdict for entry in work.entries)
        total += counts
        numbers = " | ".join(str(counts[v]) for v in VERDICTS)
        lines.append(f"| [{work.name}]({name}.md) | {counts.total()} | {numbers} | {seconds[name]:.1f} |")
    numbers = " | ".join(str(total[v]) for v in VERDICTS)
    lines.append(f"| all | {total.total()} | {numbers} | {sum(seconds.values()):.1f} |")
    found = [
        f"- {work.name}, {entry.where}: {entry.what}"
        for work in works.values()
        for entry in work.entries
        if entry.verdict == "misprint"
    ]
    more = "Dimensions of spline spaces beside published formulas are on [a page of their own](../dimensions.md)."
    return "\n\n".join([HEAD.strip(), "\n".join(lines), more, "## Misprints", "\n".join(found)]) + "\n"


def timeless(text: str) -> str:
    """A page without the last column of its tables, which has the times."""
    return re.sub(r"^(\|.*\|)[^|]*\|$", r"\1", text, flags=re.MULTILINE)


def drift(path: Path, text: str) -> list[str]:
    """The lines that a page has (-) and should have (+), times apart."""
    if not path.exists():
        return [f"{path.name} is new"]
    old, new = (timeless(page).splitlines() for page in (path.read_text(encoding="utf-8"), text))
    changes = list(difflib.unified_diff(old, new, path.name, path.name, n=0, lineterm=""))
    return [f"{path.name}: {change}" for change in changes[2:] if not change.startswith("@@")]


def main(arguments: list[str] | None = None) -> int:
    """Recompute, compare, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("works", nargs="*", metavar="WORK", help=f"of {', '.join(WORKS)}; all if none is named")
    parser.add_argument("--update", action="store_true", help="write the pages where rows have changed, too")
    parser.add_argument("--pictures", action="store_true", help="draw the pictures again")
    options = parser.parse_args(arguments)
    pages, problems, seconds = {}, [], {}
    for name in options.works or WORKS:
        work, rows = work_of(name), []
        for entry in work.entries:
            row = entry.run()
            rows.append(row)
            print(f"{row.seconds:8.3f} s  {'WRONG' if row.failure else entry.verdict:<9} {entry.where}: {entry.what}")
            problems += [f"{name}, {entry.where}, {entry.what}: {row.failure}"] if row.failure else []
        seconds[name] = sum(row.seconds for row in rows)
        pages[HERE / f"{name}.md"] = page_of(name, work, rows)
        if options.pictures:
            importlib.import_module(name).draw(HERE / "pictures")
    if not options.works:
        pages[HERE / "index.md"] = index_of({name: work_of(name) for name in WORKS}, seconds)
    changed = [change for path, text in pages.items() for change in drift(path, text)]
    print(*problems, *changed, sep="\n")
    if problems or (changed and not options.update):
        return 1
    for path, text in pages.items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
