"""Reading and writing: YAML, JSON, whole files or nothing."""
