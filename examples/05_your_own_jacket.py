"""A three-leg jacket of your own: read it, check it, find its modes.

Run: python examples/05_your_own_jacket.py
"""

from pathlib import Path

from jackettwin import assemble, build_system, read_structure, read_support, undamped_modes
from jackettwin.structure import check


def main() -> list[float]:
    """Print the check and the first modes; return their frequencies."""
    structure = read_structure(Path(__file__).with_name("three_leg_jacket.yaml"))
    assembly = assemble(structure)
    model = check(assembly)
    print(f"{len(structure.members)} members, {model.mass_kg / 1e3:.0f} t")
    print(f"{model.rigid_body_modes} rigid-body modes", *model.warnings, sep="\n")
    system = build_system(assembly, read_support("pinned", structure))
    frequencies = undamped_modes(system, 5).frequency_hz
    print(", ".join(f"{f:.4f} Hz" for f in frequencies))
    return frequencies.tolist()


if __name__ == "__main__":
    main()
