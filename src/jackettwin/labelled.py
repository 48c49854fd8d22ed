"""Results as pandas, xarray and ArviZ hold them, for those who plot and tabulate with these."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.errors import MissingExtra

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from jackettwin.records import Record
    from jackettwin.study import TwinResult
    from jackettwin.twin import Observation, TwinState
    from jackettwin.updating import Posterior


def to_arviz(posterior: Posterior) -> Any:
    """Return a posterior as ArviZ takes it: an ``xarray.DataTree`` of the parameters by chain and draw.

    Raises
    ------
    MissingExtra
        If ArviZ is not installed.
    """
    chains = posterior.log_theta.reshape(posterior.runs, -1, len(posterior.names))
    log_l = posterior.log_likelihood.reshape(posterior.runs, -1)
    values = {name: np.exp(chains[..., i]) for i, name in enumerate(posterior.names)}
    return _library("arviz_base").from_dict({"posterior": values, "sample_stats": {"lp": log_l}})


def to_dataframe(result: TwinResult | Posterior | Observation | TwinState) -> pd.DataFrame:
    """Return a table: a run's modes, a posterior's draws, an observation's modes, a state's by day.

    Raises
    ------
    MissingExtra
        If pandas is not installed.
    """
    from jackettwin.study import TwinResult
    from jackettwin.twin import Observation
    from jackettwin.updating import Posterior

    frame: Any = _library("pandas").DataFrame
    if isinstance(result, Posterior):
        table: pd.DataFrame = frame(np.exp(result.log_theta), columns=list(result.names))
        return table
    if isinstance(result, TwinResult):
        run: pd.DataFrame = frame(_compared(result))
        return run
    rows = _modes(result) if isinstance(result, Observation) else _days(result)
    modes: pd.DataFrame = frame(rows)
    return modes


def to_xarray(record: Record) -> xr.DataArray:
    """Return a record as an array by channel and time [s], or UTC where the start is known.

    Raises
    ------
    MissingExtra
        If xarray is not installed.
    """
    seconds = np.arange(record.data.shape[1]) / record.sample_rate_hz
    time: Any = seconds
    if record.start_utc is not None:
        start = np.datetime64(record.start_utc.replace(tzinfo=None) - record.start_utc.utcoffset(), "ns")  # type: ignore[operator]
        time = start + np.round(seconds * 1e9).astype("timedelta64[ns]")
    array: xr.DataArray = _library("xarray").DataArray(
        record.data,
        dims=("channel", "time"),
        coords={
            "channel": list(record.channel_names),
            "time": time,
            "unit": ("channel", [c.unit for c in record.channels]),
        },
        name=record.name,
        attrs={"sample_rate_hz": record.sample_rate_hz, **record.conditions},
    )
    return array


def _compared(result: TwinResult) -> list[dict[str, Any]]:
    """Return every measured mode, and what each law makes of it."""
    rows = []
    for i, m in enumerate(result.measured):
        row: dict[str, Any] = {
            "label": m.label,
            "frequency_hz": m.frequency_hz,
            "frequency_std_hz": m.frequency_std_hz,
            "damping_ratio": m.damping_ratio,
            "damping_ratio_std": m.damping_ratio_std,
        }
        for u in result.updates:
            row[f"frequency_hz {u.law}"] = float(u.modes.frequency_hz[i])
            row[f"damping_ratio {u.law}"] = float(u.modes.damping_ratio[i])
        rows.append(row)
    return rows


def _modes(seen: Observation) -> list[dict[str, Any]]:
    return [
        {
            "record_id": seen.record_id,
            "time_utc": seen.start_utc,
            "label": None if known is None else known.label,
            "frequency_hz": mode.frequency_hz,
            "frequency_std_hz": mode.frequency_std_hz,
            "damping_ratio": mode.damping_ratio,
            "damping_ratio_std": mode.damping_ratio_std,
            "status": mode.status.value,
        }
        for mode, known in zip(seen.identification.modes, seen.recognised, strict=True)
    ]


def _days(state: TwinState) -> list[dict[str, Any]]:
    from jackettwin.twin import ALL, average
    from jackettwin.twin.state import day_totals

    rows = []
    for day in state.days.values():
        for mode, total in day_totals(day)[ALL].modes.items():
            mean = average(total)
            rows.append(
                {
                    "time_utc": day.time_utc,
                    "mode": mode,
                    "records": total.sums.n,
                    "frequency_hz": mean.frequency_hz,
                    "frequency_std_hz": mean.frequency_hz * mean.log_std[0],
                    "damping_ratio": mean.damping_ratio,
                    "damping_ratio_std": mean.damping_ratio * mean.log_std[1],
                }
            )
    return rows


def _library(name: str) -> Any:
    """Return an optional library.

    Raises
    ------
    MissingExtra
        If it is not installed.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError:
        raise MissingExtra(f"{name} is not installed", remedy='pip install "jackettwin[labels]"') from None
