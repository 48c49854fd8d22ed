"""Records to modes."""
