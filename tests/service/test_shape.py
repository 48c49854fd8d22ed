"""How the service is made: thin routes, and an engine that knows neither paths nor sessions nor clocks."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import jackettwin

SOURCE = Path(jackettwin.__file__).parent
LONGEST = 15
"""Lines of a route's body: it takes a request apart, asks one function, and answers."""
PURE = ("identification", "watching", "updating", "response", "structure", "soil")
"""Packages that the pair is made of."""
PAIR = [
    *(
        SOURCE / "twin" / f"{name}.py"
        for name in ("observe", "advance", "state", "exact_sums", "observation", "model", "operation")
    ),
    SOURCE / "change" / "judge.py",
]
FOREIGN = {"sqlalchemy", "fastapi", "starlette", "distributed", "dask", "paho", "uvicorn", "httpx", "sqlite3"}
CLOCKS = {"time.time", "time.monotonic", "datetime.now", "datetime.utcnow", "datetime.today", "date.today"}


def routes(path: Path) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            calls = [d.func for d in node.decorator_list if isinstance(d, ast.Call)]
            if any(isinstance(c, ast.Attribute) and ast.unparse(c.value) == "router" for c in calls):
                found.append(node)
    return found


def test_routes_are_thin() -> None:
    known = 0
    for path in [*SOURCE.glob("service/web/routes/*.py"), SOURCE / "service" / "web" / "pages.py"]:
        for route in routes(path):
            known += 1
            body = [node for node in route.body if not _is_docstring(node)]
            lines = body[-1].end_lineno - body[0].lineno + 1  # type: ignore[operator]
            assert lines <= LONGEST, f"{path.name}: {route.name} has {lines} lines"
    assert known > 35


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def modules() -> list[Path]:
    return [*PAIR, *(path for name in PURE for path in (SOURCE / name).rglob("*.py"))]


@pytest.mark.parametrize("path", PAIR, ids=lambda path: path.stem)
def test_the_pair_sees_no_path(path: Path) -> None:
    assert "pathlib" not in imported(path) and "os" not in imported(path)
    assert not [
        n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Name) and n.id == "open"
    ]


def test_the_engine_sees_no_session_and_no_clock() -> None:
    for path in modules():
        assert not imported(path) & FOREIGN, path
        calls = {
            ast.unparse(n.func) for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)
        }
        assert not calls & CLOCKS, path
    assert len(modules()) > 100


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module.partition(".")[0])
    return names


HEAVY = {"numpy", "scipy", "numba", "pyarrow", "pandas", "plotly", "dask", "distributed", "alembic"}
"""What takes the CPU seconds of a start, if the application asks for it before a request does."""


def test_a_worker_loads_no_statistics_of_scipy() -> None:
    """They and what they load were a quarter of the 1.8 CPU seconds in which each worker starts."""
    script = "import sys, jackettwin.service.workers.engine; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not {"scipy.stats", "scipy.signal", "plotly", "pandas"} & set(done.stdout.split())


def test_importing_the_application_loads_no_numerics() -> None:
    """Counted in modules, which do not depend on the machine: 1.4 CPU seconds where it once took 4.7.

    Beside its own room and the store it loads errors, findings and the edge of files only.
    """
    script = "import sys, jackettwin.service.web.app; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert not loaded & HEAVY
    ours = {name.split(".")[1] for name in loaded if name.startswith("jackettwin.")}
    assert ours <= {"service", "store", "files", "errors", "findings", "caveats", "version"}
