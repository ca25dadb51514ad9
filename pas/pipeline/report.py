"""The report on a solution space: as text, JSON, LaTeX or sympy."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence

from pas.algebra.brief import latex
from pas.algebra.polynomial import Polynomial
from pas.blending.regularity import Generator
from pas.pipeline.result import SolutionSpace


def report(space: SolutionSpace, form: str = "text", *, module: bool = False) -> str:
    """The degree, dimension, generators and remarks of a space as "text", "json", "latex" or "sympy".

    The generators of the ideal of a single cell are always among it; those of the module of
    several pieces, which may be long to read and to find, with `module` only.
    """
    shown = space.generators if module or len(space.patches) == 1 else ()
    return {"text": _text, "json": _json, "latex": _latex, "sympy": _sympy}[form](space, shown)


def _json(space: SolutionSpace, generators: Sequence[Generator]) -> str:
    """Everything, polynomials as strings in x, y, z."""
    record = {
        "contacts": [{"surface": str(c.surface), "clip": str(c.clip)} for c in space.contacts],
        "partition": space.partition.name,
        "order": space.order,
        "degree": space.degree,
        "dimension": space.dimension,
        "degrees_tried": {str(n): m for n, m in space.degrees_tried.items()},
        "regular": space.regular,
        "remarks": list(space.trivial_part.remarks()),
        "basis": [[str(p) for p in member] for member in space.basis],
        "generators": [
            {"degree": g.degree, "regular": list(g.regular), "polynomials": [str(p) for p in g.polynomials]}
            for g in generators
        ],
    }
    return json.dumps(record, indent=1)


def _text(space: SolutionSpace, generators: Sequence[Generator]) -> str:
    tried = ", ".join(f"{n} (dimension {m})" for n, m in space.degrees_tried.items() if n != space.degree)
    rows = [(f"contact {i}", str(c)) for i, c in enumerate(space.contacts, start=1)]
    rows += [
        ("partition", space.partition.name),
        ("order", f"GC^{space.order}"),
        ("degree", f"{space.degree}{f'; tried before: {tried}' if tried else ''}"),
        ("dimension", str(space.dimension)),
        ("regular", "yes" if space.regular else "no: no member is usable" if space.dimension else "no member"),
    ]
    rows += [("remark", remark) for remark in space.trivial_part.remarks()]
    width = max(len(name) for name, _ in rows)
    lines = [f"{name:<{width}}  {value}" for name, value in rows]
    single = len(space.patches) == 1
    lines += ["", f"basis of the solutions of degree <= {space.degree}" if space.dimension else "no solutions"]
    for number, member in enumerate(space.basis, start=1):
        lines += _lines(f"b{number}", member)
    kind = "ideal" if single else "module"
    lines += ["", f"generators of the {kind} of all solutions{'' if generators else ': asked for with --generators'}"]
    for number, generator in enumerate(generators, start=1):
        lines += _lines(f"g{number}", generator.polynomials)
        lines.append(f"      degree {generator.degree}, {_regularity(generator)}")
    return "\n".join(lines)


def _lines(name: str, member: Sequence[Polynomial]) -> list[str]:
    if len(member) == 1:
        return [f"  {name} = {member[0]}"]
    return [f"  {name}, piece {i}: {p}" for i, p in enumerate(member, start=1)]


def _regularity(generator: Generator) -> str:
    singular = [str(i) for i, regular in enumerate(generator.regular, start=1) if not regular]
    if not singular:
        return "regular along all contacts"
    return f"singular along contact{'s' * (len(singular) > 1)} {', '.join(singular)}"


def _latex(space: SolutionSpace, generators: Sequence[Generator]) -> str:
    lines = [
        f"% GC^{space.order}, degree {space.degree}, dimension {space.dimension}",
        r"\begin{align*}",
    ]
    for name, members in (("b", space.basis), ("g", [g.polynomials for g in generators])):
        for number, member in enumerate(members, start=1):
            for piece, polynomial in enumerate(member, start=1):
                mark = f"{name}_{{{number}}}" if len(member) == 1 else f"{name}_{{{number}}}|_{{{piece}}}"
                lines.append(f"{mark} &= {latex(str(polynomial), whole=True)} \\\\")
    return "\n".join([*lines, r"\end{align*}"])


def _sympy(space: SolutionSpace, generators: Sequence[Generator]) -> str:
    lines = [
        "from sympy import Rational, symbols",
        'x, y, z = symbols("x y z")',
        f"order, degree, dimension = {space.order}, {space.degree}, {space.dimension}",
    ]
    for name, members in (("basis", space.basis), ("generators", [g.polynomials for g in generators])):
        written = [f"    {tuple(p.to_sympy() for p in member)},\n" for member in members]
        # fractions that Python reads exactly: 3/7 as Rational(3, 7), not x/7 as a division of a symbol
        lines.append(re.sub(r"(?<![\w)])(\d+)/(\d+)", r"Rational(\1, \2)", f"{name} = [\n{''.join(written)}]"))
    return "\n".join(lines)
