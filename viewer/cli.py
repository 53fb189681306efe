"""The command line: pbr-viewer view, render, page, serve, info, check, report, diff, doctor, cache.

Exit status: 0 success; 1 the input is bad or the output cannot be written; 2 wrong usage; 3 no OpenGL context;
130 interrupted. An error is reported in one line on stderr.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress

import click

from .base.heap import share_one_heap
from .base.messages import say_error
from .base.signals import Stopped, stoppable
from .commands.lazy import LazyCommands, command_list
from .commands.output import print_text
from .errors import UsageError, ViewerError


def _print_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not context.resilient_parsing:
        from importlib.metadata import version

        print_text(f"pbr-viewer, version {version('pbr-viewer')}")
        context.exit()


class _Commands(click.Group):
    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Take what is no command but names a model for one to view."""
        if args and args[0] not in self.commands and not args[0].startswith("-") and _names_model(args[0]):
            args = ["view", *args]
        return super().parse_args(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them, as click would."""
        with formatter.section("Commands"):
            formatter.write_dl(command_list())


def _names_model(text: str) -> bool:
    """Whether it is a file or a folder, or ends like a model, so that a missing one is told as such."""
    from .scene.model_files import MODEL_ENDINGS

    return os.path.exists(text) or os.path.splitext(text)[1].lower() in MODEL_ENDINGS


@click.group(cls=_Commands, commands=LazyCommands(),
             context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option("--version", is_flag=True, expose_value=False, is_eager=True, callback=_print_version,
              help="Show the version and exit.")
def cli() -> None:
    """Show 3D models with physically based shading: in a window, as pictures, and as measurements.

    `pbr-viewer COMMAND --help` lists the options of a command. `pbr-viewer MODEL` opens a window on it, as `view` does.

    Exit status: 0 success; 1 the input is bad or the output cannot be written; 2 wrong usage; 3 no OpenGL context. An
    error is reported in one line on stderr.
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line with `arguments`, by default those of the process. It ends by raising SystemExit."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError, OSError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # file names may not be valid text
    share_one_heap()
    sys.exit(_run(arguments))


def _run(arguments: Sequence[str] | None) -> int:
    """Run the command line and return the exit status. No error that a user can cause prints a traceback."""
    try:
        with stoppable():
            cli.main(args=arguments, prog_name="pbr-viewer", standalone_mode=False)
        return 0
    except UsageError as error:
        from .settings import with_dashes

        say_error(with_dashes(str(error)))
        return error.exit_status
    except (Stopped, ViewerError) as error:
        say_error(error)
        return error.exit_status
    except (KeyboardInterrupt, click.Abort):
        say_error("interrupted")
        return 130
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
    except click.ClickException as error:
        command = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else "pbr-viewer"
        say_error(f"{error.format_message()} (see `{command} --help`)")
    except MemoryError:
        say_error("out of memory")
        return 1
    except OSError as error:
        say_error(f"{error.filename or 'standard output'}: {error.strerror or error}")
        # At exit Python would flush the rest of the output again and report another error; redirect it to nowhere.
        with suppress(OSError, ValueError, AttributeError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 2
