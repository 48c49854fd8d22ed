"""Structures from files: our YAML, SubDyn, SACS, and blades from windIO and ElastoDyn."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
