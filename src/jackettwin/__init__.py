"""Digital twin for the jacket foundations of offshore wind turbines.

The names a notebook needs are here; each is loaded when it is first used.
"""

import lazy_loader

from jackettwin.version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
