"""The clocks of the loggers behind one record: what they do, how it is found, and how it is taken back.

One word has one meaning throughout:

step
    The time between two samples that follow each other, always the same on a regular grid.
lag
    The difference of two times in a correlation; nobody need be late.
main group
    The largest group of channels that go together. Its clock is taken to be right.
delay
    Seconds by which a channel reads an event later than the main group; negative if earlier.
drift
    Growth of a delay, in seconds a second: a clock that is too slow or too fast.
jump
    A change between two samples: of a delay, of a sensitivity or of a sign.
lost time
    Samples that a logger left out; what came after them is moved up.
strangers
    Channels with nothing in common with the others at any delay: of another time, or stored backwards.
window
    A stretch of the record over which phases between channels are averaged; a series has one value a window.
run
    Windows one after the other between which no series jumps.

``clocks_of`` looks for all of it, ``clock_findings`` says it, ``in_step`` takes it back and ``stretch`` gives
the samples that are left.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
