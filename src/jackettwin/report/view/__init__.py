"""Interactive, animated view of a structure."""
