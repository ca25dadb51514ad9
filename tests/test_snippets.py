"""What documentation shows is run: doctests, programs and problem files in docstrings and pages, commands of pages."""

from __future__ import annotations

import ast
import doctest
import importlib
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import AXES, ROOT, parsed, pipes

import pas
from pas import solid
from pas.cli.parser import parser

PACKAGE = ROOT / "pas"
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted(PACKAGE.rglob("*.py"))
    if path.name != "__main__.py"
}
REFUSED = re.compile(r"^# (?P<error>\w+Error): (?P<text>.*)$", re.M)
"""How a block says that its last line is refused."""


def indented(text: str) -> Iterator[str]:
    """The blocks of a docstring that are indented by four, without the indentation."""
    block: list[str] = []
    for line in [*text.split("\n"), "end"]:
        if line.startswith("    ") or (block and not line.strip()):
            block.append(line[4:])
        elif block:
            yield "\n".join(block).strip("\n")
            block = []


def blocks() -> Iterator[tuple[str, str]]:
    """Each indented block of each docstring, with its module."""
    for module, path in MODULES.items():
        waiting: list[ast.Module | ast.ClassDef | ast.FunctionDef] = [parsed(path)]
        while waiting:
            node = waiting.pop()
            waiting += [inner for inner in node.body[::-1] if isinstance(inner, ast.ClassDef | ast.FunctionDef)]
            for block in indented(ast.get_docstring(node) or ""):
                yield module, block


def is_program(block: str) -> bool:
    """Whether a block is Python that calls something: formulas and tables are not."""
    try:
        tree = ast.parse(block)
    except SyntaxError:
        return False
    return any(isinstance(node, ast.Call) for node in ast.walk(tree))


def is_toml(block: str) -> bool:
    """Whether a block is a problem file."""
    try:
        return any(isinstance(v, dict | list) for v in tomllib.loads(block).values())
    except tomllib.TOMLDecodeError:
        return False


PIPES = "".join(f'[[pipes]]\naxis = {list(axis)}\nradius = "1/3"\nclip = 1\n' for axis in AXES)

IMAGINED = {"pas.registry", "pas.bernstein.search"}
"""Modules whose program is about things that are not there."""

LONG = {
    *("pas.pipeline.blend", "pas.pipeline.header", "pas.render.drawing", "pas.network", "pas.network.network"),
    "pas.designs",
}
"""Modules whose program takes long; pages have the same blend, node and header, and other tests animate."""

BLOCKS = list(blocks())
PROGRAMS = [(m, b) for m, b in BLOCKS if is_program(b) and m not in IMAGINED]
PROBLEMS = [(m, b) for m, b in BLOCKS if is_toml(b) and not is_program(b)]


def test_there_are_snippets():
    assert {"pas", "pas.designs", "pas.solid.solid", "pas.solid.tube"} <= {m for m, _ in PROGRAMS}
    assert "pas.exchange.problem" in {m for m, _ in PROBLEMS}


