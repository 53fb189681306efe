// Lamps are seen through rough glass, and through solids that scatter light where they are thin.
#define SEES_LAMPS_THROUGH (HAS_TRANSMISSION && LIGHT_COUNT > 0 && ((SUBSURFACE == 0 && ROUGH_GLASS) || SUBSURFACE & 1))
