"""What was measured: records, their quality and their preparation.

The names here are the daily ones. Other filters are in ``prepare``, SEP005 dictionaries in ``readers``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
