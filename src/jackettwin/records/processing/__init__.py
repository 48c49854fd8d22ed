"""Processing of records: filters, axes, tones and merging."""
