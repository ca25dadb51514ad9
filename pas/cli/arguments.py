"""Arguments of the command line: those of settings, which derive from their fields, and a parser that guesses."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable
from typing import Any, NoReturn, TypeVar

from pas.errors import meant
from pas.settings import options

Settings = TypeVar("Settings")


def add_settings(
    parser: argparse._ActionsContainer, settings: type[Any], usual: str = "", leave: Iterable[str] = ()
) -> None:
    """An argument for each option of a class of settings, but those to leave out; `usual` stands in help texts."""
    for field in options(settings, "command", leave):
        name, about = f"--{field.name.replace('_', '-')}", field.metadata
        text = about["text"].format(usual=usual)
        if about["kind"] is bool:
            parser.add_argument(name, action="store_true", default=None, help=text)
        else:
            parser.add_argument(name, type=about["kind"], metavar=about["metavar"], help=text)


def settings_of(settings: type[Settings], arguments: argparse.Namespace) -> Settings:
    """The settings that arguments give; what was not given is as usual."""
    values = {field.name: getattr(arguments, field.name, None) for field in options(settings, "command")}
    return settings(**{name: value for name, value in values.items() if value is not None})


class Parser(argparse.ArgumentParser):
    """A reader of arguments that guesses what a misspelt command or option was meant to be."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong on stderr and end with exit code 2."""
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        if wrong:
            message = f"there is no command {wrong[1]!r}" + (
                meant(wrong[1], re.findall(r"[\w-]+", wrong[2])) or f"; there are {wrong[2]}"
            )
        option = re.search(r"unrecognized arguments: (--[\w-]+)", message)
        if option:
            message += meant(option[1], self.options)
        super().error(message)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As usual, but a project file after --curvature, whose word may be left out, is not its word."""
        words = list(sys.argv[1:] if args is None else args)
        for place, word in enumerate(words[:-1]):
            if word == "--curvature" and words[place + 1].endswith(".json"):
                words[place] = "--curvature=mean"
        return super().parse_known_args(words, namespace)

    @property
    def options(self) -> list[str]:
        """All long options, those of commands included."""
        found = list(self._option_string_actions)
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                found += [o for command in action.choices.values() for o in command._option_string_actions]
        return [o for o in dict.fromkeys(found) if o.startswith("--")]
