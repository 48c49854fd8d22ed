"""What runs in worker processes, and the cluster that runs it: plain values in, plain values out.

The server loads the engine when it first needs it: ``workers.engine`` brings all numerics with it.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
