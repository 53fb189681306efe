"""Keys and mouse gestures and their actions. The bindings, the help overlay and docs/window.md use this table."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Binding:
    """Each of `keys` does `action`. A key is a letter, a digit or a GLFW name (F1, TAB, KP_7), perhaps with Shift+ or
    Ctrl+ before it."""

    group: str
    keys: tuple[str, ...]
    action: str
    text: str


KEYS = (
    Binding("Shading", ("1",), "pbr", "Physically based"),
    Binding("Shading", ("2",), "phong", "Phong"),
    Binding("Shading", ("3",), "split", "Phong | PBR; drag the line between them"),
    Binding("Shading", ("4",), "uniform_diffuse", "Uniform diffuse light alone"),
    Binding("Shading", ("5",), "specular", "Specular light alone"),
    Binding("Shading", ("6",), "directional_diffuse", "Directional diffuse light alone (multiple scattering)"),
    Binding("Shading", ("7",), "furnace", "White furnace on or off: in it, surfaces that lose no light are invisible"),
    Binding("Shading", ("8",), "path", "Path-traced: converges to the exact picture"),
    Binding("Shading", ("9",), "path_split", "PBR | path-traced"),
    Binding("Shading", ("0",), "next_values", "Next view of values: base colour, normals, roughness, …"),
    Binding("Shading", ("Shift+0",), "previous_values", "The view of values before it"),
    Binding("Shading", ("W",), "wireframe", "Edges of triangles over the picture, or not"),
    Binding("Shading", ("G",), "grid", "Grid on the ground and axes, or not"),
    Binding("Shading", ("SPACE",), "pause", "Path tracing: pause or continue"),
    Binding("Shading", ("N",), "denoise", "Path tracing: denoise, or show the noise"),
    Binding("Shading", ("E",), "tell_error", "Error: tell how far the picture is from the truth, at rest"),
    Binding("Shading", ("Shift+E",), "error_map", "Error: show where the picture is wrong"),
    Binding("Camera", ("F", "HOME"), "frame_all", "Frame the whole model"),
    Binding("Camera", ("V",), "view_default", "Three-quarter view"),
    Binding("Camera", ("Z", "KP_1"), "view_front", "Front view"),
    Binding("Camera", ("Shift+Z", "Ctrl+KP_1"), "view_back", "Back view"),
    Binding("Camera", ("X", "KP_3"), "view_right", "Right view"),
    Binding("Camera", ("Shift+X", "Ctrl+KP_3"), "view_left", "Left view"),
    Binding("Camera", ("Y", "KP_7"), "view_top", "Top view"),
    Binding("Camera", ("Shift+Y", "Ctrl+KP_7"), "view_bottom", "Bottom view"),
    Binding("Camera", ("O", "KP_5"), "orthographic", "Perspective or orthographic"),
    Binding("Camera", ("C",), "next_camera", "The file's next camera"),
    Binding("Camera", ("I",), "inertia", "Inertia on or off"),
    Binding("Animation", ("P",), "play", "Play or pause"),
    Binding("Animation", ("Shift+P",), "next_animation", "Next animation, and after the last one the model at rest"),
    Binding("Animation", ("COMMA",), "step_back", "Pause, and go back by 1/25 s"),
    Binding("Animation", ("PERIOD",), "step_on", "Pause, and go on by 1/25 s"),
    Binding("Window", ("TAB",), "panel", "Panel"),
    Binding("Window", ("F11",), "full_screen", "Full screen, or not"),
    Binding("Window", ("PAGE_DOWN",), "next_file", "Next model of the folder"),
    Binding("Window", ("PAGE_UP",), "previous_file", "The model before it"),
    Binding("Window", ("H", "F1"), "help", "This help"),
    Binding("Window", ("S", "Ctrl+S", "F12"), "screenshot", "Save the picture as PNG in the current folder"),
    Binding("Window", ("Ctrl+C",), "copy_command", "Copy the picture as a command line, and print it"),
    Binding("Window", ("R",), "reload", "Reload the shaders now"),
    Binding("Window", ("Q", "ESCAPE"), "close", "Close: a list, the help, an error, full screen, the window"),
)

MOUSE = (
    ("Drag", "Orbit"),
    ("Right, middle or Shift + drag", "Pan"),
    ("Wheel, two fingers", "Move closer to the point under the cursor, or away from it"),
    ("Shift + wheel", "Pan"),
    ("Ctrl + wheel", "Orbit"),
    ("Double click, Shift + click", "Centre on the point under the cursor"),
    ("Drop a file", "Open a model, or an HDR or EXR picture as environment"),
)

_LABELS = {"COMMA": "Comma", "PERIOD": "Full stop", "ESCAPE": "Esc", "TAB": "Tab", "HOME": "Home", "SPACE": "Space",
           "PAGE_DOWN": "Page Down", "PAGE_UP": "Page Up"}


def action_of(key: str, shift: bool = False, control: bool = False) -> str | None:
    """The action of a key with these modifiers; None for a key without an action."""
    name = "Ctrl+" * control + "Shift+" * shift + key
    return _BY_NAME.get(name)


_BY_NAME = {key: binding.action for binding in KEYS for key in binding.keys}


def label(key: str) -> str:
    """The name of a key for users: `Ctrl+Num 7` for `Ctrl+KP_7`."""
    *modifiers, name = key.split("+")
    return "+".join([*modifiers, _LABELS.get(name, name.replace("KP_", "Num "))])


def help_groups() -> list[tuple[str, list[tuple[str, str]]]]:
    """Groups of lines; each line has the keys or the gesture, and what it does."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for binding in KEYS:
        groups.setdefault(binding.group, []).append((", ".join(map(label, binding.keys)), binding.text))
    return [*groups.items(), ("Mouse and trackpad", list(MOUSE))]


def markdown() -> str:
    """The tables of docs/window.md."""
    parts = []
    for group, lines in help_groups():
        parts += [f"### {group}", "", "| | |", "|---|---|"]
        parts += [f"| {keys} | {text.replace('|', chr(92) + '|')} |" for keys, text in lines]
        parts.append("")
    return "\n".join(parts)
