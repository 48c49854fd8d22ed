"""Is what is called ok a mode, and is no mode lost? Records with planted faults beside clean ones.

Usage: ``python qualify/screening.py [--records 450] [--peers]``. Each fault of ``FAULTS`` in three
strengths, and clean records, over random systems of known truth. ``--peers`` runs pyOMA2 and koma on the
same records; both must be installed (``pip install --no-deps koma-python``). Interrupted runs resume.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from time import process_time

import numpy as np
from common.cases import Result, cases
from common.faults import FAULTS, SENSE
from common.page import write_page
from common.peers import PEERS
from common.planted import RandomSystem, matched, random_system, recognised

from jackettwin.errors import InputError
from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.synthetic import simulate
from jackettwin.records import Record

SEED = 4
CLEAN = 7
"""Of so many records in seventy."""
KINDS = [("clean", 0.0)] * CLEAN + [(name, strength) for strength in (1.0, 2.0, 3.0) for name in FAULTS]
Peer = Callable[[Record], list[tuple[float, float, np.ndarray]]]


def tower(rng: np.random.Generator) -> RandomSystem:
    """Draw a system of four channels or more with first modes at 0.15 to 0.5 Hz, damped by at most 3 %."""
    while True:
        drawn = random_system(rng)
        system = drawn.system
        if system.mode_shapes.shape[1] < 4 or system.damping_ratio.max() > 0.03:
            continue
        scale = 10 ** rng.uniform(np.log10(0.15), np.log10(0.5)) / system.frequency_hz[0]
        system = replace(system, frequency_hz=system.frequency_hz * scale)
        rate = float(min(drawn.sample_rate_hz * scale, 30.0))
        return RandomSystem(system, min(drawn.duration_s / scale, 900.0), rate, drawn.rank)


def planted(case: int) -> tuple[str, float, RandomSystem, Record]:
    """Return fault, strength, system and record of a case."""
    rng = np.random.default_rng((SEED, case))
    fault, strength = KINDS[case % len(KINDS)]
    drawn = tower(rng)
    record = simulate(drawn.system, rng, duration_s=drawn.duration_s, sample_rate_hz=drawn.sample_rate_hz)
    if fault != "clean":
        record = FAULTS[fault](record, strength, rng)
    return fault, strength, drawn, record


def run(case: int, *, peers: tuple[str, ...] = ()) -> Result:
    """Return what is said of one record."""
    fault, strength, drawn, record = planted(case)
    start = process_time()
    try:
        found = examine(record, IdentificationSettings()).identification
    except InputError as refusal:
        return {"fault": fault, "strength": strength, "refused": str(refusal)}
    except Exception as error:
        return {"fault": fault, "strength": strength, "stopped": repr(error)}
    seconds = process_time() - start
    sense = record.metadata.get(SENSE)
    channels = [record.channel_names.index(c.name) for c in found.channels]
    pairs = matched(found, drawn.system, channels=channels, sense=sense)
    own = {pair["mode"] for pair in pairs if pair["mode"] is not None}
    others = [
        {"f": m.frequency_hz, "zeta": m.damping_ratio, "status": m.status.value, "of": m.method}
        for k, m in enumerate(found.modes)
        if k not in own
    ]
    result: Result = {
        "fault": fault,
        "strength": strength,
        "cpu_s": seconds,
        "modes": pairs,
        "others": others,
        "codes": sorted({reason.code for m in found.modes for reason in m.reasons}),
    }
    clear = [bool(p["findable"]) for p in pairs]
    for name in peers:
        try:
            said = PEERS[name](record, found.settings)
            result[name] = recognised(said, drawn.system, clear, sense)
        except Exception as error:
            result[name] = {"stopped": repr(error)}
    return result


def row(name: str, results: list[Result], peers: tuple[str, ...]) -> str:
    """Return a row of the table."""
    modes = [m for r in results for m in r.get("modes", ())]
    said = [m for m in modes if m["status"] == "ok"]
    false = sum(other["status"] == "ok" for r in results for other in r.get("others", ()))
    flagged = sum(other["status"] != "ok" for r in results for other in r.get("others", ()))
    clear = [m for m in modes if m["findable"]]
    lost = np.mean([m["status"] is None for m in clear]) if clear else 0.0
    right = 100.0 * len(said) / max(len(said) + false, 1)
    f, zeta = (100.0 * np.mean([m[key] for m in said]) if said else np.nan for key in KEYS)
    cells = [f"{len(results)}", f"{len(said) + false}", f"{right:.1f}", f"{f:.1f}", f"{zeta:.1f}"]
    cells += [f"{flagged}", f"{100.0 * lost:.1f}"]
    for peer in peers:
        known = [r[peer] for r in results if peer in r and "stopped" not in r[peer]]
        if not known:
            cells.append("–")
            continue
        true, wrong, missed, n = (sum(k[key] for k in known) for key in ("true", "false", "lost", "findable"))
        cells.append(f"{100.0 * true / max(true + wrong, 1):.0f} / {100.0 * missed / max(n, 1):.0f}")
    return f"| {name} | " + " | ".join(cells) + " |"


KEYS = ("frequency_inside", "damping_inside")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--records", type=int, default=450)
    parser.add_argument("--peers", action="store_true")
    chosen = parser.parse_args()
    wanted = {"pyoma2": "pyOMA2", "koma": "koma"}
    peers = tuple(wanted) if chosen.peers else ()
    absent = [wanted[name] for name in peers if find_spec(name) is None]
    if absent:
        parser.error(f"--peers needs {', '.join(absent)}")
    part = "-" + "-".join(peers) if peers else ""
    results = cases("screening", chosen.records, lambda case: run(case, peers=peers), part=part, whole=True)
    head = (
        "| fault | records | called ok | of these true [%] | f inside [%] | ζ inside [%] | false but flagged "
    )
    head += "| findable lost [%] |" + "".join(f" {wanted[p]}: true / lost [%] |" for p in peers)
    lines = [
        "# What is called a mode",
        "",
        f"`python qualify/screening.py --records {chosen.records}{' --peers' if peers else ''}`:",
        "random systems with planted faults. A mode is lost if no mode, of any status, is reported for",
        "it although it is findable: its peak is four times everything else in some direction.",
        "",
        head,
        "|---" * (8 + len(peers)) + "|",
        row("all", results, peers),
    ]
    for fault in dict.fromkeys(name for name, _ in KINDS):
        lines.append(row(f"**{fault}**", [r for r in results if r["fault"] == fault], peers))
        for strength in (1.0, 2.0, 3.0) if fault != "clean" else ():
            of = [r for r in results if r["fault"] == fault and r["strength"] == strength]
            lines.append(row(f"{fault}, strength {strength:.0f}", of, peers))
    cpu = [r["cpu_s"] for r in results if "cpu_s" in r]
    stopped = [r for r in results if "stopped" in r]
    lines += [
        "",
        f"Stopped: {len(stopped)}. CPU-seconds a record: median {np.median(cpu):.2f}, most {max(cpu):.2f}.",
    ]
    write_page("screening", lines)


if __name__ == "__main__":
    main()
