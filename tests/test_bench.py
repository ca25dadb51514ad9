"""Benchmarks: each runs, and a run makes a page; the sixty cases are compared as they say."""

from __future__ import annotations

import json
import os
import runpy
import subprocess
import sys

import pytest
from conftest import ROOT

QUICK = "product or Hermite or quintic"


def bench(*options):
    pytest.importorskip("pytest_benchmark")
    command = [sys.executable, "-m", "pytest", str(ROOT / "benchmarks"), *options]
    alone = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_XDIST")}
    done = subprocess.run(command, cwd=ROOT, env=alone, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-3000:]
    return done.stdout


@pytest.mark.slow
def test_benchmarks_run():
    assert " passed" in bench("--benchmark-disable")


@pytest.mark.slow
def test_a_run_makes_a_page(tmp_path):
    file = tmp_path / "run.json"
    bench("-k", QUICK, f"--benchmark-json={file}")
    record = json.loads(file.read_text())
    assert {run["extra_info"]["program"] for run in record["benchmarks"]} >= {"pas", "sympy", "numpy"}
    text = runpy.run_path(str(ROOT / "benchmarks/page.py"))["page"](record)
    assert "## Exact algebra" in text and "product of two dense quartics" in text and "times as long" in text


@pytest.fixture(scope="module")
def reference():
    return runpy.run_path(str(ROOT / "benchmarks/reference.py"))


@pytest.fixture(scope="module")
def kept():
    return json.loads((ROOT / "benchmarks/reference.json").read_text())


def test_there_are_sixty_cases(kept, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    cases = runpy.run_path(str(ROOT / "benchmarks/reference_cases.py"))["all_cases"]()
    assert list(cases) == list(kept) and len(kept) == 60


def changed(kept, number, **values):
    names = list(kept)[:number]
    return {name: {**record, **values} if name in names else record for name, record in kept.items()}


def test_what_is_worse_is_said(reference, kept, capsys):
    compare = reference["compare"]
    assert compare(kept, kept) == []
    assert compare(kept, changed(kept, 1, degree=99)) == ["elbow_gc1: degree 4 -> 99"]
    assert "undecided" in compare(kept, changed(kept, 1, verdicts=[["one sheet", "undecided"]]))[0]
    pinched = {"sharpness": [2.0, 1.0]}
    assert compare(kept, changed(kept, 3, fairness=pinched)) == []
    assert compare(kept, changed(kept, 4, fairness=pinched))[0].startswith("4 cases are less fair")
    slow = {name: {**r, "seconds": {p: 1.15 * s for p, s in r["seconds"].items()}} for name, r in kept.items()}
    assert compare and len(reference["compare_seconds"](kept, slow, True)) == 2  # of meshes and their certificates
    assert reference["compare_seconds"](kept, slow, False) == []
    capsys.readouterr()


def test_a_case_is_measured(reference, kept, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    record = reference["measured"]("torus")
    assert reference["differences"](kept["torus"], reference["rounded"](record)) == []
    assert set(record["seconds"]) == set(reference["PHASES"])
