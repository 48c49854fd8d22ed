"""What drawings, weighing and the sea leave open, and by how much: the one table of it."""
