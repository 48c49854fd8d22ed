"""What the data leave open."""
