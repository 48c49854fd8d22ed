"""The motion of an asset through a scenario."""
