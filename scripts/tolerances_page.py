"""Write docs/reference/tolerances.md from the registry: python scripts/tolerances_page.py."""

from __future__ import annotations

from pathlib import Path

from jackettwin.twin.tolerances.registry import REMAINDERS, TOLERANCES

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "tolerances.md"
TOP = """# Tolerances

What drawings, weighing and the sea leave open. Each is one unknown of all modes and records, normal about
what the twin states with the standard deviation below, and part of every fit whose data carry standard
deviations ([theory](../theory/updating.md)). A twin sizes them:

```yaml
tolerances:
  rna_mass: 0.005              # weighed to half a per cent
  growth: {weighed: true}      # inspected: there is none
  jacket_mass: 0               # closed as well
```

`tolerances: none` closes all of them, and the remainders. A unit of `-` is a share of what the twin states.

| name | of what | σ | unit | source | what settles it |
|---|---|---|---|---|---|
"""
SUSPECTS = """
Suspects widen no interval. They are tried when a twin cannot meet its data, and named where the data would
not show them; a twin that sizes one makes a tolerance of it.

| name | of what | tried at | unit | source | what settles it |
|---|---|---|---|---|---|
"""


def page() -> str:
    """Return the page."""
    rows: dict[bool, list[str]] = {False: [], True: []}
    for known in TOLERANCES.values():
        t = known.tolerance
        row = f"| `{t.name}` | {t.words} | {t.std:g} | {t.unit} | {t.source} | {t.settled_by} |"
        rows[known.suspected].append(row)
    remainders = [
        f"| `{name}` | of each mode by itself | {std:g} | - | assumed: finer meshes, shells, other laws | |"
        for name, std in REMAINDERS.items()
    ]
    return TOP + "\n".join([*rows[False], *remainders]) + "\n" + SUSPECTS + "\n".join(rows[True]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
