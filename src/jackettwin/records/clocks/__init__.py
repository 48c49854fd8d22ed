"""Clocks of loggers: time grids, delays between channels, lost time."""
