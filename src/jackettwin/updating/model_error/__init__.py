"""Errors of the model: tolerances of drawings and sea, common to all modes, and a remainder."""
