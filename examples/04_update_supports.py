"""Kelvin-Voigt feet that meet Table 6.1 of the thesis, and every other solution of the same problem.

Run: python examples/04_update_supports.py
"""

from jackettwin import read_twin, run_twin


def main() -> float:
    """Print each solution; return the largest error of the fitted frequencies of the best one."""
    result = run_twin(read_twin("thesis_table_6_1"), laws=("kelvin-voigt",))
    update = result.updates[0]
    for solution in update.solutions:
        k, c = solution.theta
        locked = ", locked damper" if solution.locked_damper else ""
        print(f"k {k:.3g} N/m, c {c:.3g} N·s/m, cost {solution.cost:.3g}{locked}")
    return max(
        abs(f / m.frequency_hz - 1.0)
        for m, f in zip(result.measured, update.modes.frequency_hz, strict=True)
        if m.frequency_hz is not None
    )


if __name__ == "__main__":
    main()
