"""Quality of a record: faults and their repair."""