@pytest.mark.parametrize(
    ("module", "block"),
    [pytest.param(m, b, id=m, marks=[pytest.mark.slow] * (m in LONG)) for m, b in PROGRAMS],
)
def test_programs_of_docstrings_run(module, block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where files that they write go
    if "register" in block:  # for all that comes after, so in a process of its own
        start = f"import numpy as np, pas\nfrom {module} import *\nfrom conftest import pipes\npipes = pipes()\n"
        start += "from dataclasses import dataclass\n"
        paths = os.pathsep.join([str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
        subprocess.run([sys.executable, "-c", start + block], env=os.environ | {"PYTHONPATH": paths}, check=True)
        return
    names: dict[str, Any] = {**vars(importlib.import_module(module)), "pas": pas, "solid": solid, "pipes": pipes()}
    refused = REFUSED.search(block)
    if refused:
        with pytest.raises(Exception, match=re.escape(refused["text"])) as caught:
            exec(compile(block, module, "exec"), names)
        assert type(caught.value).__name__ == refused["error"]
    else:
        exec(compile(block, module, "exec"), names)


@pytest.mark.parametrize(("module", "block"), PROBLEMS, ids=[m for m, _ in PROBLEMS])
def test_problem_files_of_docstrings_are_read(module, block, tmp_path):
    path = tmp_path / "problem.toml"
    whole = {"order", "surfaces", "boundaries", "quadrics", "solid"} & set(tomllib.loads(block))
    path.write_text(block if whole else f"order = 1\n{block}\n{PIPES}")  # what all kinds of problems may have
    read = pas.read_parametric_problem if {"surfaces", "boundaries"} & set(tomllib.loads(block)) else pas.read_problem
    assert read(path) is not None


@pytest.mark.parametrize("module", [m for m, path in MODULES.items() if ">>> " in path.read_text()])
def test_doctests(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted > 0
    assert found.failed == 0


PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / "docs").rglob("*.md") if p.parent.name != "generated")]
WITH_PROGRAMS = [p for p in PAGES if "```python\n" in p.read_text(encoding="utf-8")]
WITH_PROBLEMS = [p for p in PAGES if "```toml\n" in p.read_text(encoding="utf-8")]


LONG_PAGES = {
    *("guide/corners", "guide/hollow", "guide/junctions", "guide/nodes", "guide/pictures"),
    *("tutorials/bracket", "tutorials/lattice", "tutorials/manifold", "tutorials/partition", "coming_from"),
    *("tutorials/energy", "tutorials/node"),  # a notebook of the first is run always
    *("start/teapot", "tutorials/teapot"),
    *("research", "research_studies"),
}
"""Pages of `docs` whose programs take more than some three seconds: what they use other tests have as well."""

LONG_BLOCKS = {
    "guide/networks": ("corner = ", "ball = "),
    "guide/solids": ("cover = ", "tee = "),
    "start/parts": ("print(round(part.measures().volume))", "import pas\n\nnode = "),
}
"""How those programs begin that take long, on pages of which the others are run always."""


def named(paths: list[Path]) -> list[Any]:
    """Pages as cases of a test, each called by its place."""
    names = {p: str(p.relative_to(ROOT)) for p in paths}
    slow = {ROOT / "docs" / f"{name}.md" for name in LONG_PAGES}
    return [pytest.param(p, id=name, marks=[pytest.mark.slow] * (p in slow)) for p, name in names.items()]


def test_there_are_pages():
    names = {str(p.relative_to(ROOT)) for p in WITH_PROGRAMS}
    assert {"README.md", "docs/start/parts.md", "docs/start/blends.md", "docs/guide/solids.md"} <= names
    assert ROOT / "docs/start/parts.md" in WITH_PROBLEMS


def told(block: str) -> list[str]:
    """What a program says that it prints: after each `print`, or as comments at its end."""
    body = re.search(r"((?:^# .*\n)*)\Z", block, re.M)
    assert body
    return re.findall(r"print\(.*\)  # (.*)", block) + re.findall(r"^# (.*)", body[1], re.M)


def shortened() -> list[Any]:
    """Pages without their long programs, and whole ones, which are slow."""
    pages = {ROOT / "docs" / f"{name}.md": starts for name, starts in LONG_BLOCKS.items()}
    whole = [pytest.param(p, (), id=f"{p.stem}, whole", marks=pytest.mark.slow) for p in pages]
    cases = (
        pytest.param(*case.values, pages.get(case.values[0], ()), id=case.id, marks=case.marks)
        for case in named(WITH_PROGRAMS)
    )
    return [*cases, *whole]


def test_long_programs_are_those_of_pages():
    for name, starts in LONG_BLOCKS.items():
        text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
        assert name not in LONG_PAGES and [text.count(f"```python\n{start}") for start in starts] == [1] * len(starts)


@pytest.mark.parametrize(("page", "long"), shortened())
def test_programs_of_pages_print_what_they_say(page, long, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    blocks = [block for block in blocks if not block.startswith(tuple(long))]
    program = "".join(blocks)  # a reader goes from the top down
    if "register" in program:  # for all that comes after, so in a process of its own
        paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
        call = [sys.executable, "-c", program]
        done = subprocess.run(call, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True, check=True)
        printed = done.stdout
    else:
        exec(compile(program, page.name, "exec"), {})
        printed = capsys.readouterr().out
    assert printed.splitlines() == [line for block in blocks for line in told(block)]
    if page.name == "README.md":
        assert {p.name for p in tmp_path.iterdir()} == {"corner.glb", "corner.pas.json", "corner.png"}


@pytest.mark.parametrize("page", named(WITH_PROBLEMS))
def test_problem_files_of_pages_are_solved(page, tmp_path):
    for block in re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
        path = tmp_path / "problem.toml"
        path.write_text(block)
        problem = pas.read_problem(path)
        assert problem.satisfied(problem.solve().certificate)


def commands() -> Iterator[tuple[str, str]]:
    """The lines of pages that call the command."""
    for path in [*PAGES, *sorted((ROOT / "examples").rglob("README.md"))]:
        for line in path.read_text(encoding="utf-8").splitlines():
            if line.startswith("    pas "):
                yield str(path.relative_to(ROOT)), line.split("#")[0].strip()


@pytest.mark.parametrize(("page", "command"), list(commands()))
def test_commands_of_pages_are_understood(page, command):
    words = re.sub(r"\[\w+\]", "", command)  # what may be left out
    options = parser().parse_args(shlex.split(words)[1:])
    assert options.command or options.version
    for word in shlex.split(words):
        if word.endswith(".toml") and "/" in word:
            assert (ROOT / word).exists()
