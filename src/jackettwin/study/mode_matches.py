"""What each identified mode was held against in the model, in numbers and in words."""

from __future__ import annotations

from typing import Any

from jackettwin.findings import Finding
from jackettwin.identification import ModalEstimate
from jackettwin.updating import LEAST_MAC, Counterpart


def unpaired_finding(mode: ModalEstimate, held: Counterpart, labels: tuple[str, ...]) -> Finding | None:
    """Return why an identified mode has no counterpart in the model; None if it has one."""
    if held.verdict == "paired":
        return None
    params: dict[str, Any] = {
        "label": _label(held, labels),
        "model_frequency_hz": held.frequency_hz,
        "difference": held.difference,
        "mac": held.mac,
        "least_mac": LEAST_MAC,
    }
    return Finding(f"unpaired_{held.verdict}", f"{mode.frequency_hz:.3f} Hz", params)


def held_document(mode: ModalEstimate, held: Counterpart, labels: tuple[str, ...]) -> dict[str, Any]:
    """Return what an identified mode was held against as plain JSON data."""
    finding = unpaired_finding(mode, held, labels)
    return {
        "label": _label(held, labels),
        "mode": held.mode + 1,
        "model_frequency_hz": held.frequency_hz,
        "frequency_difference": held.difference,
        "mac": held.mac,
        "verdict": held.verdict,
        "reason": None if finding is None else finding.text,
    }


def _label(held: Counterpart, labels: tuple[str, ...]) -> str:
    """Return the label of the model's mode, or its number where the modes have no labels."""
    return labels[held.mode] if held.mode < len(labels) else f"mode_{held.mode + 1}"
