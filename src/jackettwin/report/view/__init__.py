"""A structure to turn, colour and set in motion."""
