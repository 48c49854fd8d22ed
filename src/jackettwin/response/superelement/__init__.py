"""A foundation as a superelement, and its files."""
