"""The panel, driven by real events: what it says, and that it leaves the picture to be seen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import viewer
from viewer.base.resources import resource_folder
from viewer.image.image import Image
from viewer.interact.scene_facts import scene_facts
from viewer.quality import POINTS, QUALITIES
from viewer.scene.color import LUMINANCE, srgb_to_linear
from viewer.scene.scene import Variant
from viewer.settings import setting_choices

from .conftest import PLAIN
from .test_window import SAME, flip


class Widgets:
    """Where the panel's widgets stand, and what they say, as of the last frame."""

    def __init__(self) -> None:
        self.places: dict[str, tuple[int, int]] = {}
        """The middle of each list, field and button, by its name."""
        self.too_wide: set[str] = set()
        """Labels that reach into their widget, and texts of lists that are cut."""
        self.tips: dict[str, str] = {}
        """The tooltip of each label."""
        self.texts: dict[str, list[str]] = {}
        """What each list has to choose from."""

    def note(self, name: str) -> None:
        from imgui_bundle import imgui

        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        self.places[name] = round((low.x + high.x) / 2), round((low.y + high.y) / 2)


@pytest.fixture
def widgets(monkeypatch) -> Iterator[Widgets]:
    from imgui_bundle import imgui

    from viewer.app import panel, setting_rows

    seen, row, combo, field = Widgets(), setting_rows.row, setting_rows.combo, panel.imgui.input_text_with_hint

    def seen_row(label: str, scale: float, tip: str) -> None:
        start = imgui.get_cursor_pos_x()
        row(label, scale, tip)
        seen.tips[label] = tip
        if imgui.calc_text_size(label).x > imgui.get_cursor_pos_x() - start:
            seen.too_wide.add(label)

    def seen_combo(name: str, current: int, texts) -> int | None:
        room = imgui.calc_item_width() - imgui.get_frame_height() - 2 * imgui.get_style().frame_padding.x
        seen.too_wide |= {text for text in texts if imgui.calc_text_size(text).x > room}
        seen.texts[name] = list(texts)
        chosen = combo(name, current, texts)
        seen.note(name)
        return chosen

    def seen_field(label: str, *arguments: object) -> tuple[bool, str]:
        result = field(label, *arguments)
        seen.note(label)
        return result

    monkeypatch.setattr(setting_rows, "row", seen_row)
    for module in (panel, setting_rows):
        monkeypatch.setattr(module, "combo", seen_combo)
    monkeypatch.setattr(panel.imgui, "input_text_with_hint", seen_field)
    yield seen


def test_panel_takes_the_mouse_and_changes_the_picture(open_window, scene):
    hands = open_window(scene, size=(640, 480))
    azimuth = hands.window.orbit.azimuth
    hands.key("Tab")
    before = hands.screen()
    assert before[:, 400:].mean() < 90 and hands.window.state.panel
    hands.drag((350, 420), (430, 420))
    hands.click(384, 47)  # the second button: Phong
    state = hands.window.state
    assert hands.window.orbit.azimuth == azimuth
    assert state.settings.mode == "phong"
    hands.key("Tab")
    assert not state.panel


def test_who_gets_the_mouse_follows_from_where_it_is_pressed(open_window, scene):
    """Between two slow frames the mouse comes over from the panel or the picture, is pressed, moves and is released."""
    hands = open_window(scene, size=(640, 480))
    hands.key("Tab")
    orbit = hands.window.orbit
    for rests_at, start, turns in (((500, 300), (100, 300), True), ((100, 300), (500, 300), False)):
        hands.move(*rests_at)
        azimuth = orbit.azimuth
        x, y = start
        hands.xdotool("mousemove", x, y, "mousedown", 1, "mousemove", x + 40, y, "mouseup", 1)
        assert (orbit.azimuth != azimuth) == turns


def test_every_section_draws_uncut_and_lights_are_added_and_removed(open_window, monkeypatch, widgets):
    """All sections open, with all rows that the modes have; the buttons are pressed by answering for them, for where
    they stand depends on the font."""
    from viewer.app import panel, setting_rows

    hands = open_window(viewer.load(resource_folder("assets") / "scenes" / "lights.glb"), size=(640, 480))
    window, pressed = hands.window, []
    count, before = len(window.state.scene.lights), hands.screen()
    monkeypatch.setattr(panel.imgui, "collapsing_header", lambda *_: True)
    button = panel.imgui.button

    def press(label: str, size) -> bool:
        button(label, size)
        return label in pressed and not pressed.remove(label)

    monkeypatch.setattr(panel.imgui, "button", press)
    monkeypatch.setattr(setting_rows, "without_effect", lambda *_: set())
    window.state.scene = replace(window.state.scene, warnings=("something is not drawn",))
    hands.key("Tab")
    for view in ("phong", "path_split", "furnace", "pbr"):
        window.do(view)
        window._draw()
    assert widgets.too_wide == set()
    facts = {name for name, _ in scene_facts(window.state.scene)} | {""}
    assert [label for label, tip in widgets.tips.items() if not tip and label not in facts] == []
    words = {text for name, texts in widgets.texts.items() if name != "environment" for text in texts}
    boxes = {"multiscatter", "shadows", "grid", "specular_aa"}
    assert {*setting_choices()} - boxes - {"plan", "bounces"} <= set(widgets.texts)
    assert not {text for text in words if text[0].islower()}  # of the command line, but for people
    for label, change in (("Add a directional light", 1), ("Remove", -1)):
        lights = len(window.state.scene.lights)
        pressed.append(label)
        hands.move(500, 300 + change)
        assert pressed == [] and len(window.state.scene.lights) == lights + change
    hands.key("Tab")
    assert len(window.state.scene.lights) == count and count == 3
    assert flip(hands.screen(), before) > SAME  # the first of the file's own went, the added one stayed
    assert [light.kind for light in window.state.scene.lights] == ["spot", "directional", "directional"]


