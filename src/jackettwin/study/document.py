"""A run's result as plain JSON data: the keys users script against."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jackettwin.arrays import FloatArray
from jackettwin.caveats import assumption_documents
from jackettwin.files import named
from jackettwin.identification import Comparison, identification_document
from jackettwin.identification.document import mode_document, shape_document
from jackettwin.intervals import interval_90
from jackettwin.soil import SERIES, members
from jackettwin.study.measurements import MeasuredMode, MeasuredRelaxation
from jackettwin.study.result import TwinResult, held_document
from jackettwin.study.scrutiny import scrutiny_document
from jackettwin.study.truth import truth_document
from jackettwin.twin import Observation
from jackettwin.updating import (
    SOURCES,
    Uncertainty,
    Update,
    beyond_literature,
    law_probability,
    leg_scatter,
    ranked,
)
from jackettwin.version import __version__

MODAL = "frequency_hz", "frequency_std_hz", "damping_ratio", "damping_ratio_std"
"""Numbers that measured and fused modes both have."""


def run_document(result: TwinResult, *, report: str | None) -> dict[str, Any]:
    """Return the document of ``jackettwin run``."""
    return {
        "name": result.name,
        "modes": [_measured(m) for m in result.measured],
        "real_poles": [_relaxation(r) for r in result.relaxations],
        "updates": [update_document(result, i) for i in range(len(result.updates))],
        "law_probability": law_probability(result.updates),
        "law_ranking": ranking_document(result.updates),
        "identification": [
            _recognised(seen, result.labels, None if i or result.shown is None else result.shown.comparison)
            for i, seen in enumerate(result.observations)
        ],
        "unpaired_modes": [
            mode_document(e, None) | {"held_against": held_document(e, held, result.labels)}
            for e, held in result.unpaired
        ],
        "assumptions": assumption_documents(result.assumptions),
        "warnings": list(result.warnings),
        "truth": truth_document(result),
        "report": report,
        "code_version": __version__,
    }


def _recognised(seen: Observation, labels: tuple[str, ...], compared: Comparison | None) -> dict[str, Any]:
    """Return a record's document with each mode's label and the model's mode it was compared with."""
    document = identification_document(seen.identification, seen.quality, seen.conditions, compared)
    modes = zip(document["modes"], seen.identification.modes, seen.labels, seen.held, strict=True)
    for plain, mode, label, held in modes:
        plain["label"] = label or None
        plain["held_against"] = held_document(mode, held, labels)
    return document


def ranking_document(updates: Sequence[Update]) -> list[dict[str, Any]]:
    """Return the laws by cost, best first."""
    names = ("place", "law", "parameters", "cost", "solutions")
    return [{**named(r, *names), "locked_damper": r.locked} for r in ranked(updates)]


def series_sentence(result: TwinResult) -> str | None:
    """Return the number of branches of a Prony series without a given one, and why; else None."""
    return next((one.value for one in result.assumptions if one.key == SERIES), None)


