"""Free decays: where they are in a record, and their modes."""
