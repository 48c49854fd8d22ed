"""The structure condensed to its supports, and its poles."""
