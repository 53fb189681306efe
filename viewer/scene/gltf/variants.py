"""KHR_materials_variants: the names of the variants, and the material that a primitive has in each."""

from __future__ import annotations

from .element import Element

VARIANTS = "KHR_materials_variants"
MAX_VARIANTS = 1024


def unique_names(extension: Element) -> list[str]:
    """The variants' names. A name that is empty or was there before gets its number behind it."""
    names: list[str] = []
    items = extension.array("variants")
    if len(items) > MAX_VARIANTS:
        raise extension.error(f"{len(items)} variants; the limit is {MAX_VARIANTS}", "variants")
    for number, variant in enumerate(items):
        name = variant.string("name")
        if not name or name in names:
            name = f"{name} {number}".strip()
            variant.warn(f"is empty or was there before; {name!r} is used", "name")
        names.append(name)
    return names


def material_choice(primitive: Element, materials: int, variants: int) -> tuple[int, ...]:
    """The numbers of the materials of a primitive, -1 for the default one: its own, and that in each variant.

    `materials` and `variants` are how many the file has. Raises InputError for others.
    """
    given: int | None = primitive.index("material", materials, None)
    own = -1 if given is None else given
    choice: list[int | None] = [None] * variants
    extension = primitive.extension(VARIANTS)
    for mapping in extension.array("mappings") if extension is not None else []:
        material = mapping.index("material", materials)
        for number in mapping.indices("variants", variants):
            if choice[number] is None:
                choice[number] = material
            else:
                mapping.warn(f"variant {number} has a material already", "variants")
    return own, *(own if material is None else material for material in choice)
