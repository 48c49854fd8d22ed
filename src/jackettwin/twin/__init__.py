"""The living model: the main job, from a twin file to a result."""
