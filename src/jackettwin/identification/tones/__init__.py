"""Tones of machines: how they are found, subtracted and told from modes."""
