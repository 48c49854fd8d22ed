"""Measured records, their quality and their preparation.

These are the names most used. Further filters are in ``prepare``, SEP005 dictionaries in ``readers``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
