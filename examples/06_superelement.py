"""A jacket as a superelement for OpenFAST, and what plain Craig-Bampton would have made of it.

Run: python examples/06_superelement.py
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from jackettwin import assemble, build_system, read_structure, read_support
from jackettwin.response.superelement.accuracy import damping_ratio, default_band_hz, reduced_modes
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.response.superelement.files import read_superelement, write_superelement
from jackettwin.structure import Rayleigh
from jackettwin.structure.cut import at_interface


def main(support: str = "kelvin-voigt:k=2.5e9,c=7.6e8") -> tuple[float, float]:
    """Print ζ of the second bending mode three ways; return the relative errors of both reductions."""
    whole = read_structure("jacket15")
    foundation, tower = at_interface(whole)
    held, steel = read_support(support, whole), Rayleigh.minimum(0.0055, 0.183)
    full, base = (build_system(assemble(part), held, rayleigh=steel) for part in (whole, foundation))
    band = default_band_hz(full)
    errors = []
    for name, damped in (("superelement", True), ("plain Craig-Bampton", False)):
        element = superelement(base, number=24, band_hz=band, damped=damped)
        modes = reduced_modes(element, full, assemble(tower), band_hz=band)
        exact, reduced = damping_ratio(modes.full)[3], damping_ratio(modes.reduced)[3]
        print(f"{name:>20}: {100 * reduced:.2f} %; full model {100 * exact:.2f} %")
        errors.append(float(reduced / exact - 1.0))
        if damped:
            with TemporaryDirectory() as folder:
                files = write_superelement(element, Path(folder) / "jacket.dat")
                print("for OpenFAST:", ", ".join(path.name for path in files))
                print(f"read back: {read_superelement(files[0]).n} coordinates")
    return errors[0], errors[1]


if __name__ == "__main__":
    main()