def update_document(result: TwinResult, index: int) -> dict[str, Any]:
    """Return the document of one law of ``jackettwin update``."""
    u = result.updates[index]
    names = [p.name for p in u.problem.parameters]
    known = u.uncertainty
    return {
        "law": u.law,
        "series": series_sentence(result) if u.law in members([SERIES]) else None,
        "parameters": _parameters(u),
        "modes": _compared(result.measured, u),
        "real_poles": _compared_relaxations(result.relaxations, u),
        "solutions": [
            {
                "parameters": dict(zip(names, map(float, s.theta), strict=True)),
                **named(s, "cost", "locked_damper", "at_bound", "frequency_hz", "damping_ratio"),
                "locks_within_extent": s.locks_within,
                "modes": list(u.problem.states[0].residuals.modes),
                "undamped_frequency_hz": s.undamped_hz,
                "real_pole_rate_rad_s": s.rates,
                "starts_that_ended_here": s.found,
                "extent": dict(zip(names, s.extent.tolist(), strict=True)),
            }
            for s in u.solutions
        ],
        "completeness": {
            **named(u.search, "statement", "starts", "missed_share_95"),
            "settled": u.search.spent is None,
        },
        "begun": [
            {
                "from": dict(zip(names, b.start.tolist(), strict=True)),
                "to": dict(zip(names, b.end.tolist(), strict=True)),
                **named(b, "cost", "settled"),
            }
            for b in u.search.begun
        ],
        "identifiability": dict.fromkeys(names)
        if known is None
        else {v.name: v.verdict for v in known.verdicts},
        "log_evidence": _log_evidence(known),
        **({} if known is None else _uncertainty(u, known)),
        "damping_budget": _budget(result.measured, u),
        "real_poles_rad_s": u.modes.damped.real_poles,
        "reference_frequency_hz": u.model.reference_hz,
        "model_error": scrutiny_document(result.scrutiny[index], names) if result.scrutiny else None,
        "unexplained_damping": [
            {
                **named(e, "label", "excess", "explained"),
                "measured_damping_ratio": e.measured,
                "measured_damping_ratio_std": e.measured_std,
                "support_damping_ratio": e.support,
                "rotor_damping_ratio": e.rotor,
                "carried_by": "rotor" if e.carried else None,
            }
            for e in result.excess[index]
        ],
    }


def _measured(m: MeasuredMode) -> dict[str, Any]:
    values = named(m, "mode", "label", *MODAL, "mac", "fits_frequency", "fits_damping")
    return {**values, "frequency_damping_correlation": m.correlation}


def _relaxation(r: MeasuredRelaxation) -> dict[str, Any]:
    return {
        **named(r, "name", "rate_rad_s", "rate_std_rad_s", "records"),
        "time_constant_s": 1.0 / r.rate_rad_s,
        "mode_shape": shape_document(r.shape, list(r.channels)) or None,
    }


def _compared_relaxations(measured: tuple[MeasuredRelaxation, ...], u: Update) -> list[dict[str, Any]]:
    """Return each measured real pole with the model's nearest at the best fit and in the posterior."""
    known = u.uncertainty
    return [
        {
            "name": r.name,
            "measured_rate_rad_s": r.rate_rad_s,
            "measured_rate_std_rad_s": r.rate_std_rad_s,
            "rate_rad_s": float(rate),
            "posterior": None if known is None else _quantiles(known.predictive.rates[r.name]),
        }
        for r, rate in zip(measured, u.best.rates, strict=True)
    ]


def _parameters(u: Update) -> dict[str, dict[str, Any]]:
    """Return the estimate of each parameter: its median, or its best fit where there is no posterior."""
    known = u.uncertainty
    best = [float(value) for value in u.best.theta]
    middle = best if known is None else [float(value) for value in known.median]
    return {
        p.name: {
            "value": middle[i],
            "std": None if known is None else float(middle[i] * known.log_std[i]),
            "interval_90": None if known is None else known.interval_90[i].tolist(),
            "median": None if known is None else middle[i],
            "best_fit": best[i],
            "log_std": None if known is None else float(known.log_std[i]),
            "laplace_log_std": None if known is None else float(known.laplace_log_std[i]),
            "prior_log_std": float(u.problem.prior.std[i]),
            "bounds": [p.low, p.high],
            "unit": p.unit,
        }
        for i, p in enumerate(u.problem.parameters)
    }


def _log_evidence(known: Uncertainty | None) -> float | None:
    """Return ln Z, None if the posterior's runs do not agree on it."""
    posterior = None if known is None else known.posterior
    return posterior.log_evidence if posterior is not None and posterior.evidence_known else None


