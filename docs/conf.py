"""The site: Sphinx with pages in Markdown (MyST), an API reference from docstrings, and formulas as MathML.

`make docs` builds it into out/docs.  Nothing is fetched while it is built or read.  When the build begins, pages that
are made from other files (gallery, command line, file formats) are written by `generated.py`, and the tutorials'
notebooks by `notebooks.py`, which runs them: two minutes at the first time.  The builder `dummy`, which
only reads the pages, runs none.
"""

from __future__ import annotations

import ast
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.nodes import make_refnode

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import generated  # noqa: E402
import notebooks  # noqa: E402

from pas._version import __version__  # noqa: E402

project, author, release = "pas", "the pas developers", __version__
copyright = f"2026, {author}. MIT licence"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.viewcode", "sphinx_design", "sphinx_copybutton"]
exclude_patterns = ["_build"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "amsmath", "attrs_block"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"pas {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sphinx = False
BLUE = {"color-brand-primary": "#2b5f8a", "color-brand-content": "#2b5f8a"}
html_theme_options = {"navigation_with_keys": True, "light_css_variables": BLUE}
pygments_style = "tango"
highlight_language = "python"
smartquotes_action = "q"  # options keep their dashes
copybutton_exclude = ".linenos, .gp, .go"
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints_format = "short"
autodoc_type_aliases = {  # which the front page of the reference explains
    name: name
    for name in (
        "Exact",
        "VectorLike",
        "PolynomialLike",
        "ContactLike",
        "PartitionLike",
        "ComponentLike",
        "FunctionLike",
    )
}
python_maximum_signature_line_length = 90
suppress_warnings = ["config.cache"]

CODE = re.compile(r"(`+)(.+?)\1", re.S)
ENDS = "'\")]}>-/:.,;!?\\"
"""What may follow a literal in reStructuredText without a space."""

SHORT = {
    r"TypeAliasForwardRef\('(\w+)'\)": r"\1",
    r"_Buffer \|.*?_NestedSequence\[complex \| bytes \| str\]": "ArrayLike",
    r"ndarray\[tuple\[Any, \.\.\.\], dtype\[(?:\w+\.)*(\w+)\]\]": r"ndarray[\1]",
}
"""How types in signatures are shortened."""


def as_rst(lines: list[str]) -> list[str]:
    """The docstring, written in plain text with `code` and indented programs, as reStructuredText."""
    found = re.split(r"((?:^|(?<=\n))(?: {4}.*(?:\n|$))(?:(?: {4}.*)?(?:\n|$))*)", "\n".join(lines))
    done: list[str] = []
    before = "\n\n"
    for number, part in enumerate(found):
        if number % 2 and before.endswith("\n\n"):  # a list goes on indented as well, without an empty line
            text = textwrap.dedent(part).strip("\n")
            done.append(f"\n\n.. code-block:: {language_of(text)}\n\n{textwrap.indent(text, '   ')}\n\n")
        else:
            done.append(inline(part))
        before = part if part.strip() else before
    return "".join(done).split("\n")


def language_of(text: str) -> str:
    """The language of a block, for its colours."""
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return "toml" if re.search(r"^\[\[?\w+\]|^\w+ = ", text, re.M) else "text"
    return "python" if any(isinstance(node, ast.Call) for node in ast.walk(tree)) else "text"


def inline(text: str) -> str:
    """Code in double backticks, and what reStructuredText would take for markup outside it escaped."""
    pieces, at = [], 0
    for found in CODE.finditer(text):
        code, before, after = " ".join(found[2].split()), text[: found.start()][-1:], text[found.end() :][:1]
        starts, ends = (not c or c.isspace() or c in marks for c, marks in ((before, "'\"([{<-/:"), (after, ENDS)))
        pieces += [escaped(text[at : found.start()]), "" if starts else "\\ ", f"``{code}``", "" if ends else "\\ "]
        at = found.end()
    return "".join([*pieces, escaped(text[at:])])


def escaped(text: str) -> str:
    """Text in which nothing is markup."""
    return re.sub(r"([*|]|_(?=\W|$))", r"\\\1", text.replace("\\", "\\\\"))


def process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """See `as_rst`."""
    lines[:] = as_rst(lines)


def named(app: Sphinx, what: str, name: str, obj: Any, options: Any, *texts: str | None) -> tuple[str | None, ...]:
    """Signatures with the names of aliases, for which Sphinx shows objects of its own or all that they stand for."""
    for long, short in SHORT.items():
        texts = tuple(text and re.sub(long, short, text) for text in texts)
    return texts


def relinked(app: Sphinx, page: str, source: list[str]) -> None:
    """Links to texts elsewhere in the repository, as the README of an example, lead to their pages here; tutorials
    have a link to their notebook below the title, and the reference has the entries of registries."""
    path = HERE / f"{page}.md"
    if path in notebooks.TUTORIALS:
        title, rest = source[0].split("\n", 1)
        link = f"[notebook with its results](../generated/notebooks/{path.stem}.ipynb)"
        source[0] = f"{title}\n\nThis page as a {link}, to go on from.\n{rest}"
    if path.parent != generated.FOLDER:
        source[0] = generated.with_registered(generated.moved(source[0], path, path))


class LinkedCode(SphinxPostTransform):
    """Code such as `pas.blend` or `solid.box(...)` in any page leads to the reference."""

    default_priority = 5

    def run(self, **kwargs: Any) -> None:
        """Replace such literals by references."""
        domain = self.env.get_domain("py")
        for node in list(self.document.findall(nodes.literal)):
            if isinstance(node.parent, nodes.reference | pending_xref) or node.findall is None:
                continue
            words = re.fullmatch(r"((?:pas|solid|network)\.[\w.]+)(\(.*\))?", node.astext(), re.S)
            if not words:
                continue
            name = words[1] if words[1].startswith("pas.") else f"pas.{words[1]}"
            entry = domain.objects.get(name)
            if entry is None:
                continue
            link = make_refnode(self.app.builder, self.env.docname, entry.docname, entry.node_id, node.deepcopy(), name)
            node.replace_self(link)


def mathml(self: Any, node: Any) -> None:
    """A formula, which browsers set themselves."""
    block = isinstance(node, nodes.math_block)
    text = tex2mathml(node.astext(), as_block=block)
    self.body.append(f'<div class="math">{text}</div>' if block else text)
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Connect all this."""
    app.add_html_math_renderer("mathml", (mathml, None), (mathml, None))
    app.connect("autodoc-process-docstring", process)
    app.connect("autodoc-process-signature", named)
    app.connect("source-read", relinked)
    app.connect("builder-inited", lambda app: generated.write(HERE / "generated"))
    place = HERE / "generated/notebooks"
    app.connect("builder-inited", lambda app: notebooks.write(place, run=app.builder.name != "dummy"))
    app.add_post_transform(LinkedCode)
