"""The maps of a material: what they are called, what of their images is read, what they take as textures."""

from __future__ import annotations

from ..scene.material import Material, Texture
from ..scene.texture_image import TextureImage

# In the order of their texture units: the material's field, and whether its colours are sRGB.
MAPS = {
    "base_color": True,
    "metallic_roughness": False,
    "normal": False,
    "occlusion": False,
    "emissive": True,
    "specular": False,
    "specular_color": True,
    "transmission": False,
    "thickness": False,
}
CHANNELS = {
    "base_color": "RGBA", "metallic_roughness": "GB", "normal": "RGB", "occlusion": "R",
    "emissive": "RGB", "specular": "A", "specular_color": "RGB",
    "transmission": "R", "thickness": "G",
}


def material_map(material: Material, name: str) -> Texture | None:
    return getattr(material, f"{name}_texture")


def texture_bytes(image: TextureImage) -> float:
    """About what it takes on a GPU, all channels that it has, with mipmaps."""
    components = (1 if image.grey else 3) + image.has_alpha
    return image.width * image.height * components * (image.bits // 8) * 4 / 3
