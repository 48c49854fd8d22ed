"""Watching: has a structure changed, since when, by how much and why; of any structure, on arrays."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
