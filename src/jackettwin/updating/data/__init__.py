"""What the model is updated to."""
