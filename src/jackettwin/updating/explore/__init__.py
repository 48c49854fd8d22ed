"""What a law's parameters do to cost and modes, and which way a search took."""
