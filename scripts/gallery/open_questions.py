"""What the thesis leaves open, answered beside its own figures."""

from __future__ import annotations

from jackettwin.report import Table, Text
from jackettwin.report.pages.page import PageSection
from jackettwin.report.tables.numbers import percent, scientific
from jackettwin.updating import Update
from jackettwin.verify import supports
from jackettwin.verify.open_questions import ZETA_4, fit, ways

_WISHES = (
    (
        "ω_min of the steel and c together, for the damping of several modes",
        "Kelvin–Voigt meets ζ₁ and ζ₄ at once, f within 0.2 %",
        "update: {steel_damping: free}",
    ),
    (
        "a Prony model, regularised",
        "free branches, their number chosen by evidence; lognormal priors regularise any law",
        "jackettwin update TWIN --law prony-2",
    ),
    (
        "data of a real jacket",
        "none are public; towers and bridges are identified and watched instead",
        "docs/verification/real_records.md",
    ),
    (
        "real poles from data, as targets",
        "found with their rates where they can be seen, and updated to",
        "jackettwin identify RECORD --real-poles; targets: [{rate_rad_s: …}]",
    ),
)


def open_questions() -> PageSection:
    """Return the section on chapters 8 and 10."""
    return PageSection(
        "Chapter 10: what was left open",
        (
            Text(
                (
                    "Several optima? The search finds one minimum for each law, and Zener's is "
                    "Kelvin–Voigt's. From every point of the thesis a search goes on to it: point 2 of "
                    "Kelvin–Voigt lies on the plateau of rigid feet, Zener's two in a flat valley. "
                    "Zener's point 1 is no minimum of the cost (8.4); its k₀ is where a Kelvin–Voigt fit to "
                    "ζ₄ as well ends.",
                )
            ),
            _ways(),
            _laws(),
            Table(
                "What has each wish of chapter 10 become?",
                ("wish", "answer", "where"),
                _WISHES,
                text_columns=3,
            ),
        ),
    )


def _laws() -> Table:
    cases: list[tuple[str, str, Update]] = [
        (law, "f₁, f₂, f₄, ζ₁", fit(law, zeta_4=False))
        for law in ("kelvin-voigt", "zener", "maxwell-3", "springpot")
    ]
    cases += [(law, "and ζ₄", fit(law, zeta_4=True)) for law in ("kelvin-voigt", "zener", "maxwell-3")]
    cases.append(("kelvin-voigt, free steel", "and ζ₄", fit("kelvin-voigt", zeta_4=True, free_steel=True)))
    rows = []
    for law, targets, found in cases:
        f = zip(found.modes.frequency_hz, supports.T6_1, strict=True)
        errors = (percent(float(ours) / theirs - 1.0) for ours, (_, theirs, _) in f)
        zeta = (percent(float(found.modes.damping_ratio[i]), decimals=3) for i in (0, 2))
        parameters = zip(found.problem.parameters, found.best.theta, strict=True)
        rows.append(
            (
                law,
                targets,
                *errors,
                *zeta,
                ", ".join(f"{p.name} {scientific(float(v))}" for p, v in parameters),
            )
        )
    caption = (
        "Which law meets the damping of mode 4? Blind in the first four rows; measured "
        f"ζ₁ 1.27 % and ζ₄ {percent(ZETA_4)} %. The thesis's Kelvin–Voigt gives ζ₄ 4.24 %, its Zener 3.47 or "
        "2.76 % by its two points."
    )
    heads = (
        "law",
        "fitted to",
        "f₁ error [%]",
        "f₂ error [%]",
        "f₄ error [%]",
        "ζ₁ [%]",
        "ζ₄ [%]",
        "parameters",
    )
    return Table(caption, heads, tuple(rows), text_columns=2)


def _ways() -> Table:
    names = {
        "kelvin-voigt": ("Table 8.1, point 1", "Table 8.3, point 2"),
        "zener": ("Table 8.4, point 1", "Table 8.4, point 2"),
    }
    rows = []
    for law, own in names.items():
        gradient, simplex = ways(law, "least-squares"), ways(law, "nelder-mead")
        for name, ours, theirs in zip(own, gradient, simplex, strict=False):
            rows.append(
                (
                    law,
                    name,
                    f"{ours.cost[0]:.3g}",
                    f"{ours.end_cost:.3g}",
                    f"{theirs.end_cost:.3g}",
                    theirs.fate,
                )
            )
        scattered = simplex[len(own) :]
        counts = ", ".join(
            f"{sum(path.fate == fate for path in scattered)} {word}"
            for fate, word in (
                ("solution", "end in the minimum"),
                ("plateau", "on a plateau"),
                ("stalled", "stall"),
            )
        )
        rows.append((law, f"{len(scattered)} scattered points", "", "", "", counts))
    heads = ("law", "start", "cost there", "least squares end at", "simplex ends at", "the simplex")
    return Table("Where does a search lead from the thesis's own optima?", heads, tuple(rows), text_columns=2)
