"""What workers and the server do with records."""
