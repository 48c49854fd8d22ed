"""The search for every solution."""
