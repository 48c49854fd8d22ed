"""Design basis of a fatigue life: what a certifier needs to follow it, as data and as a page."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from jackettwin.fatigue.curves import ENVIRONMENTS
from jackettwin.fatigue.environment import SPLASH_M
from jackettwin.fatigue.weld_life import ModelsAtHeight
from jackettwin.files import read_yaml
from jackettwin.version import __version__

_LONGEST_NAME = 255
_METHOD = {
    "counting": "rainflow, ASTM E1049-85, four-point form; unclosed cycles count half",
    "damage": "Miner's sum at eight points of each side of a weld, the worst taken last",
    "stress concentration": "Efthymiou 1988 (DNV-RP-C203, appendix B), shares of K, Y and X by force balance "
    "at every instant (ISO 19902 (2020), 14.2.4)",
    "interval": "lognormal; scatter of log N of the curve's tests, and coefficients of variation below "
    "(DNVGL-RP-C210)",
}


def design_basis(
    files: Iterable[Path], models: ModelsAtHeight, left_out: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """Return inputs with their SHA-256, editions, versions, factors and what is left out, as plain data.

    Parameters
    ----------
    files : that the numbers rest on, in the order of reading; those that they name follow them
    left_out : as ``left_out`` of the answer
    """
    zones = dict(zip(ENVIRONMENTS, (SPLASH_M[1] + 1.0, SPLASH_M[0] - 1.0, 0.0), strict=True))
    curves = {name: models(z)[1] for name, z in zones.items()}
    some = curves["air"]
    return {
        "program": {"name": "jackettwin", "version": __version__},
        "inputs": [
            {"file": str(f), "sha256": hashlib.sha256(f.read_bytes()).hexdigest()} for f in _with_named(files)
        ],
        "edition": some.curve.edition,
        "curves": {
            name: {
                "curve": m.curve.name,
                "m": list(m.curve.m),
                "log_a": list(m.curve.log_a),
                "knee_cycles": None if m.curve.knee_pa == 0.0 else m.curve.knee_cycles,
                "thickness_exponent": m.curve.thickness_exponent,
                "reference_thickness_m": m.curve.reference_thickness_m,
                "log_std": m.curve.log_std,
            }
            for name, m in curves.items()
        },
        "free_corrosion_zone_m": list(SPLASH_M),
        "design_factor": some.design_factor,
        "scf_cov": some.scf_cov,
        "miner_cov": some.miner_cov,
        "load_cov": some.load_cov,
        "method": dict(_METHOD),
        "left_out": [dict(one) for one in left_out],
    }


def _with_named(files: Iterable[Path]) -> list[Path]:
    """Return files, each followed by the files that it names, and they name, relative to their folder."""
    found: dict[Path, Path] = {}
    waiting = list(files)
    while waiting:
        file = waiting.pop(0)
        if file.resolve() not in found:
            found[file.resolve()] = file
            texts = _texts(read_yaml(file)) if file.suffix.lower() in (".yaml", ".yml", ".json") else ()
            waiting = [*(file.parent / text for text in texts if _is_file(file.parent, text)), *waiting]
    return list(found.values())


def _is_file(folder: Path, text: str) -> bool:
    return "." in text and "\n" not in text and len(text) < _LONGEST_NAME and (folder / text).is_file()


def _texts(value: Any) -> Iterator[str]:
    """Yield all texts in plain data."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _texts(one)
    elif isinstance(value, list):
        for one in value:
            yield from _texts(one)


def basis_page(title: str, basis: Mapping[str, Any], rows: Sequence[tuple[str, ...]]) -> str:
    """Return the design basis as a page in Markdown, the results' table (a head, then rows) at its end."""
    program = basis["program"]
    lines = [f"# Design basis: {title}", "", f"Computed with {program['name']} {program['version']}.", ""]
    lines += ["## Inputs", "", "| file | SHA-256 |", "|---|---|"]
    lines += [f"| {one['file']} | `{one['sha256']}` |" for one in basis["inputs"]]
    lines += ["", f"## S-N curves, {basis['edition']}", ""]
    lines += ["| environment | curve | m | log a | knee [cycles] | k | t_ref [mm] | deviation of log N |"]
    lines += ["|---|---|---|---|---|---|---|---|"]
    for name, c in basis["curves"].items():
        knee = "–" if c["knee_cycles"] is None else f"{c['knee_cycles']:.3g}"
        m, a = (", ".join(f"{v:g}" for v in dict.fromkeys(c[key])) for key in ("m", "log_a"))
        lines.append(
            f"| {name} | {c['curve']} | {m} | {a} | {knee} | {c['thickness_exponent']:g} "
            f"| {1e3 * c['reference_thickness_m']:g} | {c['log_std']:g} |"
        )
    low, high = basis["free_corrosion_zone_m"]
    lines += ["", f"Free corrosion from {low:g} to {high:g} m about the sea, cathodic protection below."]
    lines += ["", "## Method and factors", "", f"- design fatigue factor: {basis['design_factor']:g}"]
    lines += [f"- {name}: {text}" for name, text in basis["method"].items()]
    lines += [
        f"- coefficients of variation: stress concentration {basis['scf_cov']:g}, Miner's sum at failure "
        f"{basis['miner_cov']:g}, stress ranges {basis['load_cov']:g}",
        "", "## Left out", "",
    ]  # fmt: skip
    lines += [
        f"- {one['what']}" + (f" ({one['clause']})" if one["clause"] else "") for one in basis["left_out"]
    ]
    head, *body = rows
    lines += ["", "## Results", "", f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    lines += [f"| {' | '.join(row)} |" for row in body]
    return "\n".join(lines) + "\n"
