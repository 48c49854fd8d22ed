"""Digital twin for the jacket foundations of offshore wind turbines."""

__version__ = "0.1.0"
