"""A published number beside ours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Row:
    """One published number, recomputed.

    Attributes
    ----------
    tolerance : float or None
        Largest allowed relative error; for ``kind="at most"`` the bound itself is ``published``. None marks a
        row that informs only: it needs drawings or data that were not published.
    kind : {"equal", "at most"}
        ``at most`` rows hold a figure that must not exceed the published one (an error of a fit).
    note : str
        Why a row informs only, or which misprint is corrected.
    """

    id: str
    source: str
    quantity: str
    published: float
    computed: float | None
    tolerance: float | None
    kind: Literal["equal", "at most"] = "equal"
    note: str = ""

    @property
    def relative_error(self) -> float | None:
        """computed/published − 1; None where it makes no sense."""
        if self.computed is None or self.kind == "at most" or self.published == 0.0:
            return None
        return self.computed / self.published - 1.0

    @property
    def ok(self) -> bool | None:
        """Whether the row holds; None if it informs only."""
        if self.tolerance is None:
            return None
        if self.computed is None:
            return False
        if self.kind == "at most":
            return bool(self.computed <= self.published * (1.0 + self.tolerance))
        error = self.relative_error
        return error is not None and bool(abs(error) <= self.tolerance)

    def document(self) -> dict[str, Any]:
        """Return the row as JSON data."""
        return {
            "id": self.id,
            "source": self.source,
            "quantity": self.quantity,
            "published": self.published,
            "computed": self.computed,
            "relative_error": self.relative_error,
            "tolerance": self.tolerance,
            "ok": self.ok,
            "kind": self.kind,
            "note": self.note,
        }


def rounded(value: float, digits: int) -> float:
    """Return the largest relative error that printing ``value`` with ``digits`` decimals can make."""
    return 0.5 * 10.0**-digits / abs(value) * 1.001
