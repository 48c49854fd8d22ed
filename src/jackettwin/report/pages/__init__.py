"""Pages, each one self-contained file."""
