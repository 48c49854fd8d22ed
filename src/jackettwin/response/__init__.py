"""What the structure does."""
