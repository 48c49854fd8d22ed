"""What an operator's programs are given: rules and a dashboard of measures there are, and lines of log."""

from __future__ import annotations

import json
import logging
import re
import sys
from pathlib import Path

import pytest
import yaml
from fastapi.testclient import TestClient
from tests.service.conftest import Here, upload

from jackettwin.service.context import Service
from jackettwin.service.logs import JsonLines, start_logging

DEPLOY = Path(__file__).parents[2] / "deploy"


def measured(client: TestClient) -> dict[str, str]:
    """Return the type of every measure, {name: type}."""
    text = client.get("/api/v1/metrics").text
    return dict(re.findall(r"^# TYPE (\S+) (\S+)$", text, flags=re.MULTILINE))


def test_rules_and_dashboard_ask_for_measures_there_are(client: TestClient, service: Service) -> None:
    upload(client, 1)
    service.broker_connected = lambda: True
    rules = yaml.safe_load((DEPLOY / "prometheus_rules.yaml").read_text())["groups"][0]["rules"]
    panels = json.loads((DEPLOY / "grafana_dashboard.json").read_text())["panels"]
    asked = [rule["expr"] for rule in rules] + [p["targets"][0]["expr"] for p in panels]
    names = {name for expression in asked for name in re.findall(r"jackettwin_\w+", expression)}
    known = measured(client)
    known |= {f"{name}_bucket": kind for name, kind in known.items() if kind == "histogram"}
    # no asset has an alarm here: the measure has no rows, and then no type is said of it
    assert names - {"jackettwin_alarms_open"} <= set(known)
    assert len(names) >= 10
    rising = {name for e in asked if "increase(" in e for name in re.findall(r"jackettwin_\w+", e)}
    assert {known[name] for name in rising} == {"counter"}
    assert {name for name, kind in known.items() if kind == "counter"} == rising


def test_latency_is_told_by_route_and_never_by_path(client: TestClient) -> None:
    client.get("/api/v1/assets/wtg")
    client.get("/api/v1/assets/nobody")
    client.get("/somewhere/else")
    text = client.get("/api/v1/metrics").text
    told = 'jackettwin_request_seconds_count{method="GET",route="/api/v1/assets/{asset}",status="%s"} 1.0'
    assert told % 200 in text and told % 404 in text
    assert "nobody" not in text and "somewhere" not in text


def test_slow_queries_are_counted_and_the_log_says_which(
    client: TestClient, service: Service, caplog: pytest.LogCaptureFixture
) -> None:
    """Not of whom: what a query is given may be a secret."""
    client.get("/api/v1/assets/wtg")
    assert "jackettwin_slow_queries_total 0.0" in client.get("/api/v1/metrics").text
    service.latency.watch(service.database, 0.0)
    client.get("/api/v1/assets/wtg")
    assert "jackettwin_slow_queries_total 0.0" not in client.get("/api/v1/metrics").text
    assert "FROM events WHERE" in caplog.text and "wtg" not in caplog.text


def test_a_request_is_a_span_of_the_trace_it_came_with(client: TestClient) -> None:
    """FastAPI makes them, if OpenTelemetry is there."""
    pytest.importorskip("opentelemetry.sdk", reason="optional: the user installs OpenTelemetry")
    from opentelemetry import trace
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.sdk.trace.export import SimpleSpanProcessor
    from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter

    told, provider = InMemorySpanExporter(), TracerProvider()
    provider.add_span_processor(SimpleSpanProcessor(told))
    trace.set_tracer_provider(provider)
    caller = "4bf92f3577b34da6a3ce929d0e0e4736"
    client.get("/api/v1/assets/wtg", headers={"traceparent": f"00-{caller}-00f067aa0ba902b7-01"})
    (span,) = [s for s in told.get_finished_spans() if s.kind is trace.SpanKind.SERVER]
    assert span.name == "GET /api/v1/assets/{asset}"
    assert f"{span.context.trace_id:032x}" == caller
    assert span.attributes["http.response.status_code"] == 200


def test_health_says_what_is_lacking(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert client.get("/api/v1/health").json() == {
        "status": "ok", "version": "0.1.0", "problems": [], "openid": False,
    }  # fmt: skip
    service.broker_connected = lambda: False
    monkeypatch.setattr(Here, "reachable", False)
    said = client.get("/api/v1/health")
    assert (said.status_code, said.json()["status"]) == (200, "degraded")  # another start does not help
    assert said.json()["problems"] == ["the scheduler does not answer", "the broker does not answer"]
    assert client.get("/api/v1/ready").status_code == 503
    service.turning = lambda: False
    assert client.get("/api/v1/health").status_code == 503  # another start does


def test_a_line_of_log_is_one_object() -> None:
    try:
        raise ValueError("gone\nwrong")
    except ValueError:
        fault = logging.LogRecord("a.b", logging.ERROR, "f", 1, "it %s\n", ("fell",), sys.exc_info())
    line = JsonLines().format(fault)
    assert "\n" not in line
    said = json.loads(line)
    assert (said["level"], said["logger"], said["message"]) == ("error", "a.b", "it fell\n")
    assert "ValueError: gone" in said["trace"]


@pytest.mark.parametrize(
    ("level", "told"), [("info", ["slow", "here"]), ("debug", ["begun", "slow", "here"])]
)
def test_libraries_tell_their_warnings_alone(
    level: str, told: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A server that starts told of twenty handshakes between its workers."""
    root = logging.RootLogger(logging.WARNING)
    monkeypatch.setattr(logging, "root", root)
    start_logging(level, as_json=True)
    for name, severity, text in [
        ("distributed.worker", logging.INFO, "begun"),
        ("distributed.worker", logging.WARNING, "slow"),
        ("jackettwin.service", logging.INFO, "here"),
    ]:
        record = logging.LogRecord(name, severity, __file__, 1, text, None, None)
        root.handle(record)
    assert [json.loads(line)["message"] for line in capsys.readouterr().err.splitlines()] == told
