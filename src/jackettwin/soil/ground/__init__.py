"""Layered ground and its reaction curves."""
