"""Modes of a ten-minute record, with their intervals, no hands.

The record is one that OpenFAST produced and that comes with the package.
Run: python examples/03_identify_a_record.py
"""

from importlib.resources import as_file, files

from jackettwin import identify, read_record


def main() -> list[float]:
    """Print every mode with its 90 % interval of damping; return the frequencies."""
    with as_file(files("jackettwin.data") / "records") as folder:
        record = read_record(folder / "pile_U12_s308.parquet")
    found = identify(record.select([c.name for c in record.channels if c.quantity == "acceleration"]))
    for mode in found.modes:
        low, high = mode.damping_ratio_interval_90 or (float("nan"),) * 2
        print(
            f"{mode.frequency_hz:.4f} Hz, damping {100 * mode.damping_ratio:.2f} % "
            f"({100 * low:.2f} to {100 * high:.2f} in 90 %)"
        )
    return [mode.frequency_hz for mode in found.modes]


if __name__ == "__main__":
    main()
