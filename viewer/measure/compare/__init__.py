"""How far apart two pictures are, and golden images."""
