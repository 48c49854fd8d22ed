"""Tables, sentences and numbers of the report."""
