"""Record what the commands, the service and the Python interface answer; compare two such records."""

import base64
import gzip
import io
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import click
import httpx
import numpy as np
import pyarrow.parquet as pq
from scipy.io import netcdf_file

FEET = "--support kelvin-voigt:k=2.5e9,c=7.6e8"
ONE, TWO = "../inputs/pile_U12_s301.parquet", "../inputs/pile_U12_s301.parquet ../inputs/pile_U8_s302.parquet"
RUNS = {
    "run": "run openfast_pile --json",
    "run_two": "run ../inputs/two_records.yaml --compare --json",
    "compare": "compare ../run/out/openfast_pile ../run_two/out/two_records --json",
    "update": "update thesis_table_6_1 --json",
    "follow": "follow ../inputs/two_records.yaml --each record --out out --json",
    "follow_on": "follow openfast_pile --prior ../follow/out/followed.json --out out --json",
    "identify": f"identify {ONE} --compare --real-poles --report page.html --out modes.csv --json",
    "identify_two": f"identify {TWO} --report page.html --out out --json",
    "watch": "watch ../inputs/watched.csv --structure jacket15 --baseline-days 90 --out out --json",
    "modes": f"modes jacket15 {FEET} --rayleigh 0.01,0.1832 --gravity --blades iea15 --json",
    "stages": "stages jacket15 --against thesis --json",
    "soil": "soil jacket15 --out page.html --json",
    "check": "check jacket15 --support pinned --still-water --edition 2020 --json",
    "check_scenario": "check --scenario ../inputs/sea.yaml --json",
    "refine": "refine ../inputs/refine_jacket15.yaml --json",
    "loads": "loads ../inputs/sea.yaml --json",
    "simulate": "simulate ../inputs/sea.yaml --json",
    "simulate_set": "simulate-set ../inputs/set.yaml --out out --workers 1 --json",
    "superelement": f"superelement jacket15 {FEET} --rayleigh 0.01,0.1832 --json",
    "extptfm": f"superelement jacket15 {FEET} --modes 6 --out six.dat --json",
    "export": f"export jacket15 {FEET} --json",
    "view": f"view jacket15 {FEET} --growth 0,-40,0.1 --wave 6,10 --record {ONE} --json",
    "init": f"init jacket15 {TWO} --json",
    "verify": "verify --json",
    "refused": "modes jacket15 --support kelvin-voigt:k=-1 --json",
    "asset_add": "asset add wtg ../inputs/two_records.yaml --store ../store --json",
    "intake": f"intake {TWO} --asset wtg --store ../store --json",
    "serve": "serve ../store --workers 1 --port",
}
AS_TEXT = ("run", "modes", "stages", "soil", "check", "refine", "loads", "extptfm")  # without --json as well
PAGES = ("/", "/login", "/assets/wtg", "/assets/wtg/report")  # beside every GET of the OpenAPI document
EXPECTED_KEYS = {"code_version", "wall_s", "free_bytes"}  # the code's name, a duration, room on the disk
EXPECTED_TEXT = {  # what may differ, and why; folders are left out when they are recorded
    r"20(2[6-9]|[3-9]\d)-\d\d-\d\d[T ]\d\d:\d\d[:.\d]*": "time of recording: the data are of 2024 and 2025",
    r"(?<=jackettwin )\d+\.\d+\.\d\S*": "the version",
    r"\(\d+ kB\)": "size of a packed figure: depends on the compression and the drawing library",
    r"(_age_seconds|_free_bytes).*": "metrics of the clock and of the disk",
    r"(?<= at 0x)[0-9a-f]+": "where in memory a default value lies",
}
NOTED = re.compile(r"/help/|/(model_hash|state_hash)$")  # rewritten on purpose; change with any last digit
LONG_NUMBER = re.compile(r"[-+]?\d+\.\d{7,}(?:[eE][-+]?\d+)?")  # in a text; shorter ones are its letters
NOTHING, SOURCE = "(nothing)", Path(__file__).parents[1] / "src"
INTERFACE = """
import click, inspect, json, jackettwin
from jackettwin.cli import main
from jackettwin.client import Client
def help_of(command, name):
    context = click.Context(command, info_name=name)
    yield name, command.get_help(context).splitlines()
    for one in command.list_commands(context) if isinstance(command, click.Group) else ():
        yield from help_of(command.get_command(context, one), f"{name} {one}")
python = {name: getattr(jackettwin, name) for name in jackettwin.__all__} | vars(Client)
python = {name: [f"{p.kind.name} {p.name} {p.default!r}" for p in inspect.signature(one).parameters.values()]
          for name, one in python.items() if name[0] != "_"}
print(json.dumps({"python": python, "help": dict(help_of(main, "jackettwin"))}))
"""


