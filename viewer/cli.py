"""The command line: pbr-viewer view, render, info, diff, doctor, cache.

Exit status: 0 done; 1 the input is bad; 2 wrong usage; 3 no OpenGL context. Errors are one line on stderr.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from importlib.metadata import version

import click

from .errors import ViewerError
from .options import BackgroundColor, Numbers, Size, make_camera, make_light
from .settings import Settings

_SCENE_OPTIONS = [
    click.option("--mode", type=click.Choice(["pbr", "phong"]), default="pbr", help="Shading model."),
    click.option("--env", default="studio", metavar="FILE|NAME|none", show_default=True,
                 help="Environment: an HDR or EXR file, or studio, sky, furnace, none."),
    click.option("--env-rotation", type=float, default=0.0, metavar="DEG", help="Turn the environment about +Y."),
    click.option("--env-intensity", type=click.FloatRange(0), default=1.0, metavar="X", help="Multiply its light."),
    click.option("--background", type=BackgroundColor(), default="env", help="What stands behind the model."),
    click.option("--exposure", type=click.FloatRange(-64, 64), default=0.0, metavar="EV",
                 help="Exposure in stops before the tone map."),
    click.option("--tonemap", type=click.Choice(["neutral", "agx", "aces", "none"]), default="neutral"),
    click.option("--light", "lights", type=Numbers("AZ,EL,LUX", 3), multiple=True,
                 help="A directional light from azimuth and elevation; repeatable."),
    click.option("--set", "assignments", multiple=True, metavar="NAME=VALUE",
                 help="Another setting; `info --settings` lists them; repeatable."),
]
_CAMERA_OPTIONS = [
    click.option("--orbit", type=Numbers("AZ,EL[,DIST]", 2, 3), help="Camera on a sphere about the model, in degrees."),
    click.option("--eye", type=Numbers("X,Y,Z", 3), help="Camera position."),
    click.option("--target", type=Numbers("X,Y,Z", 3), help="What the camera looks at; the model's middle by default."),
    click.option("--fov", type=click.FloatRange(0.01, 179), metavar="DEG", help="Vertical field of view, 45 by default."),
    click.option("--camera", type=int, metavar="N", help="The file's own camera, counted from 0."),
]
_COMMON_OPTIONS = [
    click.option("--size", type=Size(), default="1280x720", show_default=True, help="Of the picture, in pixels."),
    click.option("--no-cache", is_flag=True, help="Neither read nor write the cache of prepared environments."),
    click.option("-q", "--quiet", is_flag=True, help="No warnings and no progress."),
    click.option("-v", "--verbose", is_flag=True, help="Say what is done."),
]


def _with(options):
    def decorate(command):
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(version("pbr-viewer"), prog_name="pbr-viewer")
def cli() -> None:
    """Show 3D models physically based: in a window, as pictures, as numbers."""


@cli.command()
@click.argument("model")
@_with(_SCENE_OPTIONS + _CAMERA_OPTIONS + _COMMON_OPTIONS)
def view(model: str, **options) -> None:
    """Open MODEL in a window with an orbit camera."""
    from .app.window import run

    settings = _settings(options)
    scene = _load(model, options)
    camera = None
    if any(options[name] is not None for name in ("orbit", "eye", "camera", "fov", "target")):
        camera = _camera(scene, options)
    run(scene, settings, camera=camera, size=options["size"], use_cache=not options["no_cache"])


@cli.command()
@click.argument("models", metavar="MODEL...", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="OUT",
              help="Picture (.png .exr .jpg .webp); for several models a folder, or a pattern with {name}.")
@click.option("--backend", type=click.Choice(["auto", "egl", "osmesa", "window"]), default="auto", show_default=True)
@click.option("--stats", metavar="FILE.json", help="Write times, plan and memory.")
@_with(_SCENE_OPTIONS + _CAMERA_OPTIONS + _COMMON_OPTIONS)
def render(models: tuple[str, ...], output: str, backend: str, stats: str | None, **options) -> None:
    """Make a picture of each MODEL, without a screen."""
    from .render_job import RenderJob, output_paths

    job = RenderJob(backend, _settings(options), options["size"], use_cache=not options["no_cache"],
                    measure=stats is not None, quiet=options["quiet"], verbose=options["verbose"])
    job.run(
        [(model, path) for model, path in zip(models, output_paths(models, output), strict=True)],
        load=lambda model: _load(model, options),
        camera=lambda scene: _camera(scene, options),
        stats=stats,
    )


@cli.command()
@click.argument("model", required=False)
@click.option("--json", "json_file", metavar="FILE", help="Write it as JSON ('-' for standard output).")
@click.option("--settings", "list_settings", is_flag=True, help="List what --set takes.")
@_with(_SCENE_OPTIONS)
@click.option("-q", "--quiet", is_flag=True, help="No warnings.")
def info(model: str | None, json_file: str | None, list_settings: bool, **options) -> None:
    """Tell what is in MODEL, what will be done to show it, and what is left out and why."""
    from .info import describe_package, describe_scene, format_facts, settings_table

    if list_settings:
        facts: dict[str, object] = {"settings": settings_table()}
    elif model is None:
        facts = describe_package()
    else:
        facts = describe_scene(_load(model, options), _settings(options))
    if json_file:
        _write_json(json_file, facts)
    else:
        click.echo(format_facts(facts))


@cli.command()
@click.argument("a")
@click.argument("b")
@click.option("--json", "json_file", metavar="FILE", help="Write the numbers as JSON ('-' for standard output).")
@click.option("-o", "--output", metavar="DIFF.png", help="Write the FLIP error map.")
def diff(a: str, b: str, json_file: str | None, output: str | None) -> None:
    """Compare two pictures: FLIP, root mean square error, maximum."""
    from .info import format_facts
    from .measure.difference import compare_files

    result = compare_files(a, b)
    if output:
        result.save_map(output)
    if json_file:
        _write_json(json_file, result.to_json())
    else:
        click.echo(format_facts(result.to_json()))


@cli.command()
@click.option("--json", "json_file", metavar="FILE", help="Write it as JSON ('-' for standard output).")
def doctor(json_file: str | None) -> None:
    """Tell which OpenGL contexts work here, and what to do about those that don't."""
    from .doctor import diagnose, exit_status, format_findings

    findings = diagnose()
    if json_file:
        _write_json(json_file, [finding.to_json() for finding in findings])
    else:
        click.echo(format_findings(findings))
    sys.exit(exit_status(findings))


