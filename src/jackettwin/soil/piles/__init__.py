"""Piles: head stiffness, capacity, damping."""
