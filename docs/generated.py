"""Pages of the site that are made from other files: gallery, benchmarks, command line, problem files, project files.

`write(folder)` makes them; `pages()` gives them by name, as text.  What they tell is read from the program itself, so
that they cannot fall behind it: options from the parser of the command line, keys from the tables of the readers, forms
of project files from the kinds of shapes.
"""

from __future__ import annotations

import argparse
import inspect
import os
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any
from unittest.mock import patch

ROOT = Path(__file__).resolve().parents[1]
DOCS, EXAMPLES = ROOT / "docs", ROOT / "examples"
FOLDER = DOCS / "generated"

REGISTERED = re.compile(r"^\.\. registered:: (\S+)$", re.M)
"""A line of a page of the reference that stands for all entries of a registry, given as `module:NAME`."""

LINK = re.compile(r"(\]\(|src=\")([^)\"#:]+)(#[\w-]*)?(?=[)\"])")

GALLERIES = {
    "parts": "Parts",
    "corners": "Corners",
    "nodes": "Nodes",
    "gallery": "Single-surface blends",
    "parametric": "Parametric and generatrix blends",
    "teapot": "The teapot",
    "networks": "Networks of struts",
    "studio": "The studio",
    "extensions": "Extensions",
}
"""Folders of examples, in the order in which the gallery shows them."""


def with_registered(text: str) -> str:
    """A page with a directive of autodoc for each public class of the registries that it names, in their order."""
    import pas
    from pas.registry import loaded

    def directives(found: re.Match[str]) -> str:
        names = [entry.__name__ for entry in loaded(found[1]).values()]
        return "\n".join(f".. autoclass:: pas.{name}" for name in names if name in pas.__all__)

    return REGISTERED.sub(directives, text)