@cli.command()
@click.option("--clear", is_flag=True, help="Empty it.")
def cache(clear: bool) -> None:
    """Tell where prepared environments are kept and how much they take."""
    from .bake.cache import cache_folder, cache_size, clear_cache

    folder = cache_folder()
    if folder is None:
        click.echo("the cache is switched off")
    elif clear:
        click.echo(f"{folder}: {clear_cache() / 1e6:.1f} MB freed")
    else:
        click.echo(f"{folder}: {cache_size() / 1e6:.1f} MB")


def main() -> None:
    """Run the command line; never a traceback for what a user did."""
    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Abort:
        _fail("interrupted", 130)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except ViewerError as error:
        _fail(str(error), error.exit_status)
    except MemoryError:
        _fail("out of memory", 1)
    except BrokenPipeError:
        sys.exit(1)
    except OSError as error:
        _fail(str(error), 1)


def _fail(text: str, status: int) -> None:
    click.echo(f"pbr-viewer: {text}", err=True)
    sys.exit(status)


def _settings(options) -> Settings:
    settings = Settings(mode=options["mode"], background=options["background"], exposure=options["exposure"],
                        tonemap=options["tonemap"])
    for assignment in options["assignments"]:
        settings = settings.with_option(assignment)
    return settings


def _load(model: str, options):
    """The scene under the environment and the extra lights the options ask for; warnings go to stderr."""
    from .scene.environment_files import load_environment
    from .scene.load import load_scene

    scene = load_scene(model)
    environment = load_environment(options["env"])
    if environment is not None:
        environment = replace(environment, rotation=math.radians(options["env_rotation"]),
                              intensity=options["env_intensity"])
    lights = (*scene.lights, *map(make_light, options["lights"]))
    scene = replace(scene, environment=environment, lights=lights)
    if not options["quiet"]:
        for warning in scene.warnings:
            click.echo(f"{model}: {warning}", err=True)
    return scene


def _camera(scene, options):
    return make_camera(scene, options["size"], orbit=options["orbit"], eye=options["eye"], target=options["target"],
                       fov=options["fov"], number=options["camera"])


def _write_json(path: str, content: object) -> None:
    from .atomic import atomic_write

    text = json.dumps(content, indent=1) + "\n"
    if path == "-":
        click.echo(text, nl=False)
        return
    with atomic_write(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
