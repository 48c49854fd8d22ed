"""Write docs/reference/tolerances.md from the registry: python scripts/tolerances_page.py."""

from __future__ import annotations

from pathlib import Path

from jackettwin.twin.tolerances.registry import REMAINDERS, TOLERANCES

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "tolerances.md"
TOP = """# Tolerances

Tolerances describe properties that drawings, weighing and sea data do not fix. Each is one unknown \
parameter common to all modes and records, normally distributed about
the value in the twin with the standard deviation below, and is part of every fit whose data have standard
deviations ([theory](../theory/updating.md)). A twin file sets their size:

```yaml
tolerances:
  rna_mass: 0.005              # weighed to half a per cent
  growth: {weighed: true}      # inspected: there is none
  jacket_mass: 0               # closed as well
```

`tolerances: none` removes all of them, and the remainders. A unit of `-` is a fraction of the value in \
the twin.

| name | of what | σ | unit | source | what settles it |
|---|---|---|---|---|---|
"""
SUSPECTS = """
Suspects are possible model errors that do not widen intervals. They are tested when a twin cannot fit \
its data, and are named where the data would
not show them; if a twin file gives one a size, it becomes a tolerance.

| name | of what | tried at | unit | source | what settles it |
|---|---|---|---|---|---|
"""
LEFT = {
    "remainder_frequency": "computed: finer meshes and shells change frequencies by 0.2 to 0.5 %",
    "remainder_damping": "computed: a dashpot differs from the twin's law by 1.9 % beyond `loss_growth`, "
    "by 31 % without it (`python qualify/wrong_models.py laws`); assumed: steel by a tenth in each mode, a "
    "third of the whole",
}
"""Sources of the remainders."""


def page() -> str:
    """Return the page."""
    rows: dict[bool, list[str]] = {False: [], True: []}
    for known in TOLERANCES.values():
        t = known.tolerance
        row = f"| `{t.name}` | {t.words} | {t.std:g} | {t.unit} | {t.source} | {t.settled_by} |"
        rows[known.suspected].append(row)
    remainders = [
        f"| `{name}` | of each mode by itself | {std:g} | - | {LEFT[name]} | |"
        for name, std in REMAINDERS.items()
    ]
    return TOP + "\n".join([*rows[False], *remainders]) + "\n" + SUSPECTS + "\n".join(rows[True]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
