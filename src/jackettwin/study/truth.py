"""Comparison of a run with the true values, which simulated records state."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from jackettwin.errors import InputError
from jackettwin.study.result import TwinResult


@dataclass(frozen=True)
class StatedMode:
    """The true mode, as the mean over records; its damping by source if they state that."""

    label: str
    frequency_hz: float
    damping_ratio: float
    damping_by_source: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class TrueParameter:
    """The true value of a support's parameter, and its estimate by an update."""

    law: str
    name: str
    true: float
    value: float
    interval_90: tuple[float, float] | None
    unit: str = "-"

    @property
    def covered(self) -> bool | None:
        """Whether the 90 % interval contains the true value; None without an interval."""
        if self.interval_90 is None:
            return None
        low, high = self.interval_90
        return low <= self.true <= high


def true_modes(result: TwinResult) -> tuple[StatedMode, ...]:
    """Return the true values of the measured modes, averaged over all records that state them."""
    stated: dict[str, list[dict[str, Any]]] = {}
    for seen in result.observations:
        for mode in seen.truth.get("true_modes") or []:
            stated.setdefault(mode["label"], []).append(mode)
    return tuple(_mean(m.label, stated[m.label]) for m in result.measured if m.label in stated)


def _mean(label: str, modes: list[dict[str, Any]]) -> StatedMode:
    sources = modes[0].get("damping_by_source") or {}
    return StatedMode(
        label,
        float(np.mean([m["frequency_hz"] for m in modes])),
        float(np.mean([m["damping_ratio"] for m in modes])),
        {s: float(np.mean([m["damping_by_source"][s] for m in modes])) for s in sources},
    )


def true_parameters(result: TwinResult) -> tuple[TrueParameter, ...]:
    """Return the support's true parameters with their estimates under the same law.

    Only supports given as a short form, ``kelvin-voigt:k=…,c=…``, have parameters to compare.
    """
    texts = {seen.truth.get("true_support") for seen in result.observations} - {None}
    if len(texts) != 1:
        return ()
    law, _, arguments = str(texts.pop()).partition(":")
    true = _numbers(arguments)
    found = []
    for update in result.updates:
        if update.law != law:
            continue
        known = update.uncertainty
        for i, (parameter, value) in enumerate(
            zip(update.problem.parameters, update.best.theta, strict=True)
        ):
            low_high = None if known is None else known.interval_90[i]
            interval = None if low_high is None else (float(low_high[0]), float(low_high[1]))
            value = value if known is None else known.median[i]
            if parameter.name in true:
                found.append(
                    TrueParameter(
                        law, parameter.name, true[parameter.name], float(value), interval, parameter.unit
                    )
                )
    return tuple(found)


def truth_document(result: TwinResult) -> dict[str, Any] | None:
    """Return the comparison as plain data; None without true values."""
    modes = true_modes(result)
    if not modes:
        return None
    return {
        "modes": [asdict(m) | {"damping_by_source": m.damping_by_source or None} for m in modes],
        "parameters": [asdict(p) | {"covered": p.covered} for p in true_parameters(result)],
    }


def _numbers(arguments: str) -> dict[str, float]:
    pairs = [part.partition("=") for part in arguments.split(",") if part]
    try:
        return {key: float(value) for key, _, value in pairs}
    except ValueError:
        raise InputError("true_support is not a short form", field="true_support", value=arguments) from None
