"""Change of a structure: causes as directions, and monitoring of tables of modes and of a twin's state."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
