"""Every option of every command, and every setting, as Markdown for the site."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import cast

import click

from ..jobs.info import settings_table


def options_page(commands: Mapping[str, click.Command]) -> str:
    """A section for each of `commands`, with its words of help and a table of its options, and one for `--set`."""
    return "\n\n".join([*(_section(command) for command in commands.values()), _settings()])


def _section(command: click.Command) -> str:
    context = click.Context(command, info_name=command.name)
    arguments = [param.make_metavar(context) for param in command.params if isinstance(param, click.Argument)]
    rows = [(_names(option, context), _meaning(option, context))
            for option in command.params if isinstance(option, click.Option)]
    usage = " ".join(["pbr-viewer", str(command.name), *arguments, "[OPTIONS]"])
    return "\n\n".join([f"## pbr-viewer {command.name}", f"    {usage}", _help(command),
                        _table(("option", "what it does"), rows)])


def _help(command: click.Command) -> str:
    """Its words, with the lines that click is told not to wrap (a line of \\b before them) as a block of code."""
    parts = []
    for paragraph in (command.help or "").split("\n\n"):
        first, _, rest = paragraph.partition("\n")
        parts.append("\n".join(f"    {line.strip()}" for line in rest.splitlines()) if first.strip() == "\b"
                     else _text(paragraph))
    return "\n\n".join(parts)


def _names(option: click.Option, context: click.Context) -> str:
    value = "" if option.is_flag else " " + option.make_metavar(context)
    return ", ".join(f"`{name}{value}`" for name in sorted(option.opts, key=len, reverse=True))


def _meaning(option: click.Option, context: click.Context) -> str:
    extra = option.get_help_extra(context)
    words = [_text(option.help or "")]
    words += [f"Default: `{extra['default']}`."] if "default" in extra else []
    words += ["Required."] if option.required else []
    return " ".join(words)


def _settings() -> str:
    rows = []
    for setting in settings_table():
        name = f"`{str(setting['name']).replace('_', '-')}`"
        rows.append((name, _values(setting), f"`{_shown(setting['default'])}`", _text(str(setting["meaning"]))))
    return "\n\n".join(["## --set NAME=VALUE", _table(("name", "values", "default", "what it is"), rows)])


def _values(setting: Mapping[str, object]) -> str:
    if "choices" in setting:
        return ", ".join(f"`{choice}`" for choice in cast(list[str], setting["choices"]))
    if "range" in setting:
        low, high = cast(list[float], setting["range"])
        return f"{low:g} to {high:g}" + (", whole" if setting["whole"] else "")
    return _text(str(setting["form"]))


def _shown(default: object) -> str:
    if isinstance(default, tuple):
        return ",".join(f"{part:g}" for part in default)
    return "none" if default is None else f"{default:g}" if isinstance(default, float) else str(default)


def _text(words: str) -> str:
    """On one line, with nothing that Markdown would take for its own."""
    parts = re.split(r"(`[^`]*`)", " ".join(words.split()))
    return "".join(part if part.startswith("`") else re.sub(r"([*_<>|\[\]\\])", r"\\\1", part) for part in parts)


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    names = list(head)
    lines = [names, ["---"] * len(names), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
