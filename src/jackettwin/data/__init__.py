"""Data that ships with the package: structures, records, twins."""
