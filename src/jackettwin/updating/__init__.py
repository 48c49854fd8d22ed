"""Modes to parameters, with uncertainty."""