def moved(text: str, source: Path, page: Path) -> str:
    """Text of a file with its relative links as they must be on a page: to pages of the site where there are some."""

    def link(found: re.Match[str]) -> str:
        target = (source.parent / found[2]).resolve()
        if target.name == "README.md" and target.parent.parent == EXAMPLES:
            target = FOLDER / f"gallery_{target.parent.name}.md"
        elif target.parent == EXAMPLES and target.name in GALLERIES:
            target = FOLDER / f"gallery_{target.name}.md"
        elif target == ROOT / "benchmarks/README.md":
            target = FOLDER / "benchmarks.md"
        elif target in (ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"):
            target = FOLDER / f"{target.stem.lower()}.md"
        elif target == ROOT / "README.md":
            target = DOCS / "index.md"
        return f"{found[1]}{os.path.relpath(target, page.parent)}{found[3] or ''}"

    return LINK.sub(link, text)


def included(path: Path, page: Path, title: str | None = None) -> str:
    """A Markdown file as a page, under another title where one is given."""
    text = moved(path.read_text(encoding="utf-8"), path, page)
    return text if title is None else re.sub(r"\A# .*", f"# {title}", text)


def script(path: Path, page: Path, title: str = "") -> str:
    """A file of an example, folded in."""
    language = {".py": "python", ".toml": "toml", ".ipynb": "json"}[path.suffix]
    there = os.path.relpath(path, page.parent)
    return (
        f":::{{dropdown}} {title or path.name}\n```{{literalinclude}} {there}\n:language: {language}\n```\n"
        f"[Download {path.name}]({there})\n:::\n"
    )


def summary(path: Path) -> str:
    """The first sentence of a script's docstring, or of a file's first comment."""
    text = path.read_text(encoding="utf-8")
    found = re.search(r'"""(.+?)(?:"""|\n\n)', text, re.S) if path.suffix == ".py" else re.match(r"# (.*)", text)
    return " ".join(found[1].split()) if found else ""


def gallery(name: str) -> str:
    """The page of a folder of examples: its README, then pictures that it does not show, and all files folded in."""
    folder, page = EXAMPLES / name, FOLDER / f"gallery_{name}.md"
    readme = folder / "README.md"
    if name == "parts":
        return parts(folder, page)
    lines = [included(readme, page, GALLERIES[name])] if readme.exists() else [f"# {GALLERIES[name]}\n"]
    scripts = [p for p in sorted(folder.rglob("*")) if p.suffix in (".py", ".toml") and "pictures" not in p.parts]
    if not readme.exists():
        lines += [f"{summary(path)}\n" for path in scripts[-1:]]
        lines += [f"![]({os.path.relpath(p, page.parent)})\n" for p in sorted(folder.rglob("*.png"))]
    lines += ["## Files\n", *(script(path, page, str(path.relative_to(folder))) for path in scripts)]
    return "\n".join(lines)


def parts(folder: Path, page: Path) -> str:
    """The page of the parts: each with its picture, its script and its file."""
    readme = (folder / "README.md").read_text(encoding="utf-8")
    intro = readme.split("\n\n")[1]
    lines = [f"# {GALLERIES['parts']}\n", intro, ""]
    for names, what in re.findall(r"^\| (\[.*?) \| (.*) \|$", readme, re.M):
        files = [folder / name for name in re.findall(r"\]\(([^)]+)\)", names)]
        lines += [f"## {files[0].stem.capitalize()}\n", f"{what[0].upper()}{what[1:]}.\n"]
        lines += [f"![{files[0].stem}]({os.path.relpath(folder / 'pictures' / f'{files[0].stem}.png', page.parent)})\n"]
        for path in files:
            lines += [
                f"```{{literalinclude}} {os.path.relpath(path, page.parent)}\n"
                f":language: {'python' if path.suffix == '.py' else 'toml'}\n:caption: {path.name}\n```\n"
            ]
    return "\n".join(lines)


def overview() -> str:
    """The front page of the gallery: a picture of each folder."""
    cards = []
    for name, title in GALLERIES.items():
        pictures = sorted((EXAMPLES / name).rglob("*.png"))
        chosen = {"parts": "manifold", "corners": "three_pipes", "studio": "corner", "teapot": "views"}.get(name, "")
        shown = next((p for p in pictures if p.stem == chosen), pictures[0] if pictures else None)
        image = f":img-top: {os.path.relpath(shown, FOLDER)}\n" if shown else ""
        cards.append(f":::{{grid-item-card}} {title}\n:link: gallery_{name}\n:link-type: doc\n{image}:::\n")
    toctree = "\n".join(f"gallery_{name}" for name in GALLERIES)
    return (
        "# Gallery\n\nEvery picture is made by a script of the repository, which stands on the same page and is run by "
        "the tests.\n\n::::{grid} 2 2 3 3\n:gutter: 2\n\n" + "\n".join(cards) + "::::\n\n"
        f"```{{toctree}}\n:hidden:\n\n{toctree}\n```\n"
    )


def command_line() -> str:
    """All commands with their arguments, from the parser."""
    from pas.cli.common import EXIT_CODES
    from pas.cli.parser import parser

    whole = parser()
    lines = ["# Command line\n", "## Exit codes\n", EXIT_CODES.removeprefix("Exit codes: ") + "\n"]
    lines += ["## pas\n", "```text\n" + whole.format_usage().removeprefix("usage: ") + "```\n", *arguments(whole)]
    (group,) = (action for action in whole._actions if isinstance(action, argparse._SubParsersAction))
    for name, command in group.choices.items():
        lines += [f"## pas {name}\n", f"{command.description}\n"]
        lines += ["```text\n" + command.format_usage().removeprefix("usage: ") + "```\n", *arguments(command)]
        if command.epilog:
            lines += [f"```text\n{command.epilog}\n```\n"]
        if command.reader:
            lines += ["What the file says: [problem files](problem_files.md), and `--help`.\n"]
    return "\n".join(lines)


def arguments(command: argparse.ArgumentParser) -> list[str]:
    """A table of the arguments of a command."""
    rows = ["| argument | meaning |", "|---|---|"]
    for action in command._actions:
        if isinstance(action, argparse._SubParsersAction | argparse._HelpAction):
            continue
        value = "" if action.nargs == 0 else f" {action.metavar or action.dest.upper()}"
        shown = ", ".join(action.option_strings) + value if action.option_strings else value.strip()
        rows.append(f"| `{shown}` | {cell(command._get_formatter()._expand_help(action) if action.help else '')} |")
    return [*rows, ""]


def cell(text: str) -> str:
    """A text as the cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def tables_of(example: Path) -> Mapping[str, Mapping[str, bool]]:
    """The tables and keys that the reader of a problem file knows, as it hands them to its `TableReader`."""
    import pas
    from pas.exchange.problem import TableReader

    found: list[Any] = []
    real = TableReader.__init__

    def noted(self: Any, file: Any, text: str, keys: Any, lists: Any = ()) -> None:
        found.append((keys, tuple(lists)))
        real(self, file, text, keys, lists)

    with patch.object(TableReader, "__init__", noted):
        pas.read_problem(example)
    keys, lists = found[0]
    return {f"[[{name}]]" if name in lists else f"[{name}]" if name else "": known for name, known in keys.items()}


KINDS_OF_PROBLEMS = {
    "corner": ("Blends", "corner_problem", "corners/equal_gc2.toml"),
    "parametric": ("Parametric blends", "parametric_problem", "parametric/example_1.toml"),
    "generatrix": ("Blends by a generatrix", "parametric_problem", "parametric/generatrix/quadrics.toml"),
    "part": ("Parts", "part_problem", "parts/bracket.toml"),
}
"""Of each kind of problem: a title, the module in which its files are described, and a file of that kind."""


def problem_files() -> str:
    """All kinds of problem files with all their tables and keys."""
    from importlib import import_module

    from pas.exchange.problem import PROBLEMS

    lines = [
        "# Problem files\n",
        "A problem file is TOML and says what is to be made. `pas blend`, `pas parametric` and `pas build` "
        "read it, and "
        "so does `pas.read_problem`, whose `solve()` makes the shape. Numbers are exact: integers, decimals "
        "as written, and "
        'fractions in quotes, `"1/3"`. A key that is unknown or wrong is answered with its line and the '
        "nearest that is known.\n",
        "## What all problems have\n",
        "All problem files may have" + described(import_module("pas.exchange.problem")).partition("All may have")[2],
    ]
    for name, (title, module, example) in KINDS_OF_PROBLEMS.items():
        assert name in PROBLEMS
        text, second = described(import_module(f"pas.exchange.{module}")), "Or of blends by a Bezier generatrix:"
        if second in text:  # two kinds in one module
            first, _, rest = text.partition(second)
            text = "Two" + rest.removeprefix(" two") if name == "generatrix" else first
        lines += [f"## {title}\n", text]
        rows = ["| table | keys (needed ones in bold) |", "|---|---|"]
        for table, known in tables_of(EXAMPLES / example).items():
            keys = ", ".join(f"**`{key}`**" if needed else f"`{key}`" for key, needed in sorted(known.items()))
            rows.append(f"| {f'`{table}`' if table else 'top of the file'} | {keys} |")
        lines += ["### All tables and keys: " + title.lower() + "\n", *rows, ""]
    return "\n".join([*lines, settings_tables(), makers()])


def described(module: Any) -> str:
    """A module's docstring: text, and its indented or TOML lines as a block."""
    text = (inspect.getdoc(module) or "").split("\n\n", 1)[1]
    done: list[str] = []
    block: list[str] = []

    def close() -> None:
        while block and not block[-1].strip():
            block.pop()
        if block:
            language = "toml" if any(re.match(r"\s*(\w+ = |\[)", line) for line in block) else "text"
            done.append(f"```{language}\n" + inspect.cleandoc("\n".join(["", *block])) + "\n```\n")
            block.clear()

    for line in text.split("\n"):
        code = line.startswith("    ") or re.match(r"\w+ = |\[+\w+\]+|\S.*\S {4,}\S", line)
        if code or (block and not line.strip()):
            block.append(line)
        else:
            close()
            done.append(line)
    close()
    return "\n".join(done) + "\n"


def settings_tables() -> str:
    """The options of meshes and pictures that files have."""
    from pas.exchange.picture_options import Picture
    from pas.settings import MeshSettings, options

    lines = []
    for table, settings in (("mesh", MeshSettings), ("picture", Picture)):
        lines += [f"## The table [{table}]\n", "| key | value | meaning |", "|---|---|---|"]
        for one in options(settings, "file"):
            about = one.metadata
            kind = {bool: "true or false", int: "whole number", float: "number", str: "text", list: "list"}[
                about["kind"]
            ]
            lines.append(f"| `{one.name}` | {kind} | {cell(about['text'].format(usual='0.001 of the size'))} |")
        lines.append("")
    return "\n".join(lines)


def makers() -> str:
    """What tables of part files make, and which steps they may take."""
    from pas.exchange.part_problem import CLASSES, MAKERS, SET_OPERATIONS, steps_of

    def rows(found: Mapping[str, Any]) -> Iterator[str]:
        yield "| kind | keys (needed ones in bold) | what it does |"
        yield "|---|---|---|"
        for name, maker in sorted(found.items()):
            given = {"of": True} if name in SET_OPERATIONS else {} if name == "blend" else maker.keys
            keys = ", ".join(f"**`{key}`**" if needed else f"`{key}`" for key, needed in given.items())
            text = "the solid of a blend, with the keys of its problem file, and `length`" if name == "blend" else ""
            if name in SET_OPERATIONS:
                text = "of the tables that `of` names"
            text = text or (inspect.getdoc(maker.function) or "").split("\n\n")[0]
            yield f"| `{name}` | {keys} | {cell(text)} |"

    lines = ["## Kinds of tables of part files\n", *rows(dict(MAKERS.items())), ""]
    for name in CLASSES:
        lines += [f"### Steps for a {name.lower()}\n", *rows(dict(steps_of(name).items())), ""]
    return "\n".join(lines)


def project_files() -> str:
    """The forms of project files, kind by kind."""
    from pas.exchange import files as container
    from pas.kinds.files import whole_form
    from pas.shape import KINDS

    lines = [
        "# Project files\n",
        "A project file (`.pas.json`) holds a shape exactly: `shape.save(path)` writes it, `pas.load(path)` and the "
        "commands `pas check`, `mesh`, `render`, `write` and `convert` read it. Verdicts in it are for "
        "people: no program "
        "believes them, and they are proved again.\n",
        described(container),
        'Below are the forms of the content by `kind`. Exact numbers are texts such as `"1/3"` or whole numbers; a '
        'polynomial is a list of terms `[i, j, k, "p/q"]` for $p/q\\, x^i y^j z^k$, or a formula as a text.\n',
    ]
    for name in KINDS:
        lines += [f"## {name}\n", "```text", *form_lines(whole_form(KINDS[name])), "```\n"]
    return "\n".join(lines)


EXPLAINED = ("a polynomial", "a list of terms", "a point of three numbers", 'an exact number such as "1/3"')
"""Forms that the page explains at its head."""


def form_lines(form: Any, indent: int = 0, seen: tuple[Any, ...] = ()) -> list[str]:
    """A form of records as lines: keys, what their values must be, and what is inside of these."""
    from pas.exchange.schema import Table

    if any(form is other for other in seen) or form.words in EXPLAINED:
        return []
    seen = (*seen, form)
    lines: list[str] = []
    if isinstance(form, Table):
        for key, entry in {**form.needs, **form.may}.items():
            optional = "" if key in form.needs else " (optional)"
            lines += [
                f"{' ' * indent}{key}{optional}: {entry.words or 'as below'}",
                *form_lines(entry, indent + 4, seen),
            ]
        return lines
    inner = inspect.getclosurevars(form.inside).nonlocals if inspect.isfunction(form.inside) else {}
    parts = inner["parts_of"](1) if "parts_of" in inner else ()
    if isinstance(parts, tuple) and parts:  # a row
        lines += [f"{' ' * indent}[{', '.join(entry.words for entry in parts)}]"]
    several = {"entry": parts[0]} if isinstance(parts, list) else inner
    for name in ("entry", "form"):
        if name in several:
            entry = several[name]
            head = [] if isinstance(entry, Table) or name == "form" else [f"{' ' * indent}each {entry.words}"]
            lines += [*head, *form_lines(entry, indent + (0 if not head else 4), seen)]
    if "fitting" in inner:
        inner = inspect.getclosurevars(inner["fitting"]).nonlocals
    for number, entry in enumerate(inner.get("forms", ())):
        lines += [
            f"{' ' * indent}{'either' if number == 0 else 'or'} {entry.words}",
            *form_lines(entry, indent + 4, seen),
        ]
    if "find" in inner:
        lines += form_lines(inner["find"](), indent, seen)
    return lines


def reproduction() -> str:
    """The list of the pages on published results and on open questions, as many as there are."""
    found = [*(DOCS / "reproduction").glob("*.md"), *DOCS.glob("research*.md")]
    found.sort(key=lambda path: (path.name != "index.md", path))
    listed = "\n".join(os.path.relpath(path.with_suffix(""), FOLDER) for path in found)
    return (
        "# Reproduction and research\n\nPublished results are recomputed, and where numbers differ the page "
        "says so: in "
        "the galleries of [corners](gallery_corners.md), [single-surface blends](gallery_gallery.md) and "
        "[parametric blends](gallery_parametric.md), and on [dimensions of spline spaces](../dimensions.md).\n\n"
        + (f"```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n" if listed else "")
    )


def pages() -> dict[str, str]:
    """All of them, by name."""
    made: dict[str, Callable[[], str]] = {
        "gallery": overview,
        "command_line": command_line,
        "problem_files": problem_files,
        "project_files": project_files,
        "reproduction": reproduction,
        "benchmarks": lambda: included(ROOT / "benchmarks/README.md", FOLDER / "benchmarks.md"),
        "contributing": lambda: included(ROOT / "CONTRIBUTING.md", FOLDER / "contributing.md"),
        "changelog": lambda: included(ROOT / "CHANGELOG.md", FOLDER / "changelog.md"),
    }
    found = {name: make() for name, make in made.items()}
    return found | {f"gallery_{name}": gallery(name) for name in GALLERIES}


def write(folder: Path) -> None:
    """Write those pages that differ from what is there."""
    folder.mkdir(exist_ok=True)
    texts = pages()
    for path in folder.glob("*.md"):
        if path.stem not in texts:
            path.unlink()
    for name, text in texts.items():
        path = folder / f"{name}.md"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
