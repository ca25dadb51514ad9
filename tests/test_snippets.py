"""What documentation shows is run: doctests, the programs and problem files in docstrings, the commands of READMEs."""

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

LONG = {"pas.pipeline.blend", "pas.pipeline.header", "pas.render.drawing"}
"""Modules whose program takes long; the README has the same blend, node and header, and other tests animate."""

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


def commands() -> Iterator[tuple[str, str]]:
    """The lines of READMEs that call the command."""
    for path in sorted([ROOT / "README.md", *(ROOT / "examples").rglob("README.md")]):
        for line in path.read_text().splitlines():
            if line.startswith("    pas "):
                yield str(path.relative_to(ROOT)), line.split("#")[0].strip()


@pytest.mark.parametrize(("readme", "command"), list(commands()))
def test_commands_of_readmes_are_understood(readme, command):
    options = parser().parse_args(shlex.split(command)[1:])
    assert options.command
    for word in shlex.split(command):
        if word.endswith(".toml"):
            assert (ROOT / word).exists()
