"""What the entries of the panel do, in a sentence each, and what was measured of them."""

from __future__ import annotations

from ..settings import setting_meanings

MEASURED = {
    "environment_shadows": ("environment's shadows", 0.28, 7.8), "indirect": ("light between surfaces", 0.17, 2.4),
    "ambient_occlusion": ("ambient occlusion", 0.65, 2.1), "reflections": ("traced reflections", 0.96, 1.7),
    "refraction": ("traced refraction", 0.51, 2.9), "antialias": ("image-based light, SSAA 4", 0.81, 1.0),
    "multiscatter": ("image-based light, MSAA 4, multiscatter off", 1.0, 0.9),
    "fresnel": ("image-based light, MSAA 4, fresnel exact", 1.0, 1.0),
    "specular_aa": ("image-based light, MSAA 4, specular-aa on", 1.0, 1.0),
    "shadows": ("image-based light, MSAA 4, shadows off", 1.14, 0.7), "Phong": ("Phong", 3.28, 0.8),
}
"""Of some settings, and of a label, the method in benchmarks/results/reach.json that has it, or their family, and
for its best points the error (relMSE) and the time of a frame, as multiples of those of image-based light alone:
medians over the models that have it. A test works them out anew."""

TIPS = {
    "PBR": "Physically based shading, in real time.",
    "Phong": "Phong's model, in real time, with the same lights and textures.",
    "Path-traced": "The exact picture, which converges while the view is at rest.",
    "Phong | PBR": "Both, left and right of a line that can be dragged.",
    "PBR | Path-traced": "Both, left and right of a line that can be dragged.",
    "Show": "The shaded picture, or a view for teaching and debugging: docs/views.md says what its colours mean.",
    "Quality at rest": "A trade-off between error and time, for pictures that do not move. `pbr-viewer report` "
                       "measures it on this device.",
    "White furnace": "Uniform light on surfaces that absorb nothing: those that lose no light are invisible.",
    "Tell the error, at rest": "How far this picture is from the truth, measured with additional path-traced samples.",
    "Show where": "Where this picture is wrong: black is correct, pale is an error of 100 % or more.",
    "Denoising": "Remove noise while the error is above 1 %. Fast: a wavelet filter. Real-time picture: mix it in "
                 "where it is closer to the correct picture.",
    "Paused": "Trace no more paths for now.",
    "Materials": "Another variant of the materials, if the file has several.",
    "Animation": "The animation to play, or the model at rest.",
    "Time": "Stand still at this time of the animation.",
    "Speed": "How fast the animation plays: 1 is the speed of the file.",
    "Environment": "What lights the model from all around: a built-in picture, a file, or nothing.",
    "File": "The path of a model to show, or of a panorama to light it with.",
    "Rotation": "Turn the environment about the vertical axis.",
    "Intensity": "Multiply the light of the environment.",
    "Azimuth": "Where the light comes from: 0 is the front, and it grows towards the right.",
    "Elevation": "How high the light stands above the horizon.",
    "Lux": "Illuminance of a surface that faces the light. White at 3.14 lux has radiance 1.",
    "Candela": "Luminous intensity: illuminance at a distance of 1 m.",
    "Colour": "The colour of the light.",
    "Exposure": "Make the picture 2^EV times as bright.",
    "Tone map": "How bright light is compressed to the range of a screen.",
    "Background": "What is behind the model.",
    "Copy as command line": "A line of `pbr-viewer render` that makes this picture, to the clipboard and the terminal.",
}
"""By label, of what is no setting of `--set`."""


def tip_of(label: str, setting: str = "") -> str:
    """The tooltip of an entry; "" for rows that only tell something."""
    text = TIPS.get(label, "")
    if setting:
        meaning = setting_meanings()[setting]
        text = f"{meaning[:1].upper()}{meaning[1:]}.\n--set {setting.replace('_', '-')}"
    if (setting or label) in MEASURED:
        method, error, times = MEASURED[setting or label]
        text += (f"\nMeasured (benchmarks/results/reach.md, llvmpipe), {method}: {error:g} times the error of "
                 f"image-based light alone, in {times:g} times its time.")
    return text
