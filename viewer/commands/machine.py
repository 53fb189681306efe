"""The commands about this machine: doctor, cache."""

from __future__ import annotations

import sys

import click

from ..errors import InputError
from ..jobs.options import JSON_OPTION
from .output import print_text, write_or_print_json


@click.command()
@JSON_OPTION
def doctor(json_file: str | None) -> None:
    """Show which OpenGL contexts work here, and how to fix those that do not. Exit status 3: none works."""
    from ..jobs.doctor import diagnose, exit_status, format_findings

    findings = diagnose()
    if json_file:
        write_or_print_json(json_file, [finding.to_json() for finding in findings])
    else:
        print_text(format_findings(findings))
    sys.exit(exit_status(findings))


@click.command()
@click.option("--clear", is_flag=True, help="Delete all entries of the cache.")
def cache(clear: bool) -> None:
    """Show the folder and size of the cache, which holds prepared environments and their shadow maps.

    The environment variable PBR_VIEWER_CACHE names another folder, or is `off`.
    """
    from ..bake.cache import cache_folder, cache_size, clear_cache

    folder = cache_folder()
    if folder is None:
        print_text("the cache is switched off")
    elif folder.exists() and not folder.is_dir():
        raise InputError(folder, "", "is no folder, so nothing is kept; PBR_VIEWER_CACHE must name one, or be `off`")
    elif clear:
        print_text(f"{folder}: {clear_cache() / 1e6:.1f} MB freed")
    else:
        print_text(f"{folder}: {cache_size() / 1e6:.1f} MB")
