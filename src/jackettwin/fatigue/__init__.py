"""Fatigue: cycles, S-N curves, stress concentration at tubular joints, damage and life."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
