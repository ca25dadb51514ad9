"""The tutorials as notebooks: each page is the one source of its notebook, which is executed when the site is built.

`python docs/notebooks.py [NAME ...] [-o FOLDER]` writes them; the site has them in `generated/notebooks`.  A notebook
whose page, and what it includes, has not changed since it was executed is left as it is.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import nbformat
from nbclient import NotebookClient

DOCS = Path(__file__).resolve().parent
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
BLOCK = re.compile(r"^```(?P<kind>python|\{literalinclude\} (?P<file>\S+))\n(?P<text>.*?)^```$\n?", re.M | re.S)
PICTURE = re.compile(r"!\[(?P<about>[^\]]*)\]\((?P<file>[^)]+\.png)\)")
LINK = re.compile(r"(?<!!)\[(?P<text>[^\]]+)\]\((?!http)[^)]+\)")
DRAWN = re.compile(r"""\.(?:draw|picture)\(\s*"(?P<file>[\w.-]+\.png)\"""")


def notebook(page: Path) -> nbformat.NotebookNode:
    """The notebook of a page, not executed: text and pictures as they stand there, programs as cells."""
    text, cells, at = page.read_text(encoding="utf-8"), [], 0
    for block in BLOCK.finditer(text):
        cells += [*words(text[at : block.start()], page), *program(block, page)]
        at = block.end()
    cells += words(text[at:], page)
    for number, cell in enumerate(cells):
        cell.id = f"{page.stem}-{number}"  # the same whenever it is made
    made = nbformat.v4.new_notebook(cells=cells)
    made.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    made.metadata["source"] = hashlib.sha256(nbformat.writes(made).encode()).hexdigest()
    return made


def words(text: str, page: Path) -> list[nbformat.NotebookNode]:
    """Text as a cell, with its pictures inside, and without links to pages, which a notebook has not beside it."""
    pictures: dict[str, dict[str, str]] = {}

    def attached(found: re.Match[str]) -> str:
        file = page.parent / found["file"]
        pictures[file.name] = {"image/png": base64.b64encode(file.read_bytes()).decode("ascii")}
        return f"![{found['about']}](attachment:{file.name})"

    plain = LINK.sub(lambda found: found["text"], PICTURE.sub(attached, text)).strip()
    more = {"attachments": pictures} if pictures else {}
    return [nbformat.v4.new_markdown_cell(plain, **more)] if plain else []


def program(block: re.Match[str], page: Path) -> list[nbformat.NotebookNode]:
    """A program as a cell, and another that shows what it has drawn."""
    code = (page.parent / block["file"]).read_text(encoding="utf-8") if block["file"] else block["text"]
    if "sys.argv" in code:
        code = code.replace("import sys\n", f'import sys\n\nsys.argv = ["{Path(block["file"]).name}"]\n', 1)
    drawn = "\n".join(f'display(Image("{found["file"]}"))' for found in DRAWN.finditer(code))
    shown = [f"from IPython.display import Image, display\n\n{drawn}"] if drawn else []
    return [nbformat.v4.new_code_cell(one.strip()) for one in (code, *shown)]


def executed(made: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """The notebook with what its cells print and show, run in an empty folder; raises where a cell does."""
    paths = os.pathsep.join([str(DOCS.parent), os.environ.get("PYTHONPATH", "")])
    with TemporaryDirectory() as folder, patch.dict(os.environ, PYTHONPATH=paths):
        quiet = ["--log-level=ERROR"]  # no warning that the kernel is on this machine alone
        resources = {"metadata": {"path": folder}}
        return NotebookClient(made, timeout=600, resources=resources, extra_arguments=quiet).execute()


def write(folder: Path, pages: list[Path] = TUTORIALS, run: bool = True) -> None:
    """Write the notebooks of pages that have changed; without `run`, those that are missing, not executed."""
    folder.mkdir(parents=True, exist_ok=True)
    for page in pages:
        made, place = notebook(page), folder / f"{page.stem}.ipynb"
        if not run:
            del made.metadata["source"]  # the next build executes it
            if not place.exists():
                nbformat.write(made, place)
            continue
        if place.exists() and nbformat.read(place, as_version=4).metadata.get("source") == made.metadata["source"]:
            continue
        nbformat.write(executed(made), place)


def main(arguments: list[str] | None = None) -> int:
    """Write what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [page.stem for page in TUTORIALS]
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(names)}; all if none is named")
    parser.add_argument("-o", "--output", type=Path, default=DOCS / "generated/notebooks", metavar="FOLDER")
    options = parser.parse_args(arguments)
    write(options.output, [page for page in TUTORIALS if page.stem in (options.names or names)])
    return 0


if __name__ == "__main__":
    sys.exit(main())
