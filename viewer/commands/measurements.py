"""The commands that measure: check, report, diff."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ..base.messages import say
from ..errors import UsageError
from ..jobs.camera_options import CAMERA_OPTIONS, check_camera_options
from ..jobs.options import (
    BACKEND_OPTION,
    JSON_OPTION,
    LOOK_OPTIONS,
    MODEL_OPTIONS,
    NO_CACHE_OPTION,
    QUIET_OPTION,
    Number,
    size_option,
    with_options,
)
from .output import print_facts, warn, write_or_print_json


@click.command()
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
    from ..base.atomic import made_folders
    from ..measure.check.checks import exit_status
    from ..measure.check.run import run_checks, run_model_checks, run_shader_checks
    from ..measure.check.table import print_table

    with made_folders(*([Path(output)] if output else [])):  # so that an error is reported before the checks run
        if shader and lobe:
            checks = run_shader_checks(shader, lobe, quiet)
        elif model:
            from ..scene.load import load_scene
            from ..settings import Settings

            settings = Settings()
            for assignment in assignments:
                settings = settings.with_option(assignment)
            checks = run_model_checks(load_scene(model), settings, quiet)
        else:
            checks = run_checks(what, quiet)
        if output:
            from ..measure.check.page import write_page

            write_page(output, checks, with_plots=not (model or shader))
    if json_file:
        write_or_print_json(json_file, [check.to_json() for check in checks])
    if json_file != "-":
        print_table(checks)
    if output and not quiet:
        say(f"the page: {Path(output) / 'index.html'}")
    sys.exit(exit_status(checks))


@click.command()
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
    from ..jobs.assemble import make_camera, make_environment, make_scene, make_settings
    from ..measure.report.job import ReportJob

    settings = make_settings(options)
    settings.check_told("a report")
    environment = make_environment(options)

    def load(model: str) -> Any:
        scene = make_scene(model, environment, options)
        warn(model, scene, settings, options)
        return scene

    job = ReportJob(Path(output), options, settings, limit, backend, options["quiet"])
    sys.exit(job.run(models, load, lambda model, scene: make_camera(model, scene, options)))


@click.command()
@click.argument("a")
@click.argument("b")
@JSON_OPTION
@click.option("-o", "--output", metavar="DIFF.png", help="Write the FLIP map, black where the pictures agree.")
def diff(a: str, b: str, json_file: str | None, output: str | None) -> None:
    """Compare picture B with the reference A by FLIP (the perceived difference), RMS error and maximum error.

    Two .exr or .hdr files are compared as linear light, others as displayed. The exit status does not depend on the
    result.
    """
    from ..measure.compare.difference import compare_files

    result = compare_files(a, b)
    if output:
        result.save_map(output)
    print_facts(result.to_json() if json_file else result.to_text(), json_file)
