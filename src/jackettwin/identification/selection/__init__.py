"""Which poles are modes, and why the others are not."""
