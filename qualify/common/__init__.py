"""What the scripts beside share."""
