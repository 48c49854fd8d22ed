"""The identification methods: one table, to which installed packages add theirs.

A method is a function from a prepared record and the settings to the poles of every model order: a
``PoleMethod``. Settings, command line, comparison and report know all methods that stand here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jackettwin.plugins import plugins

if TYPE_CHECKING:
    from collections.abc import Mapping

POLE_METHODS: Mapping[str, str] = {
    "ssi-cov": "jackettwin.identification.pole_methods:by_ssi_cov",
    "ssi-dat": "jackettwin.identification.pole_methods:by_ssi_dat",
    "plscf": "jackettwin.identification.pole_methods:by_plscf",
}
"""Where the function of each method stands, as an entry point says it: it is loaded when it is used."""
EFDD = "efdd"
"""The method without poles: it reads modes off peaks of the spectrum (``frequency_domain/fdd.py``)."""
PLUGINS = "jackettwin.identification_methods"
"""Group of entry points, each a function like those of ``POLE_METHODS``, by the name of the method."""


def method_names() -> tuple[str, ...]:
    """Return the names of all methods: ours, then those that installed packages bring."""
    return (*POLE_METHODS, EFDD, *(name for name in plugins(PLUGINS) if name not in (*POLE_METHODS, EFDD)))


def is_method(name: str) -> bool:
    """Tell whether a method has this name; of our own, without looking for plugins."""
    return name in POLE_METHODS or name in method_names()
