"""The lists of mutants are valid, and the runner tells killed mutants from those that survive.

The mutants themselves are run by `make mutants`.
"""

from __future__ import annotations

from collections import Counter

import pytest
from conftest import ROOT
from mutants.run import flaws, main, mutants

FEWEST = 40
"""Each rule of the proof code has a mutant; these are the fewest that cover them."""


def test_every_list_is_valid():
    known = mutants()
    assert {m.list: found for m in known if (found := list(flaws(m)))} == {}
    assert [name for name, times in Counter((m.list, m.name) for m in known).items() if times > 1] == []


def test_there_are_enough_mutants():
    assert len(mutants()) >= FEWEST


MODULE = '''
def sign(x):
    """The sign of a number."""
    if x > 0:
        return 1
    return -1 if x < 0 else 0
'''

TESTS = """
from pas.signs import sign


def test_positive():
    assert sign(2) == 1


def test_negative():
    assert sign(-2) == -1
"""

ENTRY = """
[[mutant]]
name = "{name}"
file = "pas/signs.py"
old = "{old}"
new = "{new}"
tests = ["tests/test_signs.py{test}"]
"""


@pytest.fixture
def tree(tmp_path):
    """A package with one function and its tests; returns a function that writes its list of mutants."""
    for folder in ("pas", "tests/mutants"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "pas/__init__.py").write_text("")
    (tmp_path / "pas/signs.py").write_text(MODULE)
    (tmp_path / "tests/test_signs.py").write_text(TESTS)

    def listed(*entries: tuple[str, str, str, str], more: str = "") -> list[str]:
        text = "".join(ENTRY.format(name=n, old=o, new=w, test=t) for n, o, w, t in entries)
        (tmp_path / "tests/mutants/signs.toml").write_text(text + more)
        return ["--root", str(tmp_path)]

    return listed


KILLED = ("positive", "return 1", "return 2", "::test_positive")


def test_a_mutant_that_never_ends_is_killed_where_the_list_says_so(tree, capsys):
    loop = ("if x > 0:", "while x > 0:\\n        __import__('time').sleep(1)\\n    if x > 0:", "::test_positive")
    options = tree(("unannounced", *loop), ("announced", *loop), more="hangs = true\n")
    assert main([*options, "--seconds", "1"]) == 1
    printed = capsys.readouterr().out
    assert "1 of 2 killed" in printed
    assert "signs: unannounced: hangs" in printed


def test_only_killed_mutants_count(tree, capsys):
    not_tested = ("not tested", "return -1", "return -2", "::test_positive")
    not_importable = ("import", "def sign(x)", "def signs(x)", "")
    options = tree(KILLED, not_tested, not_importable)
    assert main(options) == 1
    printed = capsys.readouterr().out
    assert "1 of 3 killed" in printed
    for said in ("signs: not tested: SURVIVED", "signs: import: tests cannot be run"):
        assert said in printed


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (("missing", "return 7", "return 8", ""), "occurs 0 times"),
        (("twice", "return", "yield", ""), "occurs 2 times"),
        (("the same", "return 1", "return 1", ""), "occurs 1 times"),
        (("syntax", "return 1", "return (1", ""), "does not compile"),
        (("no such test", "return 1", "return 2", "::test_other"), "has no test"),
    ],
)
def test_flaws_are_named(tree, capsys, entry, said):
    assert main(tree(entry)) == 1
    assert said in capsys.readouterr().out


def test_failing_tests_kill_nothing(tree, capsys):
    options = tree(KILLED)
    module = options[1] + "/pas/signs.py"
    with open(module, "a", encoding="utf-8") as file:
        file.write("\n\ndef sign(x):\n    return 0\n")
    assert main(options) == 1
    assert "without any mutation" in capsys.readouterr().out


@pytest.mark.slow
def test_a_pattern_chooses(tree, capsys):
    assert main([*tree(KILLED, ("zero", "else 0", "else 1", "")), "--only", "positive"]) == 0
    assert "1 of 1 killed" in capsys.readouterr().out


def test_the_makefile_runs_them():
    assert "tests/mutants/run.py" in (ROOT / "Makefile").read_text()
