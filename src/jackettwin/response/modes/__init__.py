"""Modes and poles of the whole model, their names and their shapes."""
