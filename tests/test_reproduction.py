"""The reproduction report: its quick rows again, its pages as they are recorded, and that a wrong row fails."""

from __future__ import annotations

import re
import sys
from types import ModuleType

import pytest
from conftest import ROOT

FOLDER = ROOT / "docs" / "reproduction"
WORKS = ("yu_sun_ma", "lou_feng_chen_deng", "xu_chen_deng", "perez_diaz_sendra", "cheng_gao")


@pytest.fixture(scope="module", autouse=True)
def scripts():
    """The folder's scripts as modules, and gone afterwards."""
    before = set(sys.modules)
    sys.path.insert(0, str(FOLDER))
    yield
    sys.path.remove(str(FOLDER))
    for name in set(sys.modules) - before:
        if str(FOLDER) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def table(text: str) -> list[str]:
    """The rows of the first table of a page, without times and numbers of reasons."""
    import reproduce

    lines = [line for line in reproduce.timeless(text).splitlines() if line.startswith("|")][2:]
    return [re.sub(r" \(\[\d+\]\)", "", line) for line in lines]


def test_all_works_are_tested_here():
    import reproduce

    assert reproduce.WORKS == WORKS


@pytest.mark.parametrize("name", WORKS)
def test_quick_rows_come_out_as_recorded(name):
    import reproduce

    work = reproduce.work_of(name)
    page = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
    recorded = table(page)
    assert len(recorded) == len(work.entries)
    for entry, line in zip(work.entries, recorded, strict=True):
        if entry.slow:
            assert line.startswith(f"| {reproduce.cell(entry.where)} | {reproduce.cell(entry.what)}")
            continue
        row = entry.run()
        assert not row.failure, f"{entry.where}, {entry.what}: {row.failure}"
        assert table(f"|\n|\n{reproduce.line(entry, row, 0)}") == [line]
        assert row.reason in page


def test_the_table_of_all_has_the_counts():
    import reproduce

    works = {name: reproduce.work_of(name) for name in WORKS}
    text = reproduce.index_of(works, dict.fromkeys(WORKS, 0.0))
    assert reproduce.drift(FOLDER / "index.md", text) == []
    assert sum(len(work.entries) for work in works.values()) > 200


def test_links_and_pictures_exist_and_are_small():
    for page in FOLDER.glob("*.md"):
        for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
            assert (FOLDER / link).exists(), link
    pictures = list((FOLDER / "pictures").glob("*.png"))
    assert sum(p.stat().st_size for p in pictures) < 3_000_000
    shown = "\n".join(page.read_text(encoding="utf-8") for page in FOLDER.glob("*.md"))
    assert all(f"pictures/{p.name}" in shown for p in pictures)


WRONG = {
    "agrees": (("agrees", 2, lambda: 3), "printed 2, computed 3"),
    "misprint": (("misprint", 3, lambda: 3, "why", lambda n: n == 3), "so it is no misprint"),
    "condition": (
        ("misprint", 2, lambda: 3, "why", lambda n: n > 1),
        "does not tell the printed value from the computed",
    ),
    "other condition": (("misprint", 2, lambda: 3, "why", lambda n: n > 3), "does not tell the printed value"),
    "differs": (("differs", 3, lambda: 3, lambda: "why", lambda: {}), "so it is no differs"),
    "reason": (("differs", 2, lambda: 3, lambda: "", lambda: {"3 > 2": True}), "no reason is given"),
    "fact": (
        ("differs", 2, lambda: 3, lambda: "why", lambda: {"3 > 2": True, "3 < 2": False, "3 = 2": False}),
        "the reason is wrong, as it is not true that 3 < 2 and that 3 = 2",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_row_fails_and_nothing_is_written(name, tmp_path, monkeypatch, capsys):
    import entries
    import reproduce

    (kind, *arguments), words = WRONG[name]
    module = ModuleType("false_work")
    module.work = entries.Work("A", "title", "words")
    getattr(module.work, kind)("section 1", "number", *arguments)
    monkeypatch.setitem(sys.modules, "false_work", module)
    monkeypatch.setattr(reproduce, "HERE", tmp_path)
    monkeypatch.setattr(reproduce, "WORKS", ("false_work",))
    assert reproduce.main(["--update"]) == 1
    assert words in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


def test_drift_fails_and_times_do_not(tmp_path, monkeypatch, capsys):
    import entries
    import reproduce

    def module(value):
        made = ModuleType("small_work")
        made.work = entries.Work("A", "title", "words")
        made.work.agrees("section 1", "number", value, lambda: value, note="a | b")
        monkeypatch.setitem(sys.modules, "small_work", made)

    monkeypatch.setattr(reproduce, "HERE", tmp_path)
    monkeypatch.setattr(reproduce, "WORKS", ("small_work",))
    module(3)
    assert reproduce.main([]) == 1  # new pages are written when that is asked
    assert reproduce.main(["--update"]) == 0
    page = tmp_path / "small_work.md"
    assert "| section 1 | number | `3` | `3` | agrees ([1]) |" in page.read_text()
    page.write_text(re.sub(r"\d\.\d{3} \|$", "7.654 |", page.read_text(), flags=re.MULTILINE))
    assert "7.654" in page.read_text()
    assert reproduce.main([]) == 0
    assert "7.654" not in page.read_text()
    module(4)
    before = page.read_text()
    assert reproduce.main([]) == 1
    assert "small_work.md: -| section 1 | number | `3` | `3` |" in capsys.readouterr().out
    assert page.read_text() == before


def test_values_are_shown_on_one_line():
    import entries

    assert entries.show((True, 1.5, "a")) == "yes, 1.5, a"
    assert entries.show(()) == "none"
    assert entries.show("x" * 500).endswith("x ... (500 characters)")


def test_inputs_without_a_second_solution_say_why():
    import perez_diaz_sendra

    for name in ("input V", "input XI"):
        assert "is not defined at h = 0" in perez_diaz_sendra.refusal(name)
