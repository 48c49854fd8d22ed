"""What is wrong with a record, and what can be repaired."""
