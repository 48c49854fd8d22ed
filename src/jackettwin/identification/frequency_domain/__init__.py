"""Frequency-domain identification methods, for comparison."""