def test_only_settings_that_can_change_the_picture_have_rows(open_window, scene, widgets):
    hands = open_window(scene, size=(640, 480))
    hands.key("Tab")
    state = hands.window.state

    def rows() -> set[str]:
        widgets.texts.clear()
        hands.window._draw()
        return set(widgets.texts)

    plain, media = rows(), {"media_scattering", "media_rays", "media_steps"}
    assert plain >= {"ndf", "environment_shadows", "reflections", "indirect"}
    assert not plain & {"hair_scattering", "yarn", "sheen", "subsurface", "refraction", *media}
    state.settings = replace(state.settings, fog=0.1)
    assert rows() == plain | media
    state.settings = replace(state.settings, fog=0.0, indirect="estimated")
    assert "indirect" in rows(), "another choice has an effect, even if this one has none without shadows"
    state.show_values("normal")
    state.choose("ndf", "beckmann")
    assert "ndf" in rows(), "it could not be changed back"
    state.show_mode("phong")
    assert "ndf" not in rows() and "phong" in rows()


def test_a_variant_is_chosen(open_window, scene, monkeypatch):
    """The panel lists variants only where there are some, and shows the one that is chosen."""
    from viewer.app import panel

    red, green = (replace(scene.materials[0], base_color=color, base_color_texture=None)
                  for color in ((1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0)))
    variants = tuple(Variant(name, (material,) * len(scene.materials), (-1,) * len(scene.materials))
                     for name, material in (("", red), ("Green", green)))
    hands = open_window(scene, size=(640, 480))
    combo, listed, chosen = panel.combo, [], []

    def choose(name: str, current: int, texts) -> int | None:
        combo(name, current, texts)
        if name == "variant":
            listed.append((current, list(texts)))
            return chosen.pop() if chosen else None
        return None

    monkeypatch.setattr(panel, "combo", choose)
    hands.key("Tab")
    assert not listed
    hands.window.state.scene = replace(scene, materials=variants[0].materials, variants=variants)
    hands.move(100, 301)
    assert listed[-1] == (0, ["The file's own", "Green"])
    red_pixels = hands.screen()
    chosen.append(1)
    hands.move(100, 302)
    assert listed[-1] == (1, ["The file's own", "Green"]) and hands.window.state.scene.variant == "Green"
    assert flip(hands.screen()[:, :300], red_pixels[:, :300]) > SAME


def test_a_quality_is_chosen_and_lists_show_what_it_has(open_window, scene, monkeypatch):
    from viewer.app import panel, setting_rows

    hands = open_window(scene, size=(640, 480))
    combo, shown, chosen = panel.combo, {}, {}

    def choose(name: str, current: int, texts) -> int | None:
        combo(name, current, texts)
        shown[name] = texts[current]
        return chosen.pop(name, None)

    for module in (panel, setting_rows):
        monkeypatch.setattr(module, "combo", choose)
    hands.key("Tab")
    assert (shown["quality"], shown["environment_shadows"]) == ("Draft", "Off")
    chosen["quality"] = QUALITIES.index("standard")
    hands.move(100, 301)
    hands.move(100, 302)
    count = POINTS["standard"]["environment_shadows"]
    assert (shown["quality"], shown["environment_shadows"]) == ("Standard", f"{count} lights")
    chosen["environment_shadows"] = 0
    hands.move(100, 303)
    assert hands.window.state.at_rest.environment_shadows == "off"
    assert hands.window.state.at_rest.antialias == POINTS["standard"]["antialias"]
    hands.window.do("phong")
    shown.clear()
    hands.move(100, 304)
    assert "quality" not in shown and shown


