"""What the window shows, as data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.interact.actions import Actions
from viewer.interact.free_path import free_path
from viewer.interact.keys import KEYS
from viewer.interact.orbit import OrbitController
from viewer.interact.shots import CLEAR_GREY, on_screen, parts, shots
from viewer.interact.state import FURNACE, VIEWS, ViewState
from viewer.quality import POINTS
from viewer.scene.animation import Animation, Target, Track
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.rig import Nodes, Rig
from viewer.scene.scene import Instance, Scene, Variant
from viewer.settings import Settings

GREY = np.ones((2, 4, 3), np.float32)


def triangle(**kwargs) -> Scene:
    mesh = Mesh("m", np.eye(3, dtype=np.float32), 0)
    return Scene("triangle.glb", (mesh,), (Material(),), (Instance(0, np.eye(4)),), **kwargs)


@pytest.fixture
def state() -> ViewState:
    return ViewState(triangle(environment=Environment("grey", GREY, rotation=0.5, intensity=2.0)), Settings())


def test_the_noise_is_shown_and_hidden_as_before(state):
    for denoise, first, second in (("raster", "off", "raster"), ("off", "raster", "off"), ("fast", "off", "fast")):
        state.settings = replace(state.settings, denoise=denoise)
        state.toggle_denoise()
        assert state.settings.denoise == first
        state.toggle_denoise()
        assert state.settings.denoise == second


def test_one_shot_is_the_whole_picture(state):
    assert shots(state, state.settings, (100, 50)) == [(state.settings, None)]


@pytest.mark.parametrize("split, line", [(0.5, 50), (0.251, 25), (0.999, 100)])
def test_a_split_covers_the_picture_without_overlap(state, split, line):
    state.split = split
    shown = shots(state, state.settings, (100, 50))
    assert shown[0][0].mode == "phong" and shown[0][1] == (0, 0, line, 50)
    assert shown[1:] == [] if line == 100 else shown[1][0].mode == "pbr" and shown[1][1] == (line, 0, 100 - line, 50)


def test_a_mode_ends_the_split_and_the_split_stays_where_it_was(state):
    state.show_split()
    state.split = 0.3
    state.show_split()
    assert state.split == 0.3
    state.show_mode("pbr", "specular")
    assert state.split is None and (state.settings.mode, state.settings.lobes) == ("pbr", "specular")
    state.show_mode("phong")
    assert (state.settings.mode, state.settings.lobes) == ("phong", "all")


def test_paths_stand_beside_or_over_a_whole_picture_of_the_raster(state):
    state.show_mode("path")
    traced = replace(state.settings, spp=5, bounces=3, denoise="fast")
    assert shots(state, traced, (100, 50)) == [(Settings(), None)] and parts(state, (100, 50)) == [("path", None)]
    state.show_split("phong", "path")
    state.split = 0.3
    assert shots(state, traced, (100, 50)) == [(Settings(mode="phong"), None)]
    assert parts(state, (100, 50)) == [("phong", (0, 0, 30, 50)), ("path", (30, 0, 70, 50))]
    state.split = 1.0
    assert parts(state, (100, 50)) == [("phong", (0, 0, 100, 50))] and state.shows("path")


def test_a_single_contribution_is_shown_by_the_raster_but_for_path_traced_pictures(state):
    for mode, expected in (("path", "path"), ("phong", "pbr"), ("pbr", "pbr")):
        state.show_mode(mode)
        state.show_lobes("specular")
        assert (state.modes, state.settings.lobes) == ((expected,), "specular")


def test_views_of_values_are_of_one_real_time_mode_and_leave_with_any_other_view(state):
    state.show_mode("path")
    state.step_values(1)
    assert (state.modes, state.settings.show) == (("pbr",), "base-color") and not state.has_error
    assert not state.message and on_screen(state).background == CLEAR_GREY
    for view, mode in (("phong", "phong"), ("split", "phong"), ("path", "path")):
        state.show_view(view)
        assert state.settings.show == "shaded" and state.modes[0] == mode and not state.message
        state.step_values(-1)
        assert state.settings.show == "wireframe" and len(state.modes) == 1 and state.modes != ("path",)
    state.step_values(1)
    assert state.settings.show == "shaded" and state.has_error and on_screen(state).background == "env"


@pytest.mark.parametrize("key", ["next_values", "previous_values", "wireframe"])
def test_views_of_values_and_edges_leave_the_furnace_and_it_leaves_them(key):
    state = ViewState(scene := triangle(), Settings(exposure=1.5))
    actions = Actions(state, OrbitController(scene, 1.0), lambda: 1.0)
    actions.do("furnace")
    actions.do(key)
    assert state.scene is scene and state.settings.show != "shaded" and state.settings.exposure == 1.5
    show = state.settings.show
    actions.do("furnace")
    assert state.before_furnace is not None and state.settings.show == "shaded"
    actions.do("furnace")
    assert state.scene is scene and state.settings.show == show


def test_an_error_is_not_told_of_a_picture_with_a_grid(state):
    state.toggle_grid()
    state.toggle_error()
    assert not (state.has_error or state.tells_error) and "without a grid" in state.message
    state.toggle_grid()
    state.toggle_error()
    assert state.has_error and state.tells_error


def test_only_paths_are_paused_and_only_until_another_mode(state):
    state.toggle_pause()
    assert not state.paused and state.message
    state.show_mode("path")
    state.toggle_pause()
    assert state.paused
    state.toggle_pause()
    assert not state.paused
    state.toggle_pause()
    state.show_split("pbr", "path")
    assert not state.paused


def test_another_environment_keeps_rotation_and_intensity(state):
    state.relight(Environment("other", GREY))
    environment = state.scene.environment
    assert (environment.name, environment.rotation, environment.intensity) == ("other", 0.5, 2.0)
    state.relight(None)
    assert state.scene.environment is None


def test_relighting_keeps_what_the_renderer_shares(state):
    before, corners = state.scene, state.scene.corners
    state.set_lights((Light("point"),))
    assert state.scene is not before and state.scene.lights == (Light("point"),)
    assert state.scene.meshes is before.meshes and state.scene.instances is before.instances
    assert state.scene.corners is corners


def test_another_model_keeps_the_environment_and_the_lights_added_by_hand(state):
    added, environment = Light.from_angles(0.1, 0.2, 3.0), state.scene.environment
    state.set_lights((Light("point", name="lamp"), added))
    state.open(triangle(lights=(Light("spot", name="torch"),)))
    assert [light.name for light in state.scene.lights] == ["torch", added.name]
    assert state.scene.environment is environment


def test_no_background_is_dark_on_screen_only(state):
    state.settings = Settings(background="none", exposure=1.0)
    assert isinstance(on_screen(state).background, tuple) and on_screen(state).exposure == 1.0
    assert state.settings.background == "none"


def test_where_there_is_no_environment_something_opaque_is_behind_the_model_on_screen(state):
    assert on_screen(state).background == "env"
    state.scene = state.scene.relit(environment=None, lights=())
    assert on_screen(state).background == CLEAR_GREY and state.settings.background == "env"


def test_the_quality_is_of_the_picture_at_rest_and_what_is_chosen_by_hand_wins(state):
    assert state.at_rest == state.settings
    state.choose_quality("high")
    assert state.settings == Settings() and state.at_rest == replace(Settings(), **POINTS["high"])
    state.choose("indirect", "off")
    state.choose("ndf", "beckmann")
    assert state.at_rest == replace(Settings(ndf="beckmann"), **POINTS["high"] | {"indirect": "off"})
    state.choose("environment_shadows", "256")
    assert state.settings.environment_shadows == state.at_rest.environment_shadows == "256"
    state.choose_quality("draft")
    assert state.settings == state.at_rest == Settings(ndf="beckmann")


def test_messages_are_one_line_and_go_but_errors_stay(state, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("viewer.interact.state.time.monotonic", lambda: now[0])
    state.say("saved\n  it")
    assert state.message == "saved it" and not state.forget_message()
    now[0] += 5
    assert state.forget_message() and state.message == "" and not state.forget_message()
    state.say("broken", is_error=True)
    now[0] += 1e6
    assert not state.forget_message() and state.message == "broken"


def test_a_free_path_is_never_one_that_exists(tmp_path):
    assert free_path(tmp_path, "helmet").name == "helmet-1.png"
    (tmp_path / "helmet-1.png").touch()
    (tmp_path / "helmet-3.png").touch()
    assert free_path(tmp_path, "helmet").name == "helmet-2.png"
    assert free_path(tmp_path, "a/../b:c?").parent == tmp_path
    assert free_path(tmp_path, "..").name == "picture-1.png"


def shown(state: ViewState) -> dict[str, object]:
    """What a view decides: the modes, the contribution, the furnace, and the settings that the furnace changes."""
    return {"modes": state.modes, "in furnace": state.before_furnace is not None,
            **{name: getattr(state.settings, name) for name in FURNACE}}


SHOWS = {
    "pbr": {"modes": ("pbr",)}, "phong": {"modes": ("phong",)}, "split": {"modes": ("phong", "pbr")},
    "uniform_diffuse": {"lobes": "uniform-diffuse"}, "specular": {"lobes": "specular"},
    "directional_diffuse": {"lobes": "directional-diffuse"}, "furnace": {"in furnace": True, **FURNACE},
    "path": {"modes": ("path",)}, "path_split": {"modes": ("pbr", "path")},
}
"""What the table of keys says of each view. The modes that it does not name may be those of the view before."""
OWN = Settings(exposure=1.5, tonemap="agx", background=(0.1, 0.2, 0.3))


def test_the_views_are_keys_of_the_table():
    keys = [binding.keys for binding in KEYS if binding.action in VIEWS]
    assert keys == [(str(k),) for k in range(1, 10)] and set(SHOWS) == set(VIEWS)


@pytest.mark.parametrize("first", VIEWS)
@pytest.mark.parametrize("before", ["key", "panel"])
def test_every_key_shows_its_view_from_every_other_view(first, before):
    """All ordered pairs; before the second key, the panel may have put any mode or contribution into the furnace."""
    scene = triangle(environment=Environment("grey", GREY), lights=(Light("point"),))
    for second in VIEWS:
        state = ViewState(scene, OWN)
        state.show_view(first)
        if before == "panel" and state.before_furnace is None:
            state.toggle_furnace()
            state.show_mode("phong", "specular")
        was_in_furnace = state.before_furnace is not None
        state.show_view(second)
        if second == "furnace" and was_in_furnace:
            assert state.before_furnace is None and state.scene is scene and state.settings.exposure == 1.5
            continue
        plain = {name: getattr(OWN, name) for name in FURNACE} | {"in furnace": False, "modes": state.modes}
        assert shown(state) == plain | SHOWS[second], (first, second)
        assert (state.scene is scene) == (second != "furnace")
        assert state.modes in [("pbr",), ("path",)] or SHOWS[second].get("modes") or second == "furnace"


def test_a_newer_version_of_the_model_keeps_the_variant_if_it_has_it():
    variants = tuple(Variant(name, (Material(),), (-1,)) for name in ("", "red"))
    state = ViewState(triangle(variants=variants), Settings())
    state.choose_variant("red")
    state.open(triangle(variants=variants), again=True)
    assert state.scene.variant == "red" and state.scene.materials == variants[1].materials
    state.open(triangle(variants=variants[:1]), again=True)
    assert state.scene.variant == ""


def test_another_light_leaves_the_furnace_for_the_model_that_it_lights(state):
    scene = state.scene
    state.toggle_furnace()
    state.relight(Environment("other", GREY))
    assert state.before_furnace is None and state.scene.meshes is scene.meshes
    assert state.scene.environment.name == "other" and state.scene.environment.rotation == 0.5
    assert state.settings == Settings()


def test_the_furnace_view_makes_white_and_comes_back():
    scene = Scene("x", materials=(Material(base_color=(0.2, 0.4, 0.6, 1.0), emissive=(1.0, 0.0, 0.0), metallic=0.0),),
                  lights=(Light("directional"),))
    state = ViewState(scene, Settings(exposure=2.0, multiscatter="off"))
    state.toggle_furnace()
    assert state.scene.materials[0].base_color == (1.0, 1.0, 1.0, 1.0)
    assert not any(state.scene.materials[0].emissive)
    assert state.scene.lights == () and state.scene.environment.name == "furnace"
    assert (state.settings.exposure, state.settings.tonemap) == (-1.0, "none")
    state.settings = replace(state.settings, multiscatter="on")
    state.toggle_furnace()
    assert state.scene is scene
    assert (state.settings.exposure, state.settings.tonemap, state.settings.multiscatter) == (2.0, "neutral", "on")


def swinging(names=("sway", "rise")) -> Scene:
    """A triangle that its node moves by 4 along x, or along y, in 2 s."""
    nodes = Nodes(np.array([-1]), np.array([0]), np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]), np.ones((1, 3)), {},
                  np.ones(1, bool))
    animations = tuple(Animation(name, (Track(Target("node", 0, "translation"), [0, 2], [[0, 0, 0], end]),))
                       for name, end in zip(names, ([4, 0, 0], [0, 4, 0])))
    grey = Environment("grey", GREY)
    return replace(triangle(environment=grey), animations=animations, rig=Rig(nodes, np.array([0])))


def place(state: ViewState) -> list[float]:
    return state.scene.instances[0].transform[:3, 3].tolist()


def test_an_animation_plays_pauses_and_begins_again():
    state = ViewState(swinging(), Settings())
    assert not state.play(1.0) and place(state) == [0, 0, 0]
    state.toggle_play()
    assert state.play(0.5) and place(state) == [1, 0, 0]
    state.playback.speed = 2.0
    state.play(0.5)
    assert place(state) == [3, 0, 0]
    state.play(0.75)
    assert place(state) == [2, 0, 0], "0.5 s after the beginning and 0.5 s before it"
    state.toggle_play()
    shown = state.scene
    assert not state.play(1.0) and state.scene is shown


def test_seeking_pauses_and_stays_within_the_animation():
    state = ViewState(swinging(), Settings())
    state.seek(1.0)
    assert place(state) == [0, 0, 0], "at rest there is no time"
    state.toggle_play()
    state.seek(1.5)
    assert place(state) == [3, 0, 0] and not state.playback.is_playing
    for time, x in ((9.0, 4), (-1.0, 0)):
        state.seek(time)
        assert place(state) == [x, 0, 0]


def test_a_step_from_rest_is_one_in_the_first_animation():
    state = ViewState(swinging(), Settings())
    state.step_animation(0.5)
    assert place(state) == [1, 0, 0] and not state.playback.is_playing
    state.step_animation(-9.0)
    assert place(state) == [0, 0, 0]
    still = ViewState(replace(swinging(), animations=(), rig=None), Settings())
    still.step_animation(0.5)
    assert still.message == "The model has no animations"


def test_animations_are_shown_one_after_the_other_and_then_the_model_at_rest():
    state = ViewState(swinging(), Settings())
    state.show_next_animation()
    state.seek(1.0)
    state.show_next_animation()
    assert state.message == "Animation 2 of 2: rise" and state.playback.time == 0
    state.seek(2.0)
    assert place(state) == [0, 4, 0]
    state.show_next_animation()
    assert state.playback.animation is None and place(state) == [0, 0, 0] and state.message == "At rest"


def test_the_furnace_moves_and_is_left_in_the_same_pose():
    state = ViewState(swinging(), Settings())
    state.show_animation(0)
    state.toggle_furnace()
    state.seek(1.0)
    assert place(state) == [2, 0, 0] and state.scene.environment.name == "furnace"
    state.toggle_furnace()
    assert place(state) == [2, 0, 0] and state.scene.environment.name == "grey"


def test_another_model_is_shown_at_rest(state):
    state.toggle_play()
    assert state.message == "The model has no animations" and not state.playback.is_playing
    state.open(swinging())
    state.toggle_play()
    state.open(swinging())
    assert state.playback.animation is None and not state.playback.is_playing


def test_a_pose_that_cannot_be_drawn_stops_the_animation_with_a_message():
    scene = swinging(("far",))
    track = replace(scene.animations[0].tracks[0], values=[[0, 0, 0], [3e38, 0, 0]])
    state = ViewState(replace(scene, animations=(replace(scene.animations[0], tracks=(track,)),)), Settings())
    state.toggle_play()
    state.play(1.0)
    assert state.is_error and "cannot be drawn" in state.message and not state.playback.is_playing


def test_lights_that_are_edited_stand_still_and_added_ones_stay():
    scene = replace(swinging(), lights=(Light("point"),))
    scene = replace(scene, rig=replace(scene.rig, lights=(0,), light_items=(0,)))
    state = ViewState(scene, Settings())
    state.set_lights((*state.scene.lights, Light("directional")))
    state.show_animation(0)
    state.seek(1.0)
    assert [light.position[0] for light in state.scene.lights] == [2, 0]
    state.set_lights(state.scene.lights[1:])
    state.seek(2.0)
    assert len(state.scene.lights) == 1 and state.scene.lights[0].kind == "directional"
