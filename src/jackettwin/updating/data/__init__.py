"""Data that the model is updated to."""
