// The distance to a collision that does not happen
const float NO_COLLISION = 3e38;
