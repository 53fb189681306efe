"""Makes `demo.glb`, a still life that shows what the renderer can do: python assets/make_demo.py

On a turned wooden board stand a hammered copper vase with verdigris, a glazed ball with gold inlay on a ring of
quilted leather, and a pierced lantern. Everything is drawn from noise and arithmetic; nothing in it is anyone else's.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, arc, lathe, torus, without

SIZE = 512
Y, X = (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE


def noise(seed: int, scale: float, stretch: float = 1.0) -> np.ndarray:
    """Tileable noise of mean 0 and variance 1 with about `scale` blobs across, `stretch` times as many upwards."""
    frequency = np.hypot(np.fft.fftfreq(SIZE)[:, None] / stretch, np.fft.fftfreq(SIZE)) * SIZE / scale
    spectrum = np.fft.fft2(np.random.default_rng(seed).standard_normal((SIZE, SIZE))) * np.exp(-frequency**2)
    spectrum[0, 0] = 0
    values = np.fft.ifft2(spectrum).real
    return values / values.std()


def fractal(seed: int, scale: float) -> np.ndarray:
    """Noise on noise of twice the frequency and half the size."""
    return sum(noise(seed + octave, scale * 2**octave) / 2**octave for octave in range(5)) / 1.15


def cells(seed: int, columns: int, rows: int) -> np.ndarray:
    """Distance to the nearest of jittered points, one in each cell of a grid, in cells; tileable."""
    jitter = np.random.default_rng(seed).uniform(0.15, 0.85, (rows, columns, 2))
    x, y = X * columns, Y * rows
    nearest = np.full_like(X, np.inf)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            column, row = np.floor(x).astype(int) + dx, np.floor(y).astype(int) + dy
            point = jitter[row % rows, column % columns]
            nearest = np.minimum(nearest, np.hypot(column + point[..., 0] - x, row + point[..., 1] - y))
    return nearest


def step(low: float, high: float, values: np.ndarray) -> np.ndarray:
    """GLSL's smoothstep."""
    t = np.clip((values - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def mix(first, second, weight: np.ndarray) -> np.ndarray:
    """From colour `first` to `second` (each (3,) or (H, W, 3)) by `weight` (H, W)."""
    weight = weight[..., None]
    return np.asarray(first) * (1 - weight) + np.asarray(second) * weight


def normals(height: np.ndarray, strength: float) -> np.ndarray:
    """A normal map, +Y up, of a tileable height."""
    slope_x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * strength
    slope_y = (np.roll(height, 1, 0) - np.roll(height, -1, 0)) * strength
    normal = np.stack([-slope_x, -slope_y, np.ones_like(height)], -1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True) / 2 + 0.5


def orm(occlusion, roughness, metallic) -> np.ndarray:
    """Occlusion, roughness and metallic in the channels glTF has them in."""
    return np.stack(np.broadcast_arrays(occlusion, roughness, metallic, X)[:3], -1)


def smooth(points: list[tuple[float, float]], count: int) -> np.ndarray:
    """A Catmull-Rom curve through (radius, height) points."""
    p = np.array([points[0], *points, points[-1]], float)
    t = np.linspace(0, len(points) - 1, count)
    i = np.minimum(t.astype(int), len(points) - 2)
    t = (t - i)[:, None]
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)


def board(glb: Glb, feet: list[tuple[float, float, float]]) -> None:
    """A walnut disc of 36 cm; `feet` (x, z, radius) of what stands on it darken it, for light from all around."""
    radius = 0.18
    rim = np.r_[arc(radius - 0.008, -0.014, 0.008, -90, 0, 7), arc(radius - 0.005, -0.005, 0.005, 0, 90, 6)]
    shape = without(lathe([[0, -0.022], rim[0]], rim, [rim[-1], [0, 0]], segments=80), "TANGENT")
    x, z = (X - 0.5) * 2 * radius, (Y - 0.5) * 2 * radius
    shape["TEXCOORD_0"] = shape["POSITION"][:, [0, 2]] / (2 * radius) + 0.5
    rings = np.hypot(x / radius * 0.6 - 1.1 + 0.04 * noise(3, 3, 0.3), z / radius * 0.12) * 34
    band = np.interp(rings % 1, [0, 0.75, 0.95, 1], [0, 0.7, 1, 0]) * (0.75 + 0.25 * noise(4, 4))
    pores = step(1.2, 2.4, noise(6, 200, 0.05))
    color = mix((0.46, 0.28, 0.16), (0.25, 0.135, 0.075), np.clip(0.8 * band + 0.08 * noise(5, 80, 0.04), 0, 1))
    color = mix(color, (0.13, 0.07, 0.04), 0.6 * pores)
    shade = np.ones_like(X)
    for foot_x, foot_z, size in feet:
        shade *= 1 - 0.85 * np.exp(-np.maximum(np.hypot(x - foot_x, z - foot_z) - size, 0) / (0.28 * size))
    surface = glb.texture(orm(shade, 0.38 + 0.12 * band + 0.2 * pores, 0), jpeg=80)
    glb.node(glb.mesh(shape, glb.material(name="walnut", roughness=1, metallic=1, occlusionTexture=surface,
                                          metallicRoughnessTexture=surface,
                                          baseColorTexture=glb.texture(color, jpeg=88))), name="board")


def vase(glb: Glb, place) -> None:
    """Copper, hammered below the neck; verdigris where water would stand."""
    outside = smooth([(0.030, 0), (0.036, 0.004), (0.058, 0.045), (0.062, 0.085), (0.044, 0.128), (0.023, 0.160),
                      (0.020, 0.182), (0.030, 0.204), (0.035, 0.209)], 48)
    inside = smooth([(0.035, 0.209), (0.0335, 0.2095), (0.028, 0.203), (0.0175, 0.182), (0.021, 0.158),
                     (0.041, 0.126)], 12)
    shape = lathe([[0, 0], [0.030, 0]], outside, inside, segments=60)
    hammered = step(0.36, 0.46, Y) * (1 - step(0.90, 0.93, Y))
    dents = cells(11, 30, 34)
    height = np.minimum(dents, 0.75) ** 2 * hammered + 0.004 * fractal(13, 40)
    groove = np.exp(-((Y - 0.345) / 0.006) ** 2) + np.exp(-((Y - 0.365) / 0.006) ** 2)
    patina = step(0.55, 1.7, fractal(17, 7) + 2.2 * step(0.80, 0.97, Y) + 1.2 * groove + 0.5 * (dents - 0.4) * hammered)
    patina *= step(0.2, 0.3, Y)
    tarnish = step(-1.0, 2.0, fractal(23, 5))
    copper = mix((0.985, 0.77, 0.68), (0.84, 0.50, 0.38), tarnish)
    color = mix(copper, mix((0.25, 0.44, 0.38), (0.44, 0.60, 0.51), step(-1, 1, fractal(29, 30))), patina)
    roughness = 0.16 + 0.16 * tarnish + 0.55 * patina
    surface = glb.texture(orm(1 - 0.5 * groove, roughness, 1 - patina), jpeg=82)
    material = glb.material(
        name="copper", roughness=1, metallic=1, baseColorTexture=glb.texture(color, jpeg=88),
        metallicRoughnessTexture=surface, occlusionTexture=surface,
        normalTexture=glb.texture(normals(height - 0.3 * groove + 0.05 * patina * fractal(31, 60), 4.0), jpeg=85))
    glb.node(glb.mesh(shape, material), name="vase", translation=place)


def ball(glb: Glb, place, radius: float) -> None:
    """Glazed squares of cobalt and cream, every second one matt, with gold in the joints."""
    across, up = X * 12, Y * 6
    joint = np.minimum(np.abs(across - np.round(across)) * np.maximum(np.sin(np.pi * Y), 0.15),
                       np.abs(up - np.round(up)))
    gold = 1 - step(0.035, 0.05, joint)
    even = (np.floor(across) + np.floor(up)) % 2
    cobalt = mix((0.05, 0.10, 0.30), (0.10, 0.22, 0.50), step(-1.5, 1.5, fractal(41, 12)))
    cream = mix((0.93, 0.89, 0.80), (0.84, 0.77, 0.65), step(0.5, 2.5, fractal(43, 40)))
    color = mix(mix(cream, cobalt, even), (1.0, 0.86, 0.57), gold)
    roughness = np.where(gold > 0.5, 0.18, np.where(even > 0, 0.06, 0.55)) + 0.04 * step(0, 2, fractal(47, 20))
    rim = step(0.02, 0.09, joint)
    surface = glb.texture(orm(1, roughness, gold), jpeg=84)
    profile = arc(0, 0, radius, -90, 90, 31)
    profile[[0, -1], 0] = 0
    bumps = normals(rim + 0.01 * fractal(53, 30), 3.0)
    material = glb.material(
        name="glaze", roughness=1, metallic=1, baseColorTexture=glb.texture(color, jpeg=86),
        metallicRoughnessTexture=surface, normalTexture=glb.texture(bumps, jpeg=86))
    glb.node(glb.mesh(lathe(profile, segments=60), material), name="ball", translation=place,
             rotation=[0.26, 0.1, 0.17, 0.945])


def ring(glb: Glb, place, radius: float, size: float) -> None:
    """Oxblood leather, quilted in diamonds, with the seams' shade in the occlusion map."""
    a, b = X * 28 + Y * 7, X * 28 - Y * 7
    seam = np.minimum(np.abs(a - np.round(a)), np.abs(b - np.round(b)))
    puff = 1 - (1 - np.minimum(seam * 2, 1)) ** 3
    wrinkles = cells(61, 112, 40)
    color = mix((0.20, 0.03, 0.03), (0.42, 0.07, 0.05), puff * (0.75 + 0.25 * step(-1, 1, fractal(67, 10))))
    surface = glb.texture(orm(0.35 + 0.65 * step(0, 0.22, seam), 0.42 + 0.2 * (1 - puff) + 0.05 * fractal(71, 30), 0),
                          jpeg=75)
    height = puff + 0.05 * np.minimum(wrinkles, 0.6)
    material = glb.material(
        name="leather", roughness=1, metallic=1, baseColorTexture=glb.texture(color, jpeg=88),
        metallicRoughnessTexture=surface, occlusionTexture=surface,
        normalTexture=glb.texture(normals(height, 5.0), jpeg=75))
    glb.node(glb.mesh(torus(radius, size, 64, 20), material), name="ring", translation=place)


def lantern(glb: Glb, place) -> None:
    """A small pierced globe on a brass foot, lit from within."""
    foot = smooth([(0.026, 0), (0.027, 0.003), (0.020, 0.007), (0.0075, 0.014), (0.006, 0.026), (0.011, 0.034)], 28)
    brass = glb.material((0.95, 0.79, 0.46), 1.0, 0.24, name="brass")
    finial = smooth([(0.011, 0.0925), (0.0045, 0.096), (0.006, 0.101), (0.003, 0.106), (0.0, 0.107)], 16)
    glb.node(glb.mesh(without(lathe([[0, 0], [0.026, 0]], foot, finial, segments=40), "TANGENT", "TEXCOORD_0"), brass),
             name="foot", translation=place)
    across, up = X * 16, Y * 9
    x = (across + 0.5 * (np.floor(up) % 2)) % 1 - 0.5
    y = up % 1 - 0.5
    petals = np.hypot(x * np.maximum(np.sin(np.pi * Y), 0.3), y) - 0.26 - 0.08 * np.cos(6 * np.arctan2(y, x))
    hole = (1 - step(-0.03, 0.03, petals)) * step(0.11, 0.12, Y) * step(0.11, 0.12, 1 - Y)
    glow = mix((1.0, 0.45, 0.12), (1.0, 0.78, 0.42), 1 - step(-0.3, 0.0, petals))
    profile = arc(0, 0.063, 0.031, -90, 90, 25)
    profile[[0, -1], 0] = 0
    material = glb.material(
        (0.32, 0.22, 0.14), 1.0, 0.38, name="lantern", emissiveFactor=[1, 1, 1],
        emissiveTexture=glb.texture((glow * hole[..., None])[::2, ::2], jpeg=88),
        normalTexture=glb.texture(normals(step(-0.12, 0.12, petals), 3.0)[::2, ::2], jpeg=85),
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 3.0}})
    glb.node(glb.mesh(lathe(profile, segments=48), material), name="lantern", translation=place)


def demo() -> Glb:
    glb = Glb()
    board(glb, [(-0.055, -0.035, 0.036), (0.055, 0.045, 0.055), (-0.055, 0.090, 0.027)])
    vase(glb, [-0.055, 0, -0.035])
    ring(glb, [0.055, 0.0155, 0.045], 0.042, 0.0155)
    ball(glb, [0.055, 0.0565, 0.045], 0.048)
    lantern(glb, [-0.055, 0, 0.090])
    glb.camera((0.29, 0.29, 0.63), (0, 0.083, 0.01))
    return glb


if __name__ == "__main__":
    path = Path(__file__).parent / "demo.glb"
    demo().save(path)
    print(f"{path.name}: {path.stat().st_size} bytes")
