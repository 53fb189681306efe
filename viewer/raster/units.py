"""The texture units of the programs."""

# The maps that a program samples have the first ones. The units from 16 on are for textures that all programs share. A
# program has at most 16 samplers, but may use any of the 48 units that OpenGL 3.3 guarantees.
(UNIT_DFG, UNIT_PREFILTERED, UNIT_IRRADIANCE, UNIT_SHADOW, UNIT_BACKGROUND, UNIT_RADIANCE, UNIT_VISIBILITY,
 UNIT_REFLECTED, UNIT_RAY_POSITIONS, UNIT_REFRACTED, UNIT_MIRRORED, UNIT_PATH_POSITIONS, UNIT_MEDIA,
 UNIT_MEDIA_LIGHT, UNIT_VOLUME_DEPTH) = range(16, 31)
(UNIT_SUBSURFACE, UNIT_SUBSURFACE_POSITIONS, UNIT_WEAVE, UNIT_CHOSEN, UNIT_GEOMETRY,
 UNIT_NORMAL_ROOT, UNIT_SEEN_POSITIONS) = range(32, 39)  # moderngl makes textures with the last of 32
# Of the passes of media, which have no maps
(UNIT_DENSITIES, UNIT_SKY_IN_FOG, UNIT_SKY_IN_VOLUMES, UNIT_SKY_SHADOWS, UNIT_CARRIED, UNIT_DEPTHS,
 UNIT_PATCHES) = range(7)
