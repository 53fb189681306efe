"""What commands print: facts, JSON, and warnings of a scene."""

from __future__ import annotations

from typing import Any

import click

from ..base.messages import one_line, say


def warn(model: str, scene: Any, settings: Any, options: dict[str, Any]) -> None:
    """Say what is left out of the picture, or ignored, on stderr; not with --quiet."""
    if options["quiet"]:
        return
    from ..jobs.assemble import known_warnings

    for warning in known_warnings(scene, settings):
        say(f"{model}: warning: {warning}")


def print_facts(facts: dict[str, object], json_file: str | None) -> None:
    """Write `facts` to the JSON file, or print them."""
    if json_file:
        write_or_print_json(json_file, facts)
        return
    from ..jobs.info import format_facts

    print_text(format_facts(facts))


def write_or_print_json(path: str, content: object) -> None:
    """`path` may be "-"."""
    from ..base.atomic import write_json

    if path == "-":
        import json

        print_text(json.dumps(content, indent=1, allow_nan=False))
    else:
        write_json(path, content)


def print_text(text: str) -> None:
    click.echo("\n".join(map(_escaped, text.split("\n"))))


def _escaped(line: str) -> str:
    indent = len(line) - len(line.lstrip(" "))
    return line if line.isprintable() else " " * indent + one_line(line)
