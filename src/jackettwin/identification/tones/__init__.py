"""Tones of machines: found, taken out, and told from modes."""
