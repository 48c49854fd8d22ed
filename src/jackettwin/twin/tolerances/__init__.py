"""Tolerances of drawings, weighing and the sea, in one table."""
