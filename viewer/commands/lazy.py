"""The commands by their names, each imported when it is looked up, so that no command waits for what others need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module

import click

_COMMANDS = {
    "view": ("pictures", "Open a model in a window."),
    "render": ("pictures", "Render pictures of models, without a screen."),
    "page": ("browser", "Write a page on which a model turns."),
    "serve": ("browser", "Show a model in a browser, drawn here."),
    "info": ("pictures", "Show what is in a model and how it will be rendered."),
    "check": ("measurements", "Check the shaders: energy conservation and float32 precision."),
    "report": ("measurements", "Measure error against time, by every method there is."),
    "diff": ("measurements", "Compare two pictures."),
    "doctor": ("machine", "Show which OpenGL contexts work here."),
    "cache": ("machine", "Show or clear the cache on disk."),
}
"""The module of each command in this folder, and its line in the list of all."""


class LazyCommands(Mapping[str, click.Command]):
    """All commands by their names. Each has its line of the list as its short help."""

    def __getitem__(self, name: str) -> click.Command:
        module, line = _COMMANDS[name]
        command: click.Command = getattr(import_module(f".{module}", __package__), name)
        command.short_help = line
        return command

    def __contains__(self, name: object) -> bool:
        return name in _COMMANDS  # without its import, which Mapping would do

    def __iter__(self) -> Iterator[str]:
        return iter(_COMMANDS)

    def __len__(self) -> int:
        return len(_COMMANDS)


def command_list() -> list[tuple[str, str]]:
    """(name, line) of every command, in alphabetical order, without an import."""
    return [(name, line) for name, (_, line) in sorted(_COMMANDS.items())]
