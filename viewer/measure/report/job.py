"""`pbr-viewer report`: models measured one after the other, with one OpenGL context."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...base.atomic import made_folders
from ...base.messages import say, say_error
from ...base.progress import Progress
from ...base.signals import Stopped
from ...errors import ContextError, OutputError, UsageError, ViewerError
from ...gpu.context import Context, open_context
from ...scene.camera import Camera
from ...scene.scene import Scene
from ...settings import Settings
from .bench import Bench
from .command import command_line
from .document import Document, make_findings
from .page import write_report
from .store import Store
from .summary import write_summary
from .survey import Survey, Surveyor


@dataclass
class ReportJob:
    """`options` are those of the command line; `limit` is the time for each model."""

    folder: Path
    options: dict[str, Any]
    settings: Settings
    limit: float
    backend: str = "auto"
    quiet: bool = False

    def run(self, models: Sequence[str], load: Callable[[str], Scene], camera: Callable[[str, Scene], Camera]) -> int:
        """Measure each model and write its report: into `folder`, or each into one of its own below it where there are
        several. The exit status: 0, or 1 if some model could not be rendered, which is reported on stderr.

        Raises ContextError, OutputError and UsageError, which concern all models, and Stopped when the user interrupts:
        what was measured by then is kept and goes into the report.
        """
        if isinstance(self.settings.background, tuple):
            self.settings = replace(self.settings, background="none")
        folders = report_folders(models, self.folder)
        status = 0
        reports: dict[Path, Document] = {}
        with (made_folders(self.folder), open_context(self.backend) as context,
              Progress(len(models), enabled=not self.quiet) as progress):
            for model, folder in zip(models, folders):
                try:
                    reports[folder] = self._one(context, model, folder, load, camera, progress)
                except (ContextError, OutputError, UsageError):
                    raise
                except (ViewerError, MemoryError) as error:
                    say_error(f"{model}: out of memory" if isinstance(error, MemoryError) else error)
                    status = 1
            if len(folders) > 1 and reports:
                write_summary(self.folder, reports)
        if reports and not self.quiet:
            say(f"the report: {self.folder / 'index.html'}")
        return status

    def _one(self, context: Context, model: str, folder: Path, load: Callable[[str], Scene],
             camera: Callable[[str, Scene], Camera], progress: Progress) -> Document:
        """Measure a model and write its report, which is returned."""
        name = Path(model).name
        progress.step(f"{name}: loading")
        scene = load(model)
        use_cache = not self.options["no_cache"]
        bench = Bench(context, scene, camera(model, scene), self.settings, self.options["size"], use_cache,
                      self.limit)
        with made_folders(folder, folder / "measured"):
            surveyor = Surveyor(bench, Store(folder / "measured"), name, progress, use_cache)
            survey = surveyor.survey
            try:
                surveyor.run()
                progress.say(f"{name}: comparing and writing")
                return self._write(survey, model, folder)
            except Stopped:
                count = len(survey.measured)
                say(f"{folder}: {count} points are measured and kept; the same command continues from there")
                if survey.reference is not None and survey.measured:
                    self._write(survey, model, folder)
                raise
            finally:
                bench.release()

    def _write(self, survey: Survey, model: str, folder: Path) -> Document:
        scene = survey.bench.scene
        facts = {"triangles": scene.triangle_count, "lights": len(scene.lights),
                 "environment": scene.environment.name if scene.environment is not None else None}
        findings = make_findings(survey, Path(model).name,
                                 lambda method: command_line(model, self.options, method), facts)
        write_report(folder, findings)
        return findings.document


def report_folders(models: Sequence[str], folder: Path) -> list[Path]:
    """`folder` itself for one model; for several, one in it for each, named after the model, and numbered if needed."""
    if len(models) == 1:
        return [folder]
    names: list[str] = []
    for number, model in enumerate(models, 1):
        name = Path(model).stem or "model"
        while name in names:
            name = f"{name}-{number}"
        names.append(name)
    return [folder / name for name in names]
