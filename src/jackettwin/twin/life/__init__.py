"""Damage at the welds of a structure from one record's motion, and its exact sums."""
