"""The stiffness of the ground through time."""
