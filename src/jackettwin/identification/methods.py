"""Registry of identification methods, to which installed packages add theirs.

A method is a function from a prepared record and the settings to the poles of every model order:
a ``PoleMethod``. Settings, command line, comparison and report read this registry.
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
"""Entry point of each method's function, loaded on first use."""
POLELESS: Mapping[str, str] = {
    "efdd": "jackettwin.identification.frequency_domain.fdd:fdd",
    "bayoma": "jackettwin.identification.frequency_domain.bayoma:bayoma",
}
"""Methods without poles, which take modes from spectral peaks: entry point of a function from a record and
settings to its identification."""
PLUGINS = "jackettwin.identification_methods"
"""Group of entry points for further methods, each a function like those of ``POLE_METHODS``."""


def method_names() -> tuple[str, ...]:
    """Return the names of all methods: built-in ones, then those of installed packages."""
    own = (*POLE_METHODS, *POLELESS)
    return (*own, *(name for name in plugins(PLUGINS) if name not in own))


def is_method(name: str) -> bool:
    """Return whether a method has this name, without loading plugins for a built-in one."""
    return name in POLE_METHODS or name in method_names()
