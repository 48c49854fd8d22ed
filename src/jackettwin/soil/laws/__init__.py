"""Viscoelastic support laws."""
