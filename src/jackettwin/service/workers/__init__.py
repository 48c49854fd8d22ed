"""Tasks of worker processes, with plain values as inputs and outputs, and the cluster that runs them.

The server loads the engine when it first needs it: ``workers.engine`` brings all numerics with it.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
