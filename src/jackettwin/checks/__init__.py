"""Code checks of members and joints to ISO 19902."""
