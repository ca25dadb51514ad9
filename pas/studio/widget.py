"""The studio in a notebook: the same page as an anywidget, for Jupyter, marimo and others.

    import pas

    pipes = [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1)]
    widget = pas.blend(pipes, order=1).studio()

`widget.shape` is what is seen at rest, and setting `widget.document` moves the page.  The kernel does the work, one
request after the other.  In marimo, cells that use `mo.ui.anywidget(widget)` follow it.
"""

from __future__ import annotations

import re
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from pas.errors import PasError, library
from pas.shape import Shape
from pas.studio import GALLERY, Data, Message, refusal
from pas.studio.conversation import VERBS, answer, asked
from pas.studio.server import PAGE
from pas.studio.session import StudioSession

if TYPE_CHECKING:
    from pas.pipeline.result import Blend

NOTEBOOK = Path(__file__).parent / "notebook"

IMPORT = re.compile(r'^import \{(?P<names>[^}]*)\} from "\./(?P<module>\w+)\.js";$', re.M)
EXPORT = re.compile(r"^export (?=(?:const|class|(?:async )?function) (?P<name>\w+))", re.M)


@cache
def module() -> str:
    """All modules of the page in one, as notebooks want it: each in a function that gives what it exports."""
    texts = {file.stem: file.read_text(encoding="utf-8") for folder in (PAGE, NOTEBOOK) for file in folder.glob("*.js")}
    imports = {name: [found["module"] for found in IMPORT.finditer(text)] for name, text in texts.items()}
    needed = ["widget"]  # and what it imports, and what that does
    for name in needed:
        needed += [other for other in imports[name] if other not in needed]
    parts = []
    for name in TopologicalSorter({name: imports[name] for name in needed}).static_order():
        text = IMPORT.sub(_taken, texts[name])
        names = ", ".join(found["name"] for found in EXPORT.finditer(text))
        text = EXPORT.sub("", text).replace("export default", "const widget =")
        parts.append(f"const {name}_ = (() => {{\n{text}\nreturn {{ {names or 'widget'} }};\n}})();")
    return "\n".join([*parts, "export default widget_.widget;"])


def _taken(found: re.Match[str]) -> str:
    """An import as a line that takes what is named from the module's function."""
    return f"const {{{found['names'].replace(' as ', ': ')}}} = {found['module']}_;"


@cache
def widget_class() -> type[Any]:
    """The class of widgets; raises `MissingLibraryError` without the library of `pas[notebook]`."""
    library("anywidget", 'the studio in a notebook needs anywidget: pip install "pas[notebook]"')
    import anywidget
    import traitlets

    class StudioWidget(anywidget.AnyWidget):
        """A shape that is dragged in a notebook."""

        _esm = module()
        _css = (PAGE / "studio.css").read_text(encoding="utf-8")
        document = traitlets.Dict().tag(sync=True)

        def __init__(self, document: Data | None = None, shape: Shape | None = None) -> None:
            self.session, self._shot = StudioSession(), 0
            start = document or next(iter(GALLERY.values()))
            super().__init__(document=start if shape is None else self.session.open("shape.pas.json", shape))
            self.on_msg(lambda _, request, __: self.answer(request))

        @property
        def shape(self) -> Shape:
            """The shape that is seen at rest."""
            return self.session.shape_of(self.document)

        @property
        def blend(self) -> Blend:
            """The blend that is seen at rest, where the shape is one."""
            return cast("Blend", self.shape)

        def answer(self, request: dict[str, Any]) -> None:
            """Do what the page asks for; what cannot be done is said there in one sentence."""
            try:
                for message in self._answers(request):
                    self._tell(message, request)
            except (PasError, ValueError, TypeError, KeyError) as error:
                self._tell(refusal(error), request)

        def _answers(self, request: dict[str, Any]) -> list[Message]:
            verb, document, do = str(request.get("do")), request.get("document", {}), self.session.do
            if verb == "move":
                return [do(verb, document, str(request.get("scene", "")), bool(request.get("mesh")), True)]
            if verb == "rest":
                return [do("solve", document), do("measure", document)]
            if verb in VERBS - {"gallery"}:
                return [answer(verb, do(*asked(request)))]
            raise ValueError(f"there is no request {verb!r}")

        def _tell(self, message: Message, request: dict[str, Any]) -> None:
            shown = message.head["kind"] in ("picture", "moved")
            self._shot += shown
            asked = {"seq": int(request.get("seq", 0)), "of": request.get("do"), "view": request.get("view")}
            self.send(*message.added(shot=self._shot, **asked).parts())

    return StudioWidget


def studio(shape: Shape) -> Any:
    """The widget of a shape; see `Shape.studio`."""
    return widget_class()(shape=shape)
