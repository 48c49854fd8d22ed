"""Schemas of requests and responses of the API, by subject."""
