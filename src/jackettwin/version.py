"""The version, for results that state what made them."""

__version__ = "0.1.0"
