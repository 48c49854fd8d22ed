"""The staged update of the steel (thesis section 5.4)."""
