"""Many models by one process: the next one is loaded while one is drawn, and nothing of them is kept."""

from __future__ import annotations

import ctypes
import gc
import weakref
from concurrent.futures import Future
from pathlib import Path

from command_line import SCENES, runner
from contexts import open_or_skip

from viewer.base.progress import Progress
from viewer.batch.engines import Here
from viewer.batch.run import Attempt, Batch, Run
from viewer.batch.work import Done
from viewer.gpu.context import Context
from viewer.jobs.model_renderer import ModelRenderer
from viewer.jobs.render_job import RenderJob, RenderTask
from viewer.scene.scene import Scene

MODELS = "textures", "alpha", "textures", "broken", "alpha", "textures", "alpha"
KINDS = "Buffer", "Framebuffer", "Program", "Renderbuffer", "Sampler", "Texture", "VertexArray"
MOST_NAMES = 2000


class Listed(Here):
    """Notes what it is asked for instead of doing it."""

    def __init__(self, events: list[str]) -> None:
        self._events = events

    def expect(self, task: RenderTask) -> None:
        self._events.append(f"expect {task.model}")

    def submit(self, task: RenderTask) -> Future[Done]:
        self._events.append(f"submit {task.model}")
        future: Future[Done] = Future()
        future.set_result(Done(({"model": task.model},), ""))
        return future


def test_the_key_of_a_model_is_older_than_what_is_read_of_it(monkeypatch):
    """Else --resume would take a picture of the model before a change for one of the model after it."""
    events: list[str] = []
    monkeypatch.setattr(Run, "_key", lambda self, task: events.append(f"key {task.model}") or task.model)
    attempts = [Attempt(number, RenderTask(name, Path(f"{name}.png"))) for number, name in enumerate("abc")]
    Run(RenderJob({"quiet": True}), Batch(), None).do(attempts, Listed(events), Progress(3, enabled=False))
    assert events == ["key a", "key b", "expect b", "submit a", "key c", "expect c", "submit b", "submit c"]


def living(context: Context | None) -> dict[str, int]:
    """How many objects of each kind OpenGL has. Python is not asked: `gc.get_objects` is not for several threads."""
    found = {}
    for kind in KINDS if context is not None else ():
        is_one = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(context.address(f"glIs{kind}"))
        found[kind] = sum(is_one(name) for name in range(1, MOST_NAMES))
    return found


def test_models_are_loaded_ahead_and_nothing_of_them_is_kept(tmp_path, capsys, monkeypatch):
    open_or_skip().release()
    models = [tmp_path / f"{number}-{name}.glb" for number, name in enumerate(MODELS)]
    for model, name in zip(models, MODELS, strict=True):
        model.write_bytes(b"glTF" if name == "broken" else (SCENES / f"{name}.glb").read_bytes())
    ahead: list[str] = []
    scenes: list[weakref.ref[Scene]] = []
    counts: list[dict[str, int]] = []
    load_ahead, load, render = ModelRenderer._load_ahead, ModelRenderer._load, ModelRenderer.render

    def noting_ahead(self, task):
        ahead.append(task.model)
        return load_ahead(self, task)

    def noting(self, task):
        scene = load(self, task)
        scenes.append(weakref.ref(scene))
        return scene

    def counting(self, task, progress):
        counts.append(living(self._context))
        gc.collect()
        assert [scene() for scene in scenes[:-1]] == [None] * (len(scenes) - 1 if scenes else 0)
        return render(self, task, progress)

    for name, function in (("_load_ahead", noting_ahead), ("_load", noting), ("render", counting)):
        monkeypatch.setattr(ModelRenderer, name, function)
    outcome = runner(capsys)("render", *models, "-o", f"{tmp_path}/", "--size", "32", "--quality", "draft", "-q")
    assert outcome.status == 1
    assert "3-broken.glb" in outcome.error
    assert ahead == [str(model) for model in models[2:]]
    pictures = [(tmp_path / f"{model.stem}.png") for model in models]
    assert [picture.exists() for picture in pictures] == [name != "broken" for name in MODELS]
    for name in ("textures", "alpha"):  # the first of which was not loaded ahead
        assert len({picture.read_bytes() for picture in pictures if name in picture.stem}) == 1
    assert counts[3] == counts[6]  # after the second and the third of one model, with all programs of both