def content(suffix: str, raw: bytes) -> Any:
    """Return what is in a file, by the ending of its name."""
    if suffix == ".parquet":
        return pq.read_table(io.BytesIO(raw)).to_pydict()
    if suffix in (".npz", ".nc"):
        arrays = np.load(io.BytesIO(raw)) if suffix == ".npz" else netcdf_file(io.BytesIO(raw)).variables
        return {name: array[...].tolist() for name, array in arrays.items()}
    text = raw.decode()
    return page(text) if suffix == ".html" else json.loads(text) if suffix == ".json" else text.splitlines()


def page(html: str) -> dict[str, Any]:
    """Return the visible text of a page, and the data that its scripts draw, packed or not."""
    text = re.sub(r"(?s)<(script|style)\b.*?</\1>|<[^>]*>", "\n", html)
    data = {}
    for name, script in re.findall(r'(?s)<script[^>]* id="(?!plotly")([\w-]+)"[^>]*>(.*?)</script>', html):
        drawn = script if script.startswith("{") else gzip.decompress(base64.b64decode(script)).decode()
        data[name] = page(drawn) if drawn.startswith("<") else json.loads(drawn, object_hook=_unpacked)
    return {"text": [" ".join(line.split()) for line in text.splitlines() if line.strip()], "data": data}


def _unpacked(value: dict[str, Any]) -> Any:
    packed = value.get("bdata")  # as Plotly packs an array
    return value if packed is None else np.frombuffer(base64.b64decode(packed), value["dtype"]).tolist()


def run(here: Path, *command: str) -> dict[str, Any]:
    """Run Python in a folder; return what it printed and wrote, and why it refused."""
    done = subprocess.run([sys.executable, *command], capture_output=True, cwd=here)
    files: dict[str, list[Any]] = {}
    for file in sorted(here.rglob("*")):
        if file.is_file() and file.suffix != ".js":  # the drawing library
            masked = re.sub(r"[0-9a-f]{12,}", "HASH", str(file.relative_to(here)))
            files.setdefault(masked, []).append(content(file.suffix, file.read_bytes()))
    return {
        "exit_code": done.returncode,
        "errors": [line for line in done.stderr.decode().splitlines() if re.match(r"error:|\w+Error", line)],
        "printed": content(".json" if done.stdout[:1] == b"{" else "", done.stdout),
        "files": {name: sorted(same, key=str) for name, same in files.items()},
    }


