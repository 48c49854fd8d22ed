"""Hydrodynamic loads on members."""
