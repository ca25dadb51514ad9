"""Macaulay2 (Grayson and Stillman): its input, and what its `toString` gives."""

from __future__ import annotations

import re

from pas.algebra.brief import cut
from pas.algebra.systems import Rows, System, check_ring, read_entry

RING = re.compile(r"(?P<field>\b[A-Z]+[\w/]*)\s*\[(?P<variables>[^\]]*)\]")
MATRIX = re.compile(r"(?P<kind>ideal|image)\s*\(?\s*(?:matrix|map)\b[^{]*\{(?P<rows>.*)\}", re.S)
IDEAL = re.compile(r"\bideal\s*\(?(?P<all>[^;]*?)\)?\s*;?\s*$", re.S)


def write(rows: Rows) -> str:
    """The ring and the ideal or module of some generators, which are the columns of a matrix."""
    lines = ["{" + ", ".join(map(str, line)) + "}" for line in zip(*rows, strict=True)]
    kind = "M = image" if len(lines) > 1 else "I = ideal"
    return f"R = QQ[x, y, z];\n{kind} matrix(R, {{{', '.join(lines)}}});\n"


def read(text: str) -> Rows:
    """The generators of the ideal or module."""
    check_ring(RING.search(text))
    matrix, ideal = MATRIX.search(text), IDEAL.search(text)
    if matrix:
        table = [[read_entry(e) for e in line.split(",")] for line in re.findall(r"\{([^{}]*)\}", matrix["rows"])]
        if table and len({len(line) for line in table}) == 1:
            return tuple(zip(*table, strict=True))
    elif ideal:
        return tuple((read_entry(e),) for e in ideal["all"].split(","))
    raise ValueError(f"there is no ideal and no module of Macaulay2 in {cut(text.strip(), 60)!r}")


MACAULAY2 = System("macaulay2", write, read)
