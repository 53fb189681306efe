"""The command line: pbr-viewer view, render, info, check, report, diff, doctor, cache.

Exit status: 0 success; 1 the input is bad or the output cannot be written; 2 wrong usage; 3 no OpenGL context;
130 interrupted. An error is reported in one line on stderr.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from .base.heap import share_one_heap
from .base.messages import one_line, say, say_error
from .base.signals import Stopped, stoppable
from .errors import UsageError, ViewerError
from .jobs.options import (
    AOV_OPTION,
    BACKEND_OPTION,
    CAMERA_OPTIONS,
    COMMON_OPTIONS,
    ERROR_OPTIONS,
    FILM_OPTIONS,
    JSON_OPTION,
    LOOK_OPTIONS,
    MODEL_OPTIONS,
    NO_CACHE_OPTION,
    PATH_OPTIONS,
    QUIET_OPTION,
    SCENE_OPTIONS,
    TIME_OPTIONS,
    Number,
    check_camera_options,
    size_option,
    with_options,
)


def _print_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not context.resilient_parsing:
        from importlib.metadata import version

        _print(f"pbr-viewer, version {version('pbr-viewer')}")
        context.exit()


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option("--version", is_flag=True, expose_value=False, is_eager=True, callback=_print_version,
              help="Show the version and exit.")
def cli() -> None:
    """Show 3D models with physically based shading: in a window, as pictures, and as measurements.

    `pbr-viewer COMMAND --help` lists the options of a command.

    Exit status: 0 success; 1 the input is bad or the output cannot be written; 2 wrong usage; 3 no OpenGL context. An
    error is reported in one line on stderr.
    """


@cli.command(short_help="Open a model in a window.", context_settings={"default_map": {"denoise": "fast"}})
@click.argument("model")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *PATH_OPTIONS, *CAMERA_OPTIONS, *COMMON_OPTIONS])
def view(model: str, **options: Any) -> None:
    """Open MODEL in a window. Drag to orbit, scroll to move closer, press H for a list of all keys.

    With --animation it plays, unless a --time is given, at which it stands still.

    MODEL is a glTF file (.gltf, .glb), an OBJ, PLY, STL, OFF or XYZ, a volume (.vdb, .npz, .vol), or curves (.hair,
    .bcc, .curves). 3MF and COLLADA (.dae) need `pip install 'pbr-viewer[formats]'`.
    """
    check_camera_options(options)
    from .app import open_window
    from .jobs.assemble import make_camera, make_environment, make_playback, make_scene, make_settings

    settings = make_settings(options)
    start = time.perf_counter()
    scene = make_scene(model, make_environment(options), options)
    _warn(model, scene, settings, options)
    tell = say if options["verbose"] else None
    if tell:
        tell(f"{model}: load {time.perf_counter() - start:.3f} s")
    asked = any(options[name] is not None for name in ("orbit", "eye", "camera", "fov", "target"))
    camera = make_camera(model, scene, options) if asked else None
    open_window(scene, settings, camera, options["size"], use_cache=not options["no_cache"], tell=tell,
                playback=make_playback(model, scene, options))


@cli.command(short_help="Render pictures of models, without a screen.")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="OUT",
              help="The picture: .png .jpg .webp (as displayed), .exr (linear light). A film of what moves: .mp4 .webp "
                   ".gif .apng. For several models: a folder, which ends in / and is made if it is missing, or a "
                   "pattern such as out/{name}.png.")
@BACKEND_OPTION
@click.option("--stats", metavar="FILE.json",
              help="Write times, plan and memory as JSON; for several models a list of them.")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *FILM_OPTIONS, *PATH_OPTIONS, *ERROR_OPTIONS, AOV_OPTION,
               *CAMERA_OPTIONS, *COMMON_OPTIONS])
def render(models: tuple[str, ...], output: str, backend: str, stats: str | None, **options: Any) -> None:
    """Render a picture of each MODEL, without a screen.

    MODEL is a glTF file (.gltf, .glb), an OBJ, PLY, STL, OFF or XYZ, a volume (.vdb, .npz, .vol), or curves (.hair,
    .bcc, .curves). 3MF and COLLADA (.dae) need `pip install 'pbr-viewer[formats]'`. If one of several models cannot be
    rendered, it is reported on stderr, the others are still rendered, and the exit status is not 0.

    \b
    pbr-viewer render helmet.glb -o helmet.png
    pbr-viewer render *.glb -o thumbnails/ --size 256 --background none
    pbr-viewer render car.obj -o car.exr --env studio.hdr --orbit -30,15
    pbr-viewer render room.glb -o room.png --mode path --spp 256 --denoise fast
    pbr-viewer render fox.glb -o fox.png --animation Run --time 0.4
    pbr-viewer render fox.glb -o fox.mp4 --animation Run --fps 30
    pbr-viewer render helmet.glb -o helmet.webp --turntable 90
    """
    check_camera_options(options)
    from .base.atomic import made_folders
    from .jobs.assemble import make_camera, make_environment, make_scene, make_settings
    from .jobs.film import check_film_options, make_film
    from .jobs.render_job import RenderJob, check_layers, check_output, output_paths
    from .jobs.tell_error import check_tell_error, map_paths

    settings = make_settings(options)
    chooses = _leaves_mode_open(settings)
    if not chooses:
        settings.check_used()
    paths, folders = output_paths(models, output)
    check_layers(options["aov"], settings, paths, chooses)
    check_film_options(paths, options, chooses)
    check_tell_error(settings, options, paths, chooses)
    maps, map_folders = map_paths(models, options["error_map"])

    def load(model: str) -> Any:
        scene = make_scene(model, environment, options)
        _warn(model, scene, settings, options)
        return scene

    job = RenderJob(backend, settings, options["size"], options["aov"], use_cache=not options["no_cache"],
                    measure=stats is not None, quiet=options["quiet"], verbose=options["verbose"], chooses=chooses,
                    tell_error=options["tell_error"], error_maps=dict(zip(paths, maps)))
    with made_folders(*folders, *map_folders):
        for path in (*paths, *maps):
            check_output(path)
        if stats is not None:
            check_output(stats)
        environment = make_environment(options)
        if environment is not None and len(models) > 1:
            environment.radiance  # noqa: B018  decode it here, so that an error is reported once, not for every model
        status = job.run(list(zip(models, paths, strict=True)), load,
                         lambda model, scene: make_camera(model, scene, options), stats,
                         lambda model, path, scene: make_film(model, path, scene, options))
    sys.exit(status)


@cli.command(short_help="Show what is in a model and how it will be rendered.")
@click.argument("model", required=False)
@JSON_OPTION
@click.option("--settings", "list_settings", is_flag=True, help="List what --set takes.")
@with_options([*SCENE_OPTIONS, QUIET_OPTION])
def info(model: str | None, json_file: str | None, list_settings: bool, **options: Any) -> None:
    """Show what MODEL contains, what is needed to render it, and what is left out and why.

    Without MODEL: show the supported formats and the folder of the cache. No OpenGL is needed.
    """
    from .jobs.info import describe_package, describe_scene, format_settings, settings_table

    if list_settings:
        if json_file:
            _write_json(json_file, settings_table())
        else:
            _print(format_settings())
        return
    if model is None:
        facts = describe_package()
    else:
        from .jobs.assemble import make_environment, make_scene, make_settings

        settings = make_settings(options)
        scene = make_scene(model, make_environment(options), options)
        facts = describe_scene(scene, settings)
        _warn(model, scene, settings, options)  # of images that do not decode, too
    _report(facts, json_file)


@cli.command(short_help="Check the shaders: energy conservation and float32 precision.")
@click.argument("what", type=click.Choice(["energy", "stability", "all"]), default="all")
@click.argument("model", required=False)
@click.option("--shader", metavar="FILE", help="Check a lobe of your own GLSL file.")
@click.option("--lobe", metavar="NAME",
              help="The lobe's name: the file defines NAME_eval, and may define NAME_sample and NAME_pdf.")
@JSON_OPTION
@click.option("-o", "--output", metavar="DIR", help="Write index.html, with plots, and check.json.")
@click.option("--set", "assignments", multiple=True, metavar="NAME=VALUE", help="A setting to shade the MODEL with.")
@QUIET_OPTION
def check(what: str, model: str | None, shader: str | None, lobe: str | None, json_file: str | None,
          output: str | None, assignments: tuple[str, ...], quiet: bool) -> None:
    """Check that no shader creates or loses light, and that float32 computes the formulas precisely enough.

    With MODEL: check the energy of each of its materials. The exit status is 1 if a bound is exceeded. Shading models
    that are known to fail are reported, and do not change the exit status.

    \b
    pbr-viewer check -o report/
    pbr-viewer check energy helmet.glb
    pbr-viewer check energy --shader mine.glsl --lobe velvet
    """
    if (shader is None) != (lobe is None):
        raise UsageError("--shader and --lobe must be used together")
    if model and shader:
        raise UsageError("check either a MODEL or a --shader")
    if what != "energy" and (model or shader):
        raise UsageError("for a MODEL or a --shader there is only `check energy`")
    from .base.atomic import made_folders
    from .measure.check.checks import exit_status
    from .measure.check.run import run_checks, run_model_checks, run_shader_checks
    from .measure.check.table import print_table

    with made_folders(*([Path(output)] if output else [])):  # so that an error is reported before the checks run
        if shader and lobe:
            checks = run_shader_checks(shader, lobe, quiet)
        elif model:
            from .scene.load import load_scene
            from .settings import Settings

            settings = Settings()
            for assignment in assignments:
                settings = settings.with_option(assignment)
            checks = run_model_checks(load_scene(model), settings, quiet)
        else:
            checks = run_checks(what, quiet)
        if output:
            from .measure.check.page import write_page

            write_page(output, checks, with_plots=not (model or shader))
    if json_file:
        _write_json(json_file, [check.to_json() for check in checks])
    if json_file != "-":
        print_table(checks)
    if output and not quiet:
        say(f"the page: {Path(output) / 'index.html'}")
    sys.exit(exit_status(checks))


@cli.command(short_help="Measure error against time, by every method there is.")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="DIR",
              help="Folder for index.html, report.json, the charts and all measurements; made if it is missing.")
@click.option("--within", "limit", type=Number(0.1, 1e6), default=150.0, show_default=True, metavar="SECONDS",
              help="How long to measure each model; more time gives more points and a better reference. The first "
                   "point of each method is measured in any case; loading, comparing and writing come on top.")
@with_options([size_option("256x256"), *MODEL_OPTIONS, *LOOK_OPTIONS, *CAMERA_OPTIONS, BACKEND_OPTION, NO_CACHE_OPTION,
               QUIET_OPTION])
def report(models: tuple[str, ...], output: str, limit: float, backend: str, **options: Any) -> None:
    """Render each MODEL by every method, from the cheapest to path tracing, and report the time and error of each.

    The errors are against a path-traced reference, whose own noise is reported too. DIR/index.html is a self-contained
    page. If there are several models, each gets a folder in DIR, and DIR/index.html links to them. After an
    interruption the same command continues.

    \b
    pbr-viewer report helmet.glb -o report/
    pbr-viewer report *.glb -o reports/ --env studio.hdr --within 60
    """
    check_camera_options(options)
    from .jobs.assemble import make_camera, make_environment, make_scene, make_settings
    from .measure.report.job import ReportJob

    settings = make_settings(options)
    environment = make_environment(options)

    def load(model: str) -> Any:
        scene = make_scene(model, environment, options)
        _warn(model, scene, settings, options)
        return scene

    job = ReportJob(Path(output), options, settings, limit, backend, options["quiet"])
    sys.exit(job.run(models, load, lambda model, scene: make_camera(model, scene, options)))


@cli.command(short_help="Compare two pictures.")
@click.argument("a")
@click.argument("b")
@JSON_OPTION
@click.option("-o", "--output", metavar="DIFF.png", help="Write the FLIP map, black where the pictures agree.")
def diff(a: str, b: str, json_file: str | None, output: str | None) -> None:
    """Compare picture B with the reference A by FLIP (the perceived difference), RMS error and maximum error.

    Two .exr or .hdr files are compared as linear light, others as displayed. The exit status does not depend on the
    result.
    """
    from .measure.compare.difference import compare_files

    result = compare_files(a, b)
    if output:
        result.save_map(output)
    _report(result.to_json() if json_file else result.to_text(), json_file)


@cli.command(short_help="Show which OpenGL contexts work here.")
@JSON_OPTION
def doctor(json_file: str | None) -> None:
    """Show which OpenGL contexts work here, and how to fix those that do not. Exit status 3: none works."""
    from .jobs.doctor import calibration_line, diagnose, exit_status, format_findings

    findings = diagnose()
    if json_file:
        _write_json(json_file, [finding.to_json() for finding in findings])
    else:
        _print("\n".join(filter(None, [format_findings(findings), calibration_line(findings)])))
    sys.exit(exit_status(findings))


@cli.command(short_help="Show or clear the cache on disk.")
@click.option("--clear", is_flag=True, help="Delete all entries of the cache.")
def cache(clear: bool) -> None:
    """Show the folder and size of the cache, which holds prepared environments and measurements of this device.

    The environment variable PBR_VIEWER_CACHE names another folder, or is `off`.
    """
    from .bake.cache import cache_folder, cache_size, clear_cache

    folder = cache_folder()
    if folder is None:
        _print("the cache is switched off")
    elif clear:
        _print(f"{folder}: {clear_cache() / 1e6:.1f} MB freed")
    else:
        _print(f"{folder}: {cache_size() / 1e6:.1f} MB")


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


def _leaves_mode_open(settings: Any) -> bool:
    """Whether the method shall be chosen: there is a time budget or an error, and no --mode.

    Raises UsageError if no method supports all settings.
    """
    source = click.get_current_context().get_parameter_source("mode")
    if source is not click.core.ParameterSource.DEFAULT or (settings.time_budget is None and settings.error is None):
        return False
    settings.check_open()
    return True


def _warn(model: str, scene: Any, settings: Any, options: dict[str, Any]) -> None:
    if options["quiet"]:
        return
    from .plan.unused import unused_settings
    from .plan.warnings import picture_warnings
    from .settings import with_dashes

    about_settings = [*picture_warnings(scene, settings), *unused_settings(scene, settings)]
    for warning in [*scene.all_warnings, *map(with_dashes, about_settings)]:
        say(f"{model}: warning: {warning}")


def _report(facts: dict[str, object], json_file: str | None) -> None:
    """Write `facts` to the JSON file, or print them."""
    if json_file:
        _write_json(json_file, facts)
        return
    from .jobs.info import format_facts

    _print(format_facts(facts))


def _write_json(path: str, content: object) -> None:
    from .base.atomic import write_json

    if path == "-":
        import json

        _print(json.dumps(content, indent=1, allow_nan=False))
    else:
        write_json(path, content)


def _print(text: str) -> None:
    click.echo("\n".join(map(_escaped, text.split("\n"))))


def _escaped(line: str) -> str:
    indent = len(line) - len(line.lstrip(" "))
    return line if line.isprintable() else " " * indent + one_line(line)