def test_the_panel_grows_with_the_desktops_scale(open_window, scene, monkeypatch):
    from viewer.app import panel

    monkeypatch.setattr("glfw.get_window_content_scale", lambda _: (1.5, 1.5))
    hands = open_window(scene, size=(800, 300))
    plain = hands.screen().astype(int)
    hands.key("Tab")
    changed = np.argwhere(np.abs(hands.screen() - plain).sum(axis=2) > 60)
    assert abs(changed[:, 1].min() - (800 - 1.5 * panel.WIDTH)) <= 2


def test_the_picture_is_centred_in_what_the_panel_leaves(open_window, scene, tmp_path, monkeypatch):
    """Its size, what the mouse does on it and what is saved are those of the part that is seen."""
    from viewer.app.panel import WIDTH
    from viewer.interact.pick import pick

    monkeypatch.chdir(tmp_path)
    hands = open_window(scene, size=(1000, 240))
    window, free = hands.window, (1000 - int(WIDTH), 240)
    assert window.state.panel and window._pixels == free
    framed = scene.framing_camera(free[0] / free[1])
    assert np.allclose(window.orbit.camera.pose, framed.pose, atol=1e-9 * scene.radius)
    expected = viewer.render(scene, free, framed, **vars(PLAIN)).srgb[..., :3]
    screen = hands.screen()
    assert screen.shape == (240, 1000, 3) and flip(screen[:, :free[0]], expected) < SAME
    assert screen[:, free[0] + 5:].mean() < 90
    point = pick(scene, framed, free, (free[0] // 2, 100))
    hands.move(free[0] // 2, 100)
    hands.xdotool("keydown", "shift", "click", 1, "keyup", "shift")
    assert np.allclose(window.orbit.target, point, atol=1e-9 * scene.radius)
    window.do("split")
    hands.drag((free[0] // 2, 100), (free[0] // 4, 100))
    assert window.state.split == 0.25
    window.do("screenshot")
    assert Image.open(f"{scene.name}-1.png").size == free
    hands.key("Tab")
    assert window._pixels == (1000, 240)


def test_escape_closes_a_list_leaves_a_field_and_only_then_the_window(open_window, scene, widgets, monkeypatch):
    from imgui_bundle import imgui

    def is_open() -> bool:
        return imgui.is_popup_open("", imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level)

    hands = open_window(scene, size=(640, 790))
    window = hands.window
    hands.key("Tab")
    for key in ("Escape", "q"):
        hands.click(*widgets.places["lobes"])
        assert is_open()
        hands.key(key)
        assert not is_open() and not window.is_closed and window.state.settings == PLAIN
    hands.click(*widgets.places["##file"])
    hands.key("2", "q", "Escape")
    assert not window._gui.wants_keyboard and not window.is_closed and window._panel._path == ""
    hands.click(*widgets.places["##file"])
    hands.key("2", "q", "3")
    assert window.state.settings.mode == "pbr" and window._panel._path == "2q3"
    hands.key("Return")
    assert window.state.is_error and "2q3" in window.state.message
    monkeypatch.setenv("HOME", "/home/of")
    monkeypatch.setenv("USERPROFILE", "/home/of")
    window._panel._path = "~/helmet.glb"
    hands.click(*widgets.places["##file"])
    hands.key("Return")
    assert window.state.message.startswith("/home/of/helmet.glb: ")
    hands.key("Escape")
    assert window.state.message == "" and not window.is_closed
    hands.key("Escape")
    assert window.is_closed


def test_the_help_stands_before_the_panel(open_window, scene):
    """In the middle of the window; its right half would be hidden by a panel that was clicked before."""
    hands = open_window(scene, size=(1000, 240))
    hands.click(900, 20)
    hands.key("h")
    shown = hands.screen()[120, :, :].astype(int)
    hands.key("h")
    changed = np.flatnonzero(np.abs(shown - hands.screen()[120]).sum(axis=1) > 30)
    assert changed.min() < 300 and changed.max() > 1000 - 344 + 20


def test_the_help_breaks_its_lines_where_the_window_is_narrow(open_window, scene, monkeypatch):
    from viewer.app import overlay

    rights, text = [], overlay.imgui.text

    def seen(line: str) -> None:
        text(line)
        rights.append(overlay.imgui.get_item_rect_max().x)

    monkeypatch.setattr(overlay.imgui, "text", seen)
    hands = open_window(scene, size=(400, 300))
    hands.key("h")
    assert rights and max(rights[len(rights) // 2:]) <= 400 - 22


def test_numbers_are_readable_on_the_knobs_of_sliders(open_window, scene):
    """By the contrast that WCAG 2.1 asks of text at least, 4.5 : 1."""
    from imgui_bundle import imgui

    open_window(scene)
    style = imgui.get_style()

    def luminance(name: str) -> float:
        color = style.color_(getattr(imgui.Col_, name))
        return float(srgb_to_linear(np.array([color.x, color.y, color.z])) @ LUMINANCE)

    for knob in ("slider_grab", "slider_grab_active"):
        assert (luminance("text") + 0.05) / (luminance(knob) + 0.05) > 4.5, knob
