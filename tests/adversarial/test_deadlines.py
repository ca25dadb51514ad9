"""Limits at any moment: every long call gives up in one sentence, leaves nothing behind and can be done again.

The clock moves on by a second whenever it is looked at, so that a deadline falls at a given look.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from random import Random
from types import FunctionType

import pytest
from limit_cases import ENDLESS_COMMANDS, LONG_CALLS, LONG_COMMANDS, TickingClock

import pas
from pas import solid
from pas.cli import main
from pas.cli.common import FAILED
from pas.cli.parser import parser
from pas.independent.checker import check_independently
from pas.limits import LIMITED

SENTENCE = re.compile(r"gave up after \d[\d.e+-]* s while [^;\n]+; allow more seconds( or [^;\n]+)?")

SHORT = {
    "Kind.mesh",
    "Shape.meshed",
    "VolumeMesh.write",
    "Layout.mesh",
    "ParametricBlend.all_polynomial_solutions",
    "Submodule.contains",
    "Submodule.normal_form",
    "pas.write_mesh",
}
"""Calls of long ones on what is small, under limits of the caller, and of other functions of the same name; and what
hands all keywords on."""

COMMON = {"write"}
"""Names that methods of other things have too: they count where a function is called by them."""

FOREVER, AT_ENTRY = 1e9, 0.5
"""Seconds of a clock that moves on by one at each look; the second look is at the entry of a call."""


BELOW = ("pas.pipeline.chosen", "pas.pipeline.hollow")
"""Modules whose classes public ones are built on."""


def functions() -> Iterator[tuple[str, FunctionType]]:
    """All public functions and methods of the package, by the names that users read."""
    for home in (pas, solid):
        for name in home.__all__:
            thing = getattr(home, name)
            if inspect.isclass(thing):
                bases = [base for base in thing.__mro__ if base is thing or base.__module__ in BELOW]
                for attribute, value in (item for base in bases for item in vars(base).items()):
                    function = getattr(value, "__func__", value)  # of class methods
                    if isinstance(function, FunctionType) and not attribute.startswith("_"):
                        yield f"{thing.__name__}.{attribute}", function
            elif isinstance(thing, FunctionType) and thing.__name__ == name:  # and no other name of it
                yield f"{home.__name__}.{name}", thing
    yield f"{check_independently.__module__}.{check_independently.__name__}", check_independently


def is_limited(function: FunctionType) -> bool:
    return (function.__doc__ or "").endswith(LIMITED)


def test_all_long_calls_are_in_the_table():
    assert {name for name, function in functions() if is_limited(function)} == set(LONG_CALLS)


def test_long_calls_take_the_keywords():
    for name, function in functions():
        parameters = inspect.signature(function).parameters
        takes = {"seconds", "progress"} <= parameters.keys()
        assert takes == is_limited(function) or function is pas.limit, name
        if takes:
            assert parameters["seconds"].default is parameters["progress"].default is None


def test_no_public_call_does_long_work_without_the_keywords():
    """What calls a long function by its name takes the keywords itself."""
    long_names = {name.rsplit(".", 1)[-1] for name in LONG_CALLS}
    for name, function in functions():
        if is_limited(function) or name in SHORT:
            continue
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
        called = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
        methods = {f.attr for f in called if isinstance(f, ast.Attribute)} - COMMON
        names = ({f.id for f in called if isinstance(f, ast.Name)} | methods) & long_names
        assert not names, f"{name} calls {names}"


@pytest.fixture
def clock(monkeypatch) -> TickingClock:
    clock = TickingClock()
    monkeypatch.setattr("pas.limits.time", clock)
    return clock


def written(folder: Path) -> dict[str, bytes]:
    """The files of a folder, which is empty afterwards."""
    found = {path.name: path.read_bytes() for path in folder.iterdir()}
    for name in found:
        (folder / name).unlink()
    return found


def gives_up(name: str, count: int, folder: Path, clock: TickingClock) -> None:
    """A long call does so in one sentence at `count` places, and then does its work as if nothing had been."""
    case, out, told = LONG_CALLS[name], folder / "out", list[float]()
    out.mkdir()
    case.call(case.make(folder), out, seconds=FOREVER)  # the first one in a process fills tables that are kept
    written(out)
    problem, before = case.make(folder), clock.looks
    case.call(problem, out, seconds=FOREVER)
    looks, whole = clock.looks - before, written(out)
    for deadline in {AT_ENTRY, *Random(name).choices(range(1, max(2, looks - 1)), k=count if looks > 2 else 0)}:
        problem = case.make(folder)
        with pytest.raises(pas.LimitError) as caught:
            case.call(problem, out, seconds=deadline)
        assert SENTENCE.fullmatch(str(caught.value))
        if "mesh" in name.lower():
            assert not re.search("degree|order", str(caught.value))
        assert not written(out)
    case.call(problem, out, progress=lambda fraction, words: told.append(fraction))
    assert told[-1] == 1 and told == sorted(told) and all(0 <= fraction < 1 for fraction in told[:-1])
    assert written(out) == whole


@pytest.mark.parametrize("name", LONG_CALLS)
def test_every_long_call_gives_up_wherever_the_deadline_falls(name, tmp_path, clock):
    gives_up(name, LONG_CALLS[name].deadlines, tmp_path, clock)


@pytest.mark.parametrize("name", LONG_COMMANDS)
def test_every_command_gives_up_wherever_the_deadline_falls(name, tmp_path, clock, capsys):
    make, arguments = LONG_COMMANDS[name]
    out, file = tmp_path / "out", str(make(tmp_path))
    out.mkdir()
    words = [str(word).replace("{}", file).replace("OUT", str(out)) for word in arguments]
    for deadline in (AT_ENTRY, 3, 11):
        assert main([*words, "--seconds", str(deadline)]) == FAILED
        told = capsys.readouterr().err.splitlines()
        assert SENTENCE.fullmatch(told[-1].removeprefix("pas: ")), told
        assert not written(out)


def test_all_commands_are_in_the_table():
    (commands,) = [a.choices for a in parser()._actions if isinstance(a, argparse._SubParsersAction)]
    assert {arguments[0] for _, arguments in LONG_COMMANDS.values()} == set(commands) - set(ENDLESS_COMMANDS)
    for name, command in commands.items():
        assert ("--seconds" in command._option_string_actions) == (name not in ENDLESS_COMMANDS)


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG_CALLS)
def test_fifty_deadlines(name, tmp_path, clock):
    gives_up(name, 50, tmp_path, clock)


def test_a_limit_around_all_holds_inside(clock):
    """As one around each call does, and the sooner one counts."""
    body = solid.box((0, 0, 0), (3, 2, 1))
    with pytest.raises(pas.LimitError, match=r"gave up after 7 s while .*; allow more seconds"), pas.limit(seconds=7):
        body.shell(0.2, seconds=1000).mesh(0.1, seconds=2000)
    with pas.limit(seconds=10**6), pytest.raises(pas.LimitError, match=r"gave up after 5 s"):
        body.mesh(0.1, seconds=5)
