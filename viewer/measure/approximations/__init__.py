"""What the renderer approximates, piece by piece: the error and the cost of each way to do it."""