def serve(here: Path, *command: str) -> dict[str, Any]:
    """Let the service observe what was taken in; return its answers to all that can be got but its events."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    transport = httpx.HTTPTransport(retries=8)  # until it is there
    server = subprocess.Popen([sys.executable, *command, port], cwd=here, stderr=subprocess.DEVNULL)
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, transport=transport) as http:
            while {"queued", "leased"} & {job["state"] for job in http.get("/api/v1/jobs").json()["items"]}:
                time.sleep(2)
            answers: dict[str, Any] = {"openapi": http.get("/api/v1/openapi.json").json()}
            paths = [path for path, can in answers["openapi"]["paths"].items() if "get" in can]
            record_id = http.get("/api/v1/assets/wtg/records").json()["items"][0]["record_id"]
            for path in (*PAGES, *(path for path in paths if not path.endswith("/events"))):
                asked = path.format(asset="wtg", record_id=record_id, job_id=1)
                answer = http.get(asked, params={"version": 1} if asked.endswith("/comparison") else None)
                kind = re.split(r"[./+]", answer.headers["content-type"].partition(";")[0])[-1]
                answers[path] = [answer.status_code, kind, content(f".{kind}", answer.content)]
            return answers
    finally:
        server.terminate()
        server.wait()


def write_inputs(into: Path, source: Path) -> None:
    """Copy records and examples, shorten what is shipped, and make a table to watch from a seed."""
    into.mkdir()
    for file in (*source.rglob("pile_U*"), *source.parent.glob("examples/*.yaml")):
        (into / file.name).write_bytes(file.read_bytes())
    twin, scenario = (next(source.rglob(f"{name}.yaml")).read_text() for name in ("openfast_pile", "parked"))
    (into / "two_records.yaml").write_text(re.sub(r"  - \S*_s30[348]\S*\n|\.\./records/", "", twin))
    (into / "sea.yaml").write_text(scenario.replace("duration_s: 600", "duration_s: 100"))
    (into / "set.yaml").write_text("{scenario: sea.yaml, seeds: 2, bins: [{speed_m_s: 9, hs_m: 1, tp_s: 6}]}")
    table = ["time_utc,label,frequency_hz,temperature"]
    for (k, mode), noise in np.ndenumerate(np.random.default_rng(3).standard_normal((320, 2))):
        label, f = (("fore_aft_1", 0.178), ("side_side_2", 0.744))[mode]
        f *= 1 + 0.002 * noise - 0.01 * (k > 240)
        table.append(f"{np.datetime64('2024-03-01T00') + 12 * k}:00,{label},{f:.6f},{k % 7}")
    (into / "watched.csv").write_text("\n".join(table))


@click.group()
def main() -> None:
    """Record what two states of the code answer, and compare."""


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, resolve_path=True))
@click.option("--source", type=click.Path(path_type=Path, resolve_path=True), default=SOURCE)
def record(folder: Path, source: Path) -> None:
    """Run everything with the code in SOURCE, the src of a checkout; write what it says into FOLDER."""
    folder.mkdir(parents=True)
    examples = {f"example_{file.stem}": [str(file)] for file in sorted(source.parent.glob("examples/*.py"))}
    texts = {f"{name}_text": RUNS[name].removesuffix(" --json") for name in AS_TEXT}
    runs = {name: ["-m", "jackettwin", *command.split()] for name, command in (RUNS | texts).items()}
    with tempfile.TemporaryDirectory() as work:
        os.environ.update(PYTHONPATH=str(source), XDG_CACHE_HOME=work, OMP_NUM_THREADS="1", COLUMNS="110")
        write_inputs(Path(work, "inputs"), source)
        for name, program in {"interface": ["-c", INTERFACE], **examples, **runs}.items():
            Path(work, name).mkdir()
            answer = (serve if name == "serve" else run)(Path(work, name), *program)
            print(name, answer.get("exit_code", ""), flush=True)
            text = json.dumps(answer, indent=1, ensure_ascii=False, default=str)
            text = re.sub(rf"({re.escape(work)}|{re.escape(str(source))})[\w./-]*/", "", text)
            (folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def differences(before: Any, after: Any, path: str, rtol: float) -> list[tuple[str, Any, Any]]:
    """Return where two answers differ: the path, before, after."""
    if close(before, after, rtol):
        return []
    if isinstance(before, list) and isinstance(after, list):
        before, after = dict(enumerate(before)), dict(enumerate(after))
    if not (isinstance(before, dict) and isinstance(after, dict)):
        return [(path, before, after)]
    pairs = {key: (before.get(key, NOTHING), after.get(key, NOTHING)) for key in before | after}
    compared = {key: pair for key, pair in pairs.items() if key not in EXPECTED_KEYS}
    return [d for key, pair in compared.items() for d in differences(*pair, f"{path}/{key}", rtol)]


def close(before: Any, after: Any, rtol: float) -> bool:
    """Return whether values are the same but for what is expected and for rounding."""
    if before == after:
        return True
    if isinstance(before, str) and isinstance(after, str):
        for pattern in EXPECTED_TEXT:
            before, after = re.sub(pattern, "", before), re.sub(pattern, "", after)
        old, new = ([float(n) for n in LONG_NUMBER.findall(text)] for text in (before, after))
        return LONG_NUMBER.sub("", before) == LONG_NUMBER.sub("", after) and close(old, new, rtol)
    try:
        a, b = np.array(before), np.array(after)
    except ValueError:  # lists of different lengths
        return False
    if a.shape != b.shape or {a.dtype.kind, b.dtype.kind} not in ({"f"}, {"f", "i"}):
        return False
    dust = 1e-3 * rtol * np.nanmax(np.abs(a), initial=0.0)  # beside the largest of an array
    return np.allclose(a, b, rtol, dust, equal_nan=True)


@main.command()
@click.argument("folders", metavar="BEFORE AFTER", nargs=2, type=click.Path(path_type=Path, exists=True))
@click.option("--rtol", default=1e-9, help="Of numbers, to call them the same.")
@click.option("--reworded", is_flag=True, help="Make a note of sentences that differ in no number.")
def compare(folders: tuple[Path, Path], rtol: float, reworded: bool) -> None:
    """Print how two recorded folders differ, 20 lines an answer; exit with 1 if it is by more than notes."""
    failed = 0
    said = re.compile(r"^\S*$|\d+").findall  # a value or a word that stands alone; the numbers of a sentence
    for name in sorted({file.name for folder in folders for file in folder.glob("*.json")}):
        files = [folder / name for folder in folders]
        old, new = (json.loads(file.read_text("utf-8")) if file.exists() else NOTHING for file in files)
        found = differences(old, new, name[:-5], rtol)
        notes = [NOTED.search(path) or reworded and said(str(a)) == said(str(b)) for path, a, b in found]
        failed += sum(not note for note in notes)
        for note, (path, *pair) in sorted(zip(notes, found, strict=True), key=lambda one: bool(one[0]))[:20]:
            texts = [json.dumps(value, ensure_ascii=False) for value in pair]
            shown = slice(start := max(len(os.path.commonprefix(texts)) - 50, 0), start + 100)
            print(f"{'note: ' if note else ''}{path}: {' -> '.join(one[shown] for one in texts)}")
        if len(found) > 20:
            print(f"{name[:-5]}: and {len(found) - 20} more")
    sys.exit(failed and f"differences: {failed}")


if __name__ == "__main__":
    main()
