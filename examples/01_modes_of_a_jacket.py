"""Modes of the shipped 15 MW jacket: pinned, then with self-weight, which softens the tower.

Run: python examples/01_modes_of_a_jacket.py
"""

from jackettwin import assemble, build_system, read_structure, read_support, undamped_modes


def main() -> float:
    """Print the first five frequencies; return how much gravity lowers the first."""
    structure = read_structure("jacket15")
    pinned = read_support("pinned", structure)
    without = undamped_modes(build_system(assemble(structure), pinned), 5).frequency_hz
    gravity = undamped_modes(build_system(assemble(structure, gravity=True), pinned), 5).frequency_hz
    for number, (f, softer) in enumerate(zip(without, gravity, strict=True), start=1):
        print(f"mode {number}: {f:.4f} Hz, with self-weight {softer:.4f} Hz")
    return float(1.0 - gravity[0] / without[0])


if __name__ == "__main__":
    main()
