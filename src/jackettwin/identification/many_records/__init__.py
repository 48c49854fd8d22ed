"""What several records say together."""
