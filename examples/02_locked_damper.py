"""Two supports, almost the same first pole: one is soil, the other a spring behind a locked damper.

Tables 8.1 and 8.3 of the thesis. The undamped frequencies tell them apart.
Run: python examples/02_locked_damper.py
"""

from jackettwin import (
    Rayleigh,
    assemble,
    build_system,
    damped_modes,
    read_structure,
    read_support,
    undamped_modes,
)


def main() -> list[float]:
    """Print damped and undamped first frequencies; return the undamped ones."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    undamped = []
    for text in ("kelvin-voigt:k=2.5e9,c=7.6e8", "kelvin-voigt:k=1.1e8,c=1e11"):
        support = read_support(text, structure)
        system = build_system(assembly, support, rayleigh=Rayleigh.minimum(0.01, 0.1832))
        damped = damped_modes(system, below_hz=0.5)
        undamped.append(float(undamped_modes(system, 1).frequency_hz[0]))
        print(f"{text}: damped {damped.frequency_hz[0]:.4f} Hz, undamped {undamped[-1]:.4f} Hz")
    return undamped


if __name__ == "__main__":
    main()
