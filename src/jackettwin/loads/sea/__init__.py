"""Waves, current and the sea during a record."""
