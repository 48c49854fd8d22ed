"""Filters, axes, tones and merging: a record in, a record out."""
