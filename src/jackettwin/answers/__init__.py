"""Answers of a run: is the model right, what is the ground, whose is the damping, what to do next."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
