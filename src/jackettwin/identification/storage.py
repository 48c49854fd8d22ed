"""Identifications as plain JSON data and back: what a batch keeps of a record and resumes from.

Poles and spectra, which only figures need, are left out: a record takes a few kilobytes.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np

from jackettwin.arrays import ComplexArray
from jackettwin.findings import Finding
from jackettwin.identification.estimate import (
    Identification,
    ModalEstimate,
    RealPole,
    Rejected,
    ResolvedSettings,
    Spectrum,
    Stabilisation,
)
from jackettwin.identification.picks import Pick, plain_picks
from jackettwin.identification.status import ModeStatus
from jackettwin.records import Channel

_ARRAYS = ("log_covariance", "mode_shape_std", "cramer_rao_log_std")


def slim(found: Identification) -> Identification:
    """Return an identification without poles and spectrum."""
    none, no = np.empty(0), np.empty(0, dtype=bool)
    whole = np.empty(0, dtype=np.int64)
    n_channels = len(found.channels)
    shapes = np.empty((0, n_channels), dtype=complex)
    poles = Stabilisation(whole, none, none, shapes, no, no, no, whole)
    spectrum = Spectrum(none, np.empty((n_channels, 0)), np.empty((n_channels, 0)))
    return replace(found, stabilisation=poles, spectrum=spectrum)


def to_plain(found: Identification) -> dict[str, Any]:
    """Return what JSON can hold of an identification; shapes as [real parts, imaginary parts]."""
    return {
        "records": list(found.records),
        "channels": [asdict(channel) for channel in found.channels],
        "modes": [_plain_mode(mode) for mode in found.modes],
        "rejected": [asdict(rejected) for rejected in found.rejected],
        "settings": asdict(found.settings),
        "duration_s": found.duration_s,
        "warnings": list(found.warnings),
        "notes": list(found.notes),
        "picks": plain_picks(found.picks),
        "real_poles": [
            {**vars(pole), "mode_shape": [pole.mode_shape.real.tolist(), pole.mode_shape.imag.tolist()]}
            for pole in found.real_poles
        ],
    }


def from_plain(data: dict[str, Any]) -> Identification:
    """Return the identification without poles and spectrum.

    Raises
    ------
    KeyError, TypeError
        If the data is not of ``to_plain``, of this version.
    """
    settings = data["settings"]
    bare = Identification(
        records=tuple(data["records"]),
        channels=tuple(Channel(**{**c, "direction": tuple(c["direction"])}) for c in data["channels"]),
        modes=tuple(_mode(mode) for mode in data["modes"]),
        rejected=tuple(
            Rejected(**{**rejected, "status": ModeStatus(rejected["status"])})
            for rejected in data["rejected"]
        ),
        stabilisation=None,  # type: ignore[arg-type]
        spectrum=None,  # type: ignore[arg-type]
        settings=ResolvedSettings(**{**settings, "orders": tuple(settings["orders"])}),
        duration_s=data["duration_s"],
        warnings=tuple(data["warnings"]),
        notes=tuple(data["notes"]),
        picks=tuple(Pick(**pick) for pick in data["picks"]),
        real_poles=tuple(
            RealPole(
                **{
                    **pole,
                    "mode_shape": _complex(pole["mode_shape"]),
                    "rate_interval_95": tuple(pole["rate_interval_95"]),
                }
            )
            for pole in data["real_poles"]
        ),
    )
    return slim(bare)


def _plain_mode(mode: ModalEstimate) -> dict[str, Any]:
    plain: dict[str, Any] = {}
    for name, value in vars(mode).items():
        if isinstance(value, ModalEstimate):
            plain[name] = _plain_mode(value)
        elif name == "reasons":
            plain[name] = [asdict(finding) for finding in value]
        elif isinstance(value, np.ndarray):
            plain[name] = [value.real.tolist(), value.imag.tolist()] if _is_shape(name) else value.tolist()
        else:
            plain[name] = value
    return plain


def _mode(plain: dict[str, Any]) -> ModalEstimate:
    values: dict[str, Any] = {}
    for name, value in plain.items():
        if value is None:
            values[name] = None
        elif isinstance(value, dict):
            values[name] = _mode(value)
        elif name == "reasons":
            values[name] = tuple(Finding(**finding) for finding in value)
        elif name == "status":
            values[name] = ModeStatus(value)
        elif _is_shape(name):
            values[name] = _complex(value)
        elif name in _ARRAYS:
            values[name] = np.array(value, dtype=float)
        else:
            values[name] = tuple(value) if isinstance(value, list) else value
    return ModalEstimate(**values)


def _is_shape(name: str) -> bool:
    return name in ("mode_shape", "mode_shape_unaligned")


def _complex(parts: list[list[float]]) -> ComplexArray:
    return np.array(parts[0]) + 1j * np.array(parts[1])
