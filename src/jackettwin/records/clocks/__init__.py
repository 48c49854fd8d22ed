"""Clock errors of the loggers of one record: their detection, correction and findings.

Terms:

step
    Time between successive samples, constant on a regular grid.
lag
    Time shift in a correlation; it does not imply a clock error.
main group
    Largest group of channels with a common clock, which is taken as correct.
delay
    Seconds by which a channel records an event later than the main group; negative if earlier.
drift
    Rate of change of a delay [s/s], of a clock that runs slow or fast.
jump
    Change of a delay, sensitivity or sign between two samples.
lost time
    Samples that a logger omitted, so that later ones are shifted.
strangers
    Channels without coherence with the others at any delay: of another time, or stored backwards.
window
    Part of the record over which phases between channels are averaged; a series has one value per window.
run
    Successive windows between which no series jumps.

``clocks_of`` detects all of these, ``clock_findings`` reports them,
``in_step`` corrects them and ``stretch`` gives the samples that remain.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
