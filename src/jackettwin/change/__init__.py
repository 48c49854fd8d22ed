"""What changed: its causes as directions, tables of modes and days of a state watched through time."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
