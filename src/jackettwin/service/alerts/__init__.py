"""Alerts about findings: rules, channels, and the outbox."""
