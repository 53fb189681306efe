"""The commands that show models: view, render, info."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

import click

from ..base.messages import say, say_error
from ..batch.options import BATCH, BATCH_OPTIONS, check_batch_options
from ..errors import InputError
from ..jobs.camera_options import CAMERA_OPTIONS, VIEWS_OPTIONS, check_camera_options, chooses_camera
from ..jobs.options import (
    AOV_OPTION,
    BACKEND_OPTION,
    COMMON_OPTIONS,
    ERROR_OPTIONS,
    FILM_OPTIONS,
    GROUND_OPTION,
    JSON_OPTION,
    PATH_OPTIONS,
    QUIET_OPTION,
    SCENE_OPTIONS,
    TIME_OPTIONS,
    is_given,
    size_option,
    with_options,
)
from .output import print_facts, print_text, warn, write_or_print_json


@click.command(context_settings={"default_map": {"denoise": "fast"}})
@click.argument("model")
@click.option("--watch", is_flag=True, help="Load the model again when its file changes, or a file that it refers to.")
@click.option("--fullscreen", is_flag=True, help="Begin on the whole screen; F11 leaves it.")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *PATH_OPTIONS, *CAMERA_OPTIONS, *COMMON_OPTIONS])
def view(model: str, watch: bool, fullscreen: bool, **options: Any) -> None:
    """Open MODEL in a window. Drag to orbit, scroll to move closer, press F1 for a list of all keys.

    `pbr-viewer MODEL` does the same. Of a folder the first model that can be read is opened; Page Down and Page Up show
    the others.

    With --animation it plays, unless a --time is given, at which it stands still.

    MODEL is a glTF file (.gltf, .glb), an OBJ, PLY, STL, OFF or XYZ, a volume (.vdb, .npz, .vol), or curves (.hair,
    .bcc, .curves). Other formats need an extra of the package: 3MF and COLLADA (.dae)
    `pip install 'pbr-viewer[formats]'`, USD `[usd]`, STEP `[cad]`.
    """
    check_camera_options(options)
    from ..app import open_window
    from ..interact.model_files import ModelFiles
    from ..interact.window_settings import window_settings
    from ..jobs.assemble import (
        load_model,
        make_camera,
        make_environment,
        make_playback,
        make_quality,
        make_scene,
        make_settings,
    )
    from ..jobs.inputs import find_models
    from ..scene.files import noting_files

    settings = window_settings(make_settings(options), is_given)
    start = time.perf_counter()
    folder = model if Path(model).is_dir() else None
    environment = make_environment(options)
    failed: list[InputError] = []
    for first in find_models([model]) if folder is not None else [model]:
        try:
            with noting_files() as read:
                scene = make_scene(first, environment, options)
            break
        except InputError as error:
            failed.append(error)
    else:
        raise failed[0]
    for unread in failed:
        say_error(unread)
    others = {name: options[name] for name in ("up", "material")}  # the other options are about MODEL
    own = [] if options["scene"] is None else ["--scene", options["scene"]]
    own += [word for file in options["with_files"] for word in ("--with", file)]
    common = ["--up", options["up"]] if options["up"] != "y" else []
    common += [] if options["material"] is None else ["--material", options["material"]]
    files = ModelFiles(first, folder, lambda path: load_model(path, options if path == first else others), read,
                       lambda path: [*common, *own] if path == first else common)
    model = first
    warn(model, scene, settings, options)
    tell = say if options["verbose"] else None
    if tell:
        tell(f"{model}: load {time.perf_counter() - start:.3f} s")
    camera = make_camera(model, scene, options) if chooses_camera(options) else None
    quality = make_quality(options, replace(settings, mode="pbr"), scene, options["size"])  # for the keys of the mode
    open_window(scene, settings, camera, options["size"], use_cache=not options["no_cache"], tell=tell,
                playback=make_playback(model, scene, options), quality=quality, files=files, watch=watch,
                full_screen=fullscreen)


class _Render(click.Command):
    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """What is behind `--tell-error=` may be left out. So click takes a negative number there for an option."""
        for option in self.params:
            given = [arg.partition("=")[2] for arg in args if arg.startswith("--tell-error=-")]
            if option.name == "tell_error" and given:
                option.type.convert(given[0], option, ctx)
        return super().parse_args(ctx, args)


@click.command(cls=_Render)
@click.argument("models", metavar="MODEL...", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="OUT",
              help="The picture: .png .jpg .webp (as displayed), .exr or .npz (linear light, and the layers of --aov). "
                   "A film of what moves: .mp4 .webp .gif .apng. For several models: a folder, which ends in /, or a "
                   "pattern such as out/{name}.png. Folders that are missing are made.")
@BACKEND_OPTION
@click.option("--stats", metavar="FILE.json",
              help="Write times, plan and memory as JSON; for several models a list of them.")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *FILM_OPTIONS, *PATH_OPTIONS, *ERROR_OPTIONS, AOV_OPTION, GROUND_OPTION,
               *CAMERA_OPTIONS, *VIEWS_OPTIONS, *BATCH_OPTIONS, *COMMON_OPTIONS])
def render(models: tuple[str, ...], output: str, backend: str, stats: str | None, **options: Any) -> None:
    """Render a picture of each MODEL, without a screen.

    MODEL is a glTF file (.gltf, .glb), an OBJ, PLY, STL, OFF or XYZ, a volume (.vdb, .npz, .vol), or curves (.hair,
    .bcc, .curves). Other formats need an extra of the package: 3MF and COLLADA (.dae)
    `pip install 'pbr-viewer[formats]'`, USD `[usd]`, STEP `[cad]`. It is also a folder, for all models
    in it and in its folders, a pattern in quotes ('**/*.glb'), or - for a list on standard input, one a line. Models of
    the same name keep their folders' names. If one of several models cannot be rendered, it is reported on stderr, the
    others are still rendered, and the exit status is not 0.

    \b
    pbr-viewer render helmet.glb -o helmet.png
    pbr-viewer render *.glb -o thumbnails/ --size 256 --background none
    pbr-viewer render models/ -o thumbnails/ --size 256
    pbr-viewer render car.obj -o car.exr --env studio.hdr --orbit -30,15
    pbr-viewer render room.glb -o room.png --mode path --spp 256 --denoise fast
    pbr-viewer render fox.glb -o fox.npz --aov depth,normal,instance
    pbr-viewer render fox.glb -o fox.png --animation Run --time 0.4
    pbr-viewer render fox.glb -o fox.mp4 --animation Run --fps 30
    pbr-viewer render helmet.glb -o helmet.webp --turntable 90
    """
    chosen = {name: options.pop(name) for name in BATCH}
    check_batch_options(chosen)
    check_camera_options(options, takes_several=True)
    options |= {"backend": backend, "has_size": is_given("size") or options["sheet"] is not None}
    from ..base.atomic import made_folders
    from ..batch.films import is_film_in_parts, render_film_in_parts
    from ..batch.run import Batch, render_all
    from ..batch.samples import is_in_parts, render_in_parts
    from ..jobs.assemble import make_settings
    from ..jobs.camera_output import camera_files, warn_of_cameras
    from ..jobs.film import check_film_options
    from ..jobs.inputs import find_models
    from ..jobs.outputs import base_folder, check_apart, check_layers, check_output, output_paths
    from ..jobs.render_job import RenderJob, RenderTask
    from ..jobs.tell_error import check_tell_error, map_paths
    from ..quality import check_quality

    settings = make_settings(options)
    chooses = _leaves_mode_open(settings)
    check_quality(options["quality"], settings, chooses)
    if not chooses:
        settings.check_used()
    settings.check_ground()
    found = find_models(models)
    if options["sheet"] is not None:
        from ..batch.contact import render_contact_sheet
        from ..jobs.sheets import CELL, check_sheet, check_sheet_paths, is_contact_sheet

        if not is_given("size"):
            options["size"] = CELL
        check_sheet(found, output, options, stats)
        if is_contact_sheet(found, output, options):
            columns, _ = options["sheet"]
            job = RenderJob(options | {"sheet": None}, chooses)
            with made_folders(Path(output).parent):
                check_output(output)
                sys.exit(render_contact_sheet(found, Path(output), columns, job, Batch(**chosen)))
    outputs = output_paths(found, output)
    if options["sheet"] is not None:
        check_sheet_paths(outputs.paths, options)
    check_layers(options["aov"], settings, outputs.paths, chooses)
    check_film_options(outputs.paths, options, chooses)
    check_tell_error(settings, options, outputs.paths, chooses)
    maps = map_paths(found, options["error_map"])
    cameras = camera_files(found, options["write_cameras"], outputs.paths, options)
    files = [*dict.fromkeys(cameras.values()), *([Path(stats)] if stats is not None else [])]
    check_apart([*outputs.paths, *maps.paths, *files])
    tasks = [RenderTask(*each) for each in zip_longest(found, outputs.paths, maps.paths)]
    folders = dict.fromkeys(file.parent for file in cameras.values())
    with made_folders(*outputs.folders, *maps.folders, *folders):
        for path in (*outputs.paths, *maps.paths, *files):
            check_output(path)
        warn_of_cameras(options)
        keeps = len(tasks) > 1 or chosen["resume"]
        job = RenderJob(options, chooses, stats is not None)
        batch = Batch(stats, base_folder(output) if keeps else None, **chosen, cameras=cameras)
        if is_in_parts(tasks, job, batch):
            status = render_in_parts(tasks[0], job, batch)
        elif is_film_in_parts(tasks, job, batch):
            status = render_film_in_parts(tasks[0], job, batch)
        else:
            status = render_all(tasks, job, batch)
    sys.exit(status)


@click.command()
@click.argument("model", required=False)
@JSON_OPTION
@click.option("--settings", "list_settings", is_flag=True, help="List what --set takes.")
@with_options([*SCENE_OPTIONS, size_option("1280x720"), QUIET_OPTION])
def info(model: str | None, json_file: str | None, list_settings: bool, **options: Any) -> None:
    """Show what MODEL contains, what is needed to render it, and what is left out and why.

    Without MODEL: show the supported formats and the folder of the cache. No OpenGL is needed.
    """
    from ..jobs.info import describe_package, describe_scene, format_settings, settings_table

    if list_settings:
        if json_file:
            write_or_print_json(json_file, settings_table())
        else:
            print_text(format_settings())
        return
    if model is None:
        facts = describe_package()
    else:
        from ..jobs.assemble import make_environment, make_quality, make_scene, make_settings
        from ..quality import check_quality

        settings = make_settings(options)
        check_quality(options["quality"], settings, chooses=False)
        scene = make_scene(model, make_environment(options), options)
        facts = describe_scene(scene, settings, make_quality(options, settings, scene, options["size"]))
        warn(model, scene, settings, options)  # of images that do not decode, too
    print_facts(facts, json_file)


def _leaves_mode_open(settings: Any) -> bool:
    """Whether the method shall be chosen: there is a time budget or an error, and no --mode.

    Raises UsageError if no method supports all settings.
    """
    if is_given("mode") or (settings.time_budget is None and settings.error is None):
        return False
    settings.check_open()
    return True
