"""The documentation is whole: every public name in the reference, every page in a toctree, every link leads somewhere.

`make docs` builds the pages; here they are read as text, with those that are made from other files.
"""

from __future__ import annotations

import posixpath
import re
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from conftest import ROOT

import pas
from pas import network, solid
from pas.cli.parser import COMMANDS, parser
from pas.exchange.problem import PROBLEMS
from pas.shape import KINDS

DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))

import generated  # noqa: E402  # the module beside the pages

WORDS_OF_README = 900
ALIASES = {
    *("pas.ParametricMesh", "pas.solid.SolidMesh"),
    *("pas.save_solid", "pas.save_parametric", "pas.load_solid"),
    *("pas.write_solid", "pas.write_step", "pas.write_cells"),
}
"""Other names of `pas.Mesh`, and of `pas.save`, `pas.load` and `pas.write`."""

OUTSIDE = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "examples").rglob("README.md"))]
"""Texts that are read in the repository as well, where their links must lead somewhere, too."""


@cache
def pages() -> dict[str, str]:
    """All pages of the site by their place in `docs`, without suffix."""
    written = {
        str(path.relative_to(DOCS).with_suffix("")): generated.with_registered(path.read_text(encoding="utf-8"))
        for path in DOCS.rglob("*.md")
        if path.parent.name != "generated"
    }
    return written | {f"generated/{name}": text for name, text in generated.pages().items()}


