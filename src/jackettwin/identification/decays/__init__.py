"""Free decays: found in a record, and identified as what they are."""
