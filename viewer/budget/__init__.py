"""Making the best picture in a time, or one of a given error in little time."""
