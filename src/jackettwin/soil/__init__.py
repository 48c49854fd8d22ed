"""Supports: what the ground does to the structure."""