def slug(heading: str) -> str:
    """The anchor of a heading, as GitHub and MyST make it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-")


def without_code(text: str) -> str:
    """A page without its literal blocks."""
    return re.sub(r"^(`{3,})(?!\{).*?^\1$", "", text, flags=re.M | re.S)


def test_every_public_name_stands_in_the_reference_once():
    text = "".join(text for page, text in pages().items() if page.startswith("reference/"))
    found = Counter(re.findall(r"^\.\. auto(?:class|function|exception):: (\S+)$", text, re.M))
    modules = {"pas": pas, "pas.solid": solid, "pas.network": network}
    names = {f"{prefix}.{name}" for prefix, module in modules.items() for name in module.__all__}
    assert set(found) == names - ALIASES - {"pas.__version__", "pas.solid", "pas.network"}
    assert set(found.values()) == {1}
    assert all(alias in text or alias.removeprefix("pas.") in text for alias in ALIASES)


def entries(page: str) -> list[str]:
    """The pages that the toctrees of a page name."""
    found = []
    for block in re.findall(r"^```\{toctree\}\n(.*?)^```", pages()[page], re.M | re.S):
        for line in block.splitlines():
            if line and not line.startswith(":"):
                path = posixpath.normpath(posixpath.join(posixpath.dirname(page), line))
                found += [p for p in pages() if Path(p).match(path)] if "*" in path else [path]
    return found


def test_every_page_is_in_one_toctree():
    found = Counter(entry for page in pages() for entry in entries(page))
    assert set(found) == set(pages()) - {"index"}
    assert set(found.values()) == {1}


def links(text: str) -> set[str]:
    """Where the links, pictures and included files of a page lead."""
    plain = without_code(text)
    found = re.findall(r"\]\(([^)\s]*)\)", plain) + re.findall(r"^:img-top: (.*)$", plain, re.M)
    return {*found, *re.findall(r"\{(?:literalinclude|include|image|figure)\} (\S+)", text)}


def broken(text: str, folder: Path) -> list[str]:
    """The links of a page in a folder that lead nowhere."""
    wrong = []
    for link in links(text):
        if re.match(r"[a-z]+:", link):
            wrong += [] if link.startswith("https://") else [link]
            continue
        place, _, anchor = link.partition("#")
        target = Path(posixpath.normpath(folder / place)) if place else None
        page = None if target is None else str(target.with_suffix("")).removeprefix(f"{DOCS}/")
        there = text if target is None else pages().get(page or "")
        if there is None or (target is not None and target.suffix != ".md"):
            there = target is not None and target.exists() and target.suffix != ".md"  # no page of the site
            wrong += [] if there and not anchor else [link]
        elif anchor and anchor not in {slug(h) for h in re.findall(r"^#+ (.*)$", without_code(there), re.M)}:
            wrong.append(link)
    return wrong


@pytest.mark.parametrize("page", sorted(pages()))
def test_links_of_pages_lead_somewhere(page):
    path = DOCS / f"{page}.md"
    assert not broken(generated.moved(pages()[page], path, path), path.parent)  # as the build reads it


@pytest.mark.parametrize("path", OUTSIDE, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_of_texts_in_the_repository_lead_somewhere(path):
    wrong = [
        link for link in links(path.read_text(encoding="utf-8")) if not (path.parent / link.split("#")[0]).exists()
    ]
    assert not [link for link in wrong if not link.startswith("https://")]


def test_links_that_lead_nowhere_are_found():
    text = "# A\n[a](#a) [b](#b) [c](index.md#no-such) [d](nowhere.md) ![e](no.png)\n```text\n[f](code.md)\n```\n"
    assert sorted(broken(text, DOCS)) == ["#b", "index.md#no-such", "no.png", "nowhere.md"]


def test_the_command_line_is_told_whole():
    text = pages()["generated/command_line"]
    assert all(f"\n## pas {command.name}\n" in text for command in COMMANDS)
    assert all(option in text for option in parser().options if option != "--help")


def test_problem_files_are_told_whole():
    text = pages()["generated/problem_files"]
    assert set(generated.KINDS_OF_PROBLEMS) == set(PROBLEMS)
    for _, _, example in generated.KINDS_OF_PROBLEMS.values():
        for table, keys in generated.tables_of(ROOT / "examples" / example).items():
            assert f"`{table}`" in text and all(f"`{key}`" in text for key in keys)


def test_project_files_are_told_whole():
    text = pages()["generated/project_files"]
    assert all(f"\n## {name}\n" in text for name in KINDS)
    assert all(f"{key}" in text for kind in KINDS.values() for key in (*kind.form.needs, *kind.form.may))


def test_every_example_is_in_the_gallery():
    text = "".join(text for page, text in pages().items() if page.startswith(("generated/gallery", "tutorials/")))
    scripts = [p for p in (ROOT / "examples").rglob("*") if p.suffix in (".py", ".toml")]
    left = [p for p in scripts if f"{p.relative_to(ROOT / 'examples')}\n:language" not in text]
    assert len(scripts) > 50 and not left


def test_the_readme_is_a_door():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= WORDS_OF_README


def test_no_change_is_told_twice():
    """As merges by union may leave it."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    told = Counter(" ".join(entry.split()) for entry in re.split(r"\n(?=- |#|\n)", text) if entry.startswith("- "))
    assert not [entry for entry, times in told.items() if times > 1]


def test_the_citation_has_the_version():
    assert f"\nversion: {pas.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_docstrings_become_text_of_the_reference():
    pytest.importorskip("sphinx")
    import conf  # beside the pages

    assert conf.inline("GC^`order`, `a`^2 (`b`) and `c`s") == "GC^\\ ``order``, ``a``\\ ^2 (``b``) and ``c``\\ s"
    long = "(x: Sequence[TypeAliasForwardRef('Exact')], y: ndarray[tuple[Any, ...], dtype[float64]])"
    assert conf.named(None, "", "", None, None, long, None) == ("(x: Sequence[Exact], y: ndarray[float64])", None)


@pytest.mark.parametrize("command", [[], *([command.name] for command in COMMANDS)], ids=" ".join)
def test_every_command_has_its_help(command, capsys):
    with pytest.raises(SystemExit) as done:
        parser().parse_args([*command, "--help"])
    assert done.value.code == 0 and " ".join(["usage: pas", *command]) in capsys.readouterr().out
