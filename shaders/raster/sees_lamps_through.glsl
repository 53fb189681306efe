// Lamps are seen through solids that scatter light, where they are thin.
#define SEES_LAMPS_THROUGH (SUBSURFACE != 0 && SUBSURFACE != 2 && HAS_TRANSMISSION && LIGHT_COUNT > 0)