def _uncertainty(u: Update, known: Uncertainty) -> dict[str, Any]:
    """Return the results of the posterior other than the parameters."""
    posterior, q = known.posterior, known.predictive
    names = [p.name for p in u.problem.parameters]
    return {
        "log_evidence_std": None if posterior is None else posterior.log_evidence_std,
        "posterior": {
            "status": known.status,
            "intervals_from": "laplace" if posterior is None else "posterior",
            "draws": len(known.log_theta),
            "rhat": None if posterior is None else _named(names, posterior.convergence.rhat),
            "ess_bulk": None if posterior is None else _named(names, posterior.convergence.ess_bulk),
            "ess_tail": None if posterior is None else _named(names, posterior.convergence.ess_tail),
        },
        "identifiability_detail": {
            v.name: {
                **named(v, "verdict", "decided_by", "interval_factor", "reason"),
                "posterior_over_prior_std": v.ratio,
                "before": v.verdict_before,
                "expected_posterior_over_prior_std": v.ratio_before,
            }
            for v in known.verdicts
        },
        "predictions": [
            {
                "mode": mode,
                "frequency_hz": _quantiles(q.frequency_hz[:, i]),
                "undamped_frequency_hz": _quantiles(q.undamped_hz[:, i]),
                "damping_ratio": _quantiles(q.damping_ratio[:, i]),
            }
            for i, mode in enumerate(q.modes)
        ],
        "support": {name: _quantiles(values) for name, values in q.support.items()},
        "leg_scatter": {
            s.name: {**_quantiles(s.draws), "prior_interval_90": list(s.before)}
            for s in leg_scatter(u.problem.prior, known.log_theta)
        },
        "profile_likelihood": {p.name: named(p, "values", "cost") for p in known.profiles},
    }


def _named(names: list[str], values: FloatArray) -> dict[str, float]:
    return dict(zip(names, values.tolist(), strict=True))


def _quantiles(draws: FloatArray) -> dict[str, Any]:
    """Return median and 90 % interval, null where no draw has the mode."""
    low, middle, high = interval_90(draws) or (None, None, None)
    return {"median": middle, "interval_90": None if middle is None else [low, high]}


def _budget(measured: tuple[MeasuredMode, ...], u: Update) -> list[dict[str, Any]]:
    """Return each mode's damping ratio by source; without a model of drag the water's part is null.

    Shares are of the measured damping ratio; of the model's where none was measured.
    """
    b = u.budget
    whole = [
        float(b.damping_ratio[i].sum()) if m.damping_ratio is None else m.damping_ratio
        for i, m in enumerate(measured)
    ]

    def by_source(values: FloatArray | None, i: int) -> dict[str, Any] | None:
        if values is None:
            return None
        return dict.fromkeys(SOURCES) | dict(zip(SOURCES, values[i].tolist(), strict=False))

    return [
        {
            "label": m.label,
            "damping_ratio": by_source(b.damping_ratio, i),
            "damping_ratio_interval_90": by_source(b.damping_ratio_interval_90, i),
            "beyond_literature": beyond_literature(
                m.label, dict(zip(SOURCES, map(float, b.damping_ratio[i]), strict=False))
            ),
            "share": by_source(b.damping_ratio / whole[i], i),
            "share_interval_90": by_source(
                None if b.damping_ratio_interval_90 is None else b.damping_ratio_interval_90 / whole[i], i
            ),
            "share_of": "model" if m.damping_ratio is None else "measured",
        }
        for i, m in enumerate(measured)
    ]


def _compared(measured: tuple[MeasuredMode, ...], u: Update) -> list[dict[str, Any]]:
    return [
        {
            "mode": m.mode,
            "label": m.label,
            "measured_frequency_hz": m.frequency_hz,
            "frequency_hz": float(f),
            "undamped_frequency_hz": float(undamped),
            "measured_damping_ratio": m.damping_ratio,
            "damping_ratio": float(zeta),
        }
        for m, f, undamped, zeta in zip(
            measured, u.central_hz, u.central_undamped_hz, u.central_damping, strict=True
        )
    ]
