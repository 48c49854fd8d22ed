"""What the environment does."""
