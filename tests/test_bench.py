"""What `pas bench` measures: every suite runs, runs are kept and compared, a page is written."""

from __future__ import annotations

import json

import pytest

from pas.bench.case import PEERS, SUITES, Case
from pas.bench.measure import measured, timed
from pas.bench.run import run
from pas.cli import main

QUICK = ("algebra", "parametric")
"""Suites that take less than a second."""


@pytest.mark.parametrize("name", SUITES)
def test_suites_are_told_apart(name):
    suite = SUITES[name]
    cases = suite.cases()
    assert suite.name == name and suite.about
    assert cases and len({case.name for case in cases}) == len(cases)
    assert {peer for case in cases for peer in case.peers} <= set(PEERS)


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in SUITES])
def test_suites_run(name):
    for result in run([name], quick=True).results:
        assert result.suite == name and result.timing.runs == 1 and result.timing.median > 0
        assert all(PEERS[peer].found and ratio > 0 for peer, ratio in result.ratios.items())


def test_a_ratio_says_how_much_longer_a_peer_takes(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("pas.bench.measure.spent", lambda: now[0])

    def lasts(seconds):
        def work():
            now[0] += seconds

        return lambda: work

    result = measured("a", Case("sleep", lasts(0.5), {"numpy": lasts(1.5), "sympy": lasts(5.0)}))
    assert result.timing.median == 0.5 and result.ratios == {"numpy": 3.0, "sympy": 10.0}
    assert result.timing.runs == 3 and result.peers["sympy"].runs == 1


def test_a_quick_look_runs_once():
    calls = []
    assert timed(lambda: calls.append(1), quick=True).runs == 1 == len(calls)


def test_peers_that_are_not_installed_are_left_out(monkeypatch):
    monkeypatch.setenv("PATH", "")
    peers = {peer for result in run(["algebra"], quick=True).results for peer in result.peers}
    assert "sympy" in peers and not peers & {"Singular", "Macaulay2"}


def test_runs_are_kept_and_compared(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("pas.bench.measure.ENOUGH", 0.0)
    history, page = tmp_path / "runs" / "bench.jsonl", tmp_path / "README.md"
    words = ["bench", "--suite", "parametric", "--history", str(history), "--json"]
    assert main([*words, "--readme", str(page)]) == 0
    first = json.loads(capsys.readouterr().out)
    assert {"processor", "cores", "Python"} == set(first["machine"])
    assert all(row["before"] is None for row in first["results"])
    assert main(words) == 0
    second = json.loads(capsys.readouterr().out)
    assert [row["before"] for row in second["results"]] == [row["timing"]["median"] for row in first["results"]]
    assert len(history.read_text(encoding="utf-8").splitlines()) == 2
    text = page.read_text(encoding="utf-8")
    assert all(row["case"] in text for row in first["results"]) and "## parametric" in text


def test_what_is_wrong_is_said(tmp_path, capsys):
    assert main(["bench", "--suite", "algebr"]) == 2
    assert "there is no suite 'algebr'; is 'algebra' meant?" in capsys.readouterr().err
    other = tmp_path / "notes.txt"
    other.write_text("not a run\n")
    assert main(["bench", "--suite", "parametric", "--quick", "--history", str(other)]) == 2
    assert "is no history of benchmarks" in capsys.readouterr().err
    assert other.read_text() == "not a run\n"
    assert main(["bench", "--suite", "parametric", "--quick", "--readme", str(tmp_path / "no" / "README.md")]) == 2
    assert "does not exist" in capsys.readouterr().err
